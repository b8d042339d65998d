// One vertex of a meshlet: fetched, its joints found, skinned.
#include CODEC_FILE
#include "skin.glsl"
#include "meshlet.glsl"
#include "view.glsl"

struct LaneVertex {
    uint id;  // its record within the copy
    Skinned skinned;
    vec2 uv;
    vec3 color;
};

// JOINTS: a meshlet's list is its length and its joint ids; behind it stand the vertices' local ids, a byte each.
#if JOINTS != JOINTS_VERTEX
uint jointCount(Meshlet meshlet) { return meshletExtra[meshlet.firstJoint]; }

uint listedJoint(Meshlet meshlet, uint place) { return meshletExtra[meshlet.firstJoint + 1u + place]; }

uvec4 fourLocalJoints(Meshlet meshlet, uint firstWord, uint i, uint four) {
    uint word = meshletExtra[firstWord + i * uint(INFLUENCES / 4) + four];
    uvec4 local = uvec4(word, word >> 8, word >> 16, word >> 24) & 0xFFu;
#if JOINTS == JOINTS_STAGED
    return local;
#else
    return uvec4(listedJoint(meshlet, local.x), listedJoint(meshlet, local.y), listedJoint(meshlet, local.z),
                 listedJoint(meshlet, local.w));
#endif
}
#endif

// Copies the palette rows of the meshlet's joints to shared memory, a row a lane.
void stageJoints(Meshlet meshlet) {
#if JOINTS == JOINTS_STAGED && !REUSE_SKINNED
    uint rows = jointCount(meshlet) * uint(PALETTE_ROWS);
    for (uint row = gl_LocalInvocationID.x; row < rows; row += uint(GROUP_SIZE)) {
        uint joint = listedJoint(meshlet, row / uint(PALETTE_ROWS)) + FIRST_JOINT(meshlet.copyNumber);
        stagedRows[row] = paletteRow(joint * uint(PALETTE_ROWS) + row % uint(PALETTE_ROWS));
    }
    memoryBarrierShared();
    barrier();
#endif
}

Vertex fetchVertex(Meshlet meshlet, uint i, uint id) {
    uint place = meshlet.copyNumber * uint(VERTEX_COUNT) + id;
#if COMMON_INFLUENCES
    if (!meshlet.sharesList) return loadVertex(place, meshlet.copyNumber);
    Vertex vertex = loadWithoutJoints(place, meshlet.copyNumber);
    uint list = (meshlet.copyNumber * uint(COMMON_MESHLETS) + meshlet.number) * uint(INFLUENCES);
    vertex.joints0 = uvec4(meshletExtra[list], meshletExtra[list + 1u], meshletExtra[list + 2u], meshletExtra[list + 3u]);
#if INFLUENCES == 8
    vertex.joints1 =
        uvec4(meshletExtra[list + 4u], meshletExtra[list + 5u], meshletExtra[list + 6u], meshletExtra[list + 7u]);
#endif
    return vertex;
#elif JOINTS != JOINTS_VERTEX
    Vertex vertex = loadWithoutJoints(place, meshlet.copyNumber);
    uint firstLocal = meshlet.firstJoint + 1u + jointCount(meshlet);
    vertex.joints0 = fourLocalJoints(meshlet, firstLocal, i, 0u);
#if INFLUENCES == 8
    vertex.joints1 = fourLocalJoints(meshlet, firstLocal, i, 1u);
#endif
    return vertex;
#elif CODEC_PER_MESHLET
#if RECORDS_ORDERED
    uint firstByte = meshlet.firstByte + i * vertexBytes(meshlet.blendBytes);
#else
    uint firstByte = firstByteOf(id, meshlet.blendBytes);
#endif
    return loadMeshletVertex(firstByte, meshlet.copyNumber, meshlet.blendBytes, meshlet.blend);
#else
    return loadVertex(place, meshlet.copyNumber);
#endif
}

#if REUSE_SKINNED
#include "skinned.glsl"
#endif

// `id`: of the meshlet's vertex `i`.
LaneVertex makeVertex(Meshlet meshlet, uint i, uint id) {
    LaneVertex made;
    made.id = id;
#if REUSE_SKINNED
    SkinnedVertex skinned = skinnedVertices[meshlet.copyNumber * uint(VERTEX_COUNT) + made.id];
    made.skinned = Skinned(skinned.positionU.xyz, skinned.normalV.xyz);
    made.uv = vec2(skinned.positionU.w, skinned.normalV.w);
    made.color = vec3(1.0);
#else
    Vertex vertex = fetchVertex(meshlet, i, made.id);
#if SKINNING
    made.skinned = skinVertex(vertex, meshlet.copyNumber, meshlet.influences);
#else
    made.skinned = keepVertex(vertex);
#endif
    made.uv = vertex.uv;
    made.color = viewColor(vertex, meshlet.number, COMMON_INFLUENCES == 1 && !meshlet.sharesList);
#endif
    return made;
}

LaneVertex makeVertex(Meshlet meshlet, uint i) { return makeVertex(meshlet, i, meshletVertexId(meshlet, i)); }
