// Uncompressed without joint ids, which stand with the meshlet: 48 bytes (4 influences) or 64 bytes (8). The first
// SLIM_RECORDS records of a copy are slim, the others whole as in uc.glsl; both kinds share one buffer. FAT_RECORDS
// keeps the joint ids that are not read in every record, so that what their absence brings can be told.
//
//   slim   uvec4 0: position.xyz, normal.x    1: normal.yz, uv.xy    2: weights 0-3    3: weights 4-7 (8 influences)
#include "vertex_data.glsl"

#if INFLUENCES == 8
#define SLIM_QUADS 4u
#define WHOLE_QUADS 6u
#else
#define SLIM_QUADS 3u
#define WHOLE_QUADS 4u
#endif
#define COPY_QUADS (uint(SLIM_RECORDS) * SLIM_QUADS + uint(VERTEX_COUNT - SLIM_RECORDS) * WHOLE_QUADS)

layout(std430, binding = SLOT_VERTEX) readonly restrict buffer VertexBlock { uvec4 vertexQuads[]; };

Vertex loadSurface(uint first) {
    vec4 a = uintBitsToFloat(vertexQuads[first]);
    vec4 b = uintBitsToFloat(vertexQuads[first + 1u]);
    Vertex vertex;
    vertex.position = a.xyz;
    vertex.normal = vec3(a.w, b.xy);
    vertex.uv = b.zw;
    return vertex;
}

// A whole record.
Vertex loadVertex(uint place, uint copyNumber) {
    uint number = place - copyNumber * uint(VERTEX_COUNT);
    uint first = copyNumber * COPY_QUADS + uint(SLIM_RECORDS) * SLIM_QUADS + (number - uint(SLIM_RECORDS)) * WHOLE_QUADS;
    Vertex vertex = loadSurface(first);
    vertex.joints0 = vertexQuads[first + 2u];
    vertex.weights0 = uintBitsToFloat(vertexQuads[first + 3u]);
#if INFLUENCES == 8
    vertex.joints1 = vertexQuads[first + 4u];
    vertex.weights1 = uintBitsToFloat(vertexQuads[first + 5u]);
#endif
    return vertex;
}

// The caller fills in the joints.
#if FAT_RECORDS
Vertex loadWithoutJoints(uint place, uint copyNumber) { return loadVertex(place, copyNumber); }
#else
Vertex loadWithoutJoints(uint place, uint copyNumber) {
    uint first = copyNumber * COPY_QUADS + (place - copyNumber * uint(VERTEX_COUNT)) * SLIM_QUADS;
    Vertex vertex = loadSurface(first);
    vertex.weights0 = uintBitsToFloat(vertexQuads[first + 2u]);
#if INFLUENCES == 8
    vertex.weights1 = uintBitsToFloat(vertexQuads[first + 3u]);
#endif
    return vertex;
}
#endif
