// What one pass skins and a later one draws, 32 bytes (common/scene/skin_cpu.h, SkinnedVertex). The variant `compute` also
// has a short form and keeps more (common/plans/plan_parts.h, SkinnedLayout).
#include "shared.h"
#if SKINNED_PACKED
#include UNIT_VECTORS
#endif

struct SkinnedVertex {
#if SKINNED_PACKED
    uvec4 positionNormal;  // position as 3 floats, the normal by packNormal
#else
    vec4 positionU;
    vec4 normalV;
#endif
#if SKINNED_PREVIOUS
    vec4 previous;  // xyz: position one update ago
#endif
#if SKINNED_TANGENT && !SHORT_TANGENT
    vec4 tangent;  // w as in SLOT_TANGENT
#endif
};

#if REUSE_SKINNED
layout(std430, binding = SLOT_SKINNED) readonly restrict buffer SkinnedBlock { SkinnedVertex skinnedVertices[]; };
#else
#if SKINNED_PREVIOUS
layout(std430, binding = SLOT_SKINNED) restrict buffer SkinnedBlock { SkinnedVertex skinnedVertices[]; };
#else
layout(std430, binding = SLOT_SKINNED) writeonly restrict buffer SkinnedBlock { SkinnedVertex skinnedVertices[]; };
#endif

// `place` counts vertices over all copies.
void storeSkinned(uint place, vec3 position, vec3 normal, vec2 uv) {
#if SKINNED_PREVIOUS
#if SKINNED_PACKED
    skinnedVertices[place].previous = vec4(uintBitsToFloat(skinnedVertices[place].positionNormal.xyz), 0.0);
#else
    skinnedVertices[place].previous = vec4(skinnedVertices[place].positionU.xyz, 0.0);
#endif
#endif
#if SKINNED_PACKED
    skinnedVertices[place].positionNormal = uvec4(floatBitsToUint(position), packNormal(normal));
#else
    skinnedVertices[place].positionU = vec4(position, uv.x);
    skinnedVertices[place].normalV = vec4(normal, uv.y);
#endif
}
#endif
