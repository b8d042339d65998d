// What the variant `compute` keeps beside position and normal crosses to the pixel too, and is read there: a linker
// drops what is not.
#include "frame.glsl"

#if SKINNED_PREVIOUS
#define SURFACE_MOTION vec3 motion;
#define READ_MOTION surface.motion
#else
#define SURFACE_MOTION
#define READ_MOTION vec3(0.0)
#endif
#if SKINNED_TANGENT
#define SURFACE_TANGENT vec4 tangent;
#define READ_TANGENT surface.tangent
#else
#define SURFACE_TANGENT
#define READ_TANGENT vec4(0.0)
#endif
#define SURFACE_BLOCK Surface { vec3 normal; vec2 uv; SURFACE_COLOR SURFACE_MOTION SURFACE_TANGENT }

// The grid never has a negative number of columns, which no compiler knows.
#define KEEP_SURFACE(color) (frame.grid.x < 0.0 ? color + vec4(READ_MOTION, 0.0) + READ_TANGENT : color)
