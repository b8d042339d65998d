#include "common/codecs/permutation.h"

#include <algorithm>
#include <cmath>
#include <format>
#include <limits>
#include <unordered_map>

#include "common/scene/tuples.h"

namespace skinbench {
namespace {

constexpr uint64_t kPayloads = 1ull << 32;
constexpr uint32_t kMaxValues = 65535;
constexpr uint32_t kMaxExtra = 16;

uint64_t largestCode(int bits) { return bits == 64 ? std::numeric_limits<uint64_t>::max() : (1ull << bits) - 1; }

// W^N * P <= 2^b, asked of the largest code so that nothing overflows.
bool fits(uint32_t values, int entries, uint64_t quotients, int bits) {
    const uint64_t limit = largestCode(bits);
    uint64_t code = quotients - 1;
    if (code > limit) return false;
    for (int i = 0; i < entries; ++i) {
        if (limit < values - 1 || code > (limit - (values - 1)) / values) return false;
        code = code * values + (values - 1);
    }
    return true;
}

// The most values a weight that fit; 0 for none.
uint32_t mostValues(int entries, uint64_t quotients, int bits) {
    uint32_t low = 0;
    uint32_t high = kMaxValues;
    while (low < high) {
        const uint32_t middle = (low + high + 1) / 2;
        if (fits(middle, entries, quotients, bits)) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return low;
}

uint64_t ceilDivide(uint64_t a, uint64_t b) { return (a + b - 1) / b; }

// Weight of the error of entry i in docs/codecs.md 4.5: 1 / ((N + 1 - i)(N - i)).
double errorShare(int entries, int i) { return 1.0 / ((entries + 1.0 - i) * (entries - i)); }

// Depth-first search over the non-decreasing extra counts. W depends on their product alone.
class Configurator {
public:
    Configurator(int entries, uint64_t tuples, int bits) : entries_(entries), tuples_(tuples), bits_(bits) {}

    PermutationCode search() {
        best_ = {entries_, bits_, 0, {}, tuples_, 0};
        extra_.fill(0);
        visit(0, 1, 0.0);
        return best_;
    }

private:
    uint32_t values(uint64_t product) {
        const auto [it, isNew] = values_.try_emplace(product, 0);
        if (isNew) it->second = mostValues(entries_, quotients(product), bits_);
        return it->second;
    }
    uint64_t quotients(uint64_t product) const { return ceilDivide(tuples_ * product, factorial(entries_)); }

    // No completion of extra_[0..depth) can cost less: every later count at most kMaxExtra, W at most today's.
    bool hopeless(int depth, uint64_t product, double sum) {
        const uint32_t w = values(product);
        if (w <= static_cast<uint32_t>(entries_)) return true;
        for (int i = depth; i < entries_; ++i) sum += errorShare(entries_, i) / (kMaxExtra * kMaxExtra);
        const double levels = w - entries_;
        return best_.values != 0 && sum / (levels * levels) > bestCost_ * (1 + 1e-12);
    }

    void visit(int depth, uint64_t product, double sum) {
        if (hopeless(depth, product, sum)) return;
        if (depth == entries_) {
            offer(product, sum);
            return;
        }
        for (uint32_t e = depth == 0 ? 1 : extra_[depth - 1]; e <= kMaxExtra; ++e) {
            uint64_t least = product;
            for (int i = depth; i < entries_ && least * tuples_ <= kPayloads; ++i) least *= e;
            if (least * tuples_ > kPayloads) break;
            extra_[depth] = e;
            visit(depth + 1, product * e, sum + errorShare(entries_, depth) / (double{1} * e * e));
        }
        extra_[depth] = 0;
    }

    void offer(uint64_t product, double sum) {
        const uint32_t w = values(product);
        const double levels = w - entries_;
        const double cost = sum / (levels * levels);
        if (best_.values != 0) {
            const bool tie = std::abs(cost - bestCost_) <= bestCost_ * 1e-12;
            if (tie && (product > bestProduct_ || (product == bestProduct_ && w <= best_.values))) return;
            if (!tie && cost > bestCost_) return;
        }
        bestCost_ = cost;
        bestProduct_ = product;
        best_.values = w;
        best_.extra = extra_;
        best_.quotients = quotients(product);
    }

    int entries_;
    uint64_t tuples_;
    int bits_;
    std::array<uint32_t, kMaxEntries> extra_{};
    std::unordered_map<uint64_t, uint32_t> values_;
    PermutationCode best_;
    double bestCost_ = 0;
    uint64_t bestProduct_ = 0;
};

// Truncation that maps NaN and everything below 0 to 0 and everything above `most` to `most`.
uint64_t truncateTo(float x, uint64_t most) {
    if (!(x > 0)) return 0;
    if (x >= static_cast<float>(most)) return most;
    return std::min(static_cast<uint64_t>(x), most);
}

// Whether the code and all that it is made of stay below 2^32, where a division takes a fraction of the time.
bool isNarrow(const PermutationCode& code) {
    return code.bits <= 32 && code.quotients * factorial(code.entries) <= largestCode(32) &&
           (uint64_t{code.values} + 1) * code.extra[code.entries - 1] <= largestCode(32);
}

template <class Word>
uint64_t encodeWith(const PermutationCode& code, std::span<const float> ascending, uint32_t tuple) {
    const int n = code.entries;
    std::array<Word, kMaxEntries> quotient{};
    Word payload = tuple;
    float pre = 0;
    for (int i = 0; i < n; ++i) {
        const Word extra = code.extra[i];
        // Strict: every operation below is rounded to float on its own.
        const float product = static_cast<float>(n + 1 - i) * ascending[i];
        const float c = product + pre;
        pre = pre + ascending[i];
        const float scaled = static_cast<float>(code.levels(i)) * c;
        const float shifted = scaled + (static_cast<float>(code.offset(i)) + 0.5f);
        Word m = static_cast<Word>(truncateTo(shifted, code.levels(i) + code.offset(i)));
        if (i > 0) m = std::max(m, (quotient[i - 1] + 1) * extra);  // equal weights on a half step: docs/codecs.md 4.6
        m = std::max(m, static_cast<Word>(code.offset(i)));         // below only for weights out of range
        quotient[i] = m / extra;
        payload = payload * extra + m % extra;
    }

    const uint32_t orders = factorial(n);
    const auto place = permutationOfRank(static_cast<uint32_t>(payload % orders), n);
    std::array<Word, kMaxEntries> stored{};
    for (int i = 0; i < n; ++i) stored[place[i]] = quotient[i];
    Word value = payload / orders;
    for (int p = 0; p < n; ++p) value = value * Word{code.values} + stored[p];
    return value;
}

template <class Word>
Result<PermutationBlend> decodeWith(const PermutationCode& code, uint64_t value) {
    const int n = code.entries;
    const auto fault = [value](const char* what) {
        return inputError(std::format("permutation code {:#x}: {}; encode the mesh again", value, what));
    };
    std::array<uint32_t, kMaxEntries> stored{};
    Word rest = static_cast<Word>(value);
    for (int p = n - 1; p >= 0; --p) {
        stored[p] = static_cast<uint32_t>(rest % Word{code.values});
        rest /= code.values;
    }
    if (rest >= code.quotients) return fault("the quotient is out of range");

    std::array<uint8_t, kMaxEntries> order{};
    for (int i = 0; i < n; ++i) order[i] = static_cast<uint8_t>(i);
    std::sort(order.begin(), order.begin() + n, [&](uint8_t a, uint8_t b) { return stored[a] < stored[b]; });
    for (int i = 1; i < n; ++i) {
        if (stored[order[i]] == stored[order[i - 1]]) return fault("two entries are equal");
    }

    Word payload = rest * factorial(n) + permutationRank({order.data(), static_cast<size_t>(n)});
    std::array<Word, kMaxEntries> remainder{};
    for (int i = n - 1; i >= 0; --i) {
        remainder[i] = payload % code.extra[i];
        payload /= code.extra[i];
    }
    if (payload >= kPayloads) return fault("the tuple is out of range");
    PermutationBlend blend;
    blend.tuple = static_cast<uint32_t>(payload);
    float pre = 0;
    for (int i = 0; i < n; ++i) {
        const uint64_t raised = stored[order[i]] * uint64_t{code.extra[i]} + remainder[i];
        if (raised < code.offset(i) || raised - code.offset(i) > code.levels(i))
            return fault("a level is out of range");
        const float c = static_cast<float>(raised - code.offset(i)) / static_cast<float>(code.levels(i));
        const float count = static_cast<float>(n + 1 - i);
        blend.weights[i] = c / count - pre;
        pre = pre + c / (count * static_cast<float>(n - i));
    }
    blend.weights[n] = 1.0f - pre;
    return blend;
}

}  // namespace

Result<PermutationCode> makePermutationCode(std::span<const uint32_t> extra, uint32_t values, uint64_t tuples,
                                            int bits) {
    const std::string place = std::format("permutation code of {} entries, {} values, {} tuples, {} bits", extra.size(),
                                          values, tuples, bits);
    if (extra.empty() || extra.size() > kMaxEntries) return inputError(place + ": entries must be 1 to 12");
    if (bits < 1 || bits > 64) return inputError(place + ": bits must be 1 to 64");
    if (values <= extra.size() || values > kMaxValues) {
        return inputError(place + ": values must exceed the entries and stay below 65536");
    }
    if (tuples < 1 || tuples > kPayloads) return inputError(place + ": tuples must be 1 to 2^32");
    PermutationCode code{static_cast<int>(extra.size()), bits, values, {}, tuples, 0};
    uint64_t payloads = tuples;
    for (size_t i = 0; i < extra.size(); ++i) {
        if (extra[i] < 1 || (i > 0 && extra[i] < extra[i - 1])) {
            return inputError(place + ": extra counts must be 1 or more and must not decrease");
        }
        if (extra[i] > kPayloads / payloads) {
            return inputError(place + ": the tuples times all extra counts must not exceed 2^32");
        }
        payloads *= extra[i];
        code.extra[i] = extra[i];
    }
    code.quotients = ceilDivide(payloads, factorial(code.entries));
    if (!fits(values, code.entries, code.quotients, bits)) return inputError(place + ": the codes need more bits");
    return code;
}

Result<PermutationCode> configurePermutation(int influences, uint64_t tuples, int bits) {
    const std::string place =
        std::format("permutation code of {} influences, {} tuples, {} bits", influences, tuples, bits);
    if (influences < 2 || influences > kMaxEntries + 1) return inputError(place + ": influences must be 2 to 13");
    if (tuples < 1 || tuples > kPayloads) return inputError(place + ": tuples must be 1 to 2^32");
    if (bits < 1 || bits > 64) return inputError(place + ": bits must be 1 to 64");
    const PermutationCode best = Configurator(influences - 1, tuples, bits).search();
    if (best.values == 0) return inputError(place + ": no weights fit, use more bits or fewer tuples");
    return best;
}

uint64_t encodePermutation(const PermutationCode& code, std::span<const float> ascending, uint32_t tuple) {
    SKINBENCH_ASSERT(code.entries >= 1 && code.entries <= kMaxEntries &&
                     ascending.size() >= static_cast<size_t>(code.entries));
    return isNarrow(code) && tuple < code.tuples ? encodeWith<uint32_t>(code, ascending, tuple)
                                                 : encodeWith<uint64_t>(code, ascending, tuple);
}

Result<PermutationBlend> decodePermutation(const PermutationCode& code, uint64_t value) {
    SKINBENCH_ASSERT(code.entries >= 1 && code.entries <= kMaxEntries &&
                     code.values > static_cast<uint32_t>(code.entries));
    return isNarrow(code) && value <= largestCode(32) ? decodeWith<uint32_t>(code, value)
                                                      : decodeWith<uint64_t>(code, value);
}

double worstErrorLength(const PermutationCode& code) {
    double sum = 0;
    for (int i = 0; i < code.entries; ++i) {
        const double half = 0.5 / static_cast<double>(code.levels(i));
        sum += half * half * errorShare(code.entries, i);
    }
    return std::sqrt(sum);
}

double worstErrorSingle(const PermutationCode& code) {
    double sum = 0;
    for (int i = 0; i < code.entries; ++i) {
        sum += 0.5 / static_cast<double>(code.levels(i)) * errorShare(code.entries, i);
    }
    return sum;
}

}  // namespace skinbench
