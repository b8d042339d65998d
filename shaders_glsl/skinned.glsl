// What one pass skins and a later one draws (common/skin_cpu.h, SkinnedVertex).
#include "shared.h"

struct SkinnedVertex {
    vec4 positionU;
    vec4 normalV;
};
#if REUSE_SKINNED
layout(std430, binding = SLOT_SKINNED) readonly restrict buffer SkinnedBlock { SkinnedVertex skinnedVertices[]; };
#else
layout(std430, binding = SLOT_SKINNED) writeonly restrict buffer SkinnedBlock { SkinnedVertex skinnedVertices[]; };

// `place` counts vertices over all copies.
void storeSkinned(uint place, vec3 position, vec3 normal, vec2 uv) {
    skinnedVertices[place] = SkinnedVertex(vec4(position, uv.x), vec4(normal, uv.y));
}
#endif
