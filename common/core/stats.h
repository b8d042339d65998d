// Statistics of repeated measurements. Pure functions; every random choice comes from a fixed seed.
//
// Samples of a case are taken in rounds: `roundSizes` counts the samples of each, one round behind the other. Samples
// of one round are alike in what they share (clocks, placement in memory), so intervals resample rounds first.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace skinbench {

// cv is the sample standard deviation (n - 1) over the mean; 0 for fewer than two samples or a mean of 0.
struct Summary {
    double mean = 0;
    double median = 0;
    double min = 0;
    double max = 0;
    double p95 = 0;
    double cv = 0;
};

// All zero for no samples. The median of an even count is the mean of the two in the middle.
Summary summarise(std::span<const double> samples);

// The value below which the fraction `q` (0 to 1) of the samples lies, interpolated between neighbours (type 7 of
// Hyndman and Fan 1996); 0 for no samples.
double quantile(std::span<const double> samples, double q);

struct Interval {
    double low = 0;
    double high = 0;
    bool operator==(const Interval&) const = default;
};

// The percentile-bootstrap interval of the median (Efron 1979), resampled in two stages: as many rounds as there are,
// with replacement, then of each chosen round as many samples as it has (Davison and Hinkley 1997, 3.8). `level`, above
// 0 and below 1, is the share of resamples inside. Sizes must add up to the samples. A single sample is its own
// interval; no samples give 0, 0.
Interval medianInterval(std::span<const double> samples, std::span<const size_t> roundSizes, double level = 0.95);

// The same for each of the levels, from one set of resamples.
std::vector<Interval> medianIntervals(std::span<const double> samples, std::span<const size_t> roundSizes,
                                      std::span<const double> levels);

// Samples round behind round; sizes add up to the samples.
struct Measured {
    std::vector<double> samples;
    std::vector<size_t> roundSizes;
};

// The same at 0.95 for median(b) / median(a), of positive samples, at least one in each.
Interval medianRatioInterval(const Measured& a, const Measured& b);

// Half of the interval's width over the median.
double relativeHalfWidth(const Interval& interval, double median);

// Samples whose modified z-score |0.6745 (x - median) / MAD| is above 3.5 (Iglewicz and Hoaglin 1993). Where more than
// half of the samples are equal the MAD is 0, and no sample counts as an outlier.
size_t countOutliers(std::span<const double> samples);

// How far rounds lie apart: the largest less the smallest median of a round, over the median of all; `p` is the chance
// of rounds that differ so much in rank when nothing drifts (Kruskal and Wallis 1952, corrected for ties), empty for
// fewer than two rounds.
struct Drift {
    double relative = 0;
    std::optional<double> p;
};
Drift driftBetweenRounds(std::span<const double> samples, std::span<const size_t> roundSizes);

}  // namespace skinbench
