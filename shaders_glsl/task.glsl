// The task stage in front of a mesh stage: a lane tests a meshlet at a time, and mesh work groups start for those that are
// drawn.
#if STAGE_TASK
#include "cluster_tests.glsl"
#define PAYLOAD_WAY out
#include "task_payload.glsl"

layout(local_size_x = TASK_GROUP) in;

shared uint places[TASK_MESHLETS];

// How many lanes before this one draw their meshlet, and how many there are.
#if TASK_BALLOT
uint drawnBelow(bool drawn, out uint total) {
    uvec4 lanes = subgroupBallot(drawn);
    total = subgroupBallotBitCount(lanes);
    return subgroupBallotExclusiveBitCount(lanes);
}
#else
shared uint drawnLanes[TASK_GROUP];

uint drawnBelow(bool drawn, out uint total) {
    uint lane = gl_LocalInvocationID.x, below = 0u;
    memoryBarrierShared();
    barrier();
    drawnLanes[lane] = drawn ? 1u : 0u;
    memoryBarrierShared();
    barrier();
    total = 0u;
    for (uint i = 0u; i < uint(TASK_GROUP); ++i) {
        if (i == lane) below = total;
        total += drawnLanes[i];
    }
    return below;
}
#endif

bool isGroupDrawn(uint group) {
#if BATCHED
    uint copyNumber = group / uint(MESHLET_COUNT);
    uint number = group - copyNumber * uint(MESHLET_COUNT);
    return copyNumber < uint(COPY_COUNT) && isClusterShown(number, copyNumber);
#else
    return group < uint(MESHLET_COUNT) && isClusterShown(group, drawConstants.x);
#endif
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint first = (gl_WorkGroupID.x + drawConstants.y) * uint(TASK_MESHLETS);
    uint count = 0u;
    for (uint next = 0u; next < uint(TASK_MESHLETS); next += uint(TASK_GROUP)) {
        bool drawn = isGroupDrawn(first + next + lane);
        uint total;
        uint below = drawnBelow(drawn, total);
        if (drawn) places[count + below] = next + lane;
        count += total;
    }
    memoryBarrierShared();
    barrier();
    for (uint word = lane; word * 4u < count; word += uint(TASK_GROUP)) {
        uint four = 0u;
        for (uint i = 0u; i < 4u; ++i)
            if (word * 4u + i < count) four |= places[word * 4u + i] << (8u * i);
        payload.places[word] = four;
    }
    if (lane == 0u) payload.first = first;
#if MESH_NV
    if (lane == 0u) gl_TaskCountNV = count;
#else
    memoryBarrierShared();
    barrier();
    EmitMeshTasksEXT(count, 1u, 1u);
#endif
}
#endif
