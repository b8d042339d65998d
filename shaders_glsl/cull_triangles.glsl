// `compute-cull`, the pass between skinning and the draw: a triangle an invocation, tested by TRIANGLE_TESTS, and the
// indices of those left in a list. One atomic addition a work group makes room for all of its triangles.
#if STAGE_COMPUTE
#include "frame.glsl"
#include "skinned.glsl"
#include "commands.glsl"
#include "triangle_tests.glsl"
#include "verdicts.glsl"
#define PLACES_GROUP CULL_GROUP
#include "places.glsl"
#if CLUSTER_CULL == CLUSTER_LIST
layout(std430, binding = SLOT_CLUSTER) readonly restrict buffer ClusterBlock { uvec4 clusters[]; };
layout(std430, binding = SLOT_CLUSTER_LIST) readonly restrict buffer ClusterListBlock { uint listedMeshlets[]; };
#endif

layout(local_size_x = CULL_GROUP) in;

layout(std430, binding = SLOT_INDEX) readonly restrict buffer IndexBlock { uint sourceIndices[]; };
layout(std430, binding = SLOT_VISIBLE) writeonly restrict buffer VisibleBlock { uint visibleIndices[]; };

shared uint firstPlace;

bool leaveOut(uint verdict) {
#if STORES_VERDICTS
    if (VIEW_NUMBER == VERDICT_DRAWN) atomicAdd(verdicts[uint(FIRST_COUNTED) + verdict - VERDICT_TRIANGLE_BEYOND], 1u);
#endif
    return showsTriangles(verdict);
}

// Whether the pass shows the triangle: where nothing says that it cannot be seen.
bool isShown(vec4 a, vec4 b, vec4 c) {
#if (TRIANGLE_TESTS & TEST_FRUSTUM) != 0
    if (isBeyondOnePlane(a, b, c)) return leaveOut(VERDICT_TRIANGLE_BEYOND);
#endif
#if (TRIANGLE_TESTS & (TEST_BACK | TEST_SMALL)) != 0
    if (isTrusted(a) && isTrusted(b) && isTrusted(c)) {
        vec2 pa = screenPosition(a), pb = screenPosition(b), pc = screenPosition(c);
#if (TRIANGLE_TESTS & TEST_BACK) != 0
        if (facesAway(pa, pb, pc)) return leaveOut(VERDICT_TRIANGLE_AWAY);
#endif
#if (TRIANGLE_TESTS & TEST_SMALL) != 0
        if (coversNoSample(pa, pb, pc)) return leaveOut(VERDICT_TRIANGLE_SMALL);
#endif
    }
#endif
    return showsTriangles(VERDICT_DRAWN);
}

void main() {
#if CLUSTER_CULL == CLUSTER_LIST
    // A work group for each meshlet that is left.
    uint meshlet = listedMeshlets[drawConstants.x * uint(MESHLET_COUNT) + gl_WorkGroupID.x];
    uvec4 header = clusters[drawConstants.x * uint(MESHLET_COUNT) * 3u + meshlet];
    uint triangle = header.z + gl_LocalInvocationID.x;
    bool there = gl_LocalInvocationID.x < (header.w & 0xFFFFu);
#else
    uint triangle = gl_GlobalInvocationID.x + drawConstants.y * uint(CULL_GROUP);
#endif
#if BATCHED
    uint copyNumber = triangle / uint(TRIANGLE_COUNT);
    bool there = triangle < uint(TRIANGLE_COUNT) * uint(COPY_COUNT);
    uint firstVertex = 0u;  // indices count over all copies
    uint source = triangle * 3u;
    uint list = 0u;
#else
    uint copyNumber = drawConstants.x;
#if CLUSTER_CULL != CLUSTER_LIST
    bool there = triangle < uint(TRIANGLE_COUNT);
#endif
    uint firstVertex = copyNumber * uint(VERTEX_COUNT);
    uint list = copyNumber * uint(TRIANGLE_COUNT) * 3u;
    uint source = list + triangle * 3u;
#endif
    startChoice();
    uvec3 corners = uvec3(0u);
    bool kept = false;
    if (there) {
        corners = uvec3(sourceIndices[source], sourceIndices[source + 1u], sourceIndices[source + 2u]);
        kept = isShown(clipPosition(skinnedVertices[firstVertex + corners.x].positionU.xyz, copyNumber),
                       clipPosition(skinnedVertices[firstVertex + corners.y].positionU.xyz, copyNumber),
                       clipPosition(skinnedVertices[firstVertex + corners.z].positionU.xyz, copyNumber));
    }
    uint total;
    uint before = placeOfChosen(kept, total);
    if (gl_LocalInvocationID.x == 0u && total > 0u)
        firstPlace = atomicAdd(commands[commandOf(copyNumber, VIEW_NUMBER)].count, total * 3u);
    memoryBarrierShared();
    barrier();
    if (!kept) return;
    uint place = list + firstPlace + before * 3u;
    visibleIndices[place] = corners.x;
    visibleIndices[place + 1u] = corners.y;
    visibleIndices[place + 2u] = corners.z;
}
#endif
