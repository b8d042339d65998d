#include "common/meshlets/meshlets.h"

#include <algorithm>
#include <format>
#include <map>
#include <set>

#include "common/meshlets/builders/builders.h"
#include "common/scene/tuples.h"

namespace skinbench {

const std::vector<Builder>& builders() {
    static const std::vector<Builder> rows = {
        {"meshopt", "meshoptimizer's builder: grown by adjacency, compact", buildMeshopt},
        {"scan", "greedy in index order", buildScan},
    };
    return rows;
}

const Builder* findBuilder(const std::string& name) {
    for (const Builder& builder : builders())
        if (name == builder.name) return &builder;
    return nullptr;
}

static std::string place(size_t meshlet) { return "meshlet " + std::to_string(meshlet) + ": "; }

// The smallest of a triangle's three rotations, so that rotations compare equal and mirror images do not.
static std::array<uint32_t, 3> canonical(uint32_t a, uint32_t b, uint32_t c) {
    return std::min({std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}});
}

using Triangles = std::vector<std::array<uint32_t, 3>>;

// Sorts by the first corner in linear time, then what shares it.
static void sortTriangles(Triangles& triangles, size_t vertices) {
    const auto bucket = [vertices](const auto& triangle) { return std::min<size_t>(triangle[0], vertices); };
    std::vector<size_t> next(vertices + 2);
    for (const auto& triangle : triangles) ++next[bucket(triangle) + 1];
    for (size_t v = 0; v <= vertices; ++v) next[v + 1] += next[v];
    Triangles sorted(triangles.size());
    for (const auto& triangle : triangles) sorted[next[bucket(triangle)]++] = triangle;
    size_t begin = 0;
    for (size_t v = 0; v <= vertices; begin = next[v++]) std::sort(sorted.begin() + begin, sorted.begin() + next[v]);
    triangles = std::move(sorted);
}

Result<void> checkMeshlets(const Mesh& mesh, const MeshletMesh& cut) {
    Triangles drawn;
    drawn.reserve(mesh.indices.size() / 3);
    for (size_t m = 0; m < cut.meshlets.size(); ++m) {
        const Meshlet& meshlet = cut.meshlets[m];
        if (meshlet.vertexCount > cut.limits.vertices || meshlet.triangleCount > cut.limits.triangles)
            return inputError(place(m) + std::format("{} vertices and {} triangles exceed the limits {} and {}",
                                                     meshlet.vertexCount, meshlet.triangleCount, cut.limits.vertices,
                                                     cut.limits.triangles));
        if (uint64_t{meshlet.firstVertex} + meshlet.vertexCount > cut.vertices.size() ||
            uint64_t{meshlet.firstTriangle} + meshlet.triangleCount > cut.triangles.size())
            return inputError(place(m) + "reaches past the end of the vertex or triangle list");
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i)
            if (cut.vertices[meshlet.firstVertex + i] >= mesh.positions.size())
                return inputError(place(m) + "names a vertex that does not exist");
        for (uint32_t t = 0; t < meshlet.triangleCount; ++t) {
            const auto& local = cut.triangles[meshlet.firstTriangle + t];
            if (std::ranges::any_of(local, [&](uint8_t i) { return i >= meshlet.vertexCount; }))
                return inputError(place(m) + "a local index is not below the vertex count");
            const uint32_t* ids = &cut.vertices[meshlet.firstVertex];
            drawn.push_back(canonical(ids[local[0]], ids[local[1]], ids[local[2]]));
        }
    }
    Triangles wanted;
    wanted.reserve(mesh.indices.size() / 3);
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        wanted.push_back(canonical(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]));
    sortTriangles(drawn, mesh.positions.size());
    sortTriangles(wanted, mesh.positions.size());
    if (drawn != wanted) return inputError("the meshlets do not hold every triangle exactly once");
    return {};
}

std::vector<uint32_t> triangleList(const MeshletMesh& meshlets) {
    std::vector<uint32_t> corners;
    corners.reserve(meshlets.triangles.size() * 3);
    for (const Meshlet& meshlet : meshlets.meshlets)
        for (uint32_t t = 0; t < meshlet.triangleCount; ++t)
            for (uint8_t local : meshlets.triangles[meshlet.firstTriangle + t])
                corners.push_back(meshlets.vertices[meshlet.firstVertex + local]);
    return corners;
}

MeshletStats meshletStats(const Mesh& mesh, const MeshletMesh& cut) {
    MeshletStats stats;
    stats.meshlets = static_cast<uint32_t>(cut.meshlets.size());
    if (cut.meshlets.empty()) return stats;
    uint64_t vertices = 0, triangles = 0, tuples = 0;
    const TupleTable table = distinctTuples(mesh, kMaxInfluences);
    std::vector<size_t> seenIn(table.tuples.size(), SIZE_MAX);  // the last meshlet that has the tuple
    SKINBENCH_ASSERT(cut.vertices.empty() || std::ranges::max(cut.vertices) < table.vertexTuple.size());
    for (size_t m = 0; m < cut.meshlets.size(); ++m) {
        const Meshlet& meshlet = cut.meshlets[m];
        vertices += meshlet.vertexCount;
        triangles += meshlet.triangleCount;
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
            size_t& seen = seenIn[table.vertexTuple[cut.vertices[meshlet.firstVertex + i]]];
            tuples += seen != m;
            seen = m;
        }
    }
    const double count = static_cast<double>(cut.meshlets.size());
    stats.meanVertices = static_cast<double>(vertices) / count;
    stats.meanTriangles = static_cast<double>(triangles) / count;
    stats.vertexFill = stats.meanVertices / cut.limits.vertices;
    stats.triangleFill = stats.meanTriangles / cut.limits.triangles;
    stats.vertexReuse = static_cast<double>(vertices) / static_cast<double>(mesh.positions.size());
    stats.meanUniqueTuples = static_cast<double>(tuples) / count;
    return stats;
}

static uint32_t countsWord(const MeshletMesh& cut, const MeshletPacking& packing, size_t number) {
    const Meshlet& meshlet = cut.meshlets[number];
    const uint32_t blendBytes = packing.blendBytes.empty() ? 0 : packing.blendBytes[number];
    const uint32_t influences = packing.influences.empty() ? 0 : packing.influences[number];
    SKINBENCH_ASSERT(blendBytes < 8 && influences < 16);
    SKINBENCH_ASSERT(meshlet.vertexCount < 1u << 13 && meshlet.triangleCount < 1u << 11);
    return uint32_t{number < packing.commonMeshlets} << 31 | influences << 27 | meshlet.triangleCount << 16 |
           blendBytes << 13 | meshlet.vertexCount;
}

static bool isWide(const MeshletPacking& packing) { return packing.orderedRecords || !packing.extraStart.empty(); }

static void appendWide(std::vector<uint32_t>& words, const MeshletMesh& cut, const MeshletPacking& packing,
                       size_t number) {
    if (!isWide(packing)) return;
    const Meshlet& meshlet = cut.meshlets[number];
    const uint32_t first = cut.vertices[meshlet.firstVertex];
    for (uint32_t i = 0; i < meshlet.vertexCount && packing.orderedRecords; ++i)
        SKINBENCH_ASSERT(cut.vertices[meshlet.firstVertex + i] == first + i);
    words.push_back(packing.orderedRecords ? first : 0);
    words.push_back(packing.extraStart.empty() ? 0 : packing.extraStart[number]);
}

static void appendIds(std::vector<uint32_t>& words, const MeshletMesh& cut, const Meshlet& meshlet) {
    auto ids = cut.vertices.begin() + meshlet.firstVertex;
    words.insert(words.end(), ids, ids + meshlet.vertexCount);
}

static void appendLocalIndices(std::vector<uint32_t>& words, const MeshletMesh& cut, const Meshlet& meshlet,
                               size_t wordCount) {
    const size_t first = words.size();
    words.resize(first + wordCount, 0);
    for (uint32_t t = 0; t < meshlet.triangleCount; ++t)
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const uint32_t byte = t * 3 + corner;
            words[first + byte / 4] |= uint32_t{cut.triangles[meshlet.firstTriangle + t][corner]} << byte % 4 * 8;
        }
}

static PackedMeshlets packRedirect(const MeshletMesh& cut, const MeshletPacking& packing) {
    PackedMeshlets packed;
    packed.descriptors.reserve(cut.meshlets.size() * 4);
    packed.data.reserve(cut.vertices.size() + cut.triangles.size());
    for (size_t m = 0; m < cut.meshlets.size(); ++m) {
        const Meshlet& meshlet = cut.meshlets[m];
        packed.descriptors.push_back(static_cast<uint32_t>(packed.data.size()));
        packed.descriptors.push_back(countsWord(cut, packing, m));
        appendWide(packed.descriptors, cut, packing, m);
        if (!packing.orderedRecords) appendIds(packed.data, cut, meshlet);
        appendLocalIndices(packed.data, cut, meshlet, (meshlet.triangleCount + 3) / 4 * 3);
    }
    return packed;
}

static PackedMeshlets packFixed(const MeshletMesh& cut, const MeshletPacking& packing) {
    const uint32_t idWords = packing.orderedRecords ? 0 : cut.limits.vertices;
    const uint32_t indexWords = (cut.limits.triangles * 3 + 3) / 4;
    PackedMeshlets packed;
    packed.fixedWords = ((isWide(packing) ? 3 : 1) + idWords + indexWords + 3) / 4 * 4;
    packed.data.reserve(cut.meshlets.size() * packed.fixedWords + 2);
    for (size_t m = 0; m < cut.meshlets.size(); ++m) {
        const Meshlet& meshlet = cut.meshlets[m];
        packed.data.push_back(countsWord(cut, packing, m));
        appendWide(packed.data, cut, packing, m);
        if (!packing.orderedRecords) {
            appendIds(packed.data, cut, meshlet);
            packed.data.resize(packed.data.size() + idWords - meshlet.vertexCount, 0);
        }
        appendLocalIndices(packed.data, cut, meshlet, indexWords);
        packed.data.resize((m + 1) * packed.fixedWords, 0);
    }
    packed.data.resize(packed.data.size() + 2, 0);
    return packed;
}

const std::vector<MeshletLayout>& meshletLayouts() {
    static const std::vector<MeshletLayout> rows = {
        {"redirect", "a descriptor a meshlet and one index stream", packRedirect},
        {"fixed", "every meshlet takes the words of a full one", packFixed},
    };
    return rows;
}

const MeshletLayout* findMeshletLayout(const std::string& name) {
    for (const MeshletLayout& layout : meshletLayouts())
        if (name == layout.name) return &layout;
    return nullptr;
}

}  // namespace skinbench
