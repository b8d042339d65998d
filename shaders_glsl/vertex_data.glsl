// A decoded vertex: what every codec delivers and every variant skins. A file of codecs/ defines either
//
//   Vertex loadVertex(uint place, uint copyNumber)
//   Vertex loadMeshletVertex(uint place, uint copyNumber, uint meshletNumber, uint localVertex)   CODEC_PER_MESHLET 1
//
// `place` counts vertices over all copies, `meshletNumber` meshlets within the copy. Codecs trust their encoder: no index
// is tested. Their files include the parts that they need, the parts include nothing.
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
