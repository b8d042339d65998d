// What every stage knows about the frame and about the copy that it works on.
//
// drawConstants: x: copy, y: first work group of the draw (draws above the device's group count are split).
// w: with OTHER_VIEW the number of the view, 1 to MOST_VIEWS - 1; in the view `culled` the verdict that the pass shows.
// A batched draw covers all copies; there the copy follows from the vertex, group or invocation number.
#include "shared.h"
#include "platform.glsl"

layout(std140, binding = SLOT_FRAME) uniform FrameBlock { FrameConstants frame; };

// Two passes that must agree on every bit of the depth (DepthTest::equalKeep) may not contract operations differently.
#if SAME_DEPTH
#define EXACT precise
#else
#define EXACT
#endif

#if OTHER_VIEW
#define VIEW_NUMBER drawConstants.w
#define VIEW_PROJECTION frame.otherViews[VIEW_NUMBER - 1u]
#else
#if VIEW == VIEW_CULLED
#define VIEW_NUMBER drawConstants.w
#else
#define VIEW_NUMBER 0u
#endif
#define VIEW_PROJECTION frame.viewProjection
#endif

// Copies stand on a grid. The offset is added after skinning, so that skinned positions stay near the origin, where
// floats are dense, and can be compared with the reference of a single character.
vec3 copyOffset(uint copyNumber) {
    EXACT float row = floor((float(copyNumber) + 0.5) / frame.grid.x);
    EXACT float column = float(copyNumber) - row * frame.grid.x;
    EXACT vec3 offset = vec3(column * frame.grid.y, -row * frame.grid.z, 0.0);
    return offset;
}

vec4 clipPosition(vec3 skinned, uint copyNumber) {
    EXACT vec3 placed = skinned + copyOffset(copyNumber);
    EXACT vec4 clip = VIEW_PROJECTION * vec4(placed, 1.0);
    return clip;
}

// Where a vertex is drawn whose clip position is given: there, or where the overview sees what the tests see from their
// own camera.
#if VIEW == VIEW_CULLED
#define DRAWN_AT(clip, skinned, copyNumber) (frame.overview * vec4((skinned) + copyOffset(copyNumber), 1.0))
#else
#define DRAWN_AT(clip, skinned, copyNumber) clip
#endif
