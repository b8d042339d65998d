// The joints as skinning reads them (common/scene/palette_rows.h).
//
// PALETTE_ROWS rows a joint, of four floats or, with PALETTE_HALF, of four half floats. As a uniform block a draw sees
// the joints of its own copy only; std140 asks for 16 bytes an element, so that two rows of halves share one.
#include "frame.glsl"
#include "joint_rows.glsl"

#if PALETTE_UNIFORM && PALETTE_HALF
layout(std140, binding = SLOT_PALETTE) uniform PaletteBlock { uvec4 paletteRows[(JOINT_COUNT * PALETTE_ROWS + 1) / 2]; };
#elif PALETTE_UNIFORM
layout(std140, binding = SLOT_PALETTE) uniform PaletteBlock { vec4 paletteRows[JOINT_COUNT * PALETTE_ROWS]; };
#elif PALETTE_HALF
layout(std430, binding = SLOT_PALETTE) readonly restrict buffer PaletteBlock { uvec2 paletteRows[]; };
#else
layout(std430, binding = SLOT_PALETTE) readonly restrict buffer PaletteBlock { vec4 paletteRows[]; };
#endif

#if PALETTE_HALF
vec4 fromHalves(uvec2 row) { return vec4(unpackHalf2x16(row.x), unpackHalf2x16(row.y)); }

vec4 paletteRow(uint i) {
#if PALETTE_UNIFORM
    uvec4 two = paletteRows[i / 2u];
    return fromHalves((i & 1u) == 0u ? two.xy : two.zw);
#else
    return fromHalves(paletteRows[i]);
#endif
}
#else
#define paletteRow(i) paletteRows[i]
#endif

// Three rows from `first`, of which two share what is loaded where halves stand in pairs.
JointRows paletteJoint(uint first) {
#if PALETTE_HALF && PALETTE_UNIFORM
    bool odd = (first & 1u) != 0u;
    uvec4 two = paletteRows[first / 2u], next = paletteRows[first / 2u + 1u];
    return JointRows(fromHalves(odd ? two.zw : two.xy), fromHalves(odd ? next.xy : two.zw),
                     fromHalves(odd ? next.zw : next.xy));
#else
    return JointRows(paletteRow(first), paletteRow(first + 1u), paletteRow(first + 2u));
#endif
}

#if PALETTE_UNIFORM
#define FIRST_JOINT(copyNumber) 0u
#else
#define FIRST_JOINT(copyNumber) ((copyNumber) * uint(JOINT_COUNT))
#endif
