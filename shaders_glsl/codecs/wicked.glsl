// As Wicked Engine lays out what its skinning reads: three streams, so that neighbours in number are read together.
// n vertices of a copy lie one behind the other, 36 bytes each, and the copy is filled up to a multiple of 16:
//
//   16 n   position.xyz (f32), normal: [7:0] x  [15:8] y  [23:16] z, each (q / 255) * 2 - 1; [31:24] zero
//   16 n   u16 joints[4], unorm16 weights[4] that sum to exactly 65535
//    4 n   uv as two halves
#include "vertex_data.glsl"

layout(std430, binding = SLOT_VERTEX) readonly restrict buffer VertexBlock { uvec4 vertexQuads[]; };

uvec4 fourHalves(uint a, uint b) { return uvec4(a & 0xFFFFu, a >> 16u, b & 0xFFFFu, b >> 16u); }

Vertex loadVertex(uint place, uint copyNumber) {
    uint number = place - copyNumber * uint(VERTEX_COUNT);
    uint first = copyNumber * uint(BUFFER_WORDS / 4);
    uvec4 body = vertexQuads[first + number];
    uvec4 blend = vertexQuads[first + uint(VERTEX_COUNT) + number];
    Vertex vertex;
    vertex.position = vec3(uintBitsToFloat(body.x), uintBitsToFloat(body.y), uintBitsToFloat(body.z));
    vertex.normal = vec3(body.w & 255u, body.w >> 8u & 255u, body.w >> 16u & 255u) / 255.0 * 2.0 - 1.0;
    vertex.uv = unpackHalf2x16(vertexQuads[first + uint(VERTEX_COUNT) * 2u + number / 4u][number % 4u]);
    vertex.joints0 = fourHalves(blend.x, blend.y);
    vertex.weights0 = vec4(fourHalves(blend.z, blend.w)) / 65535.0;
    return vertex;
}
