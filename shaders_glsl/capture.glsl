// Verifying plans write the skinned vertices of the first and the last copy to a buffer; timed plans hold none of this.
#include "shared.h"

#if CAPTURE
struct CapturedVertex {
    vec4 positionU;
    vec4 normalV;
};
layout(std430, binding = SLOT_CAPTURE) writeonly restrict buffer CaptureBlock { CapturedVertex captured[]; };

void captureVertex(vec3 position, vec3 normal, vec2 uv, uint copyNumber, uint vertexNumber) {
    uint place = copyNumber == 0u ? vertexNumber : vertexNumber + uint(VERTEX_COUNT);
    if (copyNumber == 0u || copyNumber == uint(LAST_COPY))
        captured[place] = CapturedVertex(vec4(position, uv.x), vec4(normal, uv.y));
}
#else
#define captureVertex(position, normal, uv, copyNumber, vertexNumber)
#endif
