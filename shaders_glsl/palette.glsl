// The joints as skinning reads them (common/scene/palette_rows.h).
//
// PALETTE_ROWS rows a joint, of four floats or, with PALETTE_HALF, of four half floats. As a uniform block a draw sees
// the joints of its own copy only; std140 asks for 16 bytes an element, so that two rows of halves share one.
#include "frame.glsl"

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
vec4 paletteRow(uint i) {
#if PALETTE_UNIFORM
    uvec4 two = paletteRows[i / 2u];
    uvec2 row = (i & 1u) == 0u ? two.xy : two.zw;
#else
    uvec2 row = paletteRows[i];
#endif
    return vec4(unpackHalf2x16(row.x), unpackHalf2x16(row.y));
}
#else
#define paletteRow(i) paletteRows[i]
#endif

#if PALETTE_UNIFORM
#define FIRST_JOINT(copyNumber) 0u
#else
#define FIRST_JOINT(copyNumber) ((copyNumber) * uint(JOINT_COUNT))
#endif
