#include "common/codecs/differences.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <format>
#include <limits>
#include <unordered_map>
#include <utility>

#include "common/core/bytes.h"
#include "common/core/parallel.h"

namespace skinbench {
namespace {

constexpr uint32_t kNone = 0xFFFFFFFF;
constexpr uint32_t kReadVertex = 0xFFFF;  // pdc32: the tuple of a meshlet whose vertices hold their codes
constexpr double kUnorm16 = 65535;
constexpr uint32_t kRanks = 24;

struct BlendCodes {
    std::vector<uint32_t> codes;   // a vertex
    std::vector<uint32_t> tuple;   // a vertex: index into the table
    std::vector<uint16_t> tuples;  // TIB
};

Result<BlendCodes> makeCodes(const Mesh& mesh, const DifferenceTraits& traits) {
    BlendCodes result;
    TupleTable table = distinctTuples(mesh, 4);
    std::vector<uint8_t> rank;
    if (traits.merged) {
        MergedTuples merged = mergeTuples(table);
        table = std::move(merged.table);
        rank = std::move(merged.vertexRank);
    } else {
        table = reuseTuples(table);
    }
    if (const auto ok = checkTupleCount(traits.name, table.tuples.size(), traits.maxTuples); !ok) {
        return std::unexpected(ok.error());
    }
    result.codes.resize(mesh.positions.size());
    parallelRanges(result.codes.size(), [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            const uint32_t payload = (rank.empty() ? 0 : rank[v]) * traits.maxTuples + table.vertexTuple[v];
            result.codes[v] = static_cast<uint32_t>(encodeInfluences(traits.code, mesh.influences[v], payload));
        }
    });
    result.tuples = tupleWords(table);
    result.tuple = std::move(table.vertexTuple);
    return result;
}

struct CodeRange {
    uint32_t base = 0;
    uint32_t bytes = 0;
};

std::span<const uint32_t> verticesOf(const MeshletMesh& meshlets, const Meshlet& meshlet) {
    return std::span(meshlets.vertices).subspan(meshlet.firstVertex, meshlet.vertexCount);
}

std::vector<CodeRange> makeRanges(const MeshletMesh& meshlets, const std::vector<uint32_t>& codes,
                                  uint32_t granularity) {
    std::vector<CodeRange> ranges(meshlets.meshlets.size());
    for (size_t m = 0; m < ranges.size(); ++m) {
        uint32_t low = kNone;
        uint32_t high = 0;
        for (const uint32_t v : verticesOf(meshlets, meshlets.meshlets[m])) {
            low = std::min(low, codes[v]);
            high = std::max(high, codes[v]);
        }
        if (low > high) continue;  // no vertices
        ranges[m] = {low, differenceBytes(high - low, granularity)};
    }
    return ranges;
}

// Meshlets of the same class may share a vertex: equal width and, but for pdc32, equal base code.
std::vector<uint32_t> makeClasses(const std::vector<CodeRange>& ranges, DifferenceCodec codec) {
    std::unordered_map<uint64_t, uint32_t> classes;
    std::vector<uint32_t> result(ranges.size());
    for (size_t m = 0; m < ranges.size(); ++m) {
        const uint64_t base = codec == DifferenceCodec::pdc32 ? 0 : ranges[m].base;
        result[m] =
            classes.try_emplace(base << 8 | ranges[m].bytes, static_cast<uint32_t>(classes.size())).first->second;
    }
    return result;
}

struct StoredVertex {
    uint32_t source = 0;
    uint32_t meshletClass = 0;
    uint32_t difference = 0;
    uint32_t bytes = 0;
    uint32_t next = kNone;  // the next copy of the same source
};

uint32_t byteOffset(const DifferenceMesh& mesh, uint32_t number, uint32_t bytes) {
    return mesh.sections[bytes] + number * (kBaseVertexBytes + bytes);
}

// Stable by width: what the numbers of `found` become. Sets sections and vertexBytes.
std::vector<uint32_t> numberByWidth(const std::vector<StoredVertex>& stored, DifferenceMesh& out) {
    std::array<uint32_t, kMaxDifferenceBytes + 1> next{};
    for (const StoredVertex& v : stored) ++next[v.bytes];
    uint32_t first = 0;
    for (uint32_t bytes = 0; bytes <= kMaxDifferenceBytes; ++bytes) {
        const uint32_t count = std::exchange(next[bytes], first);
        const uint32_t stride = kBaseVertexBytes + bytes;
        out.sections[bytes] = static_cast<uint32_t>(out.vertexBytes) - first * stride;
        out.vertexBytes += uint64_t{count} * stride;
        first += count;
    }
    std::vector<uint32_t> numbers(stored.size());
    for (size_t i = 0; i < stored.size(); ++i) numbers[i] = next[stored[i].bytes]++;
    return numbers;
}

// One stored vertex per source vertex and class, by width and first use. Sets all that refers to vertices.
Result<std::vector<StoredVertex>> placeVertices(const MeshletMesh& meshlets, const std::vector<CodeRange>& ranges,
                                                const std::vector<uint32_t>& codes, DifferenceMesh& out) {
    const std::vector<uint32_t> classes = makeClasses(ranges, out.codec);
    std::vector<StoredVertex> found;
    found.reserve(codes.size());
    std::vector<uint32_t> newest(codes.size(), kNone);
    out.numbers.resize(meshlets.vertices.size());
    for (size_t m = 0; m < ranges.size(); ++m) {
        const Meshlet& meshlet = meshlets.meshlets[m];
        for (uint32_t i = meshlet.firstVertex; i < meshlet.firstVertex + meshlet.vertexCount; ++i) {
            const uint32_t source = meshlets.vertices[i];
            uint32_t place = newest[source];
            while (place != kNone && found[place].meshletClass != classes[m]) place = found[place].next;
            if (place == kNone) {
                // pdc32 stores whole codes.
                const uint32_t base = out.codec == DifferenceCodec::pdc32 ? 0 : ranges[m].base;
                place = static_cast<uint32_t>(found.size());
                out.copies += newest[source] != kNone;
                found.push_back({source, classes[m], codes[source] - base, ranges[m].bytes, newest[source]});
                newest[source] = place;
            }
            out.numbers[i] = place;
        }
    }
    const std::vector<uint32_t> numbers = numberByWidth(found, out);
    if (out.vertexBytes > std::numeric_limits<uint32_t>::max()) {
        return inputError(
            std::format("codec {}: the vertices exceed 4 GiB; use fewer vertices", differenceTraits(out.codec).name));
    }
    for (uint32_t& number : out.numbers) number = numbers[number];
    std::vector<StoredVertex> stored(found.size());
    out.sources.resize(found.size());
    for (size_t i = 0; i < found.size(); ++i) {
        stored[numbers[i]] = found[i];
        out.sources[numbers[i]] = found[i].source;
    }
    return stored;
}

// The mean of the distinct source weights: equal codes do not imply equal floats.
glm::dvec4 meanWeights(const Mesh& mesh, std::vector<uint32_t>& vertices) {
    const auto weights = [&](uint32_t v) -> const auto& { return mesh.influences[v].weights; };
    std::ranges::sort(vertices, {}, weights);
    const auto repeated = std::ranges::unique(vertices, {}, weights);
    vertices.erase(repeated.begin(), repeated.end());
    glm::dvec4 sum(0);
    for (const uint32_t v : vertices) sum += glm::dvec4(weights(v)[0], weights(v)[1], weights(v)[2], weights(v)[3]);
    return sum / static_cast<double>(vertices.size());
}

std::array<uint32_t, 2> constantEntry(const glm::dvec4& w, uint32_t tuple) {
    std::array<uint32_t, 3> v{};
    for (int j = 2; j <= 4; ++j) {
        v[j - 2] = static_cast<uint32_t>(std::min(std::floor(j * w[j - 1] * kUnorm16 + 0.5), kUnorm16));
    }
    return {tuple | v[0] << 16, v[1] | v[2] << 16};
}

// pdc32: one entry a code that fills a meshlet.
std::vector<std::array<uint32_t, 2>> makeConstants(const Mesh& mesh, const MeshletMesh& meshlets,
                                                   const BlendCodes& blend, const std::vector<CodeRange>& ranges) {
    std::vector<std::array<uint32_t, 2>> extra(ranges.size(), {kReadVertex, 0});
    std::unordered_map<uint32_t, std::vector<uint32_t>> verticesOfCode;
    for (size_t m = 0; m < ranges.size(); ++m) {
        if (ranges[m].bytes != 0) continue;
        const auto vertices = verticesOf(meshlets, meshlets.meshlets[m]);
        auto& all = verticesOfCode[ranges[m].base];
        all.insert(all.end(), vertices.begin(), vertices.end());
    }
    std::unordered_map<uint32_t, std::array<uint32_t, 2>> entries;
    for (auto& [code, vertices] : verticesOfCode) {
        if (vertices.empty()) continue;
        const uint32_t tuple = blend.tuple[vertices[0]];
        entries[code] = constantEntry(meanWeights(mesh, vertices), tuple);
    }
    for (size_t m = 0; m < ranges.size(); ++m) {
        if (ranges[m].bytes == 0 && meshlets.meshlets[m].vertexCount > 0) extra[m] = entries[ranges[m].base];
    }
    return extra;
}

std::vector<std::array<uint32_t, 2>> makeExtra(const Mesh& mesh, const MeshletMesh& meshlets, const BlendCodes& blend,
                                               const std::vector<CodeRange>& ranges, DifferenceCodec codec) {
    if (codec == DifferenceCodec::pdc32) return makeConstants(mesh, meshlets, blend, ranges);
    std::vector<std::array<uint32_t, 2>> extra;
    for (const CodeRange& range : ranges) extra.push_back({range.base, range.bytes});
    return extra;
}

void writeVertices(const Mesh& mesh, const std::vector<StoredVertex>& stored, DifferenceMesh& out) {
    out.vertexCount = static_cast<uint32_t>(stored.size());
    out.vertices.resize((out.vertexBytes + 3) / 4 * 4);
    parallelRanges(stored.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const StoredVertex& v = stored[i];
            const std::span<uint8_t> bytes(&out.vertices[byteOffset(out, static_cast<uint32_t>(i), v.bytes)],
                                           kBaseVertexBytes + v.bytes);
            writeBaseVertex(mesh, v.source, out.grids, bytes.first<kBaseVertexBytes>());
            writeBytes(bytes.subspan(kBaseVertexBytes), v.difference);
        }
    });
}

Result<void> checkReferences(const Mesh& mesh, const MeshletMesh& meshlets) {
    for (size_t m = 0; m < meshlets.meshlets.size(); ++m) {
        const Meshlet& meshlet = meshlets.meshlets[m];
        if (uint64_t{meshlet.firstVertex} + meshlet.vertexCount > meshlets.vertices.size()) {
            return inputError(std::format("meshlet {}: its vertices end behind the list; build the meshlets again", m));
        }
    }
    for (const uint32_t v : meshlets.vertices) {
        if (v >= mesh.positions.size()) {
            return inputError(std::format("meshlets: vertex {} of a mesh with {}; build the meshlets again", v,
                                          mesh.positions.size()));
        }
    }
    return {};
}

// Where one vertex of one meshlet lies, checked against every buffer.
struct Place {
    uint32_t offset = 0;
    uint32_t bytes = 0;  // of the difference
    std::array<uint32_t, 2> extra{};
};

Result<Place> findVertex(const DifferenceMesh& encoded, const MeshletMesh& meshlets, uint32_t m, uint32_t local) {
    if (m >= meshlets.meshlets.size() || m >= encoded.meshletExtra.size()) {
        return inputError(std::format("encoded mesh: there is no meshlet {}", m));
    }
    const Meshlet& meshlet = meshlets.meshlets[m];
    const uint64_t reference = uint64_t{meshlet.firstVertex} + local;
    if (local >= meshlet.vertexCount || reference >= encoded.numbers.size()) {
        return inputError(std::format("encoded mesh: meshlet {} has no vertex {}", m, local));
    }
    Place place{0, 0, encoded.meshletExtra[m]};
    if (encoded.codec == DifferenceCodec::pdc32) {
        place.bytes = (place.extra[0] & 0xFFFF) == kReadVertex ? 4 : 0;
    } else {
        place.bytes = place.extra[1];
    }
    if (place.bytes <= kMaxDifferenceBytes) place.offset = byteOffset(encoded, encoded.numbers[reference], place.bytes);
    if (place.bytes > kMaxDifferenceBytes ||
        uint64_t{place.offset} + kBaseVertexBytes + place.bytes > encoded.vertices.size()) {
        return inputError(std::format("encoded mesh: vertex {} of meshlet {} lies outside the buffer", local, m));
    }
    return place;
}

PermutationBlend constantBlend(std::array<uint32_t, 2> extra) {
    PermutationBlend blend;
    blend.tuple = extra[0] & 0xFFFF;
    const std::array<uint32_t, 3> v{extra[0] >> 16, extra[1] & 0xFFFF, extra[1] >> 16};
    float rest = 1;
    for (int j = 2; j <= 4; ++j) {
        const float w = static_cast<float>(v[j - 2]) / 65535.0f / static_cast<float>(j);
        blend.weights[4 - j] = w;
        rest -= w;
    }
    blend.weights[3] = rest;
    return blend;
}

}  // namespace

const DifferenceTraits& differenceTraits(DifferenceCodec codec) {
    static constexpr DifferenceTraits kTraits[] = {
        {"pdc8", 8, 65536, false, kPermutationPc},
        {"pdc16", 16, 65536, false, kPermutationPc},
        {"pdc32", 32, 65535, false, kPermutationPc},
        {"dpdc16", 16, 8192, true, kPermutationDpdc16},
        {"dpdc16 (mixed radix)", 16, 16384, true, kPermutationDpdc16Mixed},
    };
    return kTraits[static_cast<size_t>(codec)];
}

uint32_t differenceBytes(uint32_t largest, uint32_t granularity) {
    const uint32_t bits = static_cast<uint32_t>(std::bit_width(largest));
    return (bits + granularity - 1) / granularity * granularity / 8;
}

Result<DifferenceMesh> encodeDifferences(const Mesh& mesh, const MeshletMesh& meshlets, DifferenceCodec codec) {
    const DifferenceTraits& traits = differenceTraits(codec);
    SKINBENCH_TRY(checkPackable(mesh, 4));
    SKINBENCH_TRY(checkReferences(mesh, meshlets));
    Result<BlendCodes> blend = makeCodes(mesh, traits);
    SKINBENCH_TRY(blend);

    DifferenceMesh out;
    out.codec = codec;
    out.grids = vertexGrids(mesh);
    const std::vector<CodeRange> ranges = makeRanges(meshlets, blend->codes, traits.granularity);
    const auto stored = placeVertices(meshlets, ranges, blend->codes, out);
    SKINBENCH_TRY(stored);
    writeVertices(mesh, *stored, out);
    out.meshletExtra = makeExtra(mesh, meshlets, *blend, ranges, codec);
    for (const CodeRange& range : ranges) out.differenceBytes.push_back(static_cast<uint8_t>(range.bytes));
    out.tuples = std::move(blend->tuples);
    return out;
}

Result<DecodedVertex> decodeDifference(const DifferenceMesh& encoded, const MeshletMesh& meshlets, uint32_t meshlet,
                                       uint32_t local) {
    const DifferenceTraits& traits = differenceTraits(encoded.codec);
    const auto place = findVertex(encoded, meshlets, meshlet, local);
    SKINBENCH_TRY(place);
    const auto bytes = std::span(encoded.vertices).subspan(place->offset, kBaseVertexBytes + place->bytes);

    Result<PermutationBlend> blend;
    uint32_t rank = 0;
    if (encoded.codec == DifferenceCodec::pdc32 && place->bytes == 0) {
        blend = constantBlend(place->extra);
    } else {
        const uint32_t base = encoded.codec == DifferenceCodec::pdc32 ? 0 : place->extra[0];
        const uint32_t difference = static_cast<uint32_t>(readBytes(bytes.subspan(kBaseVertexBytes)));
        blend = decodePermutation(traits.code, base + difference);
        SKINBENCH_TRY(blend);
        if (traits.merged) {
            rank = blend->tuple / traits.maxTuples;
            blend->tuple %= traits.maxTuples;
        }
    }
    if (rank >= kRanks || (size_t{blend->tuple} + 1) * 4 > encoded.tuples.size()) {
        return inputError(
            std::format("encoded mesh: tuple {} with permutation {} is outside {} tuples and 24 permutations",
                        blend->tuple, rank, encoded.tuples.size() / 4));
    }
    const auto slots = permutationOfRank(rank, 4);
    std::array<uint16_t, 4> joints;
    for (int i = 0; i < 4; ++i) joints[i] = encoded.tuples[size_t{blend->tuple} * 4 + slots[i]];
    DecodedVertex vertex = readBaseVertex(bytes.first<kBaseVertexBytes>(), encoded.grids);
    vertex.influences = blendInfluences(traits.code, *blend, joints);
    return vertex;
}

std::string differenceText(const DifferenceMesh& encoded, size_t meshlet, uint32_t vertex) {
    const DifferenceTraits& traits = differenceTraits(encoded.codec);
    const auto& extra = encoded.meshletExtra[meshlet];
    const uint32_t width = encoded.differenceBytes[meshlet], offset = byteOffset(encoded, vertex, width);
    const bool whole = encoded.codec == DifferenceCodec::pdc32;
    if (whole && width == 0) return std::format("one blend for the whole meshlet, tuple {}", extra[0] & 0xFFFF);
    const auto stored =
        static_cast<uint32_t>(readBytes(std::span(encoded.vertices).subspan(offset + kBaseVertexBytes, width)));
    const uint32_t base = whole ? 0 : extra[0];
    const Result<PermutationBlend> blend = decodePermutation(traits.code, base + stored);
    SKINBENCH_ASSERT(blend.has_value());
    std::string text = whole        ? std::format("permutation code {} in {} bits", stored, width * 8)
                       : width == 0 ? std::format("permutation code {} of the meshlet", base)
                                    : std::format("permutation code {}, the meshlet's {} and {} in {} bits",
                                                  base + stored, base, stored, width * 8);
    text += std::format(", tuple {}", blend->tuple % traits.maxTuples);
    if (traits.merged) text += std::format(", permutation {}", blend->tuple / traits.maxTuples);
    return text;
}

}  // namespace skinbench
