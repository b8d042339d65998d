#include "common/codecs/differences.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <format>
#include <limits>
#include <unordered_map>

#include "common/codecs/bytes.h"
#include "common/codecs/parallel.h"

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
    uint32_t offset = 0;
    uint32_t difference = 0;
    uint32_t bytes = 0;
    uint32_t next = kNone;  // the next copy of the same source
};

// One stored vertex per source vertex and class, in order of first use. Sets vertexOffsets, vertexBytes and copies.
Result<std::vector<StoredVertex>> placeVertices(const MeshletMesh& meshlets, const std::vector<CodeRange>& ranges,
                                                const std::vector<uint32_t>& codes, DifferenceMesh& out) {
    const std::vector<uint32_t> classes = makeClasses(ranges, out.codec);
    std::vector<StoredVertex> stored;
    stored.reserve(codes.size());
    std::vector<uint32_t> newest(codes.size(), kNone);
    out.vertexOffsets.resize(meshlets.vertices.size());
    for (size_t m = 0; m < ranges.size(); ++m) {
        const Meshlet& meshlet = meshlets.meshlets[m];
        for (uint32_t i = meshlet.firstVertex; i < meshlet.firstVertex + meshlet.vertexCount; ++i) {
            const uint32_t source = meshlets.vertices[i];
            uint32_t found = newest[source];
            while (found != kNone && stored[found].meshletClass != classes[m]) found = stored[found].next;
            if (found == kNone) {
                if (out.vertexBytes + kBaseVertexBytes + ranges[m].bytes > std::numeric_limits<uint32_t>::max()) {
                    return inputError(std::format("codec {}: the vertices exceed 4 GiB; use fewer vertices",
                                                  differenceTraits(out.codec).name));
                }
                // pdc32 stores whole codes.
                const uint32_t base = out.codec == DifferenceCodec::pdc32 ? 0 : ranges[m].base;
                found = static_cast<uint32_t>(stored.size());
                out.copies += newest[source] != kNone;
                stored.push_back({source, classes[m], static_cast<uint32_t>(out.vertexBytes), codes[source] - base,
                                  ranges[m].bytes, newest[source]});
                newest[source] = found;
                out.vertexBytes += kBaseVertexBytes + ranges[m].bytes;
            }
            out.vertexOffsets[i] = stored[found].offset;
        }
    }
    return stored;
}

// The mean of the distinct source weights: equal codes do not imply equal floats.
glm::dvec4 meanWeights(const Mesh& mesh, std::span<const uint32_t> vertices) {
    std::vector<uint32_t> distinct;
    glm::dvec4 sum(0);
    for (const uint32_t v : vertices) {
        const auto& w = mesh.influences[v].weights;
        const bool seen =
            std::any_of(distinct.begin(), distinct.end(), [&](uint32_t d) { return mesh.influences[d].weights == w; });
        if (seen) continue;
        distinct.push_back(v);
        sum += glm::dvec4(w[0], w[1], w[2], w[3]);
    }
    return distinct.empty() ? glm::dvec4(1, 0, 0, 0) : sum / static_cast<double>(distinct.size());
}

std::array<uint32_t, 2> constantEntry(const Mesh& mesh, std::span<const uint32_t> vertices, uint32_t tuple) {
    const glm::dvec4 w = meanWeights(mesh, vertices);
    std::array<uint32_t, 3> v{};
    for (int j = 2; j <= 4; ++j) {
        v[j - 2] = static_cast<uint32_t>(std::min(std::floor(j * w[j - 1] * kUnorm16 + 0.5), kUnorm16));
    }
    return {tuple | v[0] << 16, v[1] | v[2] << 16};
}

std::vector<std::array<uint32_t, 2>> makeExtra(const Mesh& mesh, const MeshletMesh& meshlets, const BlendCodes& blend,
                                               const std::vector<CodeRange>& ranges, DifferenceCodec codec) {
    std::vector<std::array<uint32_t, 2>> extra(ranges.size());
    for (size_t m = 0; m < ranges.size(); ++m) {
        const auto vertices = verticesOf(meshlets, meshlets.meshlets[m]);
        if (codec != DifferenceCodec::pdc32) {
            extra[m] = {ranges[m].base, ranges[m].bytes};
        } else if (ranges[m].bytes != 0 || vertices.empty()) {
            extra[m] = {kReadVertex, 0};
        } else {
            extra[m] = constantEntry(mesh, vertices, blend.tuple[vertices[0]]);
        }
    }
    return extra;
}

void writeVertices(const Mesh& mesh, const std::vector<StoredVertex>& stored, DifferenceMesh& out) {
    out.vertexCount = static_cast<uint32_t>(stored.size());
    out.vertices.resize((out.vertexBytes + 3) / 4 * 4);
    parallelRanges(stored.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const StoredVertex& v = stored[i];
            const std::span<uint8_t> bytes(&out.vertices[v.offset], kBaseVertexBytes + v.bytes);
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
    if (local >= meshlet.vertexCount || reference >= encoded.vertexOffsets.size()) {
        return inputError(std::format("encoded mesh: meshlet {} has no vertex {}", m, local));
    }
    Place place{encoded.vertexOffsets[reference], 0, encoded.meshletExtra[m]};
    if (encoded.codec == DifferenceCodec::pdc32) {
        place.bytes = (place.extra[0] & 0xFFFF) == kReadVertex ? 4 : 0;
    } else {
        place.bytes = place.extra[1];
    }
    if (place.bytes > 4 || uint64_t{place.offset} + kBaseVertexBytes + place.bytes > encoded.vertices.size()) {
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
    if (const auto ok = checkPackable(mesh, 4); !ok) return std::unexpected(ok.error());
    if (const auto ok = checkReferences(mesh, meshlets); !ok) return std::unexpected(ok.error());
    Result<BlendCodes> blend = makeCodes(mesh, traits);
    if (!blend) return std::unexpected(blend.error());

    DifferenceMesh out;
    out.codec = codec;
    out.grids = vertexGrids(mesh);
    const std::vector<CodeRange> ranges = makeRanges(meshlets, blend->codes, traits.granularity);
    const auto stored = placeVertices(meshlets, ranges, blend->codes, out);
    if (!stored) return std::unexpected(stored.error());
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
    if (!place) return std::unexpected(place.error());
    const auto bytes = std::span(encoded.vertices).subspan(place->offset, kBaseVertexBytes + place->bytes);

    Result<PermutationBlend> blend;
    uint32_t rank = 0;
    if (encoded.codec == DifferenceCodec::pdc32 && place->bytes == 0) {
        blend = constantBlend(place->extra);
    } else {
        const uint32_t base = encoded.codec == DifferenceCodec::pdc32 ? 0 : place->extra[0];
        const uint32_t difference = static_cast<uint32_t>(readBytes(bytes.subspan(kBaseVertexBytes)));
        blend = decodePermutation(traits.code, base + difference);
        if (!blend) return std::unexpected(blend.error());
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

}  // namespace skinbench
