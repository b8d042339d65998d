// pdc32: a whole permutation code a vertex, or one blend for the meshlet.
//
//   words of a meshlet   0: v2, tuple   1: v4, v3   (high half, low half); tuple 0xFFFF: every vertex has its own code
#include "vertex_data.glsl"
#include "codecs/base.glsl"
#include "codecs/tuple.glsl"
#include "codecs/permutation.glsl"
#include "codecs/differences.glsl"

vec4 meshletWeights(uvec2 blend) {
    vec3 w = vec3(highHalf(blend.x), lowHalf(blend.y), highHalf(blend.y)) / 65535.0 / vec3(2.0, 3.0, 4.0);
    return vec4(1.0 - w.x - w.y - w.z, w);
}

Vertex loadMeshletVertex(uint firstByte, uint copyNumber, uint blendBytes, uvec2 blend) {
    PackedVertex stored = loadPacked(copyNumber, firstByte, vertexBytes(blendBytes));
    Vertex vertex = baseVertex(stored);
    if (blendBytes == 0u) {
        vertex.weights0 = meshletWeights(blend);
        return withTuple(vertex, lowHalf(blend.x), copyNumber);
    }
    PermutationBlend decoded = decodePermutation(uvec2(codeBytes(stored, blendBytes), 0u));
    return withTuple(withBlend(vertex, decoded), decoded.tuple, copyNumber);
}
