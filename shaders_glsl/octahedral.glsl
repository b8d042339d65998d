// A unit vector as 32 bits: two signed 16-bit coordinates on the unfolded octahedron, x in the lower half (Cigolle et
// al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014).
vec2 foldOctahedron(vec2 v) {
    return (1.0 - abs(v.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(v, vec2(0.0)));
}

uint packNormal(vec3 n) {
    vec2 unfolded = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return packSnorm2x16(n.z < 0.0 ? foldOctahedron(unfolded) : unfolded);
}

// A tangent and the side of the bitangent, 1 or -1: as above but for the lowest bit, which is set where it is -1.
uint packTangent(vec4 tangent) { return (packNormal(tangent.xyz) & ~1u) | (tangent.w < 0.0 ? 1u : 0u); }

vec3 unpackNormal(uint word) {
    vec2 unfolded = unpackSnorm2x16(word);
    float z = 1.0 - abs(unfolded.x) - abs(unfolded.y);
    return normalize(vec3(z < 0.0 ? foldOctahedron(unfolded) : unfolded, z));
}

vec4 unpackTangent(uint word) { return vec4(unpackNormal(word & ~1u), (word & 1u) != 0u ? -1.0 : 1.0); }
