#include "common/meshlets/builders/builders.h"

#include <meshoptimizer.h>

namespace skinbench {

MeshletMesh buildMeshopt(const Mesh& mesh, const MeshletLimits& limits) {
    // The library wants a triangle limit divisible by four; a limit such as 126 is rounded down.
    const uint32_t triangleLimit = limits.triangles / 4 * 4;
    const size_t bound = meshopt_buildMeshletsBound(mesh.indices.size(), limits.vertices, triangleLimit);
    std::vector<meshopt_Meshlet> built(bound);
    std::vector<uint32_t> vertices(bound * limits.vertices);
    std::vector<uint8_t> locals(bound * triangleLimit * 3);
    built.resize(meshopt_buildMeshlets(built.data(), vertices.data(), locals.data(), mesh.indices.data(),
                                       mesh.indices.size(), &mesh.positions[0].x, mesh.positions.size(),
                                       sizeof(glm::vec3), limits.vertices, triangleLimit, 0.0f));
    MeshletMesh cut;
    cut.limits = limits;
    cut.meshlets.reserve(built.size());
    cut.triangles.reserve(mesh.indices.size() / 3);
    for (const meshopt_Meshlet& from : built) {
        meshopt_optimizeMeshlet(&vertices[from.vertex_offset], &locals[from.triangle_offset], from.triangle_count,
                                from.vertex_count);
        cut.meshlets.push_back({static_cast<uint32_t>(cut.vertices.size()), static_cast<uint32_t>(cut.triangles.size()),
                                from.vertex_count, from.triangle_count});
        auto first = vertices.begin() + from.vertex_offset;
        cut.vertices.insert(cut.vertices.end(), first, first + from.vertex_count);
        for (uint32_t t = 0; t < from.triangle_count; ++t) {
            const uint8_t* corner = &locals[from.triangle_offset + t * 3];
            cut.triangles.push_back({corner[0], corner[1], corner[2]});
        }
    }
    return cut;
}

}  // namespace skinbench
