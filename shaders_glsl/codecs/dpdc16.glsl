// dpdc16: pdc16 with a table of sorted and merged tuples. The payload is rank * MOST_TUPLES + tuple index; the rank
// (0 to 23) is that of the permutation which says in which slot of the tuple each influence has its joint.
#include "vertex_data.glsl"
#include "codecs/base.glsl"
#include "codecs/tuple.glsl"
#include "codecs/permutation.glsl"
#include "codecs/differences.glsl"

// The slots 0 to 3 in the order of that permutation.
uvec4 slotsOfRank(uint rank) {
    uint left = 0x3210u;  // the slots not taken yet, 4 bits each
    uint digits[3] = {rank / 6u, rank % 6u / 2u, rank % 2u};
    uint slots[3];
    for (int i = 0; i < 3; ++i) {
        uint shift = 4u * digits[i];
        slots[i] = left >> shift & 15u;
        uint kept = (1u << shift) - 1u;
        left = (left & kept) | (left >> 4u & ~kept);
    }
    return uvec4(slots[0], slots[1], slots[2], left);
}

uint pick(uvec4 joints, uint slot) {
    uint half0 = (slot & 1u) == 0u ? joints.x : joints.y;
    uint half1 = (slot & 1u) == 0u ? joints.z : joints.w;
    return slot < 2u ? half0 : half1;
}

Vertex loadMeshletVertex(uint firstByte, uint copyNumber, uint blendBytes, uvec2 blend) {
    PackedVertex stored = loadPacked(copyNumber, firstByte, vertexBytes(blendBytes));
    PermutationBlend decoded = decodePermutation(uvec2(blend.x + codeBytes(stored, blendBytes), 0u));
    Vertex vertex = withBlend(baseVertex(stored), decoded);
    vertex = withTuple(vertex, decoded.tuple % uint(MOST_TUPLES), copyNumber);
    uvec4 slots = slotsOfRank(decoded.tuple / uint(MOST_TUPLES));
    uvec4 joints = vertex.joints0;
    vertex.joints0 = uvec4(pick(joints, slots.x), pick(joints, slots.y), pick(joints, slots.z), pick(joints, slots.w));
    return vertex;
}
