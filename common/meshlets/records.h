// Records: vertices as a case stores them, where that is not simply the scene's vertex array. The codec encodes them,
// the meshlets name them, and `sources` leads back to the scene for verification.
#pragma once

#include <cstdint>
#include <vector>

#include "common/meshlets/common_influences.h"
#include "common/meshlets/meshlets.h"
#include "common/meshlets/partition.h"

namespace skinbench {

struct Records {
    Mesh mesh;                      // one vertex a record; indices are those of `meshlets`, in order
    std::vector<uint32_t> sources;  // per record: vertex of the scene's mesh
    MeshletMesh meshlets;           // of records
    uint32_t commonRecords = 0;     // the first ones take their joints from their meshlet's list
    uint32_t commonMeshlets = 0;
    std::vector<JointList> joints;  // one list a common meshlet
    PartitionPlan partition;        // the variant `palette`: records name slots instead of joints
};

// The variant `mesh-ci`.
Records commonRecords(const CommonInfluenceCut& cut);

// Every meshlet's vertices one behind the other, a vertex of several meshlets repeated: no id is looked up.
Records orderedRecords(const Mesh& mesh, const MeshletMesh& meshlets);
Records orderedRecords(const Records& records);

// The variant `palette`: a record for each use of a vertex with other slots; indices in the order of the commands.
Records partitionedRecords(const Mesh& mesh, const PartitionPlan& plan);

// --- joints of a meshlet ---------------------------------------------------------------------------------------

inline constexpr uint32_t kMaxMeshletJoints = 256;  // local numbers are bytes

// Joint lists for JointSource::meshlet and staged. Per meshlet: [joint count] [joint ids …] then, vertex after vertex,
// influences / 4 words of local joint numbers, a byte each, the first influence in the lowest byte.
struct MeshletJoints {
    std::vector<uint32_t> words;
    std::vector<uint32_t> start;  // per meshlet, its first word
    uint32_t most = 0;            // joints of the longest list
};

// Fails when a meshlet has more than kMaxMeshletJoints joints.
Result<MeshletJoints> packMeshletJoints(const Mesh& mesh, const MeshletMesh& meshlets, int influences);

// The joint lists of the common meshlets, `influences` words each (docs/codecs.md 8.4).
std::vector<uint32_t> packJointLists(const std::vector<JointList>& lists, int influences);

}  // namespace skinbench
