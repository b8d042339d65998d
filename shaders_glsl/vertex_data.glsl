// A decoded vertex: what every codec delivers and every variant skins. A file of codecs/ defines either
//
//   Vertex loadVertex(uint place, uint copyNumber)
//
// or, with CODEC_PER_MESHLET 1,
//
//   uvec2 loadMeshletBlend(uint meshletNumber, uint copyNumber)
//   uint vertexBytes(uint blendBytes)
//   uint firstByteOf(uint number, uint blendBytes)
//   Vertex loadMeshletVertex(uint firstByte, uint copyNumber, uint blendBytes, uvec2 blend)
//
// `place` counts vertices over all copies, `number`, `firstByte` and `meshletNumber` within the copy. The meshlet's
// header tells `blendBytes` and, with ordered records, the byte too, so that a vertex need not wait for `blend`. Codecs
// trust their encoder: no index is tested. Their files include the parts that they need, the parts include nothing.
#include "shared.h"

struct Vertex {
    vec3 position;
    vec3 normal;
    vec2 uv;
    uvec4 joints0;
    vec4 weights0;
#if INFLUENCES == 8
    uvec4 joints1;
    vec4 weights1;
#endif
};
