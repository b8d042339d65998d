// `mesh`: one meshlet a work group, every vertex of the meshlet skinned where it is drawn (Torabi 3.1). With
// SKINNING 0 the variant `none` on mesh routes: the same loads and loops, no joint read. With COMMON_INFLUENCES 1 the
// variant `mesh-ci` (Torabi 3.1.1). As first pass of a pre-pass it also keeps what it has skinned, as second pass
// (REUSE_SKINNED) it reads that.
#if STAGE_MESH
#include "mesh_vertex.glsl"
#include "mesh_io.glsl"
#include "capture.glsl"
#if PREPASS
#include "skinned.glsl"
#endif

#define VERTICES_OF_LANE uint((MESHLET_VERTICES + GROUP_SIZE - 1) / GROUP_SIZE)

void saveVertex(Meshlet meshlet, LaneVertex made) {
#if PREPASS
    storeSkinned(meshlet.copyNumber * uint(VERTEX_COUNT) + made.id, made.skinned.position, made.skinned.normal, made.uv);
#else
    captureVertex(made.skinned.position, made.skinned.normal, made.uv, meshlet.copyNumber, made.id);
#endif
}

void writeVertex(Meshlet meshlet, uint i, LaneVertex made) {
    vec4 clip = clipPosition(made.skinned.position, meshlet.copyNumber);
    vec4 drawn = DRAWN_AT(clip, made.skinned.position, meshlet.copyNumber);
    emitMeshVertex(i, drawn, made.skinned.normal, made.uv, made.color);
}

#if CULL == CULL_COMPACT
#include "cull.glsl"

// A lane's vertices are written as they are made, or kept until it is known how many triangles are left.
void finishVertex(Meshlet meshlet, uint i, LaneVertex made, vec4 clip) {
    saveVertex(meshlet, made);
#if WRITES_FIRST
    vec4 drawn = DRAWN_AT(clip, made.skinned.position, meshlet.copyNumber);
    emitMeshVertex(i, drawn, made.skinned.normal, made.uv, made.color);
#endif
}

void main() {
    Meshlet meshlet = loadMeshlet();
    uvec3 words[FOURS_OF_LANE];
    UNROLL for (uint k = 0u; k < FOURS_OF_LANE; ++k) words[k] = meshletFourTriangles(meshlet, clampedFour(meshlet, k));
    stageJoints(meshlet);
#if WRITES_FIRST && !MESH_NV
    setMeshletCounts(meshlet.vertexCount, meshlet.triangleCount);
#endif

    LaneVertex made[VERTICES_OF_LANE];
    vec4 clip[VERTICES_OF_LANE];
    UNROLL for (uint k = 0u; k < VERTICES_OF_LANE; ++k) {
        uint i = gl_LocalInvocationID.x + k * uint(GROUP_SIZE);
#if CLAMPED_LOADS
        made[k] = makeVertex(meshlet, min(i, meshlet.vertexCount - 1u));
        clip[k] = clipPosition(made[k].skinned.position, meshlet.copyNumber);
        if (i < meshlet.vertexCount) finishVertex(meshlet, i, made[k], clip[k]);
#else
        clip[k] = vec4(0.0, 0.0, 0.0, 1.0);
        if (i < meshlet.vertexCount) {
            made[k] = makeVertex(meshlet, i);
            clip[k] = clipPosition(made[k].skinned.position, meshlet.copyNumber);
            finishVertex(meshlet, i, made[k], clip[k]);
        }
#endif
        offerVertex(i, k, clip[k]);
    }
    finishOffers();

    uint kept[FOURS_OF_LANE];
    UNROLL for (uint k = 0u; k < FOURS_OF_LANE; ++k) {
        kept[k] = keptOfFour(meshlet, firstOfFour(k), words[k]);
        countKept(k, kept[k]);
    }
    uint total = finishCount();
#if !WRITES_FIRST
    setMeshletCounts(total == 0u ? 0u : meshlet.vertexCount, total);
    if (total == 0u) return;
    UNROLL for (uint k = 0u; k < VERTICES_OF_LANE; ++k) {
        uint i = gl_LocalInvocationID.x + k * uint(GROUP_SIZE);
        if (i < meshlet.vertexCount)
            emitMeshVertex(i, DRAWN_AT(clip[k], made[k].skinned.position, meshlet.copyNumber), made[k].skinned.normal,
                           made[k].uv, made[k].color);
    }
#elif MESH_NV
    setMeshletCounts(meshlet.vertexCount, total);
#else
    for (uint dropped = total + gl_LocalInvocationID.x; dropped < meshlet.triangleCount; dropped += uint(GROUP_SIZE))
        writeTriangle(dropped, uvec3(0u));
#endif
    UNROLL for (uint k = 0u; k < FOURS_OF_LANE; ++k) writeKept(k, kept[k], words[k]);
}

#else
#if CULL != CULL_OFF
#include "cull.glsl"
#endif

void main() {
    Meshlet meshlet = loadMeshlet();
    stageJoints(meshlet);
    setMeshletCounts(meshlet.vertexCount, meshlet.triangleCount);

#if CLAMPED_LOADS
    // Loading unconditionally lets the compiler overlap the vertices of a lane.
    LaneVertex made[VERTICES_OF_LANE];
    UNROLL for (uint k = 0u; k < VERTICES_OF_LANE; ++k)
        made[k] = makeVertex(meshlet, min(gl_LocalInvocationID.x + k * uint(GROUP_SIZE), meshlet.vertexCount - 1u));
    UNROLL for (uint k = 0u; k < VERTICES_OF_LANE; ++k) {
        uint i = gl_LocalInvocationID.x + k * uint(GROUP_SIZE);
        if (i >= meshlet.vertexCount) break;
        writeVertex(meshlet, i, made[k]);
        saveVertex(meshlet, made[k]);
#if CULL != CULL_OFF
        offerVertex(i, k, clipPosition(made[k].skinned.position, meshlet.copyNumber));
#endif
    }
#else
#if !RECORDS_ORDERED
    // The next vertex's id is on its way while this one is skinned: not every compiler moves the load there by itself
    // (docs/studies/zero_weights.md).
    uint next = meshletVertexId(meshlet, min(gl_LocalInvocationID.x, meshlet.vertexCount - 1u));
#endif
    for (uint i = gl_LocalInvocationID.x; i < meshlet.vertexCount; i += uint(GROUP_SIZE)) {
#if RECORDS_ORDERED
        uint id = meshletVertexId(meshlet, i);
#else
        uint id = next;
        next = meshletVertexId(meshlet, min(i + uint(GROUP_SIZE), meshlet.vertexCount - 1u));
#endif
        LaneVertex made = makeVertex(meshlet, i, id);
        writeVertex(meshlet, i, made);
        saveVertex(meshlet, made);
#if CULL != CULL_OFF
        offerVertex(i, 0u, clipPosition(made.skinned.position, meshlet.copyNumber));
#endif
    }
#endif
#if CULL == CULL_OFF
    for (uint first = gl_LocalInvocationID.x * 4u; first < meshlet.triangleCount; first += uint(GROUP_SIZE) * 4u)
        writeFourTriangles(first, meshlet.triangleCount, meshletFourTriangles(meshlet, first));
#else
    finishOffers();
#if MESH_NV
    uvec3 words[FOURS_OF_LANE];
    uint kept[FOURS_OF_LANE];
    UNROLL for (uint k = 0u; k < FOURS_OF_LANE; ++k) {
        words[k] = meshletFourTriangles(meshlet, clampedFour(meshlet, k));
        kept[k] = keptOfFour(meshlet, firstOfFour(k), words[k]);
        countKept(k, kept[k]);
    }
    setMeshletCounts(meshlet.vertexCount, finishCount());
    UNROLL for (uint k = 0u; k < FOURS_OF_LANE; ++k) writeKept(k, kept[k], words[k]);
#else
    for (uint first = gl_LocalInvocationID.x * 4u; first < meshlet.triangleCount; first += uint(GROUP_SIZE) * 4u) {
        uvec3 words = meshletFourTriangles(meshlet, first);
        writeFlagged(meshlet, first, keptOfFour(meshlet, first, words), words);
    }
#endif
#endif
}
#endif
#endif
