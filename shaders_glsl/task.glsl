// The task stage in front of a mesh stage: a meshlet a lane, and mesh work groups for those that are drawn. More meshlets
// than lanes, in turns, take longer (docs/studies/culling_meshlets.md).
#if STAGE_TASK
#include "cluster_tests.glsl"
#define PAYLOAD_WAY out
#include "task_payload.glsl"

layout(local_size_x = TASK_GROUP) in;

shared uint places[TASK_GROUP];

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

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint first = (gl_WorkGroupID.x + drawConstants.y) * uint(TASK_GROUP);
    uint group = first + lane;
#if BATCHED
    uint copyNumber = group / uint(MESHLET_COUNT);
    uint number = group - copyNumber * uint(MESHLET_COUNT);
    bool there = copyNumber < uint(COPY_COUNT);
#else
    uint copyNumber = drawConstants.x;
    uint number = group;
    bool there = number < uint(MESHLET_COUNT);
#endif
    bool drawn = there && isClusterShown(number, copyNumber);
    uint total;
    uint below = drawnBelow(drawn, total);
    if (drawn) places[below] = lane;
    memoryBarrierShared();
    barrier();
    if (lane < uint(TASK_GROUP / 4)) {
        uint four = 0u;
        for (uint i = 0u; i < 4u; ++i)
            if (lane * 4u + i < total) four |= places[lane * 4u + i] << (8u * i);
        payload.places[lane] = four;
    }
    if (lane == 0u) payload.first = first;
#if MESH_NV
    if (lane == 0u) gl_TaskCountNV = total;
#else
    memoryBarrierShared();
    barrier();
    EmitMeshTasksEXT(total, 1u, 1u);
#endif
}
#endif
