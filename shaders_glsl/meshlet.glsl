// Reads one meshlet of the layout `redirect` (common/meshlets.h draws the bits).
#include "frame.glsl"

layout(std430, binding = SLOT_MESHLET) readonly restrict buffer MeshletBlock { uvec2 meshletDescriptors[]; };
layout(std430, binding = SLOT_MESHLET_DATA) readonly restrict buffer MeshletDataBlock { uint meshletData[]; };

struct Meshlet {
    uint number;        // within its copy
    uint copyNumber;
    uint vertexCount;
    uint triangleCount;
    uint firstId;       // word of the first vertex id
    uint firstIndex;    // word of the first local indices
};

Meshlet loadMeshlet() {
    uint group = gl_WorkGroupID.x + drawConstants.y;
    Meshlet meshlet;
#if BATCHED
    meshlet.copyNumber = group / uint(MESHLET_COUNT);
    meshlet.number = group - meshlet.copyNumber * uint(MESHLET_COUNT);
#else
    meshlet.copyNumber = drawConstants.x;
    meshlet.number = group;
#endif
    uvec2 descriptor = meshletDescriptors[meshlet.copyNumber * uint(MESHLET_COUNT) + meshlet.number];
    meshlet.vertexCount = bitfieldExtract(descriptor.y, 16, 15);
    meshlet.triangleCount = bitfieldExtract(descriptor.y, 0, 16);
    meshlet.firstId = meshlet.copyNumber * uint(MESHLET_DATA_WORDS) + descriptor.x;
    meshlet.firstIndex = meshlet.firstId + meshlet.vertexCount;
    return meshlet;
}

uint meshletVertexId(Meshlet meshlet, uint i) { return meshletData[meshlet.firstId + i]; }

// Local indices of the triangles first … first + 3; `first` is a multiple of four.
uvec3 meshletFourTriangles(Meshlet meshlet, uint first) {
    uint word = meshlet.firstIndex + first / 4u * 3u;
    return uvec3(meshletData[word], meshletData[word + 1u], meshletData[word + 2u]);
}
