// Statistics of samples whose answers have a closed form.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "common/core/stats.h"

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

// --- quantiles, intervals, outliers, drift ------------------------------------------------------------------------

TEST_CASE("quantiles interpolate between neighbours") {
    const std::vector<double> samples = {40, 10, 30, 20};
    CHECK(quantile(samples, 0) == 10);
    CHECK(quantile(samples, 1) == 40);
    CHECK_THAT(quantile(samples, 0.5), WithinRel(25.0, 1e-12));
    CHECK_THAT(quantile(samples, 0.95), WithinRel(38.5, 1e-12));
    CHECK(quantile({}, 0.5) == 0);
    std::vector<double> hundred(101);
    std::iota(hundred.begin(), hundred.end(), 0.0);
    CHECK_THAT(summarise(hundred).p95, WithinRel(95.0, 1e-12));
}

TEST_CASE("the interval of a median") {
    SECTION("no samples, one sample, equal samples") {
        CHECK(medianInterval({}, {}) == Interval{});
        CHECK(medianInterval(std::vector<double>{3}, std::vector<size_t>{1}) == Interval{3, 3});
        CHECK(medianInterval(std::vector<double>(40, 2.5), std::vector<size_t>{20, 20}) == Interval{2.5, 2.5});
    }
    SECTION("the same samples give the same interval") {
        const std::vector<double> samples = {1, 5, 2, 8, 3, 9, 4};
        CHECK(medianInterval(samples, std::vector<size_t>{4, 3}) == medianInterval(samples, std::vector<size_t>{4, 3}));
    }
    SECTION("of normal samples it has the width of theory, 2 x 1.96 x 1.2533 sigma / sqrt(n)") {
        std::mt19937 random(7);
        std::normal_distribution<double> normal(100, 2);
        std::vector<double> samples(2000);
        for (double& sample : samples) sample = normal(random);
        const Interval interval = medianInterval(samples, std::vector<size_t>{2000});
        const double theory = 2 * 1.96 * 1.2533 * 2 / std::sqrt(2000.0);
        CHECK(interval.low < 100.2);
        CHECK(interval.high > 99.8);
        CHECK_THAT(interval.high - interval.low, WithinRel(theory, 0.25));
        const Interval wider = medianInterval(samples, std::vector<size_t>{2000}, 0.995);
        CHECK_THAT(wider.high - wider.low, WithinRel(theory * 2.81 / 1.96, 0.25));
    }
    SECTION("it holds the true median about as often as it says") {
        std::mt19937 random(11);
        std::exponential_distribution<double> exponential(1);
        int holds = 0;
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<double> samples(60);
            for (double& sample : samples) sample = exponential(random);
            const Interval interval = medianInterval(samples, std::vector<size_t>{60});
            holds += interval.low <= std::log(2.0) && std::log(2.0) <= interval.high;
        }
        CHECK(holds >= 180);
        CHECK(holds < 200);
    }
    SECTION("equal cases are seldom told apart by the self-test's rounds and level, even if rounds differ") {
        std::mt19937 random(13);
        std::normal_distribution<double> ofRound(0, 1), ofFrame(0, 0.2);
        const std::vector<size_t> rounds(8, 4);
        auto interval = [&] {
            std::vector<double> samples;
            for (size_t round : rounds) {
                const double shared = ofRound(random);
                for (size_t i = 0; i < round; ++i) samples.push_back(shared + ofFrame(random));
            }
            return medianInterval(samples, rounds, 0.995);
        };
        int apart = 0;
        for (int trial = 0; trial < 1000; ++trial) {
            const Interval a = interval(), b = interval();
            apart += a.high < b.low || b.high < a.low;
        }
        CHECK(apart <= 5);
    }
    SECTION("rounds that lie apart widen it to their medians, whatever the samples of each round say") {
        std::vector<double> samples(30, 10.0);
        std::fill(samples.begin() + 10, samples.begin() + 20, 11.0);
        std::fill(samples.begin() + 20, samples.end(), 12.0);
        CHECK(medianInterval(samples, std::vector<size_t>{10, 10, 10}) == Interval{10, 12});
        const Interval mixed = medianInterval(samples, std::vector<size_t>{30});
        CHECK(mixed.low >= 10);
        CHECK(mixed.high - mixed.low < 2);
    }
    CHECK_THAT(relativeHalfWidth({9, 11}, 10), WithinRel(0.1, 1e-12));
    CHECK(relativeHalfWidth({0, 0}, 0) == 0);
}

TEST_CASE("outliers by the modified z-score") {
    // Median 10, MAD 1: the score of 16 is 4.047, that of 15 is 3.3725.
    CHECK(countOutliers(std::vector<double>{8, 9, 9, 10, 10, 11, 11, 12, 16}) == 1);
    CHECK(countOutliers(std::vector<double>{8, 9, 9, 10, 10, 11, 11, 12, 15}) == 0);
    CHECK(countOutliers(std::vector<double>{5, 5, 5, 5, 90}) == 0);
    CHECK(countOutliers({}) == 0);
}

TEST_CASE("drift between rounds") {
    SECTION("one round cannot drift") {
        const Drift drift = driftBetweenRounds(std::vector<double>{1, 2, 3}, std::vector<size_t>{3});
        CHECK(drift.relative == 0);
        CHECK_FALSE(drift.p);
    }
    SECTION("ranks 1-5, 6-10: H = 75/11, p from the chi-squared distribution with one degree of freedom") {
        const std::vector<double> samples = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
        const Drift drift = driftBetweenRounds(samples, std::vector<size_t>{5, 5});
        REQUIRE(drift.p);
        CHECK_THAT(*drift.p, WithinRel(std::erfc(std::sqrt(75.0 / 11 / 2)), 1e-9));
        CHECK_THAT(drift.relative, WithinRel(5 / 5.5, 1e-12));
    }
    SECTION("three rounds: H = 7.2, p = exp(-3.6) with two degrees of freedom") {
        const Drift drift =
            driftBetweenRounds(std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}, std::vector<size_t>{3, 3, 3});
        REQUIRE(drift.p);
        CHECK_THAT(*drift.p, WithinRel(std::exp(-3.6), 1e-9));
    }
    SECTION("four rounds: three degrees of freedom, 2 (1 - Phi(sqrt x)) + sqrt(2 x / pi) exp(-x / 2)") {
        const Drift drift =
            driftBetweenRounds(std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}, std::vector<size_t>{2, 2, 2, 2});
        const double h = 12.0 / 72 * (9 + 49 + 121 + 225) / 2 - 27;
        REQUIRE(drift.p);
        CHECK_THAT(
            *drift.p,
            WithinRel(std::erfc(std::sqrt(h / 2)) + std::sqrt(2 * h / std::acos(-1.0)) * std::exp(-h / 2), 1e-9));
    }
    SECTION("ties: equal samples show no drift") {
        const Drift drift = driftBetweenRounds(std::vector<double>(12, 4.0), std::vector<size_t>{6, 6});
        CHECK(drift.relative == 0);
        CHECK(*drift.p == 1);
    }
}
