// Optimal Simplex Sampling (Kuth, Meyer, HPG 2021): quantised attributes in 14 bytes, then 32 bits: the number of a
// grid point in the upper OSS_BITS (at most 26), a tuple index below. OSS_POINTS is n of common/codecs/simplex.h.
#include "vertex_data.glsl"
#include "codecs/base.glsl"
#include "codecs/tuple.glsl"

// Grid points in all, and those of one layer of the smallest weight with index j or above. 2 n + 1 - 3 j may be
// negative: its square is right modulo 2^32 all the same.
uint gridCount(uint n) { return ((n + 1u) * (n + 1u) * (2u * n + 5u) + 18u) / 36u; }
uint layerCount(uint j, uint n) {
    uint a = 2u * n + 1u - 3u * j;
    return (a * a + 6u) / 12u;
}

// The estimates of k and j are off by one step at most.
vec4 simplexWeights(uint code) {
    uint n = uint(OSS_POINTS);
    uint behind = gridCount(n) - code;
    float root = pow(144.0 * float(behind), 1.0 / 3.0);
    uint k = (2u * n + 3u - min(uint(root + 1.0 / root), 2u * n + 3u)) / 4u;
    if (behind > gridCount(n - 2u * k)) --k;
    uint m = n - 2u * k;
    uint inLayer = code - (gridCount(n) - gridCount(m));
    uint all = layerCount(0u, m);
    uint rest = all - inLayer;
    uint j = (2u * m + 1u - min(uint(sqrt(12.0 * float(rest))), 2u * m + 1u)) / 3u;
    if (rest > layerCount(j, m)) --j;
    if (rest <= layerCount(j + 1u, m)) ++j;
    uint i = inLayer - (all - layerCount(j, m));
    uint steps = 2u * (n - 1u);
    return vec4(steps - (i + 2u * j + 3u * k), i + j + k, j + k, k) / float(steps);
}

Vertex loadVertex(uint place, uint copyNumber) {
    PackedVertex stored = loadPackedPlace(place, copyNumber);
    uint blend = highHalf(stored.words[3]) | stored.words[4] << 16u;
    Vertex vertex = baseVertex(stored);
    vertex.weights0 = simplexWeights(blend >> (32 - OSS_BITS));
    return withTuple(vertex, bitfieldExtract(blend, 0, 32 - OSS_BITS), copyNumber);
}
