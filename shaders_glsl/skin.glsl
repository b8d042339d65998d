// Skinning: the joints' transforms are blended by the weights, and the vertex is moved once. The same loads and the same
// order of additions in every variant on every API. METHOD says how transforms are blended.
#include "palette.glsl"

// The rows of the joints that a work group uses, where it copies them first.
#if STAGED_JOINTS
shared vec4 stagedRows[STAGED_JOINTS * PALETTE_ROWS];
#define SKIN_ROW(i) stagedRows[i]
#define SKIN_JOINT(first) JointRows(stagedRows[first], stagedRows[(first) + 1u], stagedRows[(first) + 2u])
#define SKIN_FIRST_JOINT(copyNumber) 0u
#else
#define SKIN_ROW(i) paletteRow(i)
#define SKIN_JOINT(first) paletteJoint(first)
#define SKIN_FIRST_JOINT(copyNumber) FIRST_JOINT(copyNumber)
#endif

struct Skinned {
    vec3 position;
    vec3 normal;
};

// A file of these three defines
//
//   Blend startBlend(Vertex vertex, uint copyNumber)
//   void addJoint(inout Blend blend, uint firstRow, float weight)
//   vec3 turned(Blend blend, vec3 n)                         unit length
//   Skinned transformVertex(Blend blend, Vertex vertex)
#if LOADS_ONLY
#include "skin_loads.glsl"
#elif METHOD == METHOD_DQS
#include "skin_dual.glsl"
#else
#include "skin_linear.glsl"
#endif

void addInfluence(inout Blend blend, uint firstRow, float weight) {
#if ZERO_WEIGHTS == ZERO_WEIGHTS_SKIP
    if (weight > 1e-7)
#endif
        addJoint(blend, firstRow, weight);
}

// The first `count` of four influences; a constant 4 leaves no test. NVIDIA's compilers order the loads by how this is
// written, and neither form is the faster one for both methods (docs/studies/palette_rows.md).
void addFour(inout Blend blend, uint copyNumber, uvec4 joints, vec4 weights, uint count) {
    uvec4 rows = (joints + SKIN_FIRST_JOINT(copyNumber)) * uint(PALETTE_ROWS);
#if METHOD == METHOD_DQS
    if (count > 0u) addInfluence(blend, rows.x, weights.x);
    if (count > 1u) addInfluence(blend, rows.y, weights.y);
    if (count > 2u) addInfluence(blend, rows.z, weights.z);
    if (count > 3u) addInfluence(blend, rows.w, weights.w);
#else
    for (uint i = 0u; i < 4u; ++i)
        if (i < count) addInfluence(blend, rows[i], weights[i]);
#endif
}

Blend blendJoints(Vertex vertex, uint copyNumber, uint count) {
    Blend blend = startBlend(vertex, copyNumber);
    addFour(blend, copyNumber, vertex.joints0, vertex.weights0, count);
#if INFLUENCES == 8
    addFour(blend, copyNumber, vertex.joints1, vertex.weights1, max(count, 4u) - 4u);
#endif
    return blend;
}

// `count`: the influences that may weigh anything, INFLUENCES where nothing better is known.
Skinned skinVertex(Vertex vertex, uint copyNumber, uint count) {
    return transformVertex(blendJoints(vertex, copyNumber, count), vertex);
}

// The `none` variant: what the others do without skinning.
Skinned keepVertex(Vertex vertex) { return Skinned(vertex.position, vertex.normal); }
