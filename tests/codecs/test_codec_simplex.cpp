#include <cmath>
#include <limits>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include "common/codecs/simplex.h"
#include "tests/codec_test.h"

using namespace skinbench;
using namespace skinbench::test;
using Catch::Approx;

namespace {

glm::vec4 randomWeights(Random& random) {
    std::array<double, 4> w;
    double sum = 0;
    for (double& x : w) sum += x = -std::log(1 - random.unit());
    std::sort(w.begin(), w.end(), std::greater<>());
    return {w[0] / sum, w[1] / sum, w[2] / sum, w[3] / sum};
}

}  // namespace

TEST_CASE("grid sizes") {
    const SimplexCode& code = simplexCode16();
    CHECK(code.n == 104);
    CHECK(code.count == 65231);
    CHECK(code.step == 0.0048543689320388345);
    struct Row {
        int bits;
        uint64_t n;
    };
    for (const Row row : {Row{1, 2}, {17, 131}, {18, 166}, {19, 209}, {20, 264}, {22, 421}}) {
        CHECK(makeSimplexCode(row.bits)->n == row.n);
    }
    CHECK(makeSimplexCode(22)->count == 4189921);
    for (int bits = 1; bits <= kMaxSimplexBits; ++bits) {
        CAPTURE(bits);
        const SimplexCode c = *makeSimplexCode(bits);
        const auto exact = [](double n) { return (n + 1) * (n + 1) * (2 * n + 5) / 36; };
        CHECK(c.count <= uint64_t{1} << bits);
        CHECK(std::abs(exact(static_cast<double>(c.n)) - static_cast<double>(c.count)) <= 0.5 + 1e-3 * (bits > 40));
        CHECK(exact(static_cast<double>(c.n) + 1) > std::ldexp(1.0, bits));
        if (bits <= kMaxSimplexBits32) CHECK(c.n <= 1288);
    }
    CHECK_FALSE(makeSimplexCode(0).has_value());
    CHECK_FALSE(makeSimplexCode(kMaxSimplexBits + 1).has_value());
}

// The specification's order, enumerated: k outermost, then j, then i.
TEST_CASE("every code of every grid up to 22 bits, in both precisions") {
    for (int bits = 1; bits <= 22; ++bits) {
        const SimplexCode code = *makeSimplexCode(bits);
        uint64_t expected = 0;
        uint64_t wrong = 0;
        for (uint64_t k = 0; 4 * k <= 2 * (code.n - 1); ++k) {
            for (uint64_t j = 0; 3 * j + 4 * k <= 2 * (code.n - 1); ++j) {
                for (uint64_t i = 0; 2 * i + 3 * j + 4 * k <= 2 * (code.n - 1); ++i, ++expected) {
                    const SimplexPoint point{i, j, k};
                    wrong += encodeSimplexPoint(code, point) != expected;
                    wrong += *decodeSimplexPoint(code, expected) != point;
                    wrong += decodeSimplexPoint32(code, static_cast<uint32_t>(expected)) != point;
                    if (bits == 16 || bits == 22) wrong += encodeSimplex(code, simplexWeights(code, point)) != expected;
                }
            }
        }
        CAPTURE(bits);
        CHECK(wrong == 0);
        CHECK(expected == code.count);
        CHECK_FALSE(decodeSimplexPoint(code, code.count).has_value());
        CHECK_FALSE(decodeSimplexPoint(code, UINT64_MAX).has_value());
    }
}

TEST_CASE("larger grids decode what they encode, also at the seams of layers") {
    Random random(31);
    for (int bits = 23; bits <= kMaxSimplexBits; ++bits) {
        CAPTURE(bits);
        const SimplexCode code = *makeSimplexCode(bits);
        uint64_t wrong = 0;
        const auto check = [&](SimplexPoint p) {
            const uint64_t value = encodeSimplexPoint(code, p);
            wrong += value >= code.count || *decodeSimplexPoint(code, value) != p;
            if (bits <= kMaxSimplexBits32) wrong += decodeSimplexPoint32(code, static_cast<uint32_t>(value)) != p;
            const auto weights = decodeSimplex(code, value);
            wrong += !weights || !((*weights)[3] >= 0);
        };
        for (int r = 0; r < 20'000; ++r) {
            const uint64_t k = random.next() % ((code.n - 1) / 2 + 1);
            const uint64_t m = code.n - 2 * k;
            const uint64_t j = random.next() % ((2 * m - 2) / 3 + 1);
            const uint64_t last = m - (3 * j + 1) / 2 - 1;
            check({0, j, k});
            check({last, j, k});
            check({random.next() % (last + 1), j, k});
            check({0, 0, k});
            check({0, (2 * m - 2) / 3, k});
        }
        CHECK(wrong == 0);
        CHECK(*decodeSimplexPoint(code, 0) == SimplexPoint{0, 0, 0});
    }
}

TEST_CASE("quality at 16 bits") {
    Random random(32);
    double sum = 0;
    double most = 0;
    glm::dvec4 single(0);
    constexpr int kSamples = 1'000'000;
    for (int s = 0; s < kSamples; ++s) {
        const glm::vec4 w = randomWeights(random);
        const glm::dvec4 d =
            glm::dvec4(*decodeSimplex(simplexCode16(), encodeSimplex(simplexCode16(), w))) - glm::dvec4(w);
        sum += glm::length(d);
        most = std::max(most, glm::length(d));
        single = glm::max(single, glm::abs(d));
    }
    CHECK(sum / kSamples == Approx(3.20e-3).epsilon(0.005));
    CHECK(most <= 8.38e-3);
    CHECK(most > 7.5e-3);
    // w4: half a step. w3: where w4 was rounded up, (w3 - grid) / step reaches (0.5 + 2) / 3.
    const double limits[] = {7.26e-3, 4.82e-3, 2.5 / 3 * simplexCode16().step + 1e-6, simplexCode16().step / 2 + 1e-6};
    for (int i = 0; i < 4; ++i) CHECK(single[i] <= limits[i]);
}

TEST_CASE("finer grids are more exact") {
    double last = 1;
    for (const int bits : {4, 10, 16, 22, 28, 34, 40}) {
        Random random(33);
        const SimplexCode code = *makeSimplexCode(bits);
        double most = 0;
        for (int s = 0; s < 5000; ++s) {
            const glm::vec4 w = randomWeights(random);
            most = std::max<double>(most, glm::distance(*decodeSimplex(code, encodeSimplex(code, w)), w));
        }
        CHECK(most < 1.8 * code.step + 3e-7);
        CHECK(most < last);
        last = most;
    }
}

TEST_CASE("corners of the simplex") {
    const SimplexCode& code = simplexCode16();
    CHECK(encodeSimplex(code, {1, 0, 0, 0}) == 0);
    CHECK(encodeSimplex(code, {0.5f, 0.5f, 0, 0}) == 103);
    CHECK(encodeSimplex(code, {0.25f, 0.25f, 0.25f, 0.25f}) == 65230);
    CHECK(*decodeSimplex(code, 0) == glm::vec4(1, 0, 0, 0));
    CHECK(*decodeSimplex(code, 103) == glm::vec4(0.5f, 0.5f, 0, 0));
    for (uint32_t value = code.count; value < 65536; ++value) CHECK_FALSE(decodeSimplex(code, value).has_value());
}

TEST_CASE("weights out of range give a valid code") {
    Random random(34);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    const float strange[] = {nan, infinite, -infinite, -1, 0, 1, 2, 1e30f, 0.3f};
    for (const int bits : {1, 2, 16, 26, 48}) {
        const SimplexCode code = *makeSimplexCode(bits);
        for (int r = 0; r < 5000; ++r) {
            glm::vec4 w;
            for (int i = 0; i < 4; ++i) w[i] = strange[random.below(std::size(strange))];
            REQUIRE(encodeSimplex(code, w) < code.count);
        }
    }
}
