#include <algorithm>
#include <numeric>
#include <set>

#include <catch2/catch_test_macros.hpp>

#include "common/scene/tuples.h"
#include "tests/codec_test.h"

using namespace skinbench;
using namespace skinbench::test;

namespace {

JointTuple tuple(std::initializer_list<uint16_t> joints) {
    JointTuple t;
    t.fill(kNoJoint);
    std::copy(joints.begin(), joints.end(), t.begin());
    return t;
}

// One vertex per tuple, in the given order, weights descending.
Mesh meshOfTuples(const std::vector<std::vector<uint16_t>>& tuples) {
    Mesh mesh;
    for (const auto& joints : tuples) {
        Influences list;
        list.joints.fill(kNoJoint);
        for (size_t i = 0; i < joints.size(); ++i) {
            list.joints[i] = joints[i];
            list.weights[i] = static_cast<float>(joints.size() - i);
        }
        const float sum = std::accumulate(list.weights.begin(), list.weights.end(), 0.0f);
        for (float& w : list.weights) w /= sum;
        mesh.influences.push_back(list);
    }
    return mesh;
}

uint32_t relevant(const JointTuple& t) {
    return static_cast<uint32_t>(std::count_if(t.begin(), t.end(), [](uint16_t j) { return j != kNoJoint; }));
}

void checkReuse(const Mesh& mesh, const TupleTable& table) {
    uint32_t wrong = 0;
    for (size_t v = 0; v < mesh.influences.size(); ++v) {
        const JointTuple& stored = table.tuples.at(table.vertexTuple[v]);
        for (int i = 0; i < kMaxInfluences && mesh.influences[v].joints[i] != kNoJoint; ++i) {
            wrong += stored[i] != mesh.influences[v].joints[i];
        }
    }
    CHECK(wrong == 0);
}

void checkMerged(const Mesh& mesh, const MergedTuples& merged) {
    uint32_t wrong = 0;
    for (size_t v = 0; v < mesh.influences.size(); ++v) {
        const JointTuple& stored = merged.table.tuples.at(merged.table.vertexTuple[v]);
        wrong += merged.vertexRank[v] >= 24;
        const auto slots = permutationOfRank(merged.vertexRank[v], 4);
        for (int i = 0; i < 4 && mesh.influences[v].joints[i] != kNoJoint; ++i) {
            wrong += stored[slots[i]] != mesh.influences[v].joints[i];
        }
    }
    CHECK(wrong == 0);
    CHECK(merged.vertexRank.size() == mesh.influences.size());
}

// docs/codecs.md 3.3 step 2 read literally, with linear searches.
std::vector<TupleMerge> mergeSlowly(std::vector<JointTuple> entries) {
    std::vector<TupleMerge> merges;
    for (;;) {
        if (entries.empty()) return merges;
        size_t kept = 0;
        for (size_t i = 1; i < entries.size(); ++i) {
            if (relevant(entries[i]) < relevant(entries[kept])) kept = i;
        }
        const uint32_t offset = relevant(entries[kept]);
        const auto shared = [&](const JointTuple& t) {
            return std::count_if(entries[kept].begin(), entries[kept].begin() + offset,
                                 [&](uint16_t j) { return std::find(t.begin(), t.end(), j) != t.end(); });
        };
        size_t taken = entries.size();
        for (size_t i = 0; i < entries.size(); ++i) {
            if (i == kept || relevant(entries[i]) > 4 - offset) continue;
            if (taken == entries.size() || relevant(entries[i]) > relevant(entries[taken]) ||
                (relevant(entries[i]) == relevant(entries[taken]) && shared(entries[i]) > shared(entries[taken]))) {
                taken = i;
            }
        }
        if (taken == entries.size()) return merges;
        TupleMerge merge{entries[kept], entries[taken], entries[kept], offset};
        std::copy_n(entries[taken].begin(), relevant(entries[taken]), merge.merged.begin() + offset);
        merges.push_back(merge);
        entries[kept] = merge.merged;
        entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(taken));
    }
}

// Distinct sorted tuples after reuse, in table order: what step 2 starts from.
std::vector<JointTuple> sortedEntries(const Mesh& mesh) {
    std::set<JointTuple, std::greater<>> set;
    for (const Influences& list : mesh.influences) {
        JointTuple t = list.joints;
        std::sort(t.begin(), t.end());
        set.insert(t);
    }
    std::vector<JointTuple> result;
    for (const JointTuple& t : set) {
        const bool isPrefix = std::any_of(set.begin(), set.end(), [&](const JointTuple& o) {
            return o != t && std::equal(t.begin(), t.begin() + relevant(t), o.begin());
        });
        if (!isPrefix) result.push_back(t);
    }
    return result;
}

}  // namespace

TEST_CASE("distinct tuples stand in descending order, kNoJoint first") {
    const Mesh mesh = meshOfTuples({{1, 2}, {5}, {1}, {1, 2}, {1, 2, 3, 4}, {1, 3}});
    const TupleTable table = distinctTuples(mesh, 4);
    CHECK(table.tuples == std::vector{tuple({5}), tuple({1}), tuple({1, 3}), tuple({1, 2}), tuple({1, 2, 3, 4})});
    CHECK(table.vertexTuple == std::vector<uint32_t>{3, 0, 1, 3, 4, 2});
    CHECK(table.influences == 4);
}

TEST_CASE("a prefix follows the largest next joint") {
    const Mesh mesh = meshOfTuples({{1, 2}, {5}, {1}, {1, 2}, {1, 2, 3, 4}, {1, 3}});
    const TupleTable table = reuseTuples(distinctTuples(mesh, 4));
    CHECK(table.tuples == std::vector{tuple({5}), tuple({1, 3}), tuple({1, 2, 3, 4})});
    CHECK(table.vertexTuple == std::vector<uint32_t>{2, 0, 1, 2, 2, 1});
    CHECK(tupleWords(table) ==
          std::vector<uint16_t>{5, kNoJoint, kNoJoint, kNoJoint, 1, 3, kNoJoint, kNoJoint, 1, 2, 3, 4});
    CHECK(tupleWords(table, 0)[1] == 0);
    checkReuse(mesh, table);
}

TEST_CASE("order of joints matters for reuse, not for sort-and-merge") {
    const Mesh mesh = meshOfTuples({{1, 2, 3, 4}, {4, 3, 2, 1}, {2, 1, 4, 3}});
    CHECK(reuseTuples(distinctTuples(mesh, 4)).tuples.size() == 3);
    const MergedTuples merged = mergeTuples(distinctTuples(mesh, 4));
    CHECK(merged.table.tuples == std::vector{tuple({1, 2, 3, 4})});
    CHECK(merged.vertexRank == std::vector<uint8_t>{0, 23, 7});
    checkMerged(mesh, merged);
}

TEST_CASE("figure 2.5, in order of events") {
    const Mesh mesh = meshOfTuples({{6, 8}, {8, 4, 7}, {2, 8}, {2, 5}, {0}, {5, 2}, {9, 3, 1, 7}});
    const MergedTuples merged = mergeTuples(distinctTuples(mesh, 4));
    REQUIRE(merged.merges.size() == 2);
    CHECK(merged.merges[0] == TupleMerge{tuple({0}), tuple({4, 7, 8}), tuple({0, 4, 7, 8}), 1});
    CHECK(merged.merges[1] == TupleMerge{tuple({6, 8}), tuple({2, 8}), tuple({6, 8, 2, 8}), 2});
    CHECK(merged.table.tuples ==
          std::vector{tuple({6, 8, 2, 8}), tuple({2, 5}), tuple({1, 3, 7, 9}), tuple({0, 4, 7, 8})});
    CHECK(merged.table.vertexTuple == std::vector<uint32_t>{0, 3, 0, 1, 3, 1, 2});
    // 8|4|7 lies in slots 3, 1, 2; 2|8 in 2, 3; 5|2 in 1, 0; 9|3|1|7 in 3, 1, 0, 2.
    const auto rank = [](std::array<uint8_t, 4> p) { return static_cast<uint8_t>(permutationRank(p)); };
    CHECK(merged.vertexRank == std::vector<uint8_t>{0, rank({3, 1, 2, 0}), rank({2, 3, 0, 1}), 0, 0, rank({1, 0, 2, 3}),
                                                    rank({3, 1, 0, 2})});
    checkMerged(mesh, merged);
}

TEST_CASE("sort-and-merge equals a literal reading of the rules") {
    Random random(21);
    for (int round = 0; round < 300; ++round) {
        const uint32_t joints = 3 + random.below(30);
        std::vector<std::vector<uint16_t>> tuples;
        const uint32_t count = 1 + random.below(80);
        const uint32_t most = 1 + random.below(4);
        for (uint32_t i = 0; i < count; ++i) {
            std::set<uint16_t> set;
            const uint32_t size = 1 + random.below(std::min(most, joints));
            while (set.size() < size) set.insert(static_cast<uint16_t>(random.below(joints)));
            std::vector<uint16_t> list(set.begin(), set.end());
            for (size_t j = list.size(); j > 1; --j)
                std::swap(list[j - 1], list[random.below(static_cast<uint32_t>(j))]);
            tuples.push_back(list);
        }
        const Mesh mesh = meshOfTuples(tuples);
        const MergedTuples merged = mergeTuples(distinctTuples(mesh, 4));
        CHECK(merged.merges == mergeSlowly(sortedEntries(mesh)));
        CHECK(merged.table.tuples.size() + merged.merges.size() == sortedEntries(mesh).size());
        checkMerged(mesh, merged);
    }
}

TEST_CASE("random meshes keep their joints through every table") {
    for (const uint32_t joints : {1u, 2u, 5u, 60u, 4000u}) {
        const Mesh mesh = randomMesh(joints, 6000, joints);
        const TupleTable distinct = distinctTuples(mesh, 4);
        const TupleTable reused = reuseTuples(distinct);
        const MergedTuples merged = mergeTuples(distinct);
        CHECK(checkInfluences(mesh, 4).has_value());
        checkReuse(mesh, distinct);
        checkReuse(mesh, reused);
        checkMerged(mesh, merged);
        CHECK(reused.tuples.size() <= distinct.tuples.size());
        CHECK(merged.table.tuples.size() <= reused.tuples.size());
        for (size_t i = 1; i < reused.tuples.size(); ++i) REQUIRE(reused.tuples[i - 1] > reused.tuples[i]);
        std::set<JointTuple> all;
        for (const Influences& list : mesh.influences) all.insert(list.joints);
        CHECK(all.size() == distinct.tuples.size());
    }
}

TEST_CASE("eight influences") {
    const Mesh mesh = randomMesh(77, 4000, 60, 8);
    CHECK(checkInfluences(mesh, 8).has_value());
    CHECK_FALSE(checkInfluences(mesh, 4).has_value());
    const TupleTable table = reuseTuples(distinctTuples(mesh, 8));
    checkReuse(mesh, table);
    CHECK(tupleWords(table).size() == 8 * table.tuples.size());
}

TEST_CASE("degenerate meshes") {
    for (const auto& [name, mesh] : degenerateMeshes()) {
        CAPTURE(name);
        const TupleTable distinct = distinctTuples(mesh, 4);
        const MergedTuples merged = mergeTuples(distinct);
        checkReuse(mesh, reuseTuples(distinct));
        checkMerged(mesh, merged);
        if (name == "one joint a vertex") CHECK(merged.table.tuples.size() == 125);  // four singles a tuple
    }
    const TupleTable none = distinctTuples(Mesh{}, 4);
    CHECK(none.tuples.empty());
    CHECK(reuseTuples(none).tuples.empty());
    CHECK(mergeTuples(none).table.tuples.empty());
}

TEST_CASE("influences that are not clean are named") {
    const auto fault = [](const std::function<void(Influences&)>& change) {
        Mesh mesh = meshOfTuples({{4}, {1, 2, 3}});
        REQUIRE(checkInfluences(mesh, 4).has_value());
        change(mesh.influences[1]);
        const auto checked = checkInfluences(mesh, 4);
        REQUIRE_FALSE(checked.has_value());
        CHECK(checked.error().text.starts_with("vertex 1: "));
        return checked.error().text;
    };
    CHECK(fault([](Influences& i) { std::swap(i.weights[0], i.weights[1]); }).find("descending") != std::string::npos);
    CHECK(fault([](Influences& i) { i.weights[2] = -1; }).find("descending") != std::string::npos);
    CHECK(fault([](Influences& i) { i.weights[0] = std::nanf(""); }).find("descending") != std::string::npos);
    CHECK(fault([](Influences& i) { i.weights[2] = 0; }).find("descending") != std::string::npos);
    CHECK(fault([](Influences& i) { i.joints[1] = 1; }).find("twice") != std::string::npos);
    CHECK(fault([](Influences& i) { i.joints[1] = kNoJoint; }).find("no joint") != std::string::npos);
    CHECK(fault([](Influences& i) { i.joints.fill(kNoJoint), i.weights.fill(0); }).find("no influence") !=
          std::string::npos);
}

TEST_CASE("permutation ranks") {
    CHECK(factorial(0) == 1);
    CHECK(factorial(12) == 479001600);
    const std::array<std::array<uint8_t, 3>, 6> three{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (uint32_t r = 0; r < 6; ++r) CHECK(permutationRank(three[r]) == r);
    for (int n = 1; n <= 7; ++n) {
        std::vector<uint8_t> p(n);
        std::iota(p.begin(), p.end(), uint8_t{0});
        uint32_t rank = 0;
        do {
            REQUIRE(permutationRank(p) == rank);
            const auto back = permutationOfRank(rank, n);
            REQUIRE(std::equal(p.begin(), p.end(), back.begin()));
            ++rank;
        } while (std::next_permutation(p.begin(), p.end()));
        CHECK(rank == factorial(n));
    }
    Random random(9);
    for (int i = 0; i < 1000; ++i) {
        const uint32_t rank = random.below(factorial(12));
        CHECK(permutationRank(permutationOfRank(rank, 12)) == rank);
    }
}
