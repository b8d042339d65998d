// Between the geometry stage and the pixel: what crosses it (lean: a normal and a uv) and how it is shaded.
// Views replace the shading by a colour that the geometry stage chooses per vertex; that of culling has one a pass.
#include "shared.h"

// A colour that tells neighbours apart: hue from the golden ratio, brightness in three steps.
vec3 labelColor(uint label) {
    uint mixed = label * 2654435769u;
    float hue = float(mixed >> 8) / 16777216.0;
    float value = 0.55 + 0.15 * float((label * 7u + 3u) % 4u);
    vec3 wave = abs(fract(hue + vec3(0.0, 0.6666667, 0.3333333)) * 6.0 - 3.0) - 1.0;
    return value * mix(vec3(1.0), clamp(wave, 0.0, 1.0), 0.75);
}

// One block: NVIDIA's OpenGL compiler refuses a mesh stage's outputs as separate arrays.
#define VERTEX_COLORS (VIEW != VIEW_SHADED && VIEW != VIEW_CULLED)
#if VERTEX_COLORS
#define SURFACE_COLOR vec3 color;
#else
#define SURFACE_COLOR
#endif
#if SPARE_OUTPUT
#include "surface_spare.glsl"
#elif SKINNED_PREVIOUS || SKINNED_TANGENT
#include "surface_kept.glsl"
#else
#define SURFACE_BLOCK Surface { vec3 normal; vec2 uv; SURFACE_COLOR }
#endif

#if STAGE_FRAGMENT
layout(location = 0) in SURFACE_BLOCK surface;
layout(location = 0) out vec4 pixel;

#if !SPARE_OUTPUT
#define READ_NORMAL surface.normal
#define READ_UV surface.uv
#define READ_COLOR surface.color
#ifndef KEEP_SURFACE
#define KEEP_SURFACE(color) color
#endif
#endif

#if VIEW == VIEW_RESOLUTION
// Boxes of the grid that positions are stored on, dark and light in turn: a box is 2^level steps wide, the least that
// covers 8 pixels, and the level chooses the hue. `unit` is the bind position within the grid, 0 to 1. Without a grid:
// grey.
vec3 resolutionColor(vec3 unit) {
#ifdef POSITION_EXTENT
    vec3 steps = unit * 65535.0;
    vec3 slope = fwidth(steps);
    float level = clamp(ceil(log2(8.0 * max(max(slope.x, slope.y), max(slope.z, 0.125)))), 0.0, 16.0);
    uvec3 box = uvec3(clamp(steps, 0.0, 65535.0)) >> uint(level);
    return labelColor(uint(level)) * (((box.x + box.y + box.z) & 1u) == 0u ? 1.0 : 0.45);
#else
    return vec3(0.5);
#endif
}
#endif

#if VIEW == VIEW_CULLED
#include "frame.glsl"

const vec3 verdictColors[VERDICT_COUNT] =
    vec3[](vec3(COLOR_DRAWN), vec3(COLOR_BEYOND), vec3(COLOR_AWAY), vec3(COLOR_TRIANGLE_BEYOND),
           vec3(COLOR_TRIANGLE_AWAY), vec3(COLOR_TRIANGLE_SMALL));
#endif

void main() {
    vec3 n = normalize(READ_NORMAL);
#if VIEW == VIEW_NORMALS
    pixel = KEEP_SURFACE(vec4(n * 0.5 + 0.5, 1.0));
#elif VIEW == VIEW_CULLED
    // White light: a darker pixel has the hue of the legend still.
    float light = 0.7 + 0.3 * dot(n, normalize(vec3(0.45, 0.65, 0.62)));
    pixel = KEEP_SURFACE(vec4(verdictColors[VIEW_NUMBER] * light, 1.0));
#else
    float key = max(dot(n, normalize(vec3(0.45, 0.65, 0.62))), 0.0);
    float fill = 0.5 + 0.5 * n.y;
    float rim = pow(1.0 - abs(n.z), 3.0);
#if VIEW == VIEW_SHADED
    vec3 base = mix(vec3(0.72, 0.66, 0.60), vec3(0.66, 0.70, 0.74), clamp(READ_UV.y, 0.0, 1.0));
#elif VIEW == VIEW_RESOLUTION
    vec3 base = resolutionColor(READ_COLOR);
#else
    vec3 base = READ_COLOR;
#endif
    vec3 light = vec3(1.0, 0.96, 0.90) * key * 0.85 + vec3(0.32, 0.38, 0.48) * fill * 0.55 + vec3(0.10) * rim;
    pixel = KEEP_SURFACE(vec4(sqrt(clamp(base * light, 0.0, 1.0)), 1.0));
#endif
}
#endif
