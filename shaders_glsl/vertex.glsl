// `vertex`: linear blend skinning in the vertex stage, fed by attributes or pulling from storage buffers. With
// SKINNING 0 the variant `none` on routes without mesh shaders. As first pass of a pre-pass it also keeps what it has
// skinned.
#if STAGE_VERTEX
#if FETCH_PULL
#include CODEC_FILE
#else
#include "attributes.glsl"
#endif
#include "skin.glsl"
#include "vertex_io.glsl"
#include "capture.glsl"
#if PREPASS
#include "skinned.glsl"
#endif

void main() {
    uint copyNumber = vertexCopy();
#if FETCH_PULL
    Vertex vertex = loadVertex(VERTEX_INDEX, copyNumber);
#else
    Vertex vertex = loadAttributes();
#endif
#if SKINNING
    Skinned skinned = skinVertex(vertex, copyNumber, uint(INFLUENCES));
#else
    Skinned skinned = keepVertex(vertex);
#endif
    emitVertex(skinned.position, skinned.normal, vertex.uv, copyNumber);
#if VERTEX_COLORS && !DEPTH_ONLY
    surface.color = viewColor(vertex, 0u, false);
#endif
#if PREPASS
    storeSkinned(VERTEX_INDEX, skinned.position, skinned.normal, vertex.uv);
#else
    captureVertex(skinned.position, skinned.normal, vertex.uv, copyNumber, VERTEX_INDEX - copyNumber * uint(VERTEX_COUNT));
#endif
}
#endif
