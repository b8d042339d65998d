// Copies a buffer, 16 bytes an invocation, to measure the device's bandwidth.
#if STAGE_COMPUTE
#include "shared.h"
#include "platform.glsl"

layout(local_size_x = COPY_GROUP) in;

layout(std430, binding = SLOT_VERTEX) readonly restrict buffer FromBlock { uvec4 source[]; };
layout(std430, binding = SLOT_SKINNED) writeonly restrict buffer ToBlock { uvec4 target[]; };

void main() {
    uint i = gl_GlobalInvocationID.x + drawConstants.y * uint(COPY_GROUP);
    target[i] = source[i];
}
#endif
