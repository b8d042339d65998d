// The output side of a mesh stage, where EXT and NV write in different ways; both read the same words in the same loops.
// Culling alone asks for the dialect again (mesh.glsl, cull.glsl): EXT declares its counts before it writes.
#include "frame.glsl"
#include "view.glsl"
#include "meshlet.glsl"

layout(local_size_x = GROUP_SIZE) in;
layout(triangles, max_vertices = MESHLET_VERTICES, max_primitives = MESHLET_TRIANGLES) out;

#if !DEPTH_ONLY
layout(location = 0) out SURFACE_BLOCK surface[];
#endif

#if MESH_NV
void setMeshletCounts(uint vertexCount, uint triangleCount) {
    if (gl_LocalInvocationID.x == 0u) gl_PrimitiveCountNV = triangleCount;
}
void writePosition(uint i, vec4 position) { gl_MeshVerticesNV[i].gl_Position = position; }
void writeTriangle(uint triangle, uvec3 corners) {
    gl_PrimitiveIndicesNV[triangle * 3u] = corners.x;
    gl_PrimitiveIndicesNV[triangle * 3u + 1u] = corners.y;
    gl_PrimitiveIndicesNV[triangle * 3u + 2u] = corners.z;
}
#else
void setMeshletCounts(uint vertexCount, uint triangleCount) { SetMeshOutputsEXT(vertexCount, triangleCount); }
void writePosition(uint i, vec4 position) { gl_MeshVerticesEXT[i].gl_Position = position; }
void writeTriangle(uint triangle, uvec3 corners) { gl_PrimitiveTriangleIndicesEXT[triangle] = corners; }
#endif

#if MESH_NV && PACKED_WRITES
// Writing one word stores four local indices (Kimmersdorfer 3.1).
void writeFourTriangles(uint first, uint triangleCount, uvec3 words) {
    writePackedPrimitiveIndices4x8NV(first * 3u, words.x);
    writePackedPrimitiveIndices4x8NV(first * 3u + 4u, words.y);
    writePackedPrimitiveIndices4x8NV(first * 3u + 8u, words.z);
}
#else
void writeFourTriangles(uint first, uint triangleCount, uvec3 words) {
    UNROLL for (uint which = 0u; which < 4u; ++which)
        if (first + which < triangleCount) writeTriangle(first + which, triangleOfFour(words, which));
}
#endif

void emitMeshVertex(uint i, vec4 position, vec3 normal, vec2 uv, vec3 color) {
    writePosition(i, position);
#if DEPTH_ONLY
#elif SPARE_OUTPUT
    surface[i].first = vec4(normal, color.r);
    surface[i].second = vec4(uv, color.gb);
    surface[i].spare = vec4(normal, color.r) * 2.0 + frame.grid;
#else
    surface[i].normal = normal;
    surface[i].uv = uv;
#if VERTEX_COLORS
    surface[i].color = color;
#endif
#endif
}
