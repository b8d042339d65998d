// Two result files case by case, or pairs of cases: what became faster or slower, and what is only noise.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/core/result.h"
#include "common/core/stats.h"
#include "common/report/pairs.h"

namespace skinbench {

inline constexpr const char* kCompareSchema = "skinbench-compare/1";

// Stands in for the noise floor of a file that did not measure its own: 0.3 %.
inline constexpr double kDefaultNoiseFloor = 0.003;

// Below this no interval between two samples holds the median with 95 % (1 - 2 / 2^n).
inline constexpr size_t kFewestSamples = 6;

enum class Change {
    slower,   // the interval of the ratio lies above 1, and the ratio outside the noise floor
    faster,   // the same below 1
    same,     // no difference: noise
    unknown,  // too few samples in one of the files
    broken,   // ok in A, skipped or failed in B
    mended,   // skipped or failed in A, ok in B
    notRun,   // skipped or failed in both
    untimed,  // ok in both, without a time in one of them
    onlyA,
    onlyB,
};

const char* changeName(Change change);

// What two sets of samples of at least one show, when the ratio of their medians, B / A, is `ratio`.
struct TimeRatio {
    Change change = Change::unknown;  // slower, faster, same or unknown
    double ratio = 0;
    std::optional<Interval> interval;  // 95 %, of the ratio; empty where unknown
};
TimeRatio judgeRatio(double ratio, const Measured& a, const Measured& b, double noiseFloor);

// A case of one file; empty where the file does not have the case.
struct ComparedSide {
    std::string id, status, reason;
    std::optional<double> median;  // milliseconds a frame, above 0
    bool software = false;         // timed on a software driver
};

struct ComparedCase {
    std::string id;         // of A's case where A has one
    std::string direction;  // CasePair::direction; empty for the same case in both
    Change change = Change::same;
    ComparedSide a, b;
    std::optional<double> ratio;       // of the medians, B / A; above 1 is slower
    std::optional<Interval> interval;  // 95 %, of the ratio
};

struct Comparison {
    std::vector<std::string> differences;  // of scene, devices, settings, host and program, a line each
    std::vector<std::string> drawn;        // drawnDifferences()
    double noiseFloor = kDefaultNoiseFloor;
    bool noiseFloorMeasured = false;    // in both files
    bool placementCovered = true;       // false: a file kept its cases in place and measured no noise floor
    std::vector<std::string> pairedBy;  // names of axes; empty: the same cases were compared
    size_t alone = 0;                   // cases of A without a partner, where pairs were compared
    bool inBatches = false;             // pairs of --queues: the times are those of a frame within a batch
    std::vector<ComparedCase> cases;    // by direction, in the order of Change, within it the largest effect first
};

// The same cases of both files, as loadResults gives them. An error names A or B and what is wrong with a value, or
// says why the files have no case in common.
Result<Comparison> compareResults(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

// Cases that are equal but for some axes, of two files or, where `b` is `a`, of one. That there is no pair is an error.
Result<Comparison> comparePairs(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b,
                                std::span<const std::string> axisWords);

// What makes `--fail-above percent` fail, a sentence for each kind: cases whose whole interval lies more than `percent`
// and the noise floor above 1, that are ok in A and missing in B (unless allowed) or not ok there, that failed in B,
// that have no time or too few samples; that the files draw different things, and that nothing was compared at all.
// Empty: B is no worse than A.
std::vector<std::string> findWorse(const Comparison& comparison, double percent, bool allowMissing);

nlohmann::ordered_json comparisonJson(const Comparison& comparison);

// Lines for a terminal; what differs between the files is broken at `width` characters, 0: not at all. Times and ratios
// of software drivers carry a mark that is explained below.
std::string comparisonText(const Comparison& comparison, size_t width = 0);

}  // namespace skinbench
