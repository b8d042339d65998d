// Meshlets: small pieces of a mesh that one mesh-shader work group draws. A builder cuts the index buffer, a layout
// packs the pieces into the words that the shader reads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/scene.h"

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

MeshletStats meshletStats(const Mesh& mesh, const MeshletMesh& meshlets);

// The words a mesh shader reads. `redirect` (Kimmersdorfer 3.2): a descriptor a meshlet and one index stream.
//
//   descriptor (2 words)   word 0: first word of the meshlet in `data`
//                          word 1: [31] reserved  [30:16] vertex count  [15:0] triangle count
//   data, per meshlet      vertexCount words: vertex ids, then
//                          3 * ceil(triangleCount / 4) words: local indices, one byte each, little-endian, triangle
//                          after triangle; the last group of four triangles is filled up with zeros
struct PackedMeshlets {
    std::vector<uint32_t> descriptors;
    std::vector<uint32_t> data;
};

struct MeshletLayout {
    const char* name;
    const char* what;
    PackedMeshlets (*pack)(const MeshletMesh& meshlets);
};

const std::vector<MeshletLayout>& meshletLayouts();
const MeshletLayout* findMeshletLayout(const std::string& name);

}  // namespace skinbench
