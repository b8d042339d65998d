// What the files of the runner share: bench.cpp verifies, bench_schedule.cpp times.
#pragma once

#include <chrono>

#include "common/measure/bench.h"
#include "common/measure/drawing.h"
#include "common/measure/verify.h"

namespace skinbench {

struct Runner {
    Workload& workload;
    const Backends& backends;
    const BenchSettings& settings;
    const BenchEvents& events;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    double shown = 0;  // of Progress::fraction
    std::vector<CaseResult> results{};
    std::map<std::string, std::pair<std::string, Image>> firstImages{};                    // by pictureOf
    std::map<std::string, size_t> verifiedAs{};                                            // keyOf the plan -> result
    std::map<std::tuple<const EncodedMesh*, bool, PaletteForm>, References> references{};  // of frame 0; bool: skinned
};

// The share of a timed run's progress that verifying takes.
inline constexpr double kVerifyShare = 0.3;

void showProgress(Runner& runner, const std::string& what, double fraction, std::optional<double> secondsLeft);

void failCase(CaseResult& result, CaseStatus status, std::string reason);

// A message of the validation layer fails the case that caused it.
bool failOnMessages(CaseResult& result, Backend* backend);

Backend* backendOf(const Runner& runner, const Case& c);

// Nothing is allocated when it fails; `result` then has the status that the fault deserves.
Result<Prepared> prepareCase(Runner& runner, CaseResult& result, bool capture);

// Times every case that is ok.
void timeCases(Runner& runner);

}  // namespace skinbench
