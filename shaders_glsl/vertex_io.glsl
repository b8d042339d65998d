// The output side of a vertex stage.
#include "frame.glsl"
#include "view.glsl"

#if !DEPTH_ONLY
layout(location = 0) out SURFACE_BLOCK surface;
#endif

out gl_PerVertex { vec4 gl_Position; };

// The copy that this vertex belongs to; VERTEX_INDEX already counts over all copies.
uint vertexCopy() {
#if BATCHED
    return VERTEX_INDEX / uint(VERTEX_COUNT);
#else
    return drawConstants.x;
#endif
}

void emitVertex(vec3 position, vec3 normal, vec2 uv, uint copyNumber) {
    gl_Position = DRAWN_AT(clipPosition(position, copyNumber), position, copyNumber);
#if !DEPTH_ONLY
    surface.normal = normal;
    surface.uv = uv;
#endif
}
