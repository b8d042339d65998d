// What a meshlet of a skinned mesh can be culled by, whatever its joints do.
//
// Linear blending puts a vertex at v = Σ w_j M_j p with w ≥ 0 and Σ w = 1: in the convex hull of the places that its
// joints alone would give it. So a meshlet lies beyond a plane where, for each of its joints, the moved bound of the
// positions that this joint moves does. A meshlet with one joint for all its vertices moves by one affine map, and its
// faces all turn away from the eye where a cone of their bind-pose normals does, seen from the eye carried into the
// bind pose. docs/culling.md has the proofs, shaders_glsl/cluster_math.glsl the tests.
#pragma once

#include <cstdint>
#include <vector>

#include "common/meshlets/meshlets.h"
#include "shaders_glsl/shared.h"

namespace skinbench {

// jointSpheres: for each joint a sphere around what it moves.
// oneSphere:    one sphere around the meshlet, moved by each of its joints.
// jointBoxes:   for each joint a box around what it moves.
// instance:     nothing of the meshlet: one box around the whole posed character, for all its meshlets.
enum class ClusterBounds {
    jointSpheres = BOUNDS_JOINT_SPHERES,
    oneSphere = BOUNDS_ONE_SPHERE,
    jointBoxes = BOUNDS_JOINT_BOXES,
    instance = BOUNDS_INSTANCE
};

// A meshlet with more joints is not tested.
inline constexpr uint32_t kMostClusterJoints = 16;

// Around the positions that a joint moves, in the bind pose. A sphere has no extent, a box no radius.
struct ClusterPart {
    uint32_t joint = 0;
    glm::vec3 center{0};
    glm::vec3 extent{0};  // half of the box' size
    float radius = 0;
};

// Of the faces of a meshlet that one joint moves whole; `altitude` 0: there is none.
struct ClusterCone {
    uint32_t joint = 0;
    glm::vec3 axis{0};   // unit length
    float cosine = 0;    // of the largest angle between the axis and a face's normal, above 0
    float altitude = 0;  // the shortest one on a triangle's longest edge
    glm::vec3 center{0};
    float radius = 0;  // of a sphere around the vertices
};

struct Cluster {
    uint32_t firstPart = 0;
    uint32_t partCount = 0;  // 0: not tested
    ClusterCone cone;
};

struct ClusterSet {
    std::vector<Cluster> clusters;  // one a meshlet
    std::vector<ClusterPart> parts;
    double weightError = 0;  // the largest |Σ w - 1| of a vertex
};

// `mesh` is what shaders read: decoded, in the meshlets' own numbers of vertices. With ClusterBounds::instance no
// cluster has parts, and `parts` has one for each joint that moves anything.
ClusterSet boundClusters(const Mesh& mesh, const MeshletMesh& meshlets, ClusterBounds bounds);

// The words that shaders read. Half floats are rounded up.
//
//   clusters  one uvec4 a meshlet: first part, number of parts, first triangle, [31:16] joint of the cone [15:0]
//             triangles; then two vec4 a meshlet: axis * cosine, altitude; center, radius
//   parts     one uvec4 a sphere: center, [31:16] joint [15:0] half float: radius / scale
//             two a box: center, [31:16] joint; extent, 0
struct PackedClusters {
    std::vector<uint32_t> clusters;
    std::vector<uint32_t> parts;
    float scale = 1;  // the largest radius
};
PackedClusters packClusters(const ClusterSet& set, const MeshletMesh& meshlets, ClusterBounds bounds);

}  // namespace skinbench
