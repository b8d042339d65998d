// The verdict on a meshlet, by CLUSTER_TESTS and CLUSTER_BOUNDS. The words are drawn in common/meshlets/cluster_bounds.h.
#include "palette.glsl"
#include "cluster_math.glsl"
#include "verdicts.glsl"

layout(std430, binding = SLOT_CLUSTER) readonly restrict buffer ClusterBlock { uvec4 clusters[]; };
#if CLUSTER_BOUNDS == BOUNDS_INSTANCE
layout(std430, binding = SLOT_INSTANCE) readonly restrict buffer InstanceBlock { vec4 instanceBoxes[]; };
#else
layout(std430, binding = SLOT_CLUSTER_PART) readonly restrict buffer ClusterPartBlock { uvec4 clusterParts[]; };
#endif

uvec4 clusterHeader(uint number, uint copyNumber) {
    return clusters[copyNumber * uint(MESHLET_COUNT) * 3u + number];
}

Cone clusterCone(uint number, uint copyNumber) {
    uint first = copyNumber * uint(MESHLET_COUNT) * 3u + uint(MESHLET_COUNT) + number * 2u;
    vec4 axis = uintBitsToFloat(clusters[first]), center = uintBitsToFloat(clusters[first + 1u]);
    return Cone(axis.xyz, axis.w, center.xyz, center.w);
}

JointRows jointRows(uint joint, uint copyNumber) {
    return paletteJoint((joint + FIRST_JOINT(copyNumber)) * uint(PALETTE_ROWS));
}

#if CLUSTER_BOUNDS == BOUNDS_INSTANCE
uint clusterBeyond(uvec4 header, uint copyNumber, ClipRows view, vec3 offset) {
    const JointRows still = JointRows(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
    Solid box = Solid(instanceBoxes[copyNumber * 2u].xyz, instanceBoxes[copyNumber * 2u + 1u].xyz, 0.0);
    return planesBeyond(view, box, doubtOf(view, still, box, offset));
}
#else
Solid clusterPart(uint place, out uint joint) {
#if CLUSTER_BOUNDS == BOUNDS_JOINT_BOXES
    uvec4 box = clusterParts[place * 2u];
    joint = box.w >> 16;
    return Solid(uintBitsToFloat(box.xyz), uintBitsToFloat(clusterParts[place * 2u + 1u].xyz), 0.0);
#else
    uvec4 sphere = clusterParts[place];
    joint = sphere.w >> 16;
    return Solid(uintBitsToFloat(sphere.xyz), vec3(0.0), unpackHalf2x16(sphere.w).x * CLUSTER_SCALE);
#endif
}

// The planes that everything lies beyond which a joint moves.
uint clusterBeyond(uvec4 header, uint copyNumber, ClipRows view, vec3 offset) {
    uint first = copyNumber * uint(CLUSTER_PARTS) + header.x;
    uint beyond = header.y > 0u ? 63u : 0u;
    for (uint i = 0u; i < header.y && beyond != 0u; ++i) {
        uint joint;
        Solid part = clusterPart(first + i, joint);
        JointRows rows = jointRows(joint, copyNumber);
        beyond &= planesBeyond(jointClipRows(view, rows), part, doubtOf(view, rows, part, offset));
    }
    return beyond;
}
#endif

uint findVerdict(uint number, uint copyNumber) {
#if CLUSTER_TESTS != 0
    uvec4 header = clusterHeader(number, copyNumber);
    vec3 offset = copyOffset(copyNumber);
    ClipRows view = viewRows(VIEW_PROJECTION, offset);
#if (CLUSTER_TESTS & CLUSTER_TEST_FRUSTUM) != 0
    if (clusterBeyond(header, copyNumber, view, offset) != 0u) return VERDICT_BEYOND;
#endif
#if (CLUSTER_TESTS & CLUSTER_TEST_CONE) != 0
    Cone cone = clusterCone(number, copyNumber);
    if (cone.altitude > 0.0) {
        JointRows rows = jointRows(header.w >> 16, copyNumber);
        if (allFaceAway(jointClipRows(view, rows), cone)) return VERDICT_AWAY;
    }
#endif
#endif
    return VERDICT_DRAWN;
}

// Whether the pass shows it; most show what is drawn.
bool isClusterShown(uint number, uint copyNumber) {
    uint verdict = findVerdict(number, copyNumber);
#if STORES_VERDICTS
    verdicts[copyNumber * uint(MESHLET_COUNT) + number] = verdict;
#endif
    return showsMeshlets(verdict);
}
