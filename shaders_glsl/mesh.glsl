// `mesh`: one meshlet a work group, every vertex of the meshlet skinned where it is drawn (Torabi 3.1). With
// SKINNING 0 the variant `none` on mesh routes: the same loads and loops, no joint read.
#include CODEC_FILE
#include "skin.glsl"

#if STAGE_MESH
#include "mesh_io.glsl"
#include "meshlet.glsl"
#include "capture.glsl"

void main() {
    Meshlet meshlet = loadMeshlet();
    setMeshletCounts(meshlet.vertexCount, meshlet.triangleCount);

    for (uint i = gl_LocalInvocationID.x; i < meshlet.vertexCount; i += uint(GROUP_SIZE)) {
        uint id = meshletVertexId(meshlet, i);
        Vertex vertex = loadVertex(meshlet.copyNumber * uint(VERTEX_COUNT) + id);
#if SKINNING
        Skinned skinned = skinVertex(vertex, meshlet.copyNumber);
#else
        Skinned skinned = keepVertex(vertex);
#endif
        emitMeshVertex(i, skinned.position, skinned.normal, vertex.uv, viewColor(vertex, meshlet.number),
                       meshlet.copyNumber);
        captureVertex(skinned.position, skinned.normal, vertex.uv, meshlet.copyNumber, id);
    }
    for (uint first = gl_LocalInvocationID.x * 4u; first < meshlet.triangleCount; first += uint(GROUP_SIZE) * 4u)
        writeFourTriangles(first, meshlet.triangleCount, meshletFourTriangles(meshlet, first));
}
#endif
