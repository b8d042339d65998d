// Statistics of samples whose answers have a closed form.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "common/stats.h"

using namespace skinbench;
using Catch::Matchers::WithinRel;

static Summary of(std::vector<double> samples) { return summarise(samples); }

TEST_CASE("no sample and one sample") {
    const Summary none = of({});
    CHECK(none.mean == 0);
    CHECK(none.median == 0);
    CHECK(none.min == 0);
    CHECK(none.max == 0);
    CHECK(none.cv == 0);
    const Summary one = of({7.25});
    CHECK(one.mean == 7.25);
    CHECK(one.median == 7.25);
    CHECK(one.min == 7.25);
    CHECK(one.max == 7.25);
    CHECK(one.cv == 0);
}

TEST_CASE("the median of an odd count is the middle one, of an even count the mean of the middle two") {
    CHECK(of({9, 1, 5}).median == 5);
    CHECK(of({100, 1, 2, 3, 4}).median == 3);
    CHECK(of({4, 1}).median == 2.5);
    CHECK(of({10, 1, 2, 1000}).median == 6);
    CHECK(of({2, 2, 2, 5}).median == 2);
}

TEST_CASE("mean, extremes and coefficient of variation of known samples") {
    // Squared deviations from 5 sum to 32 over 8 samples.
    const Summary known = of({2, 4, 4, 4, 5, 5, 7, 9});
    CHECK(known.mean == 5);
    CHECK(known.median == 4.5);
    CHECK(known.min == 2);
    CHECK(known.max == 9);
    CHECK_THAT(known.cv, WithinRel(std::sqrt(32.0 / 7) / 5, 1e-14));
    // The sample variance of 1..n is n (n + 1) / 12.
    for (int n : {2, 3, 10, 1001}) {
        std::vector<double> run(static_cast<size_t>(n));
        std::iota(run.begin(), run.end(), 1.0);
        const Summary summary = summarise(run);
        CHECK_THAT(summary.mean, WithinRel((n + 1) / 2.0, 1e-14));
        CHECK_THAT(summary.median, WithinRel((n + 1) / 2.0, 1e-14));
        CHECK_THAT(summary.cv, WithinRel(std::sqrt(n * (n + 1) / 12.0) / ((n + 1) / 2.0), 1e-12));
    }
    CHECK(of({3, 3, 3, 3}).cv == 0);
}

TEST_CASE("a mean of zero has no coefficient of variation") {
    const Summary balanced = of({-1, 1});
    CHECK(balanced.mean == 0);
    CHECK(balanced.cv == 0);
}

TEST_CASE("order does not matter, and cv does not depend on the unit") {
    std::vector<double> samples = {1.5, 2.25, 8, 0.125, 3, 3, 64};
    const Summary first = summarise(samples);
    std::mt19937 random(5);
    for (int round = 0; round < 20; ++round) {
        std::ranges::shuffle(samples, random);
        const Summary again = summarise(samples);
        CHECK(again.mean == first.mean);
        CHECK(again.median == first.median);
        CHECK(again.cv == first.cv);
    }
    for (double& sample : samples) sample *= 1024;
    CHECK(summarise(samples).cv == first.cv);
    CHECK(summarise(samples).median == first.median * 1024);
}
