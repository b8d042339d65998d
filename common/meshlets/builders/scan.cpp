#include "common/meshlets/builders/builders.h"

#include <algorithm>

namespace skinbench {

MeshletMesh buildScan(const Mesh& mesh, const MeshletLimits& limits) {
    MeshletMesh cut;
    cut.limits = limits;
    cut.triangles.reserve(mesh.indices.size() / 3);
    // Which local number a vertex has, valid while `owner` names the meshlet being filled.
    std::vector<uint32_t> owner(mesh.positions.size(), UINT32_MAX);
    std::vector<uint8_t> local(mesh.positions.size(), 0);
    Meshlet open;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::array corners{mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
        auto number = static_cast<uint32_t>(cut.meshlets.size());
        uint32_t fresh = 0;
        for (size_t c = 0; c < 3; ++c)
            fresh += owner[corners[c]] != number &&
                     std::find(corners.begin(), corners.begin() + c, corners[c]) == corners.begin() + c;
        if (open.vertexCount + fresh > limits.vertices || open.triangleCount + 1 > limits.triangles) {
            cut.meshlets.push_back(open);
            open = {static_cast<uint32_t>(cut.vertices.size()), static_cast<uint32_t>(cut.triangles.size()), 0, 0};
            ++number;
        }
        std::array<uint8_t, 3> triangle;
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t vertex = corners[c];
            if (owner[vertex] != number) {
                owner[vertex] = number;
                local[vertex] = static_cast<uint8_t>(open.vertexCount++);
                cut.vertices.push_back(vertex);
            }
            triangle[c] = local[vertex];
        }
        cut.triangles.push_back(triangle);
        ++open.triangleCount;
    }
    if (open.triangleCount > 0) cut.meshlets.push_back(open);
    return cut;
}

}  // namespace skinbench
