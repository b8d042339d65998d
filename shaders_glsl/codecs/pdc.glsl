// pdc8 and pdc16: the permutation code as its difference to the smallest code of the meshlet.
// Words of a meshlet: the smallest code, bytes of a difference (which its header tells sooner).
#include "vertex_data.glsl"
#include "codecs/base.glsl"
#include "codecs/tuple.glsl"
#include "codecs/permutation.glsl"
#include "codecs/differences.glsl"

Vertex loadMeshletVertex(uint firstByte, uint copyNumber, uint blendBytes, uvec2 blend) {
    PackedVertex stored = loadPacked(copyNumber, firstByte, vertexBytes(blendBytes));
    PermutationBlend decoded = decodePermutation(uvec2(blend.x + codeBytes(stored, blendBytes), 0u));
    return withTuple(withBlend(baseVertex(stored), decoded), decoded.tuple, copyNumber);
}
