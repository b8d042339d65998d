// Meshlet difference encoding counted once more (docs/codecs.md 7 and 8.1) from nothing but the codes of the
// vertices: sorted lists instead of the encoder's chains.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "common/codecs/differences.h"
#include "common/scene/tuples.h"

namespace skinbench::test {

inline uint32_t bitsOf(uint64_t x) {
    uint32_t bits = 0;
    for (; x > 0; x /= 2) ++bits;
    return bits;
}

inline uint32_t granularityOf(DifferenceCodec codec) {
    return codec == DifferenceCodec::pdc8 ? 8 : codec == DifferenceCodec::pdc32 ? 32 : 16;
}

struct Recount {
    uint64_t vertexBytes = 0;
    uint64_t vertices = 0;
    uint64_t copies = 0;
    std::vector<uint32_t> widths;        // a meshlet: bytes of its differences
    std::vector<uint32_t> storedWidths;  // a stored vertex
};

// `ignoreBase`: pdc32, whose vertices hold whole codes.
inline Recount recount(const MeshletMesh& meshlets, const std::vector<uint64_t>& codes, uint32_t granularity,
                       bool ignoreBase) {
    Recount result;
    std::vector<std::tuple<uint32_t, uint64_t, uint32_t>> records;  // vertex, base code, width
    for (const Meshlet& meshlet : meshlets.meshlets) {
        const auto first = meshlets.vertices.begin() + meshlet.firstVertex;
        std::vector<uint64_t> values;
        for (auto v = first; v != first + meshlet.vertexCount; ++v) values.push_back(codes[*v]);
        std::sort(values.begin(), values.end());
        const uint32_t bits = values.empty() ? 0 : bitsOf(values.back() - values.front());
        uint32_t width = 0;
        while (width * 8 < bits) width += granularity / 8;
        result.widths.push_back(width);
        for (auto v = first; v != first + meshlet.vertexCount; ++v)
            records.emplace_back(*v, ignoreBase ? 0 : values.front(), width);
    }
    std::sort(records.begin(), records.end());
    records.erase(std::unique(records.begin(), records.end()), records.end());
    for (size_t i = 0; i < records.size(); ++i) {
        const uint32_t width = std::get<2>(records[i]);
        result.copies += i > 0 && std::get<0>(records[i]) == std::get<0>(records[i - 1]);
        result.vertexBytes += 14 + width;
        result.storedWidths.push_back(width);
    }
    result.vertices = records.size();
    return result;
}

struct Codes {
    std::vector<uint64_t> ofVertex;
    size_t tuples = 0;  // of the table
};

inline Codes codesOf(const Mesh& mesh, DifferenceCodec codec) {
    const DifferenceTraits& traits = differenceTraits(codec);
    const TupleTable distinct = distinctTuples(mesh, 4);
    const MergedTuples merged = traits.merged ? mergeTuples(distinct) : MergedTuples{};
    const TupleTable& table = traits.merged ? merged.table : reuseTuples(distinct);
    Codes codes;
    codes.tuples = table.tuples.size();
    for (size_t v = 0; v < mesh.influences.size(); ++v) {
        const auto& w = mesh.influences[v].weights;
        const std::array<float, 4> ascending{w[3], w[2], w[1], w[0]};
        const uint32_t rank = traits.merged ? merged.vertexRank[v] : 0;
        codes.ofVertex.push_back(
            encodePermutation(traits.code, ascending, rank * traits.maxTuples + table.vertexTuple[v]));
    }
    return codes;
}

}  // namespace skinbench::test
