// Reads one meshlet of the layouts `redirect` and `fixed` (common/meshlets/meshlets.h draws the words).
#include "frame.glsl"

#define WIDE_HEADER (RECORDS_ORDERED || JOINTS != JOINTS_VERTEX)

#if !LAYOUT_FIXED
#if WIDE_HEADER
#define DESCRIPTOR uvec4
#else
#define DESCRIPTOR uvec2
#endif
layout(std430, binding = SLOT_MESHLET) readonly restrict buffer MeshletBlock { DESCRIPTOR meshletDescriptors[]; };
#endif
layout(std430, binding = SLOT_MESHLET_DATA) readonly restrict buffer MeshletDataBlock { uint meshletData[]; };
#if JOINTS != JOINTS_VERTEX || COMMON_INFLUENCES
layout(std430, binding = SLOT_MESHLET_EXTRA) readonly restrict buffer MeshletExtraBlock { uint meshletExtra[]; };
#endif

#if CLUSTER_CULL == CLUSTER_TASK
#define PAYLOAD_WAY in
#include "task_payload.glsl"
#elif CLUSTER_CULL == CLUSTER_LIST
layout(std430, binding = SLOT_CLUSTER_LIST) readonly restrict buffer ClusterListBlock { uint listedMeshlets[]; };
#endif

// The work group's meshlet: of its copy, or of all copies in a batched draw.
uint meshletOfGroup() {
#if CLUSTER_CULL == CLUSTER_TASK
    uint four = payload.places[gl_WorkGroupID.x / 4u];
    return payload.first + ((four >> (8u * (gl_WorkGroupID.x % 4u))) & 0xFFu);
#elif CLUSTER_CULL == CLUSTER_LIST
    return listedMeshlets[drawConstants.x * uint(MESHLET_COUNT) + gl_WorkGroupID.x];
#else
    return gl_WorkGroupID.x + drawConstants.y;
#endif
}

struct Meshlet {
    uint number;         // within its copy
    uint copyNumber;
    uint vertexCount;
    uint triangleCount;
    uint influences;     // the last one of a vertex that weighs anything, counted from 1; else INFLUENCES
    bool sharesList;     // its vertices share one joint list
    uint firstId;        // word of the first vertex id
    uint firstIndex;     // word of the first local indices
    uint firstRecord;    // RECORDS_ORDERED: its records stand one behind the other
    uint firstJoint;     // JOINTS: word of its joint list
    uint firstByte;      // CODEC_PER_MESHLET and RECORDS_ORDERED: of its records
    uint blendBytes;     // CODEC_PER_MESHLET: of each of its vertices
    uvec2 blend;         // CODEC_PER_MESHLET: what the codec keeps of it
};

Meshlet loadMeshlet() {
    uint group = meshletOfGroup();
    Meshlet meshlet;
#if BATCHED
    meshlet.copyNumber = group / uint(MESHLET_COUNT);
    meshlet.number = group - meshlet.copyNumber * uint(MESHLET_COUNT);
#else
    meshlet.copyNumber = drawConstants.x;
    meshlet.number = group;
#endif
#if CODEC_PER_MESHLET
    // Here rather than where a vertex is decoded, which would wait for the header first.
    meshlet.blend = loadMeshletBlend(meshlet.number, meshlet.copyNumber);
#endif
    uint firstWord = meshlet.copyNumber * uint(MESHLET_DATA_WORDS);
#if LAYOUT_FIXED
    firstWord += meshlet.number * uint(MESHLET_WORDS);
    uint counts = meshletData[firstWord];
    meshlet.firstId = firstWord + 1u;
#if WIDE_HEADER
    meshlet.firstRecord = meshletData[firstWord + 1u];
    meshlet.firstJoint = meshlet.firstByte = meshletData[firstWord + 2u];
    meshlet.firstId += 2u;
#endif
#else
    DESCRIPTOR descriptor = meshletDescriptors[meshlet.copyNumber * uint(MESHLET_COUNT) + meshlet.number];
    uint counts = descriptor.y;
    meshlet.firstId = firstWord + descriptor.x;
#if WIDE_HEADER
    meshlet.firstRecord = descriptor.z;
    meshlet.firstJoint = meshlet.firstByte = descriptor.w;
#endif
#endif
    meshlet.vertexCount = bitfieldExtract(counts, 0, 13);
    meshlet.blendBytes = bitfieldExtract(counts, 13, 3);
    meshlet.triangleCount = bitfieldExtract(counts, 16, 11);
#if ZERO_WEIGHTS == ZERO_WEIGHTS_COUNT
    meshlet.influences = bitfieldExtract(counts, 27, 4);
#else
    meshlet.influences = uint(INFLUENCES);
#endif
    meshlet.sharesList = counts >= 0x80000000u;
#if RECORDS_ORDERED
    meshlet.firstIndex = meshlet.firstId;
#elif LAYOUT_FIXED
    meshlet.firstIndex = meshlet.firstId + uint(MESHLET_VERTICES);
#else
    meshlet.firstIndex = meshlet.firstId + meshlet.vertexCount;
#endif
#if JOINTS != JOINTS_VERTEX
    meshlet.firstJoint += meshlet.copyNumber * uint(MESHLET_EXTRA_WORDS);
#endif
    return meshlet;
}

uint meshletVertexId(Meshlet meshlet, uint i) {
#if RECORDS_ORDERED
    return meshlet.firstRecord + i;
#else
    return meshletData[meshlet.firstId + i];
#endif
}

// Local indices of the triangles first … first + 3; `first` is a multiple of four.
uvec3 meshletFourTriangles(Meshlet meshlet, uint first) {
    uint word = meshlet.firstIndex + first / 4u * 3u;
    return uvec3(meshletData[word], meshletData[word + 1u], meshletData[word + 2u]);
}

// Three words hold four triangles, a byte an index:   x: a0 b0 c0 a1   y: b1 c1 a2 b2   z: c2 a3 b3 c3   (low to high)
uvec3 triangleOfFour(uvec3 words, uint which) {
    uvec3 corners = which == 0u   ? uvec3(words.x, words.x >> 8, words.x >> 16)
                    : which == 1u ? uvec3(words.x >> 24, words.y, words.y >> 8)
                    : which == 2u ? uvec3(words.y >> 16, words.y >> 24, words.z)
                                  : uvec3(words.z >> 8, words.z >> 16, words.z >> 24);
    return corners & 0xFFu;
}
