// Permutation Coding: quantised attributes in 14 bytes, then a code of PC_BITS (16, 24 … 64) bits, little-endian.
#include "vertex_data.glsl"
#include "codecs/base.glsl"
#include "codecs/tuple.glsl"
#include "codecs/permutation.glsl"

// Low and high word of the code, which begins in the upper half of word 3.
uvec2 permutationCode(PackedVertex stored) {
    uvec2 code = uvec2(highHalf(stored.words[3]), 0u);
#if PC_BITS > 16
    code.x |= stored.words[4] << 16u;
#endif
#if PC_BITS < 32
    code.x = bitfieldExtract(code.x, 0, PC_BITS);
#elif PC_BITS > 32
    code.y = highHalf(stored.words[4]);
#if PC_BITS > 48
    code.y |= stored.words[5] << 16u;
#endif
    code.y = bitfieldExtract(code.y, 0, PC_BITS - 32);
#endif
    return code;
}

Vertex loadVertex(uint place, uint copyNumber) {
    PackedVertex stored = loadPackedPlace(place, copyNumber);
    PermutationBlend blend = decodePermutation(permutationCode(stored));
    return withTuple(withBlend(baseVertex(stored), blend), blend.tuple, copyNumber);
}
