// Meshlets: small pieces of a mesh that one mesh-shader work group draws. A builder cuts the index buffer, a layout
// packs the pieces into the words that the shader reads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/scene/scene.h"

namespace skinbench {

// The most vertices and triangles of one meshlet. Local indices are bytes, so vertices <= 256.
struct MeshletLimits {
    uint32_t vertices = 64;
    uint32_t triangles = 124;
    bool operator==(const MeshletLimits&) const = default;
};

struct Meshlet {
    uint32_t firstVertex = 0;    // into MeshletMesh::vertices
    uint32_t firstTriangle = 0;  // into MeshletMesh::triangles, counted in triangles
    uint32_t vertexCount = 0;
    uint32_t triangleCount = 0;
};

struct MeshletMesh {
    MeshletLimits limits;
    std::vector<Meshlet> meshlets;
    std::vector<uint32_t> vertices;                 // vertex ids of the mesh, meshlet by meshlet
    std::vector<std::array<uint8_t, 3>> triangles;  // meshlet-local vertex numbers, winding kept
};

struct MeshletStats {
    uint32_t meshlets = 0;
    double meanVertices = 0;  // per meshlet
    double meanTriangles = 0;
    double vertexFill = 0;  // mean vertices / limit
    double triangleFill = 0;
    double vertexReuse = 0;       // vertex references of all meshlets / vertices of the mesh: 1 is no repetition
    double meanUniqueTuples = 0;  // distinct joint tuples per meshlet
};

using BuildMeshlets = MeshletMesh (*)(const Mesh& mesh, const MeshletLimits& limits);

struct Builder {
    const char* name;
    const char* what;
    BuildMeshlets build;
};

// scan:    greedy in index order (Kimmersdorfer's AVK-Default, Torabi's naive builder, listing A.1).
// meshopt: meshoptimizer's, grown by adjacency and compactness.
const std::vector<Builder>& builders();
const Builder* findBuilder(const std::string& name);

// Every triangle exactly once with its winding, every limit kept, every local index in range. For tests and, because
// it costs little, for every builder run of the program.
Result<void> checkMeshlets(const Mesh& mesh, const MeshletMesh& meshlets);

// Three vertices a triangle, in the order of the meshlets.
std::vector<uint32_t> triangleList(const MeshletMesh& meshlets);

MeshletStats meshletStats(const Mesh& mesh, const MeshletMesh& meshlets);

// What a case's shader reads beside the plain meshlets.
struct MeshletPacking {
    bool orderedRecords = false;  // every meshlet's vertex ids count up by one: only its first one is stored
    uint32_t commonMeshlets = 0;  // these, the first ones, share a joint list
    // Per meshlet: first word of what SLOT_MESHLET_EXTRA holds for it, or, with orderedRecords and blendBytes, first
    // byte of its vertices; or empty.
    std::vector<uint32_t> extraStart;
    std::vector<uint8_t> blendBytes;  // per meshlet, below 8: bytes of blend data of its vertices; or empty
    std::vector<uint8_t> influences;  // per meshlet, 1 to 8: the last one that weighs anything; or empty
};

// The words a mesh shader reads. All layouts share the word of the counts and the way local indices lie:
//
//   counts         [31] shares a joint list  [30:27] influences  [26:16] triangle count  [15:13] blend bytes
//                  [12:0] vertex count
//   local indices  a byte each, little-endian, triangle after triangle: three words hold four triangles
//
// `redirect` (Kimmersdorfer 3.2): a descriptor a meshlet and one index stream.
//
//   descriptor         2 words: first word of the meshlet in `data`, counts
//                      4 words with orderedRecords or extraStart: also first record, first extra word
//   data, per meshlet  vertex ids (none with orderedRecords), then local indices, filled up to whole groups of four
//
// `fixed` (Kimmersdorfer 3.2): no descriptors; every meshlet takes the words of a full one, 640 bytes for 64/126.
//
//   data, per meshlet  counts; with orderedRecords or extraStart: first record, first extra word;
//                      limit.vertices ids (none with orderedRecords); 3 * limit.triangles bytes of local indices;
//                      then zeros up to a multiple of 16 bytes
//   behind the last    2 words, because the shader reads whole groups of four triangles
struct PackedMeshlets {
    std::vector<uint32_t> descriptors;
    std::vector<uint32_t> data;
    uint32_t fixedWords = 0;  // words a meshlet takes in `data`; 0: they differ
};

struct MeshletLayout {
    const char* name;
    const char* what;
    PackedMeshlets (*pack)(const MeshletMesh& meshlets, const MeshletPacking& packing);
};

const std::vector<MeshletLayout>& meshletLayouts();
const MeshletLayout* findMeshletLayout(const std::string& name);

}  // namespace skinbench
