// The output side of a mesh stage: the only place that knows EXT from NV. Both read the same words in the same loops;
// only the writes differ.
#include "frame.glsl"
#include "view.glsl"

layout(local_size_x = GROUP_SIZE) in;
layout(triangles, max_vertices = MESHLET_VERTICES, max_primitives = MESHLET_TRIANGLES) out;

layout(location = 0) out SURFACE_BLOCK surface[];

#if MESH_NV
// Writing one word stores four local indices (Kimmersdorfer 3.1).
void setMeshletCounts(uint vertexCount, uint triangleCount) {
    if (gl_LocalInvocationID.x == 0u) gl_PrimitiveCountNV = triangleCount;
}
void writePosition(uint i, vec4 position) { gl_MeshVerticesNV[i].gl_Position = position; }
#if PACKED_WRITES
void writeFourTriangles(uint first, uint triangleCount, uvec3 words) {
    writePackedPrimitiveIndices4x8NV(first * 3u, words.x);
    writePackedPrimitiveIndices4x8NV(first * 3u + 4u, words.y);
    writePackedPrimitiveIndices4x8NV(first * 3u + 8u, words.z);
}
#else
void writeTriangle(uint triangle, uvec3 corners) {
    gl_PrimitiveIndicesNV[triangle * 3u] = corners.x;
    gl_PrimitiveIndicesNV[triangle * 3u + 1u] = corners.y;
    gl_PrimitiveIndicesNV[triangle * 3u + 2u] = corners.z;
}
#endif
#else
void setMeshletCounts(uint vertexCount, uint triangleCount) { SetMeshOutputsEXT(vertexCount, triangleCount); }
void writePosition(uint i, vec4 position) { gl_MeshVerticesEXT[i].gl_Position = position; }
void writeTriangle(uint triangle, uvec3 corners) { gl_PrimitiveTriangleIndicesEXT[triangle] = corners; }
#endif

// Three words hold four triangles, a byte an index:   x: a0 b0 c0 a1   y: b1 c1 a2 b2   z: c2 a3 b3 c3   (low to high)
#if !(MESH_NV && PACKED_WRITES)
void writeFourTriangles(uint first, uint triangleCount, uvec3 words) {
    writeTriangle(first, uvec3(words.x, words.x >> 8, words.x >> 16) & 0xFFu);
    if (first + 1u < triangleCount) writeTriangle(first + 1u, uvec3(words.x >> 24, words.y & 0xFFu, (words.y >> 8) & 0xFFu));
    if (first + 2u < triangleCount) writeTriangle(first + 2u, uvec3((words.y >> 16) & 0xFFu, words.y >> 24, words.z & 0xFFu));
    if (first + 3u < triangleCount) writeTriangle(first + 3u, uvec3(words.z >> 8, words.z >> 16, words.z >> 24) & 0xFFu);
}
#endif

void emitMeshVertex(uint i, vec3 position, vec3 normal, vec2 uv, vec3 color, uint copyNumber) {
    writePosition(i, clipPosition(position, copyNumber));
#if SPARE_OUTPUT
    surface[i].first = vec4(normal, color.r);
    surface[i].second = vec4(uv, color.gb);
    surface[i].spare = vec4(normal, color.r) * 2.0 + frame.grid;
#else
    surface[i].normal = normal;
    surface[i].uv = uv;
#if VIEW != VIEW_SHADED
    surface[i].color = color;
#endif
#endif
}
