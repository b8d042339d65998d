// Quantised attributes in 14 bytes, then u16 joints and unorm16 weights that sum to exactly 65535: 30 bytes, with 8
// influences 46. Vertices lie at multiples of 2 bytes; copies at multiples of 4.
//
//   4 influences   14 u16 joints[4]   22 unorm16 weights[4]
//   8 influences   14 u16 joints[8]   30 unorm16 weights[8]
#include "vertex_data.glsl"
#include "codecs/base.glsl"

// Four u16 that begin in the upper half of a word.
uvec4 fourHalves(uint a, uint b, uint c) { return uvec4(highHalf(a), lowHalf(b), highHalf(b), lowHalf(c)); }

Vertex loadVertex(uint place, uint copyNumber) {
    PackedVertex stored = loadPackedPlace(place, copyNumber);
    Vertex vertex = baseVertex(stored);
    vertex.joints0 = fourHalves(stored.words[3], stored.words[4], stored.words[5]);
#if INFLUENCES == 8
    vertex.joints1 = fourHalves(stored.words[5], stored.words[6], stored.words[7]);
    vertex.weights0 = vec4(fourHalves(stored.words[7], stored.words[8], stored.words[9])) / 65535.0;
    vertex.weights1 = vec4(fourHalves(stored.words[9], stored.words[10], stored.words[11])) / 65535.0;
#else
    vertex.weights0 = vec4(fourHalves(stored.words[5], stored.words[6], stored.words[7])) / 65535.0;
#endif
    return vertex;
}
