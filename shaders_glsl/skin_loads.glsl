// What skinning reads, without what it computes (--arithmetic loads-only): every word is folded into the position, so that
// no compiler drops a load, and the vertex stays where it is.
struct Blend {
    uvec4 bits;
};

Blend startBlend(Vertex vertex, uint copyNumber) { return Blend(uvec4(0u)); }

void addJoint(inout Blend blend, uint firstRow, float weight) {
    blend.bits.x ^= floatBitsToUint(weight);
    UNROLL for (uint row = 0u; row < uint(PALETTE_ROWS); ++row) blend.bits ^= floatBitsToUint(SKIN_ROW(firstRow + row));
}

vec3 turned(Blend blend, vec3 n) { return n; }

Skinned transformVertex(Blend blend, Vertex vertex) {
    uint folded = blend.bits.x ^ blend.bits.y ^ blend.bits.z ^ blend.bits.w;
    vec3 position = vertex.position;
    if (folded == 0x7FC0DEADu) position.x += 1.0;  // a sum that no palette is likely to have, which no compiler knows
    return Skinned(position, vertex.normal);
}
