#include <cfloat>
#include <cmath>
#include <limits>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include "common/codecs/permutation.h"
#include "tests/codec_test.h"

using namespace skinbench;
using namespace skinbench::test;
using Catch::Approx;

namespace {

// Ascending, uniform on the simplex of n + 1 weights, some of them zero or equal.
std::vector<float> randomWeights(Random& random, int n) {
    std::vector<double> w(n + 1);
    const uint32_t shape = random.below(4);
    for (double& x : w) x = -std::log(1 - random.unit());
    if (shape == 1) w[0] = 0;
    if (shape == 2) w[n] = w[n / 2];
    if (shape == 3) w[random.below(n + 1)] *= 100;
    std::sort(w.begin(), w.end());
    double sum = 0;
    for (const double x : w) sum += x;
    std::vector<float> result;
    for (const double x : w) result.push_back(static_cast<float>(x / sum));
    return result;
}

struct Errors {
    double length = 0;
    double single = 0;
};

Errors errorOf(const std::vector<float>& weights, const PermutationBlend& blend) {
    Errors e;
    for (size_t i = 0; i < weights.size(); ++i) {
        const double d = double{blend.weights[i]} - weights[i];
        e.length += d * d;
        e.single = std::max(e.single, std::abs(d));
    }
    e.length = std::sqrt(e.length);
    return e;
}

void checkRoundTrips(const PermutationCode& code, uint64_t seed, int rounds) {
    Random random(seed);
    const double length = worstErrorLength(code) + 1e-6;
    const double single = worstErrorSingle(code) + 1e-6;
    const uint64_t limit = code.bits == 64 ? UINT64_MAX : (1ull << code.bits) - 1;
    uint32_t wrong = 0;
    for (int r = 0; r < rounds; ++r) {
        const std::vector<float> w = randomWeights(random, code.entries);
        const uint32_t tuple =
            r == 0 ? static_cast<uint32_t>(code.tuples - 1) : static_cast<uint32_t>(random.next() % code.tuples);
        const uint64_t value = encodePermutation(code, w, tuple);
        const auto blend = decodePermutation(code, value);
        if (!blend || blend->tuple != tuple || value > limit) {
            ++wrong;
            continue;
        }
        const Errors e = errorOf(w, *blend);
        wrong += e.length > length || e.single > single;
        // Entries of different E lie on different grids: neighbours may swap by their rounding errors.
        for (int i = 0; i < code.entries; ++i) {
            wrong += blend->weights[i] < (code.entries <= 3 ? -1e-7 : -single);
            wrong += blend->weights[i] > blend->weights[i + 1] + 2 * single;
        }
        if (w[0] == 0) wrong += blend->weights[0] != 0;
    }
    CHECK(wrong == 0);
}

// encode with every product contracted into the addition behind it, as a compiler with -ffp-contract=fast would.
uint64_t encodeContracted(const PermutationCode& code, const std::vector<float>& w, uint32_t tuple) {
    std::vector<float> moved(w);
    uint64_t payload = tuple, last = 0;
    std::vector<uint64_t> q;
    float pre = 0;
    for (int i = 0; i < code.entries; ++i) {
        const float c = std::fma(static_cast<float>(code.entries + 1 - i), w[i], pre);
        pre += w[i];
        const float x = std::fma(static_cast<float>(code.levels(i)), c, static_cast<float>(code.offset(i)) + 0.5f);
        uint64_t m = std::min(static_cast<uint64_t>(x), code.levels(i) + code.offset(i));
        if (i > 0) m = std::max(m, (last + 1) * code.extra[i]);
        last = m / code.extra[i];
        q.push_back(last);
        payload = payload * code.extra[i] + m % code.extra[i];
    }
    // Three entries: the six orders written out.
    static constexpr uint8_t kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    uint64_t s[3];
    for (int i = 0; i < 3; ++i) s[kOrders[payload % 6][i]] = q[i];
    uint64_t value = payload / 6;
    for (const uint64_t x : s) value = value * code.values + x;
    return value;
}

}  // namespace

TEST_CASE("worked examples of the specification") {
    const std::vector<float> w{0.04f, 0.13f, 0.31f, 0.52f};
    CHECK(encodePermutation(kPermutationPc, w, 12347) == 0x2FDC63F1);
    CHECK(encodePermutation(kPermutationDpdc16, w, 12347) == 0x0B7216A1);
    const auto blend = decodePermutation(kPermutationPc, 802972657);
    REQUIRE(blend.has_value());
    CHECK(blend->tuple == 12347);
    const double expected[] = {0.0409091, 0.1318182, 0.3090909, 0.5181818};
    for (int i = 0; i < 4; ++i) CHECK(blend->weights[i] == Approx(expected[i]).margin(1e-7));
    const std::vector<float> rigid{0, 0, 0, 1};
    CHECK(encodePermutation(kPermutationPc, rigid, 0) == 117);
    CHECK(encodePermutation(kPermutationPc, rigid, 65535) == 4262221757);
    CHECK(decodePermutation(kPermutationPc, 117)->weights[3] == 1);
    CHECK(decodePermutation(kPermutationPc, 117)->weights[2] == 0);
}

TEST_CASE("the named codes are what the constraints give") {
    struct Row {
        PermutationCode code;
        std::array<uint64_t, 3> levels;
        double length, single;
    };
    for (const Row& row : {Row{kPermutationPc, {55, 55, 110}, 5.567e-3, 4.545e-3},
                           {kPermutationDpdc16, {33, 33, 66}, 9.278e-3, 7.576e-3},
                           {kPermutationDpdc16Text, {26, 26, 52}, 1.178e-2, 9.62e-3}}) {
        const PermutationCode& c = row.code;
        const auto made = makePermutationCode(std::span(c.extra).first(c.entries), c.values, c.tuples, c.bits);
        REQUIRE(made.has_value());
        CHECK(*made == c);
        for (int i = 0; i < 3; ++i) CHECK(c.levels(i) == row.levels[i]);
        CHECK(worstErrorLength(c) == Approx(row.length).epsilon(1e-3));
        CHECK(worstErrorSingle(c) == Approx(row.single).epsilon(1e-3));
        CHECK_FALSE(
            makePermutationCode(std::span(c.extra).first(c.entries), c.values + 1, c.tuples, c.bits).has_value());
    }
    const std::array<uint32_t, 3> extra{1, 1, 2};
    CHECK(*makePermutationCode(extra, 32, 393216, 32) == kPermutationDpdc16Mixed);  // exactly 2^32 codes
    CHECK_FALSE(makePermutationCode(extra, 33, 393216, 32).has_value());
}

TEST_CASE("configurator check values") {
    struct Row {
        int influences;
        uint64_t tuples;
        int bits;
        uint32_t values;
        std::vector<uint32_t> extra;
        uint64_t quotients;
    };
    for (const Row& row : {Row{4, 65536, 32, 58, {1, 1, 2}, 21846},
                           {4, 262144, 32, 36, {1, 1, 2}, 87382},
                           {4, 393216, 32, 32, {1, 1, 2}, 131072},
                           {4, 4096, 24, 23, {1, 1, 2}, 1366},
                           {4, 256, 24, 57, {1, 1, 2}, 86},
                           {4, 128, 16, 11, {1, 1, 2}, 43},
                           {4, 1, 16, 40, {1, 2, 3}, 1},
                           {8, 4096, 64, 324, {1, 1, 1, 2, 2, 3, 5}, 49},
                           {8, 65536, 64, 218, {1, 1, 1, 2, 2, 3, 5}, 781},
                           {8, 4096, 48, 83, {1, 1, 1, 1, 2, 2, 3}, 10},
                           {8, 512, 32, 23, {1, 1, 1, 1, 1, 2, 4}, 1},
                           {6, 4096, 48, 267, {1, 1, 1, 2, 3}, 205}}) {
        CAPTURE(row.influences, row.tuples, row.bits);
        const auto code = configurePermutation(row.influences, row.tuples, row.bits);
        REQUIRE(code.has_value());
        CHECK(code->values == row.values);
        CHECK(std::equal(row.extra.begin(), row.extra.end(), code->extra.begin()));
        CHECK(code->quotients == row.quotients);
        checkRoundTrips(*code, 1, 2000);
    }
}

TEST_CASE("every entry count and bit budget that fits round-trips") {
    uint32_t made = 0;
    for (int influences = 2; influences <= 13; ++influences) {
        for (const int bits : {8, 13, 16, 24, 31, 32, 33, 40, 48, 63, 64}) {
            for (const uint64_t tuples : {1ull, 100ull, 65536ull, 1ull << 32}) {
                const auto code = configurePermutation(influences, tuples, bits);
                if (!code) continue;
                CAPTURE(influences, bits, tuples, code->values);
                const auto again =
                    makePermutationCode(std::span(code->extra).first(code->entries), code->values, tuples, bits);
                CHECK((again.has_value() && *again == *code));
                checkRoundTrips(*code, 1000 * influences + bits, 100);
                ++made;
            }
        }
    }
    CHECK(made > 250);
}

TEST_CASE("named codes round-trip within the bounds") {
    checkRoundTrips(kPermutationPc, 2, 200'000);
    checkRoundTrips(kPermutationDpdc16, 3, 200'000);
    checkRoundTrips(kPermutationDpdc16Text, 4, 50'000);
    checkRoundTrips(kPermutationDpdc16Mixed, 5, 50'000);
}

TEST_CASE("mean error of the two thesis codes, uniform on the simplex") {
    for (const auto& [code, expected] : {std::pair{kPermutationPc, 3.08e-3}, {kPermutationDpdc16, 5.13e-3}}) {
        Random random(6);
        double sum = 0;
        constexpr int kSamples = 200'000;
        for (int s = 0; s < kSamples; ++s) {
            std::vector<double> e(4);
            double total = 0;
            for (double& x : e) total += x = -std::log(1 - random.unit());
            std::sort(e.begin(), e.end());
            std::vector<float> w;
            for (const double x : e) w.push_back(static_cast<float>(x / total));
            sum += errorOf(w, *decodePermutation(code, encodePermutation(code, w, random.below(65536)))).length;
        }
        CHECK(sum / kSamples == Approx(expected).epsilon(0.01));
    }
}

TEST_CASE("equal weights on a half step keep the tuple") {
    // Two neighbouring entries of the same E whose c lies next to (level + 1/2) / V.
    Random random(8);
    for (const std::vector<uint32_t>& extra :
         {std::vector<uint32_t>{1, 1, 1}, {1, 1, 2}, {1, 1, 1, 3}, {1, 1, 1, 1, 1, 2, 4}}) {
        const int n = static_cast<int>(extra.size());
        const auto code = makePermutationCode(extra, n == 7 ? 18 : 40, 256, n == 7 ? 64 : 40);
        REQUIRE(code.has_value());
        uint32_t wrong = 0;
        for (int r = 0; r < 100'000; ++r) {
            const int first = 1 + static_cast<int>(random.below(n - 1));
            const double c = (random.below(static_cast<uint32_t>(code->levels(first))) + 0.5) / code->levels(first);
            const float x =
                static_cast<float>(c / (n + 1 - first)) + (static_cast<float>(random.below(3)) - 1) * FLT_EPSILON / 16;
            std::vector<float> w(n, 0.0f);
            for (int i = first; i < n; ++i) w[i] = x;
            const auto blend = decodePermutation(*code, encodePermutation(*code, w, r & 255));
            wrong += !blend || blend->tuple != static_cast<uint32_t>(r & 255);
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("weights out of range never damage the tuple") {
    Random random(10);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    const float strange[] = {nan, infinite, -infinite, -1, 0, 1, 2, 1e30f, -1e-30f, FLT_MAX, FLT_TRUE_MIN, 0.25f};
    for (const PermutationCode& code : {kPermutationPc, kPermutationDpdc16, *configurePermutation(8, 4096, 64)}) {
        uint32_t wrong = 0;
        for (int r = 0; r < 20'000; ++r) {
            std::vector<float> w;
            for (int i = 0; i <= code.entries; ++i) w.push_back(strange[random.below(std::size(strange))]);
            const uint32_t tuple = random.below(4096);
            const auto blend = decodePermutation(code, encodePermutation(code, w, tuple));
            wrong += !blend || blend->tuple != tuple;
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("any word decodes to a blend or an error, and what decodes encodes back") {
    Random random(13);
    uint32_t valid = 0;
    for (int r = 0; r < 200'000; ++r) {
        const uint32_t word = static_cast<uint32_t>(random.next());
        const auto blend = decodePermutation(kPermutationPc, word);
        if (!blend) continue;
        ++valid;
        float sum = 0;
        for (int i = 0; i < 4; ++i) sum += blend->weights[i];
        CHECK(std::abs(sum - 1) < 1e-6f);
        const std::span<const float> weights(blend->weights.data(), 4);
        if (std::is_sorted(weights.begin(), weights.end()) &&
            encodePermutation(kPermutationPc, weights, blend->tuple) != word) {
            FAIL_CHECK("code " << word << " changes");
        }
    }
    CHECK(valid > 100'000);
    const auto fault = [](uint64_t value) {
        const auto blend = decodePermutation(kPermutationPc, value);
        return blend ? std::string("none") : blend.error().text;
    };
    CHECK(fault(0).find("equal") != std::string::npos);
    CHECK(fault(21846ull * 58 * 58 * 58).find("quotient") != std::string::npos);
    CHECK(fault(UINT64_MAX).find("quotient") != std::string::npos);
    CHECK(fault(1 * 58 + 1).find("equal") != std::string::npos);
    CHECK(fault(0 * 58 * 58 + 56 * 58 + 57).find("level") == std::string::npos);
    CHECK(fault(1 * 58 * 58 + 2 * 58 + 0).find("level") != std::string::npos);  // x = 0 of entry 2: level 2*2+0-5 < 0
}

TEST_CASE("parameters out of range are named") {
    const auto fault = [](std::vector<uint32_t> extra, uint32_t values, uint64_t tuples, int bits) {
        const auto code = makePermutationCode(extra, values, tuples, bits);
        REQUIRE_FALSE(code.has_value());
        return code.error().text;
    };
    CHECK(fault({}, 8, 1, 32).find("entries") != std::string::npos);
    CHECK(fault(std::vector<uint32_t>(13, 1), 20, 1, 64).find("entries") != std::string::npos);
    CHECK(fault({1, 1, 2}, 3, 1, 32).find("values") != std::string::npos);
    CHECK(fault({1}, 65536, 1, 32).find("values") != std::string::npos);
    CHECK(fault({1, 1, 2}, 8, 0, 32).find("tuples") != std::string::npos);
    CHECK(fault({1, 1, 2}, 8, 1ull << 33, 32).find("tuples") != std::string::npos);
    CHECK(fault({1, 1, 2}, 8, 1ull << 32, 64).find("2^32") != std::string::npos);
    CHECK(fault({2, 1}, 8, 1, 32).find("decrease") != std::string::npos);
    CHECK(fault({0, 1}, 8, 1, 32).find("extra") != std::string::npos);
    CHECK(fault({1, 1, 2}, 8, 1, 65).find("bits") != std::string::npos);
    CHECK(fault({1, 1, 2}, 8, 1, 0).find("bits") != std::string::npos);
    CHECK(fault({1, 1, 2}, 59, 65536, 32).find("more bits") != std::string::npos);
    CHECK_FALSE(configurePermutation(1, 1, 32).has_value());
    CHECK_FALSE(configurePermutation(14, 1, 64).has_value());
    CHECK_FALSE(configurePermutation(4, 0, 32).has_value());
    CHECK_FALSE(configurePermutation(4, 65536, 16).has_value());
    CHECK_FALSE(configurePermutation(4, 1, 65).has_value());
    // 2^64 codes exactly, and one more value would not fit.
    CHECK(makePermutationCode(std::vector<uint32_t>(8, 1), 256, 40320, 64).has_value());
    CHECK_FALSE(makePermutationCode(std::vector<uint32_t>(8, 1), 257, 40320, 64).has_value());
}

TEST_CASE("float arithmetic is not contracted") {
    // Here: a * a - (1 + 2^-11) is 0 when the product is rounded and 2^-24 when it is fused.
    volatile float a = 1 + 0x1p-12f;
    volatile float b = -(1 + 0x1p-11f);
    const float x = a, y = b;
    CHECK(x * x + y == 0.0f);
    CHECK(std::fma(x, x, y) == 0x1p-24f);

    // In the library: inputs on which a contracted encoder gives another code.
    Random random(14);
    uint32_t differing = 0;
    for (int r = 0; r < 400'000 && differing < 20; ++r) {
        const double c = (random.below(54) + 0.5) / 55;
        std::vector<float> w{0, static_cast<float>(c / 3), 0, 0};
        w[0] = static_cast<float>(random.unit() * w[1]);
        w[1] = static_cast<float>((c - w[0]) / 3);
        w[2] = std::max(w[1], (1 - w[0] - w[1]) / 2 - 0.01f);
        if (w[0] > w[1] || w[0] + w[1] + w[2] > 1) continue;
        // Strict, in double with explicit rounding: contraction cannot touch it, the products are exact.
        const auto strict = [&](int i, float pre) {
            const float product = static_cast<float>(double{4.0 - i} * w[i]);
            const float moved = static_cast<float>(double{product} + pre);
            const float scaled = static_cast<float>(double(kPermutationPc.levels(i)) * moved);
            return static_cast<uint64_t>(static_cast<float>(double{scaled} + (double(kPermutationPc.offset(i)) + 0.5)));
        };
        const float pre2 = static_cast<float>(double{w[0]} + w[1]);
        const uint64_t m[3] = {strict(0, 0), strict(1, w[0]), strict(2, pre2)};
        const uint64_t payload = m[2] % 2;  // tuple 0: rank 0 or 1
        const uint64_t q2 = m[2] / 2;
        const uint64_t expected = payload == 0 ? (m[0] * 58 + m[1]) * 58 + q2 : (m[0] * 58 + q2) * 58 + m[1];
        const uint64_t contracted = encodeContracted(kPermutationPc, w, 0);
        if (contracted == expected) continue;
        ++differing;
        CHECK(encodePermutation(kPermutationPc, w, 0) == expected);
    }
    CHECK(differing == 20);
}
