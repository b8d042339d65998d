// A unit vector as three bytes, as Wicked Engine keeps normals and tangents: q / 255 * 2 - 1. What octahedral.glsl
// does, by the same names; rounded to the nearest, so that a component is off by 1 / 255 at the most.
uint packNormal(vec3 n) { return packUnorm4x8(vec4(n * 0.5 + 0.5, 0.0)); }

vec3 unpackNormal(uint word) { return normalize(unpackUnorm4x8(word).xyz * 2.0 - 1.0); }

// The side is the fourth byte: 0 or 255.
uint packTangent(vec4 tangent) { return packUnorm4x8(tangent * 0.5 + 0.5); }

vec4 unpackTangent(uint word) { return vec4(unpackNormal(word), (word >> 24u) < 128u ? -1.0 : 1.0); }
