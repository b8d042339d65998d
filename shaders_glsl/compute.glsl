// `compute`: a compute pass skins every vertex of a copy into a buffer, and a plain vertex stage draws it (Turanszki).
// The variant `cpu` draws the same way what the CPU has skinned.
#if STAGE_COMPUTE
#include CODEC_FILE
#include "skin.glsl"
#include "skinned.glsl"

layout(local_size_x = COMPUTE_GROUP) in;

#if SHORT_TANGENT
#include UNIT_VECTORS

layout(std430, binding = SLOT_TANGENT) readonly restrict buffer TangentBlock { uint tangents[]; };
layout(std430, binding = SLOT_SKINNED_TANGENT) writeonly restrict buffer KeptTangentBlock { uint skinnedTangents[]; };
#elif SKINNED_TANGENT
layout(std430, binding = SLOT_TANGENT) readonly restrict buffer TangentBlock { vec4 tangents[]; };
#endif

#if LISTS_TRIANGLES
#include "capture.glsl"
#include "commands.glsl"
#include "verdicts.glsl"
#endif

// Copies the palette of the copy to shared memory, a row an invocation.
void stagePalette(uint copyNumber) {
#if STAGED_JOINTS
    uint first = FIRST_JOINT(copyNumber) * uint(PALETTE_ROWS);
    for (uint row = gl_LocalInvocationID.x; row < uint(STAGED_JOINTS * PALETTE_ROWS); row += uint(COMPUTE_GROUP))
        stagedRows[row] = paletteRow(first + row);
    memoryBarrierShared();
    barrier();
#endif
}

// Copies in rows behind the middle of the grid are skinned every second frame, even and odd ones in turn.
bool skipsFrame(uint copyNumber) {
#if HALF_RATE
    uint columns = uint(frame.grid.x);
    uint rows = (uint(COPY_COUNT) + columns - 1u) / columns;
    return copyNumber / columns * 2u >= rows && (copyNumber + uint(frame.grid.w)) % 2u != 0u;
#else
    return false;
#endif
}

// Weights descend, so what follows once they sum to 1, up to the rounding of eight floats, adds nothing.
Blend blendUntilWhole(Vertex vertex, uint copyNumber) {
    const float whole = 1.0 - 2.5e-7;
    Blend blend = startBlend(vertex, copyNumber);
    float sum = 0.0;
    for (uint i = 0u; i < 4u && sum < whole; ++i) {
        uint row = (vertex.joints0[i] + SKIN_FIRST_JOINT(copyNumber)) * uint(PALETTE_ROWS);
        addInfluence(blend, row, vertex.weights0[i]);
        sum += vertex.weights0[i];
    }
#if INFLUENCES == 8
    for (uint i = 0u; i < 4u && sum < whole; ++i) {
        uint row = (vertex.joints1[i] + SKIN_FIRST_JOINT(copyNumber)) * uint(PALETTE_ROWS);
        addInfluence(blend, row, vertex.weights1[i]);
        sum += vertex.weights1[i];
    }
#endif
    return blend;
}

void main() {
    uint i = gl_GlobalInvocationID.x + drawConstants.y * uint(COMPUTE_GROUP);
#if BATCHED
    if (i >= uint(VERTEX_COUNT) * uint(COPY_COUNT)) return;
    uint copyNumber = i / uint(VERTEX_COUNT);
    uint place = i;
    if (skipsFrame(copyNumber)) return;
#else
    uint copyNumber = drawConstants.x;
    uint place = copyNumber * uint(VERTEX_COUNT) + i;
    if (skipsFrame(copyNumber)) return;
    stagePalette(copyNumber);
    if (i >= uint(VERTEX_COUNT)) return;
#endif
    Vertex vertex = loadVertex(place, copyNumber);
#if EARLY_EXIT
    Blend blend = blendUntilWhole(vertex, copyNumber);
#else
    Blend blend = blendJoints(vertex, copyNumber, uint(INFLUENCES));
#endif
    Skinned skinned = transformVertex(blend, vertex);
    storeSkinned(place, skinned.position, skinned.normal, vertex.uv);
#if LISTS_TRIANGLES
    captureVertex(skinned.position, skinned.normal, vertex.uv, copyNumber, place - copyNumber * uint(VERTEX_COUNT));
    if (i == 0u)  // the passes that count come next
        for (uint view = 0u; view < uint(VIEWS); ++view) commands[commandOf(copyNumber, view)].count = 0u;
#if STORES_VERDICTS
    if (place == 0u)
        for (uint word = 0u; word < uint(COUNTED_WORDS); ++word) verdicts[uint(FIRST_COUNTED) + word] = 0u;
#endif
#endif
#if SHORT_TANGENT
    vec4 tangent = unpackTangent(tangents[place]);
    skinnedTangents[place] = packTangent(vec4(turned(blend, tangent.xyz), tangent.w));
#elif SKINNED_TANGENT
    vec4 tangent = tangents[place];
    skinnedVertices[place].tangent = vec4(turned(blend, tangent.xyz), tangent.w);
#endif
}
#endif

#if STAGE_VERTEX
#if SKINNED_PACKED && !DEPTH_ONLY
#include CODEC_FILE
#endif
#include "vertex_io.glsl"
#include "capture.glsl"

#if SKINNED_PACKED || SHORT_TANGENT
#include UNIT_VECTORS
#endif

#if SKINNED_PACKED
layout(location = 0) in uvec4 attributePositionNormal;
#else
layout(location = 0) in vec4 attributePositionU;
layout(location = 1) in vec4 attributeNormalV;
#endif
#if SKINNED_PREVIOUS
layout(location = 2) in vec4 attributePrevious;
#endif
#if SHORT_TANGENT
layout(std430, binding = SLOT_SKINNED_TANGENT) readonly restrict buffer KeptTangentBlock { uint skinnedTangents[]; };
#elif SKINNED_TANGENT
layout(location = 3) in vec4 attributeTangent;
#endif

#if VIEW == VIEW_VELOCITY
// From blue at rest to yellow where a frame moves the vertex by 2 % of the scene's diagonal or more.
vec3 velocityColor(float moved) {
    float speed = min(moved / (0.02 * SCENE_DIAGONAL), 1.0);
    return mix(vec3(0.10, 0.16, 0.55), vec3(1.0, 0.85, 0.10), sqrt(speed));
}
#endif

void main() {
    uint copyNumber = vertexCopy();
#if SKINNED_PACKED
    vec3 position = uintBitsToFloat(attributePositionNormal.xyz);
    vec3 normal = unpackNormal(attributePositionNormal.w);
#if DEPTH_ONLY
    vec2 uv = vec2(0.0);
#else
    vec2 uv = loadVertex(VERTEX_INDEX, copyNumber).uv;
#endif
#else
    vec3 position = attributePositionU.xyz;
    vec3 normal = attributeNormalV.xyz;
    vec2 uv = vec2(attributePositionU.w, attributeNormalV.w);
#endif
    emitVertex(position, normal, uv, copyNumber);
#if !DEPTH_ONLY
#if SKINNED_PREVIOUS
    vec3 motion = position - attributePrevious.xyz;
    surface.motion = motion;
#if VIEW == VIEW_VELOCITY
    surface.color = velocityColor(length(motion));
#endif
#endif
#if SHORT_TANGENT
    surface.tangent = unpackTangent(skinnedTangents[VERTEX_INDEX]);
#elif SKINNED_TANGENT
    surface.tangent = attributeTangent;
#endif
#endif
    captureVertex(position, normal, uv, copyNumber, VERTEX_INDEX - copyNumber * uint(VERTEX_COUNT));
}
#endif
