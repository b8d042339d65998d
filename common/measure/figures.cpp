// What the samples of a case say.
#include <array>

#include "common/measure/bench.h"

namespace skinbench {

// Fifty pairs are compared at once. Of eight rounds that differ, intervals of 95 % part one equal pair in 80 by
// chance, those of 99.5 % one in 700 (simulated as in test_stats.cpp).
constexpr double kLevel = 0.95, kSelfTestLevel = 0.995;

CaseFigures figuresOf(const CaseResult& result) {
    SKINBENCH_ASSERT(!result.total.empty());
    const auto intervals = medianIntervals(result.total, result.roundSizes, std::array{kLevel, kSelfTestLevel});
    CaseFigures figures;
    figures.total = summarise(result.total);
    figures.interval = intervals[0];
    figures.wideInterval = intervals[1];
    figures.outliers = countOutliers(result.total);
    figures.drift = driftBetweenRounds(result.total, result.roundSizes);
    for (const auto& [label, samples] : result.passes) figures.passes[label] = summarise(samples);
    figures.record = summarise(result.record);
    figures.submit = summarise(result.submit);
    if (!result.batches.empty()) {
        figures.batch = summarise(result.batches);
        figures.batchInterval = medianInterval(result.batches, result.batchRounds);
    }
    if (result.overlapped.empty()) return figures;
    figures.overlapped = summarise(result.overlapped);
    figures.overlappedInterval = medianInterval(result.overlapped, result.roundSizes);
    return figures;
}

bool isTimed(const CaseResult& result) { return result.status == CaseStatus::ok && result.figures; }

double medianOf(const CaseResult& result) { return result.figures->total.median; }

}  // namespace skinbench
