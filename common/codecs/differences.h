// Meshlet difference encoding: blend codes as differences to the smallest of their meshlet (docs/codecs.md 7;
// Kimmersdorfer 2.2).
//
//   vertex   base vertex of packed.h, 14 bytes, then the difference to the meshlet's base code in 0 to 4 bytes,
//            little-endian, no padding; the end of the buffer is filled up with zeros to a multiple of 4. Vertices are
//            numbered by width, so that the number and the meshlet's width give the byte offset; the thesis refers
//            to a vertex by its byte offset instead, in the same four bytes
//   AMB      8 bytes a meshlet: u32 base code, u32 bytes a difference (0 to 4)
//            pdc32: u16 tuple, u16 v2, u16 v3, u16 v4; tuple 0xFFFF: every vertex holds its whole code in 4 bytes,
//            else all share the tuple and w_j = v_j / 65535 / j for j = 2, 3, 4, w_1 = 1 - w_2 - w_3 - w_4; meshlets
//            of the same code share the weights too, or their common border would crack
//   TIB      4 u16 a tuple
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/codecs/packed.h"
#include "common/codecs/permutation.h"
#include "common/meshlets/meshlets.h"
#include "common/scene/scene.h"

namespace skinbench {

inline constexpr uint32_t kMaxDifferenceBytes = 4;

// The number is the granularity in bits. dpdc16 merges tuples (tuples.h) and stores the permutation of the slots in the
// payload above the tuple index: 13 bits of index and W = 36 as in the thesis' results; dpdc16Mixed has 14 bits and
// W = 32.
enum class DifferenceCodec { pdc8, pdc16, pdc32, dpdc16, dpdc16Mixed };

struct DifferenceTraits {
    const char* name;
    uint32_t granularity;  // bits: 8, 16 or 32
    uint32_t maxTuples;    // payload = rank * maxTuples + tuple index; rank is 0 without merging
    bool merged;
    PermutationCode code;
};

const DifferenceTraits& differenceTraits(DifferenceCodec codec);

struct DifferenceMesh {
    DifferenceCodec codec = DifferenceCodec::pdc8;
    VertexGrids grids;
    uint32_t vertexCount = 0;  // stored; every vertex in use and its copies
    uint32_t copies = 0;       // stored because meshlets with different base codes or widths share a vertex
    uint64_t vertexBytes = 0;  // without the zeros at the end
    std::vector<uint8_t> vertices;
    // Vertex `number` of width w (0 to 4 bytes a difference) lies at byte sections[w] + number * (14 + w), modulo 2^32.
    std::array<uint32_t, kMaxDifferenceBytes + 1> sections{};
    std::vector<uint32_t> numbers;  // beside MeshletMesh::vertices: number of the stored vertex instead of vertex id
    std::vector<uint32_t> sources;  // a stored vertex: vertex id
    std::vector<std::array<uint32_t, 2>> meshletExtra;  // AMB
    std::vector<uint8_t> differenceBytes;               // a meshlet: 0 to 4
    std::vector<uint16_t> tuples;                       // TIB, kNoJoint where unused
};

// Bytes that hold differences 0..largest at this granularity: equation 2.22 of the thesis, in integers.
uint32_t differenceBytes(uint32_t largest, uint32_t granularity);

// `mesh` has cleaned weights of at most 4 influences. Fails on influences that are not clean, more tuples than the
// codec counts (the error names count and limit), meshlets that refer to no vertex, or more than 4 GiB of vertices.
// Vertices of one width stand in the order of their first use.
Result<DifferenceMesh> encodeDifferences(const Mesh& mesh, const MeshletMesh& meshlets, DifferenceCodec codec);

// Reads vertex `local` of a meshlet back. `meshlets` is the one that was encoded. Never reads out of bounds, whatever
// the buffers hold; fails on what no encoder writes.
Result<DecodedVertex> decodeDifference(const DifferenceMesh& encoded, const MeshletMesh& meshlets, uint32_t meshlet,
                                       uint32_t local);

// How the joints and weights of a stored vertex are kept in that meshlet, one of those that refer to it.
std::string differenceText(const DifferenceMesh& encoded, size_t meshlet, uint32_t vertex);

}  // namespace skinbench
