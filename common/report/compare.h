// Two result files case by case: what became faster or slower, and what is only noise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/core/result.h"
#include "common/core/stats.h"

namespace skinbench {

inline constexpr const char* kCompareSchema = "skinbench-compare/1";

// Stands in for the noise floor of a file that did not measure its own: 0.3 %.
inline constexpr double kDefaultNoiseFloor = 0.003;

// Below this no interval between two samples holds the median with 95 % (1 - 2 / 2^n).
inline constexpr size_t kFewestSamples = 6;

enum class Change {
    slower,   // the interval of the ratio lies above 1, and the ratio outside the noise floor
    faster,   // so too, below 1
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

// A case of one file; empty where the file does not have the case.
struct ComparedSide {
    std::string status, reason;
    std::optional<double> median;  // milliseconds a frame, above 0
    bool software = false;         // timed on a software driver
};

struct ComparedCase {
    std::string id;
    Change change = Change::same;
    ComparedSide a, b;
    std::optional<double> ratio;       // of the medians, B / A; above 1 is slower
    std::optional<Interval> interval;  // 95 %, of the ratio
};

struct Comparison {
    std::vector<std::string> differences;  // of scene, devices, settings, host and program, a line each
    double noiseFloor = kDefaultNoiseFloor;
    bool noiseFloorMeasured = false;  // in both files
    bool placementCovered = true;     // false: a file kept its cases in place and measured no noise floor
    std::vector<ComparedCase> cases;  // in the order of Change, within it the largest effect first
};

// Both as loadResults gives them. An error names A or B and what is wrong with a value.
Result<Comparison> compareResults(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

// What makes `--fail-above percent` fail, a sentence for each kind: cases that are slower beyond noise, that are ok in
// A and missing in B (unless allowed) or not ok there, that failed in B, that have no time or too few samples; and that
// nothing was compared at all. Empty: B is no worse than A.
std::vector<std::string> findWorse(const Comparison& comparison, double percent, bool allowMissing);

nlohmann::ordered_json comparisonJson(const Comparison& comparison);

// Lines for a terminal. Times and ratios of software drivers carry a mark that is explained below.
std::string comparisonText(const Comparison& comparison);

}  // namespace skinbench
