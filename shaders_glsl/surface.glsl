// Between the geometry stage and the pixel: what crosses it (lean: a normal and a uv) and how it is shaded.
// Views replace the shading by a colour that the geometry stage chooses per vertex.
#define VIEW_SHADED 0
#define VIEW_MESHLETS 1
#define VIEW_WEIGHTS 2
#define VIEW_TUPLES 3
#define VIEW_VELOCITY 4

// One block: NVIDIA's OpenGL compiler refuses a mesh stage's outputs as separate arrays.
#if VIEW == VIEW_SHADED
#define SURFACE_COLOR
#else
#define SURFACE_COLOR vec3 color;
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

void main() {
    vec3 n = normalize(READ_NORMAL);
    float key = max(dot(n, normalize(vec3(0.45, 0.65, 0.62))), 0.0);
    float fill = 0.5 + 0.5 * n.y;
    float rim = pow(1.0 - abs(n.z), 3.0);
#if VIEW == VIEW_SHADED
    vec3 base = mix(vec3(0.72, 0.66, 0.60), vec3(0.66, 0.70, 0.74), clamp(READ_UV.y, 0.0, 1.0));
#else
    vec3 base = READ_COLOR;
#endif
    vec3 light = vec3(1.0, 0.96, 0.90) * key * 0.85 + vec3(0.32, 0.38, 0.48) * fill * 0.55 + vec3(0.10) * rim;
    pixel = KEEP_SURFACE(vec4(sqrt(clamp(base * light, 0.0, 1.0)), 1.0));
}
#endif

// A colour that tells neighbours apart: hue from the golden ratio, brightness in three steps.
vec3 labelColor(uint label) {
    uint mixed = label * 2654435769u;
    float hue = float(mixed >> 8) / 16777216.0;
    float value = 0.55 + 0.15 * float((label * 7u + 3u) % 4u);
    vec3 wave = abs(fract(hue + vec3(0.0, 0.6666667, 0.3333333)) * 6.0 - 3.0) - 1.0;
    return value * mix(vec3(1.0), clamp(wave, 0.0, 1.0), 0.75);
}
