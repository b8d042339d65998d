#include "common/verify.h"

#include <algorithm>

namespace skinbench {

static SkinError larger(const SkinError& a, const SkinError& b) {
    return {std::max(a.position, b.position), std::max(a.normal, b.normal)};
}

static SkinnedReference referenceOf(const Case& which, const Mesh& mesh, const Palette& palette) {
    if (which.variant->skins) return skinReference(mesh, palette);
    return {{mesh.positions.begin(), mesh.positions.end()}, {mesh.normals.begin(), mesh.normals.end()}};
}

// For each encoded vertex the vertex of the scene that it came from.
static std::vector<uint32_t> sourcesOf(const PlanInput& input) {
    std::vector<uint32_t> sources = input.encoded->sources;
    if (sources.empty())
        for (uint32_t v = 0; v < input.encoded->vertexCount; ++v) sources.push_back(v);
    if (input.records)
        for (uint32_t& source : sources) source = input.records->sources[source];
    return sources;
}

static SkinnedReference repeat(const SkinnedReference& reference, const std::vector<uint32_t>& sources) {
    SkinnedReference repeated;
    repeated.positions.reserve(sources.size());
    repeated.normals.reserve(sources.size());
    for (uint32_t source : sources) {
        repeated.positions.push_back(reference.positions[source]);
        repeated.normals.push_back(reference.normals[source]);
    }
    return repeated;
}

CapturedError capturedError(const Case& which, const PlanInput& input, const FrameData& frame,
                            std::span<const SkinnedVertex> captured) {
    const Mesh& mesh = input.scene->mesh;
    const size_t vertices = input.encoded->vertexCount;
    SKINBENCH_ASSERT(captured.size() == vertices * 2);
    const std::vector<uint32_t> sources = sourcesOf(input);
    const bool lossy = input.encoded->decode != nullptr;
    const Mesh decoded = lossy ? input.encoded->decode() : Mesh{};
    CapturedError worst;
    for (uint32_t copy : {0u, input.copies - 1}) {
        const Palette palette = paletteOfCopy(frame, input.copies, copy);
        const double diagonal = std::max<double>(posedBounds(mesh, palette).diagonal(), 1e-30);
        const auto part = captured.subspan(copy == 0 ? 0 : vertices, vertices);
        const SkinnedReference reference = repeat(referenceOf(which, mesh, palette), sources);
        const SkinError source = compareSkinned(reference, part, diagonal);
        worst.source = larger(worst.source, source);
        const SkinError own = lossy ? compareSkinned(referenceOf(which, decoded, palette), part, diagonal) : source;
        worst.decoded = larger(worst.decoded, own);
    }
    return worst;
}

}  // namespace skinbench
