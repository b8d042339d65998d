// Joint tuples and their lookup table (docs/codecs.md 3; Kimmersdorfer 2.1.4).
//
// A tuple lists the joints of a vertex in order of descending weight, filled up with kNoJoint ("irrelevant"). All
// functions take cleaned influences (cleanWeights) and give the same result on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"

namespace skinbench {

using JointTuple = std::array<uint16_t, kMaxInfluences>;  // places behind `influences` hold kNoJoint

// Tuples are distinct and in descending lexicographic order (kNoJoint is the largest value).
struct TupleTable {
    int influences = 4;
    std::vector<JointTuple> tuples;
    std::vector<uint32_t> vertexTuple;  // per vertex: index into `tuples`
};

// One step of sort-and-merge: `merged` = `kept` with the joints of `taken` behind it, from slot `offset` on.
struct TupleMerge {
    JointTuple kept{};
    JointTuple taken{};
    JointTuple merged{};
    uint32_t offset = 0;
    bool operator==(const TupleMerge&) const = default;
};

// The joint of the i-th heaviest influence of vertex v is tuples[vertexTuple[v]][pi[i]], where pi is the permutation of
// the four slots with lexicographic rank vertexRank[v] (0..23). A merged tuple may name a joint twice.
struct MergedTuples {
    TupleTable table;
    std::vector<uint8_t> vertexRank;
    std::vector<TupleMerge> merges;  // in order
};

// Fails where an influence list is not clean: a weight that is negative or not finite, weights that ascend, kNoJoint
// before a joint, a joint named twice, or more joints than `influences` (1 to 8).
Result<void> checkInfluences(const Mesh& mesh, int influences);

// One entry per distinct joint list. Linear in the vertices.
TupleTable distinctTuples(const Mesh& mesh, int influences);

// docs/codecs.md 3.2: drops every tuple that is a proper prefix of another one. Its vertices use the extension that
// always follows the largest next joint; their weights beyond the prefix are 0.
TupleTable reuseTuples(const TupleTable& distinct);

// docs/codecs.md 3.3, four influences only. Takes the result of distinctTuples (not of reuseTuples, which would lose
// what is irrelevant). n log n in the number of tuples.
MergedTuples mergeTuples(const TupleTable& distinct);

// What the GPU reads: `influences` u16 a tuple. `fill` stands in for kNoJoint.
std::vector<uint16_t> tupleWords(const TupleTable& table, uint16_t fill = kNoJoint);

// --- permutations ----------------------------------------------------------------------------------------------

inline constexpr int kMaxPermutation = 12;  // 12! is the last factorial below 2^32

// n!, for n in 0..12.
uint32_t factorial(int n);

// Lexicographic rank, 0 to n! - 1, of a permutation of 0..n-1 (n <= 12): for n = 3 the ranks 0 to 5 are 012, 021, 102,
// 120, 201, 210.
uint32_t permutationRank(std::span<const uint8_t> permutation);

// The inverse; places n and above are 0. The rank is taken modulo n!.
std::array<uint8_t, kMaxPermutation> permutationOfRank(uint32_t rank, int n);

}  // namespace skinbench
