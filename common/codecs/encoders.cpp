// Rows of codecs(): packed vertices as the buffers and defines that shaders_glsl/codecs/ reads.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <format>
#include <limits>
#include <span>

#include <glm/gtc/packing.hpp>

#include "common/codecs/codec.h"
#include "common/codecs/differences.h"
#include "common/codecs/packed.h"
#include "common/core/bytes.h"
#include "common/core/parallel.h"

namespace skinbench {
namespace {

// Bits instead of digits: every compiler reads them as the same float.
std::string floatsText(std::span<const float> values) {
    std::string text = std::format("uintBitsToFloat(uvec{}(", values.size());
    for (size_t i = 0; i < values.size(); ++i)
        text += std::format("{}{:#x}u", i == 0 ? "" : ", ", std::bit_cast<uint32_t>(values[i]));
    return text + "))";
}

std::string listText(std::span<const uint32_t> values) {
    std::string text;
    for (size_t i = 0; i < values.size(); ++i) text += std::format("{}{}u", i == 0 ? "{" : ", ", values[i]);
    return text + "}";
}

// `bytes` is the size of the largest vertex, `alignment` a power of two that divides every vertex's place, at most 4.
Defines packedDefines(const VertexGrids& grids, size_t bufferBytes, uint32_t bytes, uint32_t alignment) {
    return {{"POSITION_MIN", floatsText(std::span(&grids.position.min.x, 3))},
            {"POSITION_EXTENT", floatsText(std::span(&grids.position.extent.x, 3))},
            {"UV_MIN", floatsText(std::span(&grids.uv.min.x, 2))},
            {"UV_EXTENT", floatsText(std::span(&grids.uv.extent.x, 2))},
            {"BUFFER_WORDS", std::to_string(bufferBytes / 4)},
            {"VERTEX_BYTES", std::to_string(bytes)},
            {"VERTEX_ALIGNMENT", std::to_string(alignment)}};
}

void addDefines(Defines& defines, const Defines& more) { defines.insert(defines.end(), more.begin(), more.end()); }

Defines permutationDefines(const PermutationCode& code) {
    return {{"PC_BITS", std::to_string(code.bits)},
            {"PC_VALUES", std::to_string(code.values)},
            {"PC_EXTRA", listText(std::span(code.extra).first(code.entries))}};
}

// Joint 0 in unused places: their weight is 0, so reading the palette needs no test.
Bytes tupleBytes(std::vector<uint16_t> tuples) {
    std::ranges::replace(tuples, kNoJoint, uint16_t{0});
    return toBytes(tuples);
}

uint32_t tupleCount(const std::vector<uint16_t>& tuples, int influences) {
    return static_cast<uint32_t>(tuples.size() / static_cast<size_t>(influences));
}

// Half a step of docs/codecs.md 1.1, and what single precision adds when it decodes.
glm::dvec3 positionBound(const PositionGrid& grid) {
    const glm::dvec3 extent(grid.extent);
    return extent * (0.5 / quantizerSteps(16)) + (extent + glm::abs(glm::dvec3(grid.min))) * 0x1p-22;
}

constexpr double kWeightRounding = 1e-6;  // of a decoder in single precision

// docs/codecs.md 4.5: the Euclidean bound, and by Cauchy and Schwarz the sum.
double weightsBound(const PermutationCode& code) {
    return std::sqrt(code.entries + 1.0) * worstErrorLength(code) + kWeightRounding;
}

// docs/codecs.md 6, in steps: half of one for w4, at most one for w3 and w2 where the grid ends, their rest for w1.
double weightsBound(const SimplexCode& code) { return 4 * code.step + kWeightRounding; }

// Each weight is rounded to one of its two neighbours.
double unorm16Bound(int influences) { return influences / 65535.0 + kWeightRounding; }

// The weights of a pdc32 meshlet are a mean of weights with the same code: each within the bound of what it decodes to.
double weightsBound(const DifferenceTraits& traits, DifferenceCodec codec) {
    const double one = weightsBound(traits.code);
    return codec == DifferenceCodec::pdc32 ? 2 * one + unorm16Bound(4) : one;
}

// Every vertex through read(v), which cannot fail on what an encoder made.
template <class Read>
Mesh readVertices(uint32_t count, const Read& read) {
    Mesh mesh;
    mesh.positions.resize(count);
    mesh.normals.resize(count);
    mesh.uvs.resize(count);
    mesh.influences.resize(count);
    parallelRanges(count, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            const Result<DecodedVertex> vertex = read(static_cast<uint32_t>(v));
            SKINBENCH_ASSERT(vertex.has_value());
            mesh.positions[v] = vertex->position;
            mesh.normals[v] = vertex->normal;
            mesh.uvs[v] = vertex->uv;
            mesh.influences[v] = vertex->influences;
        }
    });
    return mesh;
}

// What lies behind a vertex' base.
uint64_t blendCode(const PackedVertices& packed, uint32_t vertex) {
    const auto bytes = std::span(packed.vertices).subspan(size_t{vertex} * packed.stride, packed.stride);
    return readBytes(bytes.subspan(kBaseVertexBytes));
}

std::string simplexText(const SimplexCode& code, uint64_t stored) {
    const int tupleBits = 32 - code.bits;
    return std::format("grid point {} in {} bits, tuple {} in {}", stored >> tupleBits, code.bits,
                       stored & ((1u << tupleBits) - 1), tupleBits);
}

std::string permutationText(const PermutationCode& code, uint64_t stored) {
    const Result<PermutationBlend> blend = decodePermutation(code, stored);
    SKINBENCH_ASSERT(blend.has_value());
    return std::format("permutation code {} in {} bits, tuple {}", stored, code.bits, blend->tuple);
}

template <class Read>
Result<EncodedMesh> encodePacked(Result<PackedVertices> packed, const Defines& more, double weights, const Read& read,
                                 const std::function<std::string(uint64_t)>& codeText = nullptr) {
    SKINBENCH_TRY(packed);
    if (packed->vertices.size() > std::numeric_limits<uint32_t>::max())
        return inputError("packed vertices: one copy exceeds 4 GiB; use fewer vertices");
    EncodedMesh encoded;
    encoded.vertexCount = packed->vertexCount;
    encoded.vertices = toBytes(packed->vertices);
    if (!packed->tuples.empty()) encoded.tuples = tupleBytes(packed->tuples);
    const uint32_t alignment = 1u << std::min(2, std::countr_zero(packed->stride));
    encoded.defines = packedDefines(packed->grids, packed->vertices.size(), packed->stride, alignment);
    encoded.defines.emplace_back("TUPLE_COUNT", std::to_string(tupleCount(packed->tuples, packed->influences)));
    addDefines(encoded.defines, more);
    encoded.bounds = {positionBound(packed->grids.position), weights};
    const auto kept = std::make_shared<const PackedVertices>(std::move(*packed));
    encoded.decode = [kept, read] {
        return readVertices(kept->vertexCount, [&](uint32_t v) { return read(*kept, v); });
    };
    if (codeText)
        encoded.blendText = [kept, codeText](uint32_t vertex, size_t) { return codeText(blendCode(*kept, vertex)); };
    return encoded;
}

// The streams of shaders_glsl/codecs/wicked.glsl in one buffer, as words.
struct WickedStreams {
    size_t count = 0;  // vertices
    std::vector<uint32_t> words;

    explicit WickedStreams(size_t count) : count(count), words((count * 9 + 3) / 4 * 4) {}
    size_t bodyOf(size_t vertex) const { return 4 * vertex; }
    size_t blendOf(size_t vertex) const { return 4 * (count + vertex); }
    size_t uvOf(size_t vertex) const { return 8 * count + vertex; }
};

void writeWicked(const Mesh& mesh, size_t v, WickedStreams& streams) {
    constexpr float kLargestHalf = 65504;
    uint32_t* const body = &streams.words[streams.bodyOf(v)];
    std::memcpy(body, &mesh.positions[v], sizeof(glm::vec3));
    body[3] = glm::packUnorm4x8(glm::vec4(mesh.normals[v] * 0.5f + 0.5f, 0));
    const Influences& source = mesh.influences[v];
    const auto weights = weightsToUnorm16(std::span(source.weights).first(4));
    uint32_t* const blend = &streams.words[streams.blendOf(v)];
    for (size_t i = 0; i < 4; ++i) {
        // Joint 0 with weight 0, so that reading the palette needs no test.
        const uint32_t joint = source.joints[i] == kNoJoint ? 0 : source.joints[i];
        blend[i / 2] |= joint << i % 2 * 16;
        blend[2 + i / 2] |= uint32_t{weights[i]} << i % 2 * 16;
    }
    streams.words[streams.uvOf(v)] = glm::packHalf2x16(glm::clamp(mesh.uvs[v], -kLargestHalf, kLargestHalf));
}

Result<DecodedVertex> readWicked(const WickedStreams& streams, uint32_t v) {
    const uint32_t* const body = &streams.words[streams.bodyOf(v)];
    const uint32_t* const blend = &streams.words[streams.blendOf(v)];
    DecodedVertex vertex;
    std::memcpy(&vertex.position, body, sizeof(glm::vec3));
    for (int i = 0; i < 3; ++i) vertex.normal[i] = static_cast<float>(body[3] >> 8 * i & 255) / 255 * 2 - 1;
    vertex.uv = glm::unpackHalf2x16(streams.words[streams.uvOf(v)]);
    for (size_t i = 0; i < 4; ++i) {
        const uint32_t weight = blend[2 + i / 2] >> i % 2 * 16 & 0xFFFF;
        vertex.influences.weights[i] = static_cast<float>(weight) / 65535;
        vertex.influences.joints[i] = weight ? static_cast<uint16_t>(blend[i / 2] >> i % 2 * 16) : kNoJoint;
    }
    return vertex;
}

std::unexpected<Error> onlyFour(const char* codec) { return inputError(cannotHold(*findCodec(codec), 8).value()); }

Result<EncodedMesh> encodeSimplexBits(const char* name, const Mesh& mesh, int influences, int bits) {
    if (influences != 4) return onlyFour(name);
    const Result<SimplexCode> code = makeSimplexCode(bits);
    SKINBENCH_TRY(code);
    return encodePacked(
        packSimplex(mesh, *code), {{"OSS_BITS", std::to_string(bits)}, {"OSS_POINTS", std::to_string(code->n)}},
        weightsBound(*code), [code = *code](const PackedVertices& p, uint32_t v) { return readSimplex(p, code, v); },
        [code = *code](uint64_t stored) { return simplexText(code, stored); });
}

Result<EncodedMesh> encodePermutationCode(const Mesh& mesh, const PermutationCode& code) {
    return encodePacked(
        packPermutation(mesh, code), permutationDefines(code), weightsBound(code),
        [code](const PackedVertices& p, uint32_t v) { return readPermutation(p, code, v); },
        [code](uint64_t stored) { return permutationText(code, stored); });
}

// A meshlet and a local number that refer to each stored vertex.
std::vector<std::array<uint32_t, 2>> referencesOf(const MeshletMesh& meshlets, const DifferenceMesh& stored) {
    std::vector<std::array<uint32_t, 2>> references(stored.vertexCount);
    for (size_t m = meshlets.meshlets.size(); m-- > 0;) {
        const Meshlet& meshlet = meshlets.meshlets[m];
        for (uint32_t local = 0; local < meshlet.vertexCount; ++local)
            references[stored.numbers[meshlet.firstVertex + local]] = {static_cast<uint32_t>(m), local};
    }
    return references;
}

Defines differenceDefines(const DifferenceMesh& stored) {
    const DifferenceTraits& traits = differenceTraits(stored.codec);
    Defines defines = packedDefines(stored.grids, stored.vertices.size(), kBaseVertexBytes + kMaxDifferenceBytes,
                                    traits.granularity == 8 ? 1 : 2);
    addDefines(defines, permutationDefines(traits.code));
    addDefines(defines, {{"TUPLE_COUNT", std::to_string(tupleCount(stored.tuples, 4))},
                         {"MOST_TUPLES", std::to_string(traits.maxTuples)},
                         {"SECTIONS", listText(stored.sections)}});
    return defines;
}

Result<EncodedMesh> encodeDifferenceCodec(const char* name, const EncodeInput& in, DifferenceCodec codec) {
    if (in.influences != 4) return onlyFour(name);
    const MeshletMesh* const meshlets = in.meshlets;
    if (meshlets == nullptr) return inputError(std::format("codec {} needs meshlets; choose a route with them", name));
    Result<DifferenceMesh> stored = encodeDifferences(in.mesh, *meshlets, codec);
    SKINBENCH_TRY(stored);
    EncodedMesh encoded;
    encoded.vertexCount = stored->vertexCount;
    encoded.vertices = toBytes(stored->vertices);
    encoded.tuples = tupleBytes(stored->tuples);
    encoded.meshletExtra = toBytes(stored->meshletExtra);
    encoded.meshlets = *meshlets;
    encoded.meshlets->vertices = stored->numbers;
    encoded.blendBytes = stored->differenceBytes;
    for (size_t m = 0; m < meshlets->meshlets.size(); ++m) {
        const Meshlet& meshlet = meshlets->meshlets[m];
        const uint32_t width = stored->differenceBytes[m];
        const uint32_t number = meshlet.vertexCount > 0 ? stored->numbers[meshlet.firstVertex] : 0;
        encoded.firstBytes.push_back(stored->sections[width] + number * (kBaseVertexBytes + width));
    }
    encoded.defines = differenceDefines(*stored);
    encoded.sources = stored->sources;
    encoded.bounds = {positionBound(stored->grids.position), weightsBound(differenceTraits(codec), codec),
                      codec == DifferenceCodec::pdc32};
    // The copy of the meshlets holds vertex numbers, which reading back does not look at.
    const auto kept = std::make_shared<const DifferenceMesh>(std::move(*stored));
    encoded.blendText = [kept](uint32_t vertex, size_t meshlet) { return differenceText(*kept, meshlet, vertex); };
    encoded.decode = [kept, cut = std::make_shared<const MeshletMesh>(*encoded.meshlets)] {
        const auto references = referencesOf(*cut, *kept);
        return readVertices(kept->vertexCount, [&](uint32_t v) {
            return decodeDifference(*kept, *cut, references[v][0], references[v][1]);
        });
    };
    return encoded;
}

}  // namespace

Result<EncodedMesh> encodeUc16(const EncodeInput& in) {
    return encodePacked(packUc16(in.mesh, in.influences), {}, unorm16Bound(in.influences), readUc16);
}

Result<EncodedMesh> encodeWicked(const EncodeInput& in) {
    if (in.influences != 4) return onlyFour("wicked");
    SKINBENCH_TRY(checkPackable(in.mesh, 4));
    WickedStreams streams(in.mesh.positions.size());
    parallelRanges(streams.count, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) writeWicked(in.mesh, v, streams);
    });
    EncodedMesh encoded;
    encoded.vertexCount = static_cast<uint32_t>(streams.count);
    encoded.vertices = toBytes(streams.words);
    encoded.defines = {{"BUFFER_WORDS", std::to_string(streams.words.size())}};
    encoded.bounds = {glm::dvec3(0), unorm16Bound(4)};
    encoded.decode = [kept = std::make_shared<const WickedStreams>(std::move(streams))] {
        return readVertices(static_cast<uint32_t>(kept->count), [&](uint32_t v) { return readWicked(*kept, v); });
    };
    return encoded;
}

Result<EncodedMesh> encodeOss16(const EncodeInput& in) { return encodeSimplexBits("oss", in.mesh, in.influences, 16); }

Result<EncodedMesh> encodeOss22(const EncodeInput& in) {
    return encodeSimplexBits("oss22", in.mesh, in.influences, 22);
}

Result<EncodedMesh> encodePc(const EncodeInput& in) {
    if (in.influences == 4) return encodePermutationCode(in.mesh, kPermutationPc);
    static const Result<PermutationCode> eight = configurePermutation(8, kPermutationPc.tuples, 64);
    SKINBENCH_ASSERT(in.influences == 8 && eight.has_value());
    return encodePermutationCode(in.mesh, *eight);
}

template <int bits>
Result<EncodedMesh> encodePcBits(const EncodeInput& in) {
    SKINBENCH_TRY(checkPackable(in.mesh, in.influences));
    const size_t tuples = reuseTuples(distinctTuples(in.mesh, in.influences)).tuples.size();
    const Result<PermutationCode> code = configurePermutation(in.influences, std::max<size_t>(tuples, 1), bits);
    SKINBENCH_TRY(code);
    return encodePermutationCode(in.mesh, *code);
}

template Result<EncodedMesh> encodePcBits<16>(const EncodeInput&);
template Result<EncodedMesh> encodePcBits<24>(const EncodeInput&);
template Result<EncodedMesh> encodePcBits<32>(const EncodeInput&);
template Result<EncodedMesh> encodePcBits<40>(const EncodeInput&);
template Result<EncodedMesh> encodePcBits<48>(const EncodeInput&);
template Result<EncodedMesh> encodePcBits<56>(const EncodeInput&);
template Result<EncodedMesh> encodePcBits<64>(const EncodeInput&);

Result<EncodedMesh> encodePdc8(const EncodeInput& in) {
    return encodeDifferenceCodec("pdc8", in, DifferenceCodec::pdc8);
}

Result<EncodedMesh> encodePdc16(const EncodeInput& in) {
    return encodeDifferenceCodec("pdc16", in, DifferenceCodec::pdc16);
}

Result<EncodedMesh> encodePdc32(const EncodeInput& in) {
    return encodeDifferenceCodec("pdc32", in, DifferenceCodec::pdc32);
}

Result<EncodedMesh> encodeDpdc16(const EncodeInput& in) {
    auto encoded = encodeDifferenceCodec("dpdc16", in, DifferenceCodec::dpdc16);
    if (encoded || in.meshlets == nullptr || in.influences != 4) return encoded;
    auto wider = encodeDifferenceCodec("dpdc16", in, DifferenceCodec::dpdc16Mixed);
    return wider ? wider : encoded;
}

}  // namespace skinbench
