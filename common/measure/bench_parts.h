// What the files of the runner share: bench.cpp verifies, bench_schedule.cpp times.
#pragma once

#include <chrono>
#include <exception>
#include <new>

#include "common/measure/bench.h"
#include "common/measure/verify.h"

namespace skinbench {

// The copies' own vertices for skinning on the host, and room for the result.
struct HostSkinning {
    std::vector<Mesh> copies;
    std::vector<Palette> palettes;
    std::vector<SkinnedVertex> out;
};

// One case that is ready to be drawn again and again.
struct Prepared {
    Backend* backend = nullptr;  // null on route cpu
    std::optional<PlanId> plan;
    std::vector<std::string> labels;  // of the plan's passes
    PlanInput input;                  // of the plan
    std::optional<PaletteBlocks> blocks;
    std::unique_ptr<HostSkinning> host;
};

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

struct DrawnFrame {
    Timing timing;
    double skin = 0;  // milliseconds of the host
};

void failCase(CaseResult& result, CaseStatus status, std::string reason);

// What a step of one case throws (the host is out of memory, a library gave up) becomes an error of that case.
template <class Step>
auto attempt(const Step& step) -> decltype(step()) {
    try {
        return step();
    } catch (const std::bad_alloc&) {
        return deviceError("the host is out of memory; use fewer copies or a smaller scene");
    } catch (const std::exception& error) {
        return deviceError(std::string("unexpected: ") + error.what());
    }
}

// A message of the validation layer fails the case that caused it.
bool failOnMessages(CaseResult& result, Backend* backend);

Backend* backendOf(const Runner& runner, const Case& c);

Result<std::vector<FrameData>> frameRange(Workload& workload, const Case& c, uint32_t first, uint32_t count);

// Nothing is allocated when it fails; `result` then has the status that the fault deserves.
Result<Prepared> prepareCase(Runner& runner, CaseResult& result, bool capture);
void releaseCase(Prepared& ready);

// Frames that are recorded and submitted together; bounds the memory that their palettes take.
inline constexpr uint32_t kBatch = 16;

Result<std::vector<DrawnFrame>> drawFrames(Prepared& ready, std::span<const FrameData> frames,
                                           RunMode mode = RunMode::timed);

// The frame's passes by name, on the host too; passes of one name are one.
std::vector<std::pair<std::string, double>> passTimes(const Prepared& ready, const DrawnFrame& frame);

// Times every case that is ok.
void timeCases(Runner& runner);

}  // namespace skinbench
