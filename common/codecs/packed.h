// Vertices of a fixed stride: quantised base attributes and one blend code per vertex (docs/codecs.md 1.4, 4 and 6;
// Kimmersdorfer 3.3). All fields are little-endian; nothing is padded but the end of the buffer.
//
// Base vertex, 14 bytes (the first 14 of every codec here and in differences.h):
//   0 u16 px   2 u16 py   4 u16 pz     position, q / 65535 * extent + min
//   6 u16 u    8 u16 v                 octahedral normal
//  10 u16 tu  12 u16 tv                texture coordinate, q / 65535 * extent + min
//
//   oss   18 bytes: base, 14 u16 tuple index, 16 u16 simplex code of 16 bits; in general 14 u32 with a code of b bits
//         above a tuple index of 32 - b bits
//   pc    18 bytes: base, 14 u32 permutation code (kPermutationPc)
//   uc16  30 bytes: base, 14 u16 joints[4], 22 unorm16 weights[4] that sum to exactly 65535
//         46 bytes with 8 influences: base, 14 u16 joints[8], 30 unorm16 weights[8]
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/codecs/attributes.h"
#include "common/codecs/permutation.h"
#include "common/codecs/simplex.h"
#include "common/scene/scene.h"
#include "common/scene/tuples.h"

namespace skinbench {

inline constexpr uint32_t kBaseVertexBytes = 14;

// What a decoder needs beside the vertices: constants of the whole mesh.
struct VertexGrids {
    PositionGrid position;
    UvGrid uv;
};

VertexGrids vertexGrids(const Mesh& mesh);

// What a decoder gives back, in the units of Mesh. Influences in the order of the source vertex, heaviest first but
// for rounding; kNoJoint where the decoded weight is 0 and behind the codec's influences.
struct DecodedVertex {
    glm::vec3 position{0};
    glm::vec3 normal{0, 0, 1};
    glm::vec2 uv{0};
    Influences influences;
};

// Writes 14 bytes. `vertex` is in range.
void writeBaseVertex(const Mesh& mesh, size_t vertex, const VertexGrids& grids, std::span<uint8_t, 14> out);

// Position, normal and texture coordinate; no influences.
DecodedVertex readBaseVertex(std::span<const uint8_t, 14> bytes, const VertexGrids& grids);

// Unorm16 that sum to exactly 65535, descending as the 1 to 8 weights do: largest remainders. Weights sum to more than
// 0; places behind them are 0.
std::array<uint16_t, kMaxInfluences> weightsToUnorm16(std::span<const float> weights);

struct PackedVertices {
    uint32_t vertexCount = 0;
    uint32_t stride = 0;  // bytes
    int influences = 4;   // u16 a tuple in `tuples`; joints of a uc16 vertex
    VertexGrids grids;
    std::vector<uint8_t> vertices;  // vertexCount * stride, filled up with zeros to a multiple of 4
    std::vector<uint16_t> tuples;   // tuple after tuple, kNoJoint where unused; empty for uc16
};

// All take a mesh with cleaned weights and arrays of equal length; anything else is an error. oss and pc hold at most
// 65536 tuples after reuse; the error names count and limit.
Result<PackedVertices> packOss(const Mesh& mesh);
Result<PackedVertices> packPc(const Mesh& mesh);
Result<PackedVertices> packUc16(const Mesh& mesh, int influences = 4);

// oss with a code of 1 to 26 bits: 2^(32 - bits) tuples after reuse.
Result<PackedVertices> packSimplex(const Mesh& mesh, const SimplexCode& code);

// pc with another code: N + 1 influences (2 to 8), ceil(bits / 8) bytes behind the base.
Result<PackedVertices> packPermutation(const Mesh& mesh, const PermutationCode& code);

// Reads one vertex back. Fails on a vertex out of range, a code that no encoder makes, a tuple out of range.
Result<DecodedVertex> readOss(const PackedVertices& packed, uint32_t vertex);
Result<DecodedVertex> readSimplex(const PackedVertices& packed, const SimplexCode& code, uint32_t vertex);
Result<DecodedVertex> readPc(const PackedVertices& packed, uint32_t vertex);
Result<DecodedVertex> readUc16(const PackedVertices& packed, uint32_t vertex);
Result<DecodedVertex> readPermutation(const PackedVertices& packed, const PermutationCode& code, uint32_t vertex);

// --- parts that differences.h shares ---------------------------------------------------------------------------

// Arrays of equal length below 2^32 and cleaned influences.
Result<void> checkPackable(const Mesh& mesh, int influences);

Result<void> checkTupleCount(const char* codec, size_t tuples, size_t limit);

// Ascending weights of the code to descending influences with the joints of `tuple` (N + 1 places).
Influences blendInfluences(const PermutationCode& code, const PermutationBlend& blend, std::span<const uint16_t> tuple);

// The permutation code of descending weights.
uint64_t encodeInfluences(const PermutationCode& code, const Influences& influences, uint32_t payload);

}  // namespace skinbench
