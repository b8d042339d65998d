// What a file holds that was repaired, left out or against the specification, counted over the whole file, so that each
// kind becomes one warning however often it occurs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace skinbench {

enum class GltfNote {
    badWeights,  // not a number, infinite or negative
    wrongSums,
    weightless,
    repeatedJoints,  // in one vertex
    overfull,        // vertices with more than kMaxInfluences
    badNormals,
    longNormals,
    badUvs,
    skippedPrimitives,
    forbiddenFormats,  // of attributes and animation data
    misaligned,        // accessors
    unskinned,         // primitives on a node with a skin
    morphs,
    unknownTargets,  // of animation channels
    repeatedTargets,
    equalKeyTimes,
    negativeKeyTimes,
    splitMatrices,
    shearedMatrices,
    matrixAndParts,
    longRotations,
    brokenBindRows,
    repeatedSkinJoints,
    skinsWithoutRoot,
    hiddenNodes,
    undeclaredExtensions,
    zeroStrides,
    wrongBounds,
    wrongSkeletons,
    longRotationKeys,
    count
};

struct GltfNotes {
    std::array<uint64_t, static_cast<size_t>(GltfNote::count)> counts{};
    double overfullMax = 0;  // the largest share of weight that an overfull vertex lost

    void add(GltfNote note, uint64_t times = 1) { counts[static_cast<size_t>(note)] += times; }
};

std::vector<std::string> describe(const GltfNotes& notes);

}  // namespace skinbench
