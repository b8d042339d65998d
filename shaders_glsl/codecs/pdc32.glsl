// pdc32: a whole permutation code a vertex, or one blend for the meshlet.
//
//   words of a meshlet   0: v2, tuple   1: v4, v3   (high half, low half); tuple 0xFFFF: every vertex has its own code
#include "vertex_data.glsl"
#include "codecs/base.glsl"
#include "codecs/tuple.glsl"
#include "codecs/permutation.glsl"
#include "codecs/differences.glsl"

vec4 meshletWeights(uvec2 extra) {
    vec3 w = vec3(highHalf(extra.x), lowHalf(extra.y), highHalf(extra.y)) / 65535.0 / vec3(2.0, 3.0, 4.0);
    return vec4(1.0 - w.x - w.y - w.z, w);
}

Vertex loadMeshletVertex(uint place, uint copyNumber, uint meshletNumber, uint localVertex) {
    uvec2 extra = loadMeshletExtra(meshletNumber, copyNumber);
    uint tuple = lowHalf(extra.x);
    uint width = tuple == 0xFFFFu ? 4u : 0u;
    PackedVertex stored = loadWidth(place, copyNumber, width);
    Vertex vertex = baseVertex(stored);
    if (width == 0u) {
        vertex.weights0 = meshletWeights(extra);
    } else {
        PermutationBlend blend = decodePermutation(uvec2(blendBytes(stored, width), 0u));
        vertex = withBlend(vertex, blend);
        tuple = blend.tuple;
    }
    return withTuple(vertex, tuple, copyNumber);
}
