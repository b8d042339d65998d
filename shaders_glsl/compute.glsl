// `compute`: a compute pass skins every vertex of a copy into a buffer, 64 to a work group, and a plain vertex stage
// draws it (Turanszki). The variant `cpu` draws the same way what the CPU has skinned.
#if STAGE_COMPUTE
#include CODEC_FILE
#include "skin.glsl"
#include "skinned.glsl"

layout(local_size_x = 64) in;

void main() {
    uint i = gl_GlobalInvocationID.x + drawConstants.y * 64u;
#if BATCHED
    if (i >= uint(VERTEX_COUNT) * uint(COPY_COUNT)) return;
    uint copyNumber = i / uint(VERTEX_COUNT);
    uint place = i;
#else
    if (i >= uint(VERTEX_COUNT)) return;
    uint copyNumber = drawConstants.x;
    uint place = copyNumber * uint(VERTEX_COUNT) + i;
#endif
    Vertex vertex = loadVertex(place, copyNumber);
    Skinned skinned = skinVertex(vertex, copyNumber);
    storeSkinned(place, skinned.position, skinned.normal, vertex.uv);
}
#endif

#if STAGE_VERTEX
#include "vertex_io.glsl"
#include "capture.glsl"

layout(location = 0) in vec4 attributePositionU;
layout(location = 1) in vec4 attributeNormalV;

void main() {
    uint copyNumber = vertexCopy();
    vec2 uv = vec2(attributePositionU.w, attributeNormalV.w);
    emitVertex(attributePositionU.xyz, attributeNormalV.xyz, uv, copyNumber);
    captureVertex(attributePositionU.xyz, attributeNormalV.xyz, uv, copyNumber,
                  VERTEX_INDEX - copyNumber * uint(VERTEX_COUNT));
}
#endif
