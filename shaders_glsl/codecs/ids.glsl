// No bytes: a position that follows from the vertex' number, for cases that measure what remains when nothing is fetched.
// Numbers run along a Z-order curve (Morton 1966), so that neighbours in number are neighbours in place, in a square of
// a sixteenth of the scene's box: triangles so small that few cover a pixel.
#include "vertex_data.glsl"

// Every second bit, from bit 0 on.
uint evenBits(uint bits) {
    bits &= 0x55555555u;
    bits = (bits | bits >> 1) & 0x33333333u;
    bits = (bits | bits >> 2) & 0x0F0F0F0Fu;
    bits = (bits | bits >> 4) & 0x00FF00FFu;
    return (bits | bits >> 8) & 0xFFFFu;
}

Vertex loadVertex(uint place, uint copyNumber) {
    uint number = place - copyNumber * uint(VERTEX_COUNT);
    Vertex vertex;
    vertex.uv = (vec2(evenBits(number), evenBits(number >> 1)) + 0.5) / float(IDS_SIDE);
    vertex.position = vec3((vertex.uv - 0.5) / 16.0 + 0.5, 0.5) * POSITION_EXTENT + POSITION_MIN;
    vertex.normal = vec3(0.0, 0.0, 1.0);
    vertex.joints0 = uvec4(0u);
    vertex.weights0 = vec4(0.0);
#if INFLUENCES == 8
    vertex.joints1 = uvec4(0u);
    vertex.weights1 = vec4(0.0);
#endif
    return vertex;
}
