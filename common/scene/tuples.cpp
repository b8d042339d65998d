#include "common/scene/tuples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <format>
#include <map>
#include <set>
#include <utility>

#include "common/core/parallel.h"

namespace skinbench {
namespace {

constexpr int kMergeSlots = 4;
constexpr uint32_t kNone = 0xFFFFFFFF;

uint32_t relevantCount(const JointTuple& tuple) {
    return static_cast<uint32_t>(std::find(tuple.begin(), tuple.end(), kNoJoint) - tuple.begin());
}

uint64_t hashTuple(const JointTuple& tuple) {
    const auto words = std::bit_cast<std::array<uint64_t, 2>>(tuple);
    uint64_t h = words[0] * 0x9E3779B97F4A7C15u ^ std::rotl(words[1] * 0xC2B2AE3D27D4EB4Fu, 31);
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93u;
    return h ^ h >> 32;
}

// Open addressing over a growing list of distinct tuples.
class TupleSet {
public:
    uint32_t insert(const JointTuple& tuple) {
        if (2 * (tuples_.size() + 1) > slots_.size()) grow();
        const size_t slot = find(tuple);
        if (slots_[slot] == kNone) {
            slots_[slot] = static_cast<uint32_t>(tuples_.size());
            tuples_.push_back(tuple);
        }
        return slots_[slot];
    }
    std::vector<JointTuple> take() { return std::move(tuples_); }

private:
    size_t find(const JointTuple& tuple) const {
        size_t slot = hashTuple(tuple) & (slots_.size() - 1);
        while (slots_[slot] != kNone && tuples_[slots_[slot]] != tuple) slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }
    void grow() {
        slots_.assign(std::max<size_t>(1024, slots_.size() * 4), kNone);
        for (size_t i = 0; i < tuples_.size(); ++i) slots_[find(tuples_[i])] = static_cast<uint32_t>(i);
    }
    std::vector<JointTuple> tuples_;
    std::vector<uint32_t> slots_;
};

// Sorts the tuples in descending order. Returns old index -> new index.
std::vector<uint32_t> sortDescending(std::vector<JointTuple>& tuples) {
    std::vector<uint32_t> order(tuples.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<uint32_t>(i);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return tuples[a] > tuples[b]; });
    std::vector<JointTuple> sorted(tuples.size());
    std::vector<uint32_t> place(tuples.size());
    for (size_t i = 0; i < order.size(); ++i) {
        sorted[i] = tuples[order[i]];
        place[order[i]] = static_cast<uint32_t>(i);
    }
    tuples = std::move(sorted);
    return place;
}

bool isPrefix(const JointTuple& prefix, const JointTuple& tuple) {
    return std::equal(prefix.begin(), prefix.begin() + relevantCount(prefix), tuple.begin());
}

// Keeps the tuples that are no proper prefix. Descending order in, descending order out; returns old -> new index.
std::vector<uint32_t> dropPrefixes(std::vector<JointTuple>& tuples) {
    std::vector<uint32_t> place(tuples.size());
    uint32_t kept = 0;
    for (size_t i = 0; i < tuples.size(); ++i) {
        place[i] = kept;
        if (i + 1 < tuples.size() && isPrefix(tuples[i], tuples[i + 1])) continue;
        tuples[kept++] = tuples[i];
    }
    tuples.resize(kept);
    return place;
}

// Finds the partners of sort-and-merge. Entries with 1 to 3 joints are filed by their number of joints, by number and
// joint, and (two joints) by number and pair; the first entry of a file is the first in table order.
class MergeIndex {
public:
    void insert(const JointTuple& tuple, uint32_t entry) {
        forEachKey(tuple, [&](uint64_t key) { files_.insert({key, entry}); });
    }
    void erase(const JointTuple& tuple, uint32_t entry) {
        forEachKey(tuple, [&](uint64_t key) { files_.erase({key, entry}); });
    }
    uint32_t first(uint64_t key) const {
        const auto it = files_.lower_bound({key, 0});
        return it != files_.end() && it->first == key ? it->second : kNone;
    }

    // The fewest joints, then first in table order.
    uint32_t emptiest() const {
        for (uint32_t count = 1; count < kMergeSlots; ++count) {
            const uint32_t entry = first(countKey(count));
            if (entry != kNone) return entry;
        }
        return kNone;
    }

    // The best partner of a tuple that is not filed itself: most joints, then most joints shared, then first.
    uint32_t partner(const JointTuple& tuple) const {
        const uint32_t count = relevantCount(tuple);
        for (uint32_t want = kMergeSlots - count; want > 0; --want) {
            const uint32_t any = first(countKey(want));
            if (any == kNone) continue;
            if (count == 2 && want == 2) {
                const uint32_t both = first(pairKey(tuple));
                if (both != kNone) return both;
            }
            uint32_t best = kNone;
            for (uint32_t i = 0; i < count; ++i) best = std::min(best, first(jointKey(want, tuple[i])));
            return best != kNone ? best : any;
        }
        return kNone;
    }

private:
    static uint64_t countKey(uint32_t count) { return uint64_t{count} << 40; }
    static uint64_t jointKey(uint32_t count, uint16_t joint) { return countKey(count) | 1ull << 32 | joint; }
    static uint64_t pairKey(const JointTuple& tuple) {
        const auto [low, high] = std::minmax(tuple[0], tuple[1]);
        return countKey(2) | 2ull << 32 | uint64_t{high} << 16 | low;
    }

    template <class Visit>
    static void forEachKey(const JointTuple& tuple, const Visit& visit) {
        const uint32_t count = relevantCount(tuple);
        if (count == 0 || count >= kMergeSlots) return;
        visit(countKey(count));
        for (uint32_t i = 0; i < count; ++i) visit(jointKey(count, tuple[i]));
        if (count == 2) visit(pairKey(tuple));
    }

    std::set<std::pair<uint64_t, uint32_t>> files_;
};

// Where the joints of one entry went: `offset` slots into entry `into`, which may have been taken itself.
struct Moved {
    uint32_t into = kNone;
    uint32_t offset = 0;
};

std::vector<TupleMerge> mergeEntries(std::vector<JointTuple>& entries, std::vector<Moved>& moved) {
    MergeIndex index;
    for (size_t i = 0; i < entries.size(); ++i) index.insert(entries[i], static_cast<uint32_t>(i));
    std::vector<TupleMerge> merges;
    for (;;) {
        const uint32_t kept = index.emptiest();
        if (kept == kNone) break;
        const JointTuple before = entries[kept];
        index.erase(before, kept);
        const uint32_t taken = index.partner(before);
        if (taken == kNone) break;
        index.erase(entries[taken], taken);
        const uint32_t offset = relevantCount(before);
        std::copy_n(entries[taken].begin(), relevantCount(entries[taken]), entries[kept].begin() + offset);
        moved[taken] = {kept, offset};
        merges.push_back({before, entries[taken], entries[kept], offset});
        // An entry without a prefix in the table keeps its place in the descending order when joints are appended.
        index.insert(entries[kept], kept);
    }
    return merges;
}

JointTuple sortedJoints(JointTuple tuple) {
    std::sort(tuple.begin(), tuple.end());
    return tuple;
}

// The slot of the i-th heaviest joint, then the unused slots in ascending order.
uint8_t slotRank(const JointTuple& tuple, uint32_t offset) {
    const uint32_t count = relevantCount(tuple);
    std::array<uint8_t, kMergeSlots> slots{};
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t smaller = 0;
        for (uint32_t j = 0; j < count; ++j) smaller += tuple[j] < tuple[i];
        slots[i] = static_cast<uint8_t>(offset + smaller);
    }
    uint32_t filled = count;
    for (uint8_t slot = 0; slot < kMergeSlots; ++slot) {
        if (std::find(slots.begin(), slots.begin() + count, slot) == slots.begin() + count) slots[filled++] = slot;
    }
    return static_cast<uint8_t>(permutationRank(slots));
}

std::string influenceFault(const Influences& list, int influences) {
    float last = 1e30f;
    bool ended = false;
    for (int i = 0; i < kMaxInfluences; ++i) {
        const bool none = list.joints[i] == kNoJoint;
        if (none && list.weights[i] != 0) return "a weight has no joint";
        if (none) {
            ended = true;
            continue;
        }
        if (ended) return "a joint stands behind an unused place";
        if (i >= influences) return std::format("there are more than {} influences", influences);
        if (!(list.weights[i] > 0) || !(list.weights[i] <= last)) return "weights are not positive and descending";
        for (int j = 0; j < i; ++j) {
            if (list.joints[j] == list.joints[i]) return std::format("joint {} is named twice", list.joints[i]);
        }
        last = list.weights[i];
    }
    return list.joints[0] == kNoJoint ? "there is no influence" : "";
}

}  // namespace

Result<void> checkInfluences(const Mesh& mesh, int influences) {
    SKINBENCH_ASSERT(influences >= 1 && influences <= kMaxInfluences);
    const auto faults = parallelParts(mesh.influences.size(), [&](size_t begin, size_t end) -> std::string {
        for (size_t v = begin; v < end; ++v) {
            const std::string fault = influenceFault(mesh.influences[v], influences);
            if (!fault.empty())
                return std::format("vertex {}: {}; clean the weights with {} influences first", v, fault, influences);
        }
        return "";
    });
    for (const auto& [begin, fault] : faults)
        if (!fault.empty()) return inputError(fault);
    return {};
}

TupleTable distinctTuples(const Mesh& mesh, int influences) {
    SKINBENCH_ASSERT(influences >= 1 && influences <= kMaxInfluences);
    TupleTable table;
    table.influences = influences;
    table.vertexTuple.resize(mesh.influences.size());
    auto parts = parallelParts(mesh.influences.size(), [&](size_t begin, size_t end) {
        TupleSet set;
        for (size_t v = begin; v < end; ++v) table.vertexTuple[v] = set.insert(mesh.influences[v].joints);
        return set.take();
    });
    TupleSet all;
    std::map<size_t, std::vector<uint32_t>> numbers;  // of a range's tuples
    for (const auto& [begin, tuples] : parts)
        for (const JointTuple& tuple : tuples) numbers[begin].push_back(all.insert(tuple));
    table.tuples = all.take();
    const std::vector<uint32_t> place = sortDescending(table.tuples);
    parallelRanges(mesh.influences.size(), [&](size_t begin, size_t end) {
        if (begin == end) return;
        const std::vector<uint32_t>& ofRange = numbers.at(begin);
        for (size_t v = begin; v < end; ++v) table.vertexTuple[v] = place[ofRange[table.vertexTuple[v]]];
    });
    return table;
}

TupleTable reuseTuples(const TupleTable& distinct) {
    TupleTable table = distinct;
    const std::vector<uint32_t> place = dropPrefixes(table.tuples);
    for (uint32_t& t : table.vertexTuple) t = place[t];
    return table;
}

MergedTuples mergeTuples(const TupleTable& distinct) {
    SKINBENCH_ASSERT(distinct.influences == kMergeSlots);
    TupleSet set;
    std::vector<uint32_t> entryOf(distinct.tuples.size());
    for (size_t i = 0; i < entryOf.size(); ++i) entryOf[i] = set.insert(sortedJoints(distinct.tuples[i]));
    std::vector<JointTuple> entries = set.take();
    const std::vector<uint32_t> place = sortDescending(entries);
    const std::vector<uint32_t> group = dropPrefixes(entries);

    MergedTuples result;
    std::vector<Moved> moved(entries.size());
    result.merges = mergeEntries(entries, moved);

    result.table.influences = distinct.influences;
    std::vector<uint32_t> survivor(entries.size(), kNone);
    for (size_t i = 0; i < entries.size(); ++i) {
        if (moved[i].into != kNone) continue;
        survivor[i] = static_cast<uint32_t>(result.table.tuples.size());
        result.table.tuples.push_back(entries[i]);
    }

    std::vector<uint32_t> index(entryOf.size());
    std::vector<uint8_t> rank(entryOf.size());
    for (size_t i = 0; i < entryOf.size(); ++i) {
        uint32_t entry = group[place[entryOf[i]]];
        uint32_t offset = 0;
        for (; moved[entry].into != kNone; entry = moved[entry].into) offset += moved[entry].offset;
        index[i] = survivor[entry];
        rank[i] = slotRank(distinct.tuples[i], offset);
    }

    result.table.vertexTuple.resize(distinct.vertexTuple.size());
    result.vertexRank.resize(distinct.vertexTuple.size());
    for (size_t v = 0; v < distinct.vertexTuple.size(); ++v) {
        result.table.vertexTuple[v] = index[distinct.vertexTuple[v]];
        result.vertexRank[v] = rank[distinct.vertexTuple[v]];
    }
    return result;
}

std::vector<uint16_t> tupleWords(const TupleTable& table, uint16_t fill) {
    std::vector<uint16_t> words;
    words.reserve(table.tuples.size() * table.influences);
    for (const JointTuple& tuple : table.tuples) {
        for (int i = 0; i < table.influences; ++i) words.push_back(tuple[i] == kNoJoint ? fill : tuple[i]);
    }
    return words;
}

uint32_t factorial(int n) {
    SKINBENCH_ASSERT(n >= 0 && n <= kMaxPermutation);
    uint32_t product = 1;
    for (int i = 2; i <= n; ++i) product *= static_cast<uint32_t>(i);
    return product;
}

uint32_t permutationRank(std::span<const uint8_t> permutation) {
    SKINBENCH_ASSERT(permutation.size() <= kMaxPermutation);
    uint32_t rank = 0;
    for (size_t i = 0; i < permutation.size(); ++i) {
        uint32_t smaller = 0;
        for (size_t j = i + 1; j < permutation.size(); ++j) smaller += permutation[j] < permutation[i];
        rank = rank * static_cast<uint32_t>(permutation.size() - i) + smaller;
    }
    return rank;
}

std::array<uint8_t, kMaxPermutation> permutationOfRank(uint32_t rank, int n) {
    SKINBENCH_ASSERT(n >= 0 && n <= kMaxPermutation);
    std::array<uint8_t, kMaxPermutation> result{};
    for (int i = n - 1; i >= 0; --i) {
        const uint32_t radix = static_cast<uint32_t>(n - i);
        result[i] = static_cast<uint8_t>(rank % radix);
        rank /= radix;
        for (int j = i + 1; j < n; ++j) result[j] += result[j] >= result[i];
    }
    return result;
}

}  // namespace skinbench
