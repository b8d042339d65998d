// A decoded vertex: what every codec delivers and every variant skins.
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
