// The pass "bounds": a box around each posed copy, for all its meshlets. It unites the boxes of what each joint moves, so
// it holds for every palette. A work group a copy.
#if STAGE_COMPUTE
#include "palette.glsl"

layout(local_size_x = LIST_GROUP) in;

layout(std430, binding = SLOT_CLUSTER_PART) readonly restrict buffer ClusterPartBlock { uvec4 clusterParts[]; };
layout(std430, binding = SLOT_INSTANCE) writeonly restrict buffer InstanceBlock { vec4 instanceBoxes[]; };

shared vec3 lows[LIST_GROUP];
shared vec3 highs[LIST_GROUP];

void main() {
    uint copyNumber = gl_WorkGroupID.x + drawConstants.x;
    uint lane = gl_LocalInvocationID.x;
    vec3 low = vec3(3e38), high = vec3(-3e38);
    for (uint i = lane; i < uint(CLUSTER_PARTS); i += uint(LIST_GROUP)) {
        uint place = (copyNumber * uint(CLUSTER_PARTS) + i) * 2u;
        uvec4 box = clusterParts[place];
        vec4 center = vec4(uintBitsToFloat(box.xyz), 1.0);
        vec3 extent = uintBitsToFloat(clusterParts[place + 1u].xyz);
        JointRows joint = paletteJoint(((box.w >> 16) + FIRST_JOINT(copyNumber)) * uint(PALETTE_ROWS));
        vec3 middle = vec3(dot(joint.a, center), dot(joint.b, center), dot(joint.c, center));
        vec3 reach = vec3(dot(abs(joint.a.xyz), extent), dot(abs(joint.b.xyz), extent), dot(abs(joint.c.xyz), extent));
        low = min(low, middle - reach);
        high = max(high, middle + reach);
    }
    lows[lane] = low;
    highs[lane] = high;
    for (uint width = uint(LIST_GROUP / 2); width > 0u; width /= 2u) {
        memoryBarrierShared();
        barrier();
        if (lane < width) {
            lows[lane] = min(lows[lane], lows[lane + width]);
            highs[lane] = max(highs[lane], highs[lane + width]);
        }
    }
    if (lane > 0u) return;
    instanceBoxes[copyNumber * 2u] = vec4((lows[0] + highs[0]) * 0.5, 0.0);
    instanceBoxes[copyNumber * 2u + 1u] = vec4((highs[0] - lows[0]) * 0.5, 0.0);
}
#endif
