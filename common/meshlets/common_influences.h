// Common influences (Torabi 3.1.1, listing A.2): a meshlet whose vertices take all their joints from one short list
// stores that list once, and its vertices store only weights in the order of the list. The other meshlets are the
// remainder, whose vertices are stored as usual.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/meshlets/meshlets.h"

namespace skinbench {

// meshlets:  cut first, then mark the meshlets that happen to fit. Never more meshlets than the builder makes.
// triangles: group triangles by their joints first, then cut each group and what is left over (Torabi).
enum class CiGrouping { meshlets, triangles };

// What puts a triangle into a group; read by CiGrouping::triangles alone.
// ordered: its three vertices have the same joints in the same order (Torabi's own).
// set:     the same joints in any order.
// fit:     together they have at most `influences` joints; groups that share vertices become one while that holds.
enum class CiKey { ordered, set, fit };

const char* ciGroupingName(CiGrouping grouping);
const char* ciKeyName(CiKey key);

struct CommonInfluenceOptions {
    const Builder* builder = nullptr;
    MeshletLimits limits;
    int influences = 4;  // 4 or 8: places of a joint list, and what the mesh was prepared with
    CiGrouping grouping = CiGrouping::meshlets;
    CiKey key = CiKey::fit;
    uint32_t minVertices = 48;         // meshlets or groups with fewer distinct vertices join the remainder
    const MeshletMesh* cut = nullptr;  // of CiGrouping::meshlets: the builder's result where there is one already
};

using JointList = std::array<uint16_t, kMaxInfluences>;  // kNoJoint behind the last joint

// A record is a vertex as it is stored: one for each use of a vertex with another joint list, one more where the
// remainder uses it. Records and meshlets of the common part stand first.
struct CommonInfluenceCut {
    // Records. One of the common part has influences.joints = its meshlets' list and its weights in that order, 0 for
    // a joint that the vertex does not use. Indices are the meshlets' triangles, in order.
    Mesh mesh;
    std::vector<uint32_t> sources;  // per record: vertex of the given mesh
    uint32_t commonRecords = 0;
    MeshletMesh meshlets;  // of records
    uint32_t commonMeshlets = 0;
    uint32_t commonTriangles = 0;
    std::vector<JointList> joints;  // per common meshlet; ascending but for CiKey::ordered
};

// `mesh` has cleaned weights (cleanWeights) of at most options.influences influences. Near-linear in the triangles.
CommonInfluenceCut buildCommonInfluences(const Mesh& mesh, const CommonInfluenceOptions& options);

// The same meshlets of the given mesh's vertices.
MeshletMesh sourceMeshlets(const CommonInfluenceCut& cut);

// The meshlets hold every triangle of `mesh` exactly once (checkMeshlets), every record is its vertex, every common
// meshlet refers to common records with its own list only, and list and weights decode to the vertex' influences.
Result<void> checkCommonInfluences(const Mesh& mesh, const CommonInfluenceCut& cut);

}  // namespace skinbench
