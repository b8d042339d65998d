// Linear blend skinning: blend the 3x4 joint matrices, transform once. The same loads and the same order of additions
// in every variant on every API.
#include "frame.glsl"

// Three rows a joint. As a uniform block a draw sees the joints of its own copy only.
#if PALETTE_UNIFORM
layout(std140, binding = SLOT_PALETTE) uniform PaletteBlock { vec4 paletteRows[JOINT_COUNT * 3]; };
#define FIRST_JOINT(copyNumber) 0u
#else
layout(std430, binding = SLOT_PALETTE) readonly restrict buffer PaletteBlock { vec4 paletteRows[]; };
#define FIRST_JOINT(copyNumber) ((copyNumber) * uint(JOINT_COUNT))
#endif

// The rows of the joints that a work group uses, where it copies them first.
#if STAGED_JOINTS
shared vec4 stagedRows[STAGED_JOINTS * 3];
#define SKIN_ROW(i) stagedRows[i]
#define SKIN_FIRST_JOINT(copyNumber) 0u
#else
#define SKIN_ROW(i) paletteRows[i]
#define SKIN_FIRST_JOINT(copyNumber) FIRST_JOINT(copyNumber)
#endif

struct Skinned {
    vec3 position;
    vec3 normal;
};

struct Blend {
    vec4 row0;
    vec4 row1;
    vec4 row2;
};

void addInfluence(inout Blend blend, uint firstRow, float weight) {
    blend.row0 += weight * SKIN_ROW(firstRow);
    blend.row1 += weight * SKIN_ROW(firstRow + 1u);
    blend.row2 += weight * SKIN_ROW(firstRow + 2u);
}

void addFour(inout Blend blend, uint copyNumber, uvec4 joints, vec4 weights) {
    uvec4 rows = (joints + SKIN_FIRST_JOINT(copyNumber)) * 3u;
    addInfluence(blend, rows.x, weights.x);
    addInfluence(blend, rows.y, weights.y);
    addInfluence(blend, rows.z, weights.z);
    addInfluence(blend, rows.w, weights.w);
}

Blend blendJoints(Vertex vertex, uint copyNumber) {
    Blend blend = Blend(vec4(0.0), vec4(0.0), vec4(0.0));
    addFour(blend, copyNumber, vertex.joints0, vertex.weights0);
#if INFLUENCES == 8
    addFour(blend, copyNumber, vertex.joints1, vertex.weights1);
#endif
    return blend;
}

vec3 turned(Blend blend, vec3 n) {
    return normalize(vec3(dot(blend.row0.xyz, n), dot(blend.row1.xyz, n), dot(blend.row2.xyz, n)));
}

Skinned transformVertex(Blend blend, Vertex vertex) {
    vec4 p = vec4(vertex.position, 1.0);
    Skinned skinned;
    skinned.position = vec3(dot(blend.row0, p), dot(blend.row1, p), dot(blend.row2, p));
    skinned.normal = turned(blend, vertex.normal);
    return skinned;
}

Skinned skinVertex(Vertex vertex, uint copyNumber) {
    return transformVertex(blendJoints(vertex, copyNumber), vertex);
}

// The `none` variant: what the others do without skinning.
Skinned keepVertex(Vertex vertex) { return Skinned(vertex.position, vertex.normal); }
