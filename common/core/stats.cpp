#include "common/core/stats.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "common/core/result.h"

namespace skinbench {

constexpr uint32_t kResamples = 1000;
constexpr uint32_t kSeed = 20190605;
constexpr double kOutlierScore = 3.5;

// Reorders the values.
static double medianOf(std::span<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return values.size() % 2 ? *middle : (*middle + *std::max_element(values.begin(), middle)) / 2;
}

static double medianOfCopy(std::span<const double> samples) {
    std::vector<double> copy(samples.begin(), samples.end());
    return medianOf(copy);
}

double quantile(std::span<const double> samples, double q) {
    if (samples.empty()) return 0;
    std::vector<double> sorted(samples.begin(), samples.end());
    std::ranges::sort(sorted);
    const double place = q * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<size_t>(place);
    const size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

Summary summarise(std::span<const double> samples) {
    Summary summary;
    if (samples.empty()) return summary;
    const auto n = static_cast<double>(samples.size());
    const auto [smallest, largest] = std::ranges::minmax(samples);
    summary.min = smallest;
    summary.max = largest;
    summary.median = medianOfCopy(samples);
    summary.p95 = quantile(samples, 0.95);
    summary.mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
    if (samples.size() < 2 || summary.mean == 0) return summary;
    double squares = 0;
    for (double sample : samples) squares += (sample - summary.mean) * (sample - summary.mean);
    summary.cv = std::sqrt(squares / (n - 1)) / summary.mean;
    return summary;
}

static std::vector<std::span<const double>> roundsOf(std::span<const double> samples,
                                                     std::span<const size_t> roundSizes) {
    std::vector<std::span<const double>> rounds;
    size_t start = 0;
    for (size_t size : roundSizes) {
        SKINBENCH_ASSERT(start + size <= samples.size());
        if (size > 0) rounds.push_back(samples.subspan(start, size));
        start += size;
    }
    SKINBENCH_ASSERT(start == samples.size());
    return rounds;
}

// random() % n, because the sequence of std::uniform_int_distribution differs between libraries.
static double resampledMedian(std::span<const std::span<const double>> rounds, std::vector<double>& drawn,
                              std::mt19937& random) {
    drawn.clear();
    for (size_t r = 0; r < rounds.size(); ++r) {
        const std::span<const double> round = rounds[random() % rounds.size()];
        for (size_t s = 0; s < round.size(); ++s) drawn.push_back(round[random() % round.size()]);
    }
    return medianOf(drawn);
}

static Interval middle(std::span<const double> values, double level) {
    return {quantile(values, (1 - level) / 2), quantile(values, (1 + level) / 2)};
}

std::vector<Interval> medianIntervals(std::span<const double> samples, std::span<const size_t> roundSizes,
                                      std::span<const double> levels) {
    std::vector<Interval> intervals(levels.size());
    if (samples.empty()) return intervals;
    const auto rounds = roundsOf(samples, roundSizes);
    std::mt19937 random(kSeed);
    std::vector<double> medians(kResamples), drawn;
    for (double& median : medians) median = resampledMedian(rounds, drawn, random);
    for (size_t i = 0; i < levels.size(); ++i) intervals[i] = middle(medians, levels[i]);
    return intervals;
}

Interval medianInterval(std::span<const double> samples, std::span<const size_t> roundSizes, double level) {
    return medianIntervals(samples, roundSizes, {&level, 1}).front();
}

Interval medianRatioInterval(const Measured& a, const Measured& b) {
    const auto roundsA = roundsOf(a.samples, a.roundSizes), roundsB = roundsOf(b.samples, b.roundSizes);
    std::mt19937 random(kSeed);
    std::vector<double> ratios(kResamples), drawn;
    for (double& ratio : ratios) {
        const double before = resampledMedian(roundsA, drawn, random);
        ratio = resampledMedian(roundsB, drawn, random) / before;
    }
    return middle(ratios, 0.95);
}

double relativeHalfWidth(const Interval& interval, double median) {
    return median == 0 ? 0 : (interval.high - interval.low) / (2 * median);
}

size_t countOutliers(std::span<const double> samples) {
    const double median = medianOfCopy(samples);
    std::vector<double> distances;
    for (double sample : samples) distances.push_back(std::abs(sample - median));
    const double mad = medianOfCopy(distances);
    if (mad == 0) return 0;
    return static_cast<size_t>(
        std::ranges::count_if(distances, [&](double d) { return 0.6745 * d / mad > kOutlierScore; }));
}

// The chance that a chi-squared variable with `degrees` degrees of freedom is above `x`: the upper incomplete gamma
// function at half degrees, by its recurrence from Q(1/2, y) = erfc(sqrt y) or Q(1, y) = exp(-y).
static double chiSquaredTail(double x, size_t degrees) {
    const double y = x / 2;
    const bool odd = degrees % 2 == 1;
    double q = odd ? std::erfc(std::sqrt(y)) : std::exp(-y);
    for (double a = odd ? 0.5 : 1; a < static_cast<double>(degrees) / 2; a += 1)
        q += std::exp(a * std::log(y) - y - std::lgamma(a + 1));
    return std::min(q, 1.0);
}

// Ranks from 1; equal values share the mean of theirs.
struct Ranks {
    std::vector<double> of;  // by sample
    double ties = 0;         // sum of t^3 - t over groups of t equal values
};

static Ranks ranksOf(std::span<const double> samples) {
    std::vector<size_t> order(samples.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::sort(order, {}, [&](size_t i) { return samples[i]; });
    Ranks ranks{std::vector<double>(samples.size()), 0};
    for (size_t first = 0; first < order.size();) {
        size_t end = first;
        while (end < order.size() && samples[order[end]] == samples[order[first]]) ++end;
        const auto t = static_cast<double>(end - first);
        for (size_t i = first; i < end; ++i) ranks.of[order[i]] = static_cast<double>(first + end + 1) / 2;
        ranks.ties += t * t * t - t;
        first = end;
    }
    return ranks;
}

Drift driftBetweenRounds(std::span<const double> samples, std::span<const size_t> roundSizes) {
    Drift drift;
    const auto rounds = roundsOf(samples, roundSizes);
    if (rounds.size() < 2) return drift;
    std::vector<double> medians;
    for (const auto& round : rounds) medians.push_back(medianOfCopy(round));
    const auto [smallest, largest] = std::ranges::minmax(medians);
    const double median = medianOfCopy(samples);
    drift.relative = median == 0 ? 0 : (largest - smallest) / median;

    const Ranks ranks = ranksOf(samples);
    const auto n = static_cast<double>(samples.size());
    double between = 0;
    size_t start = 0;
    for (const auto& round : rounds) {
        const auto first = ranks.of.begin() + static_cast<std::ptrdiff_t>(start);
        const double sum = std::accumulate(first, first + static_cast<std::ptrdiff_t>(round.size()), 0.0);
        between += sum * sum / static_cast<double>(round.size());
        start += round.size();
    }
    const double spread = 1 - ranks.ties / (n * n * n - n);
    const double h = spread > 0 ? (12 / (n * (n + 1)) * between - 3 * (n + 1)) / spread : 0;
    drift.p = h > 0 ? chiSquaredTail(h, rounds.size() - 1) : 1;
    return drift;
}

}  // namespace skinbench
