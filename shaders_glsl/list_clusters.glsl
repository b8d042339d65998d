// The pass "cluster": the meshlets of a copy that are drawn, in their order, and how many. One work group does a copy,
// LIST_GROUP meshlets at a time, so that no two of them race for a place.
#if STAGE_COMPUTE
#include "cluster_tests.glsl"
#include "commands.glsl"
#define PLACES_GROUP LIST_GROUP
#include "places.glsl"

layout(local_size_x = LIST_GROUP) in;

layout(std430, binding = SLOT_CLUSTER_LIST) writeonly restrict buffer ClusterListBlock { uint listedMeshlets[]; };

void main() {
    uint copyNumber = gl_WorkGroupID.x + drawConstants.x;
    uint lane = gl_LocalInvocationID.x;
    uint listed = 0u;
    for (uint first = 0u; first < uint(MESHLET_COUNT); first += uint(LIST_GROUP)) {
        uint number = first + lane;
        startChoice();
        bool drawn = number < uint(MESHLET_COUNT) && isClusterShown(number, copyNumber);
        uint total;
        uint before = placeOfChosen(drawn, total);
        if (drawn) listedMeshlets[copyNumber * uint(MESHLET_COUNT) + listed + before] = number;
        listed += total;
        memoryBarrierShared();
        barrier();
    }
    if (lane == 0u) commands[uint(FIRST_GROUP_COMMAND) + commandOf(copyNumber, VIEW_NUMBER)].count = listed;
}
#endif
