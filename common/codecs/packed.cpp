#include "common/codecs/packed.h"

#include <algorithm>
#include <cmath>
#include <format>
#include <limits>

#include "common/core/bytes.h"
#include "common/core/parallel.h"

namespace skinbench {
namespace {

constexpr uint32_t kOssStride = kBaseVertexBytes + 4;
constexpr uint32_t kUnorm16 = 65535;

// Fills every vertex with its base and what write(vertex, bytes behind the base) puts there.
template <class Write>
PackedVertices packVertices(const Mesh& mesh, uint32_t stride, int influences, const Write& write) {
    PackedVertices packed;
    packed.vertexCount = static_cast<uint32_t>(mesh.positions.size());
    packed.stride = stride;
    packed.influences = influences;
    packed.grids = vertexGrids(mesh);
    packed.vertices.resize((size_t{packed.vertexCount} * stride + 3) / 4 * 4);
    parallelRanges(packed.vertexCount, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            const std::span<uint8_t> out(&packed.vertices[v * stride], stride);
            writeBaseVertex(mesh, v, packed.grids, out.first<kBaseVertexBytes>());
            write(v, out.subspan(kBaseVertexBytes));
        }
    });
    return packed;
}

Result<std::span<const uint8_t>> vertexBytes(const PackedVertices& packed, uint32_t vertex, uint32_t stride) {
    if (packed.stride != stride) {
        return inputError(std::format("packed vertices: the stride is {} instead of {} bytes", packed.stride, stride));
    }
    const size_t first = size_t{vertex} * stride;
    if (vertex >= packed.vertexCount || first + stride > packed.vertices.size()) {
        return inputError(std::format("packed vertices: vertex {} lies outside {} vertices and {} bytes", vertex,
                                      packed.vertexCount, packed.vertices.size()));
    }
    return std::span<const uint8_t>(packed.vertices).subspan(first, stride);
}

Result<std::span<const uint16_t>> tupleAt(const PackedVertices& packed, uint32_t tuple, int influences) {
    const size_t width = static_cast<size_t>(influences);
    if ((size_t{tuple} + 1) * width > packed.tuples.size()) {
        return inputError(
            std::format("packed vertices: tuple {} lies outside {} tuples", tuple, packed.tuples.size() / width));
    }
    return std::span<const uint16_t>(packed.tuples).subspan(tuple * width, width);
}

void setInfluence(Influences& influences, int i, float weight, uint16_t joint) {
    influences.weights[i] = weight;
    influences.joints[i] = weight != 0 ? joint : kNoJoint;
}

Influences noInfluences() {
    Influences influences;
    influences.joints.fill(kNoJoint);
    return influences;
}

uint32_t uc16Stride(int influences) { return kBaseVertexBytes + 4 * static_cast<uint32_t>(influences); }

uint32_t permutationStride(const PermutationCode& code) {
    return kBaseVertexBytes + (static_cast<uint32_t>(code.bits) + 7) / 8;
}

}  // namespace

VertexGrids vertexGrids(const Mesh& mesh) { return {positionGrid(mesh.positions), uvGrid(mesh.uvs)}; }

void writeBaseVertex(const Mesh& mesh, size_t vertex, const VertexGrids& grids, std::span<uint8_t, 14> out) {
    const glm::uvec3 p = quantizePosition(mesh.positions[vertex], grids.position, 16);
    const uint32_t n = encodeNormal(mesh.normals[vertex], NormalFormat::octahedral);
    const glm::uvec2 t = quantizeUv(mesh.uvs[vertex], grids.uv);
    const std::array<uint32_t, 7> fields{p.x, p.y, p.z, n & 0xFFFF, n >> 16, t.x, t.y};
    for (size_t i = 0; i < fields.size(); ++i) writeBytes(out.subspan(2 * i, 2), fields[i]);
}

DecodedVertex readBaseVertex(std::span<const uint8_t, 14> bytes, const VertexGrids& grids) {
    std::array<uint32_t, 7> fields;
    for (size_t i = 0; i < fields.size(); ++i) fields[i] = static_cast<uint32_t>(readBytes(bytes.subspan(2 * i, 2)));
    DecodedVertex vertex;
    vertex.position = dequantizePosition({fields[0], fields[1], fields[2]}, grids.position, 16);
    vertex.normal = decodeNormal(fields[3] | fields[4] << 16, NormalFormat::octahedral);
    vertex.uv = dequantizeUv({fields[5], fields[6]}, grids.uv);
    vertex.influences = noInfluences();
    return vertex;
}

std::array<uint16_t, kMaxInfluences> weightsToUnorm16(std::span<const float> weights) {
    SKINBENCH_ASSERT(weights.size() >= 1 && weights.size() <= kMaxInfluences);
    double sum = 0;
    for (const float w : weights) sum += w;
    SKINBENCH_ASSERT(sum > 0);
    const size_t count = weights.size();
    std::array<uint16_t, kMaxInfluences> q{};
    std::array<double, kMaxInfluences> remainder{};
    std::array<uint8_t, kMaxInfluences> order{};
    uint32_t left = kUnorm16;
    for (size_t i = 0; i < count; ++i) {
        const double exact = weights[i] / sum * kUnorm16;
        q[i] = static_cast<uint16_t>(std::min(static_cast<uint32_t>(exact), left));
        left -= q[i];
        remainder[i] = exact - q[i];
        order[i] = static_cast<uint8_t>(i);
        // Insertion keeps equal remainders in order: the heavier weight is rounded up.
        for (size_t k = i; k > 0 && remainder[order[k]] > remainder[order[k - 1]]; --k)
            std::swap(order[k], order[k - 1]);
    }
    for (size_t i = 0; left > 0; i = (i + 1) % count, --left) ++q[order[i]];
    return q;
}

Result<void> checkPackable(const Mesh& mesh, int influences) {
    const size_t count = mesh.positions.size();
    if (mesh.normals.size() != count || mesh.uvs.size() != count || mesh.influences.size() != count) {
        return inputError(
            std::format("mesh: {} positions, {} normals, {} uvs and {} influence lists; give every vertex all", count,
                        mesh.normals.size(), mesh.uvs.size(), mesh.influences.size()));
    }
    if (count > std::numeric_limits<uint32_t>::max()) {
        return inputError(std::format("mesh: {} vertices; split it below 2^32", count));
    }
    return checkInfluences(mesh, influences);
}

Result<void> checkTupleCount(const char* codec, size_t tuples, size_t limit) {
    if (tuples <= limit) return {};
    return inputError(
        std::format("codec {}: the mesh has {} joint tuples, the limit is {}; use fewer influences or "
                    "another codec",
                    codec, tuples, limit));
}

uint64_t encodeInfluences(const PermutationCode& code, const Influences& influences, uint32_t payload) {
    std::array<float, kMaxInfluences> ascending{};
    for (int i = 0; i < code.entries; ++i) ascending[i] = influences.weights[code.entries - i];
    return encodePermutation(code, ascending, payload);
}

Influences blendInfluences(const PermutationCode& code, const PermutationBlend& blend,
                           std::span<const uint16_t> tuple) {
    SKINBENCH_ASSERT(code.entries < kMaxInfluences && tuple.size() > static_cast<size_t>(code.entries));
    Influences influences = noInfluences();
    for (int i = 0; i <= code.entries; ++i) setInfluence(influences, i, blend.weights[code.entries - i], tuple[i]);
    return influences;
}

Result<PackedVertices> packOss(const Mesh& mesh) { return packSimplex(mesh, simplexCode16()); }

Result<PackedVertices> packSimplex(const Mesh& mesh, const SimplexCode& code) {
    SKINBENCH_ASSERT(code.bits >= 1 && code.bits <= kMaxSimplexBits32);
    SKINBENCH_TRY(checkPackable(mesh, 4));
    const TupleTable table = reuseTuples(distinctTuples(mesh, 4));
    const int tupleBits = 32 - code.bits;
    const std::string name = code.bits == 16 ? "oss" : std::format("oss{}", code.bits);
    SKINBENCH_TRY(checkTupleCount(name.c_str(), table.tuples.size(), size_t{1} << tupleBits));
    PackedVertices packed = packVertices(mesh, kOssStride, 4, [&](size_t v, std::span<uint8_t> out) {
        const auto& w = mesh.influences[v].weights;
        writeBytes(out, encodeSimplex(code, {w[0], w[1], w[2], w[3]}) << tupleBits | table.vertexTuple[v]);
    });
    packed.tuples = tupleWords(table);
    return packed;
}

Result<PackedVertices> packPc(const Mesh& mesh) { return packPermutation(mesh, kPermutationPc); }

Result<PackedVertices> packPermutation(const Mesh& mesh, const PermutationCode& code) {
    const int influences = code.entries + 1;
    if (influences > kMaxInfluences) {
        return inputError(std::format("codec pc: {} influences, a mesh holds at most {}", influences, kMaxInfluences));
    }
    SKINBENCH_TRY(checkPackable(mesh, influences));
    const TupleTable table = reuseTuples(distinctTuples(mesh, influences));
    SKINBENCH_TRY(checkTupleCount("pc", table.tuples.size(), code.tuples));
    PackedVertices packed =
        packVertices(mesh, permutationStride(code), influences, [&](size_t v, std::span<uint8_t> out) {
            writeBytes(out, encodeInfluences(code, mesh.influences[v], table.vertexTuple[v]));
        });
    packed.tuples = tupleWords(table);
    return packed;
}

Result<PackedVertices> packUc16(const Mesh& mesh, int influences) {
    SKINBENCH_TRY(checkPackable(mesh, influences));
    const size_t width = 2 * static_cast<size_t>(influences);
    return packVertices(mesh, uc16Stride(influences), influences, [&](size_t v, std::span<uint8_t> out) {
        const Influences& source = mesh.influences[v];
        const auto weights = weightsToUnorm16(std::span(source.weights).first(width / 2));
        for (size_t i = 0; i < width / 2; ++i) {
            // Joint 0 with weight 0, so that reading the palette needs no test.
            writeBytes(out.subspan(2 * i, 2), source.joints[i] == kNoJoint ? 0 : source.joints[i]);
            writeBytes(out.subspan(width + 2 * i, 2), weights[i]);
        }
    });
}

Result<DecodedVertex> readOss(const PackedVertices& packed, uint32_t vertex) {
    return readSimplex(packed, simplexCode16(), vertex);
}

Result<DecodedVertex> readSimplex(const PackedVertices& packed, const SimplexCode& code, uint32_t vertex) {
    const auto bytes = vertexBytes(packed, vertex, kOssStride);
    SKINBENCH_TRY(bytes);
    const uint32_t blend = static_cast<uint32_t>(readBytes(bytes->subspan(kBaseVertexBytes)));
    const int tupleBits = 32 - code.bits;
    const auto tuple = tupleAt(packed, blend & ((1u << tupleBits) - 1), 4);
    SKINBENCH_TRY(tuple);
    const auto weights = decodeSimplex(code, blend >> tupleBits);
    SKINBENCH_TRY(weights);
    DecodedVertex result = readBaseVertex(bytes->first<kBaseVertexBytes>(), packed.grids);
    for (int i = 0; i < 4; ++i) setInfluence(result.influences, i, (*weights)[i], (*tuple)[i]);
    return result;
}

Result<DecodedVertex> readPc(const PackedVertices& packed, uint32_t vertex) {
    return readPermutation(packed, kPermutationPc, vertex);
}

Result<DecodedVertex> readPermutation(const PackedVertices& packed, const PermutationCode& code, uint32_t vertex) {
    const auto bytes = vertexBytes(packed, vertex, permutationStride(code));
    SKINBENCH_TRY(bytes);
    const auto blend = decodePermutation(code, readBytes(bytes->subspan(kBaseVertexBytes)));
    SKINBENCH_TRY(blend);
    const auto tuple = tupleAt(packed, blend->tuple, code.entries + 1);
    SKINBENCH_TRY(tuple);
    DecodedVertex result = readBaseVertex(bytes->first<kBaseVertexBytes>(), packed.grids);
    result.influences = blendInfluences(code, *blend, *tuple);
    return result;
}

Result<DecodedVertex> readUc16(const PackedVertices& packed, uint32_t vertex) {
    const auto bytes = vertexBytes(packed, vertex, uc16Stride(packed.influences));
    SKINBENCH_TRY(bytes);
    DecodedVertex result = readBaseVertex(bytes->first<kBaseVertexBytes>(), packed.grids);
    const auto joints = bytes->subspan(kBaseVertexBytes);
    const auto weights = joints.subspan(2 * static_cast<size_t>(packed.influences));
    for (int i = 0; i < packed.influences; ++i) {
        const auto joint = static_cast<uint16_t>(readBytes(joints.subspan(2 * i, 2)));
        setInfluence(result.influences, i, static_cast<float>(readBytes(weights.subspan(2 * i, 2))) / kUnorm16, joint);
    }
    return result;
}

}  // namespace skinbench
