// pdc8 and pdc16: the permutation code as its difference to the smallest code of the meshlet.
// Words of a meshlet: the smallest code, bytes of a difference.
#include "vertex_data.glsl"
#include "codecs/base.glsl"
#include "codecs/tuple.glsl"
#include "codecs/permutation.glsl"
#include "codecs/differences.glsl"

Vertex loadMeshletVertex(uint place, uint copyNumber, uint meshletNumber, uint localVertex) {
    uvec2 extra = loadMeshletExtra(meshletNumber, copyNumber);
    PackedVertex stored = loadWidth(place, copyNumber, extra.y);
    PermutationBlend blend = decodePermutation(uvec2(extra.x + blendBytes(stored, extra.y), 0u));
    return withTuple(withBlend(baseVertex(stored), blend), blend.tuple, copyNumber);
}
