// Back-face culling in the mesh stage, three ways:
//
//   CULL_COMPACT    only the triangles that are left are written, one behind the other
//   CULL_PRIMITIVE  all are written, those to drop with gl_CullPrimitiveEXT (EXT only; not redeclared, because Mesa's
//                   OpenGL compiler refuses a boolean output)
//   CULL_TORABI     determinant of (x, y, w) once all outputs are written (Torabi 5.1.3); EXT drops with
//                   gl_CullPrimitiveEXT, NV by compaction. Loses visible micro triangles: cancellation.
//
// Lanes see each other's positions through shared memory or, where one subgroup is the work group, by shuffles
// (EXCHANGE_SHUFFLE, for CULL_COMPACT) or in the outputs (EXCHANGE_OUTPUTS, for CULL_TORABI on NV, as Torabi's listing
// does; EXT forbids to read them). Both of those count the triangles that are left by ballots.
#include "meshlet.glsl"
#include "verdicts.glsl"
#if CULL != CULL_TORABI
#include "triangle_tests.glsl"
#endif

#define FOURS_OF_LANE uint((MESHLET_TRIANGLES + GROUP_SIZE * 4 - 1) / (GROUP_SIZE * 4))

uint firstOfFour(uint k) { return (gl_LocalInvocationID.x + k * uint(GROUP_SIZE)) * 4u; }
uint clampedFour(Meshlet meshlet, uint k) { return min(firstOfFour(k), (meshlet.triangleCount - 1u) / 4u * 4u); }

#if CULL == CULL_TORABI
#define OFFERED vec3
#else
#define OFFERED vec2
#endif

// No atomics: NVIDIA's OpenGL compiler (580.159) dies of those on shared variables of mesh stages.
#if EXCHANGE_SHUFFLE
OFFERED offered[VERTICES_OF_LANE];
#elif !EXCHANGE_OUTPUTS
shared OFFERED offered[MESHLET_VERTICES];
shared uint keptOfFours[FOURS_OF_LANE * GROUP_SIZE];
#endif

// In the place of a position that cannot be trusted: the triangles of such a vertex are kept.
#define UNTRUSTED 1e30

void offerVertex(uint i, uint k, vec4 clip) {
#if !EXCHANGE_OUTPUTS
#if CULL == CULL_TORABI
    OFFERED offer = clip.xyw;
#else
    OFFERED offer = isTrusted(clip) ? screenPosition(clip) : OFFERED(UNTRUSTED);
#endif
#if EXCHANGE_SHUFFLE
    offered[k] = offer;
#else
    if (i < uint(MESHLET_VERTICES)) offered[i] = offer;
#endif
#endif
}

void finishOffers() {
#if !EXCHANGE_SHUFFLE
    memoryBarrierShared();
    barrier();
#endif
}

OFFERED offeredBy(uint vertex) {
#if EXCHANGE_OUTPUTS
    return gl_MeshVerticesNV[vertex].gl_Position.xyw;
#elif EXCHANGE_SHUFFLE
    OFFERED found = subgroupShuffle(offered[0], vertex % uint(GROUP_SIZE));
    UNROLL for (uint k = 1u; k < VERTICES_OF_LANE; ++k) {
        OFFERED other = subgroupShuffle(offered[k], vertex % uint(GROUP_SIZE));
        if (vertex / uint(GROUP_SIZE) == k) found = other;
    }
    return found;
#else
    return offered[vertex];
#endif
}

// Front faces are counter-clockwise as seen, with y down.
#if CULL == CULL_TORABI
bool isBackFace(OFFERED a, OFFERED b, OFFERED c) { return determinant(mat3(a, b, c)) > 0.0; }
#else
bool isBackFace(OFFERED a, OFFERED b, OFFERED c) {
    return facesAway(a, b, c) && max(max(a.x, b.x), c.x) < UNTRUSTED;
}
#endif

// Stores which of four triangles are drawn.
void storeFour(Meshlet meshlet, uint first, uint kept) {
#if STORES_VERDICTS
    uint place = (meshlet.copyNumber * uint(MESHLET_COUNT) + meshlet.number) * uint(MESHLET_TRIANGLES / 4) + first / 4u;
    if (VIEW_NUMBER == VERDICT_DRAWN && first < meshlet.triangleCount) verdicts[uint(FIRST_FOURS) + place] = kept;
#endif
}

// A bit a triangle: 1 where first + bit is there and the pass shows it: where it is not known to be a back face. With
// shuffles every lane must call it.
uint keptOfFour(Meshlet meshlet, uint first, uvec3 words) {
    uint kept = 0u;
    UNROLL for (uint which = 0u; which < 4u; ++which) {
        uvec3 corners = triangleOfFour(words, which);
        bool back = isBackFace(offeredBy(corners.x), offeredBy(corners.y), offeredBy(corners.z));
        bool shown = showsTriangles(back ? VERDICT_TRIANGLE_AWAY : VERDICT_DRAWN);
        if (shown && first + which < meshlet.triangleCount) kept |= 1u << which;
    }
    storeFour(meshlet, first, kept);
    return kept;
}

// --- compaction ---------------------------------------------------------------------------------------------------

#if EXCHANGE_SHUFFLE || EXCHANGE_OUTPUTS
uint placeOfLane[FOURS_OF_LANE];
uint counted = 0u;

void countKept(uint k, uint kept) {
    uvec4 lower = gl_SubgroupLtMask;
    placeOfLane[k] = counted;
    UNROLL for (uint which = 0u; which < 4u; ++which) {
        uvec4 lanes = subgroupBallot(bitfieldExtract(kept, int(which), 1) != 0u);
        placeOfLane[k] += subgroupBallotBitCount(lanes & lower);
        counted += subgroupBallotBitCount(lanes);
    }
}

uint finishCount() { return counted; }
uint placeOfKept(uint k) { return placeOfLane[k]; }
#else
uint fourOfLane(uint k) { return gl_LocalInvocationID.x + k * uint(GROUP_SIZE); }

void countKept(uint k, uint kept) { keptOfFours[fourOfLane(k)] = uint(bitCount(kept)); }

uint placeOfFour(uint four) {
    uint place = 0u;
    for (uint i = 0u; i < four; ++i) place += keptOfFours[i];
    return place;
}

uint finishCount() {
    memoryBarrierShared();
    barrier();
    return placeOfFour(FOURS_OF_LANE * uint(GROUP_SIZE));
}

uint placeOfKept(uint k) { return placeOfFour(fourOfLane(k)); }
#endif

void writeKept(uint k, uint kept, uvec3 words) {
    uint place = placeOfKept(k);
    UNROLL for (uint which = 0u; which < 4u; ++which)
        if (bitfieldExtract(kept, int(which), 1) != 0u) writeTriangle(place++, triangleOfFour(words, which));
}

// --- a flag a triangle --------------------------------------------------------------------------------------------

#if !MESH_NV && CULL != CULL_COMPACT
void writeFlagged(Meshlet meshlet, uint first, uint kept, uvec3 words) {
    UNROLL for (uint which = 0u; which < 4u && first + which < meshlet.triangleCount; ++which) {
        writeTriangle(first + which, triangleOfFour(words, which));
        // Constants: LLVM 19 under Mesa 26.1 aborts on a computed value.
        if (bitfieldExtract(kept, int(which), 1) != 0u)
            gl_MeshPrimitivesEXT[first + which].gl_CullPrimitiveEXT = false;
        else
            gl_MeshPrimitivesEXT[first + which].gl_CullPrimitiveEXT = true;
    }
}
#endif
