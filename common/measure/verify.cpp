#include "common/measure/verify.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "common/plans/plan_parts.h"
#include "common/scene/tangents.h"

namespace skinbench {

static SkinError larger(const SkinError& a, const SkinError& b) {
    return {std::max(a.position, b.position), std::max(a.normal, b.normal), std::max(a.undecided, b.undecided)};
}

static std::vector<glm::vec4> rowsOf(const PlanInput& input, const Palette& palette, const PaletteForm& form) {
    auto rows = paletteRows(input.scene->skeleton, palette, form);
    SKINBENCH_ASSERT(rows);  // the frame was drawn with them
    return std::move(*rows);
}

SkinnedReference skinnedReference(const PlanInput& input, const Mesh& mesh, const Palette& palette) {
    if (input.palette == PaletteForm{}) return skinReference(mesh, palette);
    return skinReference(mesh, rowsOf(input, palette, input.palette), input.palette);
}

static SkinnedReference referenceOf(const Case& c, const PlanInput& input, const Mesh& mesh, const Palette& palette) {
    if (posesVertices(c)) return skinnedReference(input, mesh, palette);
    return {{mesh.positions.begin(), mesh.positions.end()}, {mesh.normals.begin(), mesh.normals.end()}, {}};
}

// The joints as linear blending with rounded rows moves them.
static Palette rounded(const PlanInput& input, const Palette& palette) {
    const std::vector<glm::vec4> rows = rowsOf(input, palette, {Method::lbs, input.palette.format});
    Palette moved(palette.size());
    for (size_t i = 0; i < rows.size(); ++i) moved[i / 3].rows[i % 3] = rows[i];
    return moved;
}

// What `copy` of the case moves by because its rows are rounded.
static RowsError rowsErrorOf(const PlanInput& input, const FrameData& frame, uint32_t copy, double scale) {
    PaletteForm exact = input.palette;
    exact.format = RowFormat::f32;
    const Mesh& mesh = input.scene->mesh;
    const Palette& palette = paletteOfCopy(frame, copy);
    const SkinnedReference a = skinReference(mesh, rowsOf(input, palette, exact), exact);
    const SkinnedReference b = skinReference(mesh, rowsOf(input, palette, input.palette), input.palette);
    const glm::dvec2 half(input.width / 2.0, input.height / 2.0);
    RowsError worst;
    for (size_t v = 0; v < a.positions.size(); ++v) {
        if (!a.undecided.empty() && (a.undecided[v] || b.undecided[v])) continue;
        worst.position = std::max(worst.position, glm::distance(a.positions[v], b.positions[v]));
        const glm::dvec4 from = clipPosition(frame.constants, copy, a.positions[v]);
        const glm::dvec4 to = clipPosition(frame.constants, copy, b.positions[v]);
        if (from.w > 0 && to.w > 0)
            worst.pixels =
                std::max(worst.pixels, glm::distance(glm::dvec2(from) / from.w * half, glm::dvec2(to) / to.w * half));
    }
    worst.position /= scale;
    return worst;
}

static SkinnedReference repeat(const SkinnedReference& reference, const std::vector<uint32_t>& sources) {
    SkinnedReference repeated;
    repeated.positions.reserve(sources.size());
    repeated.normals.reserve(sources.size());
    for (uint32_t source : sources)
        if (!reference.undecided.empty()) repeated.undecided.push_back(reference.undecided[source]);
    for (uint32_t source : sources) {
        repeated.positions.push_back(reference.positions[source]);
        repeated.normals.push_back(reference.normals[source]);
    }
    return repeated;
}

double errorScale(const Mesh& mesh, const Palette& palette) {
    constexpr double kLargest = 1e18;
    double reach = 0;
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::dvec4 p(glm::abs(glm::dvec3(mesh.positions[v])), 1);
        glm::dvec3 sum(0);
        const Influences& influences = mesh.influences[v];
        for (int k = 0; k < kMaxInfluences; ++k) {
            if (influences.weights[k] == 0 || influences.joints[k] == kNoJoint) continue;
            const PaletteEntry& joint = palette[influences.joints[k]];
            for (int row = 0; row < 3; ++row)
                sum[row] += influences.weights[k] * glm::dot(glm::abs(glm::dvec4(joint.rows[row])), p);
        }
        reach = std::max({reach, sum.x, sum.y, sum.z});
    }
    const double scale = std::max(posedBounds(mesh, palette).diagonal(), reach / 2);
    return scale <= kLargest ? scale : std::numeric_limits<double>::infinity();
}

References makeReferences(const Case& c, const PlanInput& input, const FrameData& frame) {
    const Mesh& mesh = input.scene->mesh;
    const std::vector<uint32_t> sources = sourcesOf(input);
    const bool lossy = input.encoded->decode != nullptr;
    const Mesh decoded = lossy ? input.encoded->decode() : Mesh{};
    References references;
    for (uint32_t number = 0; number < input.copies; number += std::max(1u, input.copies - 1)) {
        const Palette& palette = paletteOfCopy(frame, number);
        References::Copy& copy = references.copies.emplace_back();
        copy.scale = errorScale(mesh, palette);
        copy.source = repeat(referenceOf(c, input, mesh, palette), sources);
        if (lossy) copy.decoded = referenceOf(c, input, decoded, palette);
        if (!posesVertices(c) || input.palette.format == RowFormat::f32) continue;
        const RowsError error = rowsErrorOf(input, frame, number, copy.scale);
        const RowsError before = references.rowsError.value_or(RowsError{});
        references.rowsError =
            RowsError{std::max(before.position, error.position), std::max(before.pixels, error.pixels)};
    }
    references.bound = codecPositionBound(c, input, frame);
    return references;
}

CapturedError capturedError(const References& references, std::span<const SkinnedVertex> captured,
                            std::span<const char> leftOut) {
    CapturedError worst;
    const size_t vertices = captured.size() / 2;
    for (size_t i = 0; i < references.copies.size(); ++i) {
        const References::Copy& copy = references.copies[i];
        SKINBENCH_ASSERT(copy.source.positions.size() == vertices);
        const auto part = captured.subspan(i * vertices, vertices);
        const auto left = leftOut.empty() ? leftOut : leftOut.subspan(i * vertices, vertices);
        const SkinError source = compareSkinned(copy.source, part, copy.scale, left);
        worst.source = larger(worst.source, source);
        const SkinError own = copy.decoded ? compareSkinned(*copy.decoded, part, copy.scale, left) : source;
        worst.decoded = larger(worst.decoded, own);
    }
    return worst;
}

// How far `moved` reaches, at most, in each axis.
static double reach(const PaletteEntry& joint, const glm::dvec3& moved) {
    glm::dvec3 far;
    for (int row = 0; row < 3; ++row) far[row] = glm::dot(glm::abs(glm::dvec3(joint.rows[row])), moved);
    return glm::length(far);
}

static glm::dvec3 transform(const PaletteEntry& joint, const glm::vec3& position) {
    const glm::dvec4 p(position, 1);
    return {glm::dot(glm::dvec4(joint.rows[0]), p), glm::dot(glm::dvec4(joint.rows[1]), p),
            glm::dot(glm::dvec4(joint.rows[2]), p)};
}

// One skinned vertex; `more` are joints that decoding may add.
static double vertexBound(const Mesh& mesh, uint32_t vertex, const Influences& more, const CodecBounds& bounds,
                          const Palette& palette) {
    constexpr double kSumRounding = 5e-7;  // of weights in single precision, given and decoded
    const Influences& own = mesh.influences[vertex];
    std::array<glm::dvec3, 2 * kMaxInfluences> places;
    size_t count = 0;
    double blended = 0, farthest = 0, spread = 0, length = 0;
    for (const Influences* side : {&own, &more})
        for (int k = 0; k < kMaxInfluences; ++k) {
            if (side->weights[k] == 0 || side->joints[k] == kNoJoint) continue;
            const PaletteEntry& joint = palette[side->joints[k]];
            const double moved = reach(joint, bounds.position);
            if (side == &own) blended += side->weights[k] * moved;
            farthest = std::max(farthest, moved);
            places[count] = transform(joint, mesh.positions[vertex]);
            length = std::max(length, glm::length(places[count]));
            for (size_t i = 0; i < count; ++i) spread = std::max(spread, glm::distance(places[i], places[count]));
            ++count;
        }
    // What some joints lose others gain: half of the sum moves over the distance between two of them at most.
    return blended + bounds.weights * farthest + bounds.weights / 2 * spread + kSumRounding * length;
}

std::optional<double> codecPositionBound(const Case& c, const PlanInput& input, const FrameData& frame) {
    if (!input.encoded->decode) return 0;
    if (!input.encoded->bounds || input.palette.method != Method::lbs) return std::nullopt;
    const CodecBounds& bounds = *input.encoded->bounds;
    const Mesh& mesh = input.scene->mesh;
    const std::vector<uint32_t> sources = sourcesOf(input);
    const Mesh decoded = bounds.addsJoints && posesVertices(c) ? input.encoded->decode() : Mesh{};
    double worst = 0;
    for (uint32_t copy : {0u, input.copies - 1}) {
        const Palette palette = rounded(input, paletteOfCopy(frame, copy));
        double most = posesVertices(c) ? 0 : glm::length(bounds.position);
        for (size_t v = 0; posesVertices(c) && v < sources.size(); ++v) {
            const Influences more = decoded.influences.empty() ? Influences{} : decoded.influences[v];
            most = std::max(most, vertexBound(mesh, sources[v], more, bounds, palette));
        }
        if (most > 0) worst = std::max(worst, most / errorScale(mesh, palette));
    }
    return worst;
}

// As skipsFrame of shaders_glsl/compute.glsl, whatever the frame.
static bool isFar(const FrameData& frame, uint32_t copies, uint32_t copy) {
    const auto columns = static_cast<uint32_t>(frame.constants.grid.x);
    return copy / columns * 2 >= (copies + columns - 1) / columns;
}

// The tangent that the case keeps of a vertex, counted over all copies.
static glm::vec4 keptTangent(const Case& c, const SkinnedLayout& layout, const KeptBytes& bytes, size_t vertex) {
    glm::vec4 tangent(0);
    uint32_t word = 0;
    if (layout.tangent)
        std::memcpy(&tangent, &bytes.records[vertex * layout.stride + layout.tangent], sizeof(tangent));
    else
        std::memcpy(&word, &bytes.tangents[vertex * sizeof(word)], sizeof(word));
    if (layout.tangent) return tangent;
    return c.compute.wicked ? unpackTangentBytes(word) : unpackTangent(word);
}

// The tangent that the case skins: bytes turn it by more than the rest of the verification allows.
static glm::vec4 givenTangent(const Case& c, const glm::vec4& tangent) {
    return c.compute.wicked ? unpackTangentBytes(packTangentBytes(tangent)) : tangent;
}

KeptError keptError(const Case& c, const PlanInput& input, const FrameData& before, const FrameData& frame,
                    const KeptBytes& bytes) {
    const SkinnedLayout layout = skinnedLayout(c);
    const size_t vertices = input.encoded->vertexCount;
    SKINBENCH_ASSERT(bytes.records.size() == vertices * input.copies * layout.stride);
    const Mesh mesh = decodedMesh(input);
    Mesh tangential = mesh;  // its normals are the tangents: both are turned alike
    std::vector<float> sides;
    if (skinsTangents(c.compute)) {
        const std::vector<glm::vec4> tangents = vertexTangents(input.scene->mesh);
        const std::vector<uint32_t> sources = sourcesOf(input);
        for (size_t v = 0; v < vertices; ++v) {
            tangential.normals[v] = glm::vec3(givenTangent(c, tangents[sources[v]]));
            sides.push_back(tangents[sources[v]].w);
        }
    }
    KeptError worst;
    for (uint32_t copy : {0u, input.copies - 1}) {
        std::vector<SkinnedVertex> kept(vertices);
        for (size_t v = 0; v < vertices; ++v) {
            const size_t vertex = copy * vertices + v;
            if (layout.previous)
                std::memcpy(&kept[v].position, &bytes.records[vertex * layout.stride + layout.previous],
                            sizeof(glm::vec3));
            if (sides.empty()) continue;
            const glm::vec4 tangent = keptTangent(c, layout, bytes, vertex);
            kept[v].normal = glm::vec3(tangent);
            if (tangent.w != sides[v]) worst.tangent = std::numeric_limits<double>::infinity();
        }
        const Palette& now = paletteOfCopy(frame, copy);
        if (!sides.empty())
            worst.tangent =
                std::max(worst.tangent, compareSkinned(skinnedReference(input, tangential, now), kept, 0).normal);
        if (!layout.previous) continue;
        // A copy that every frame skins has shown the last pose twice.
        const bool twice = c.compute.halfRate && !isFar(frame, input.copies, copy);
        const Palette& then = twice ? now : paletteOfCopy(before, copy);
        const double scale = errorScale(input.scene->mesh, then);
        worst.previous =
            std::max(worst.previous, compareSkinned(skinnedReference(input, mesh, then), kept, scale).position);
    }
    return worst;
}

}  // namespace skinbench
