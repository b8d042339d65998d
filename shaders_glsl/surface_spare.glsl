// For a driver that loses the last location of a mesh stage's outputs (DeviceCaps::lastMeshOutputLost): a spare one is
// last. Every component is written with a value of its own and read, because a linker packs what is left over.
#include "frame.glsl"

#define SURFACE_BLOCK Surface { vec4 first; vec4 second; vec4 spare; }

#if STAGE_FRAGMENT
#define READ_NORMAL surface.first.xyz
#define READ_UV surface.second.xy
#define READ_COLOR vec3(surface.first.w, surface.second.zw)
// The grid never has a negative number of columns, which no compiler knows.
#define KEEP_SURFACE(color) \
    (frame.grid.x < 0.0 ? color + surface.first + surface.second.wzyx + surface.spare : color)
#endif
