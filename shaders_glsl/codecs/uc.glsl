// Uncompressed: 64 bytes (4 influences) or 96 bytes (8), read as uvec4.
//
//   uvec4 0: position.xyz, normal.x    1: normal.yz, uv.xy    2: joints 0-3    3: weights 0-3 (f32)
//   with 8 influences also             4: joints 4-7          5: weights 4-7
#include "vertex_data.glsl"

#if INFLUENCES == 8
#define UC_QUADS 6u
#else
#define UC_QUADS 4u
#endif

layout(std430, binding = SLOT_VERTEX) readonly restrict buffer VertexBlock { uvec4 vertexQuads[]; };

Vertex loadVertex(uint place, uint copyNumber) {
    uint first = place * UC_QUADS;
    vec4 a = uintBitsToFloat(vertexQuads[first]);
    vec4 b = uintBitsToFloat(vertexQuads[first + 1u]);
    Vertex vertex;
    vertex.position = vec3(a);
    vertex.normal = vec3(a.w, b.x, b.y);
    vertex.uv = vec2(b.z, b.w);
    vertex.joints0 = vertexQuads[first + 2u];
    vertex.weights0 = uintBitsToFloat(vertexQuads[first + 3u]);
#if INFLUENCES == 8
    vertex.joints1 = vertexQuads[first + 4u];
    vertex.weights1 = uintBitsToFloat(vertexQuads[first + 5u]);
#endif
    return vertex;
}
