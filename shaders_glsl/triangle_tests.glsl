// Whether a triangle can be seen, from the clip positions of its corners. What is in doubt stays.
#include "rounding.glsl"

// A vertex behind the eye or far outside the view has no screen position that could be trusted.
bool isTrusted(vec4 clip) { return max(abs(clip.x), abs(clip.y)) < 8.0 * clip.w; }

// In pixels from the centre of the image, y down.
vec2 screenPosition(vec4 clip) { return clip.xy / clip.w * (0.5 * vec2(IMAGE_WIDTH, IMAGE_HEIGHT)); }

// All corners beyond one plane of the view volume, wherever the eye is.
bool isBeyondOnePlane(vec4 a, vec4 b, vec4 c) {
    vec3 right = vec3(a.x - a.w, b.x - b.w, c.x - c.w), left = vec3(-a.x - a.w, -b.x - b.w, -c.x - c.w);
    vec3 below = vec3(a.y - a.w, b.y - b.w, c.y - c.w), above = vec3(-a.y - a.w, -b.y - b.w, -c.y - c.w);
    vec3 far = vec3(a.z - a.w, b.z - b.w, c.z - c.w), near = -vec3(a.z, b.z, c.z);
    return all(greaterThan(right, vec3(0.0))) || all(greaterThan(left, vec3(0.0))) ||
           all(greaterThan(below, vec3(0.0))) || all(greaterThan(above, vec3(0.0))) ||
           all(greaterThan(far, vec3(0.0))) || all(greaterThan(near, vec3(0.0)));
}

// Front faces are counter-clockwise as seen, with y down: their doubled area is negative here. A triangle faces away only
// when its area keeps its sign whatever the rounding: each component of an edge moves by at most two roundings.
bool facesAway(vec2 a, vec2 b, vec2 c) {
    const float moved = 2.0 * MOST_ROUNDING;
    vec2 ab = b - a, ac = c - a;
    float doubledArea = ab.x * ac.y - ab.y * ac.x;
    float doubt = moved * (abs(ab.x) + abs(ab.y) + abs(ac.x) + abs(ac.y)) + 2.0 * moved * moved;
    return doubledArea > doubt;
}

// No centre of a pixel lies within the bounds of the corners (Wihlidal, "Optimizing the Graphics Pipeline with Compute",
// 2016).
bool coversNoSample(vec2 a, vec2 b, vec2 c) {
    vec2 center = 0.5 * vec2(IMAGE_WIDTH, IMAGE_HEIGHT) - 0.5;  // whole numbers are centres of pixels then
    vec2 low = min(min(a, b), c) + center - MOST_ROUNDING, high = max(max(a, b), c) + center + MOST_ROUNDING;
    return any(greaterThan(ceil(low), floor(high)));
}
