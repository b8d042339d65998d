// Dual quaternion skinning (Kavan, Collins, Zara, O'Sullivan, "Geometric Skinning with Approximate Dual Quaternion
// Blending", 2008): rows 0 and 1 of a joint are the real and the dual part of its rigid motion, xyz the vector, w the
// scalar. With PALETTE_ROWS 5 the rows 2 to 4 hold what scales and shears before that, blended linearly (his 4.2).
// common/scene/palette_rows.h is the same on the CPU.
struct Blend {
    vec4 real;
    vec4 dual;
    vec4 pivot;  // q and -q are one rotation: whatever points away from this one is turned round
#if PALETTE_ROWS == 5
    vec4 stretch0;
    vec4 stretch1;
    vec4 stretch2;
#endif
};

#if COMMON_INFLUENCES
void findPivot(inout uint joint, inout float largest, uvec4 joints, vec4 weights) {
    UNROLL for (uint i = 0u; i < 4u; ++i) {
        bool better = weights[i] > largest || (weights[i] == largest && joints[i] < joint);
        joint = better ? joints[i] : joint;
        largest = better ? weights[i] : largest;
    }
}
#endif

// The joint of the largest weight, of equal ones the lowest, which is the first of a vertex, but not of a list that the
// vertices of a meshlet share.
uint pivotJoint(Vertex vertex) {
    uint joint = vertex.joints0.x;
#if COMMON_INFLUENCES
    float largest = vertex.weights0.x;
    findPivot(joint, largest, vertex.joints0, vertex.weights0);
#if INFLUENCES == 8
    findPivot(joint, largest, vertex.joints1, vertex.weights1);
#endif
#endif
    return joint;
}

Blend startBlend(Vertex vertex, uint copyNumber) {
    Blend blend;
    blend.real = blend.dual = vec4(0.0);
    blend.pivot = SKIN_ROW((pivotJoint(vertex) + SKIN_FIRST_JOINT(copyNumber)) * uint(PALETTE_ROWS));
#if PALETTE_ROWS == 5
    blend.stretch0 = blend.stretch1 = blend.stretch2 = vec4(0.0);
#endif
    return blend;
}

void addJoint(inout Blend blend, uint firstRow, float weight) {
    vec4 real = SKIN_ROW(firstRow);
    float turnedWeight = dot(blend.pivot, real) < 0.0 ? -weight : weight;
    blend.real += turnedWeight * real;
    blend.dual += turnedWeight * SKIN_ROW(firstRow + 1u);
#if PALETTE_ROWS == 5
    blend.stretch0 += weight * SKIN_ROW(firstRow + 2u);
    blend.stretch1 += weight * SKIN_ROW(firstRow + 3u);
    blend.stretch2 += weight * SKIN_ROW(firstRow + 4u);
#endif
}

vec3 stretched(Blend blend, vec4 p) {
#if PALETTE_ROWS == 5
    return vec3(dot(blend.stretch0, p), dot(blend.stretch1, p), dot(blend.stretch2, p));
#else
    return p.xyz;
#endif
}

// By a unit quaternion.
vec3 rotated(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

vec3 turned(Blend blend, vec3 n) {
    return normalize(rotated(blend.real / length(blend.real), stretched(blend, vec4(n, 0.0))));
}

Skinned transformVertex(Blend blend, Vertex vertex) {
    float unit = 1.0 / length(blend.real);
    vec4 real = blend.real * unit, dual = blend.dual * unit;
    vec3 moved = 2.0 * (real.w * dual.xyz - dual.w * real.xyz + cross(real.xyz, dual.xyz));
    Skinned skinned;
    skinned.position = rotated(real, stretched(blend, vec4(vertex.position, 1.0))) + moved;
    skinned.normal = turned(blend, vertex.normal);
    return skinned;
}
