// The runner: order, rounds, checkpoints, interruption, and what happens to cases that cannot run.
#include <algorithm>
#include <limits>
#include <new>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/measure/bench.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

// Shows what the host skinned, so that the variant cpu is right on it, and tells of times as it is asked to.
struct FakeBackend final : Backend {
    DeviceCaps device = generousCaps(Api::vulkan);
    double milliseconds = 1e-3;  // of every pass
    bool throws = false;         // in run
    FramePlan plan;
    std::vector<std::byte> skinned;
    int held = 0;  // plans

    const DeviceCaps& caps() const override { return device; }
    Result<PlanId> prepare(const FramePlan& given) override {
        plan = given;
        return static_cast<PlanId>(++held);
    }
    Result<std::vector<Timing>> run(PlanId, std::span<const FrameInput> frames, RunMode) override {
        if (throws) throw std::bad_alloc();
        skinned.assign(frames.back().skinned.begin(), frames.back().skinned.end());
        Timing timing;
        timing.passes.assign(plan.passes.size(), milliseconds);
        timing.counters.emplace();
        return std::vector<Timing>(frames.size(), timing);
    }
    Result<Image> readImage(PlanId) override {
        return Image{plan.width, plan.height, std::vector<uint8_t>(size_t{plan.width} * plan.height * 4, 0)};
    }
    Result<void> begin(PlanId, const FrameInput&) override { return inputError("nothing begins"); }
    Result<FinishedFrame> finish(PlanId) override { return inputError("nothing has begun"); }
    // The first and the last of the two copies.
    Result<std::vector<std::byte>> readStream(PlanId, uint32_t) override { return skinned; }
    void release(PlanId) override { --held; }
    std::vector<std::string> takeMessages() override { return {}; }
};

std::vector<CaseResult> benchOn(FakeBackend& fake) {
    Workload workload = tinyWorkload(2);
    BenchSettings settings;
    settings.frames = 4;
    settings.rounds = 2;
    auto results =
        runBench(workload, {makeCase("vk", "cpu"), makeCase("cpu", "cpu")}, {{Api::vulkan, {&fake, {}}}}, settings, {});
    REQUIRE(results);
    return *results;
}

}  // namespace

TEST_CASE("times that cannot be fail their case alone") {
    FakeBackend fake;
    CHECK(benchOn(fake)[0].status == CaseStatus::ok);
    // Timestamps that stay 0; one tick backwards, of 64 bits and of 36; far beyond the run; no number.
    for (double milliseconds :
         {0.0, 18446744073708.895, 68719.476735, 1e4, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        fake.milliseconds = milliseconds;
        const std::vector<CaseResult> results = benchOn(fake);
        INFO(milliseconds << ": " << results[0].reason);
        CHECK(results[0].status == CaseStatus::failed);
        CHECK_THAT(results[0].reason, ContainsSubstring("the device's timestamps cannot be right"));
        CHECK(results[0].total.empty());
        CHECK(results[1].status == CaseStatus::ok);
        CHECK(results[1].total.size() == 4);
        CHECK(fake.held == 0);
    }
}

TEST_CASE("what one case throws fails that case alone, and its plan is released") {
    FakeBackend fake;
    fake.throws = true;
    const std::vector<CaseResult> results = benchOn(fake);
    CHECK(results[0].status == CaseStatus::failed);
    CHECK(results[0].reason == "the host is out of memory; use fewer copies or a smaller scene");
    CHECK(results[1].status == CaseStatus::ok);
    CHECK(results[1].total.size() == 4);
    CHECK(fake.held == 0);
}

TEST_CASE("route cpu is verified and timed with no graphics API at all") {
    Workload workload = tinyWorkload(3);
    BenchSettings settings;
    settings.frames = 7;
    settings.rounds = 3;
    const Backends none{{Api::vulkan, {nullptr, "no loader"}}};
    auto results = runBench(workload, {makeCase("cpu", "cpu"), makeCase("vk", "vertex"), makeCase("gl", "vertex")},
                            none, settings, {});
    REQUIRE(results);
    const CaseResult& cpu = results->at(0);
    CHECK(cpu.status == CaseStatus::ok);
    CHECK(cpu.total.size() == 7);
    CHECK(cpu.passes.at("skin") == cpu.total);
    CHECK(cpu.passes.size() == 1);
    REQUIRE(cpu.accuracy);
    CHECK(cpu.accuracy->error.position < 2e-6);
    CHECK(cpu.accuracy->error.position > 0);
    CHECK(results->at(1).status == CaseStatus::skipped);
    CHECK(results->at(1).reason == "no loader");
    CHECK(results->at(2).status == CaseStatus::skipped);
    CHECK(results->at(2).reason == "not opened");
}

TEST_CASE("a backend that draws nothing fails every case and is never timed") {
    Workload workload = tinyWorkload(2);
    auto null = openNull(generousCaps(Api::vulkan));
    std::vector<Case> cases;
    for (const Case& c : everyCase())
        if (c.route->api == Api::vulkan && c.view == View::shaded) cases.push_back(c);
    const Backends backends{{Api::vulkan, {null.get(), {}}}};
    auto results = runBench(workload, cases, backends, {}, {});
    REQUIRE(results);
    REQUIRE(results->size() == cases.size());
    for (const CaseResult& result : *results) {
        INFO(result.id);
        CHECK(result.status == CaseStatus::failed);
        CHECK(result.total.empty());
        CHECK(!result.reason.empty());
    }
}

TEST_CASE("what a device or a scene cannot hold is skipped, what the program itself lacks fails") {
    Workload workload = tinyWorkload(2);
    auto null = openNull(generousCaps(Api::vulkan));
    const Backends backends{{Api::vulkan, {null.get(), {}}}};
    BenchSettings settings;
    settings.timed = false;
    Case tight = makeCase("vk", "palette");
    tight.paletteSlots = 1;
    const auto skipped = runBench(workload, {tight}, backends, settings, {});
    REQUIRE(skipped);
    CHECK(skipped->front().status == CaseStatus::skipped);
    CHECK_THAT(skipped->front().reason,
               ContainsSubstring("but a draw has 1 palette slot; choose fewer influences a vertex (--influences) or "
                                 "more slots (--palette-slots)"));
    workload.shaders.files.erase("vertex.glsl");
    const auto failed = runBench(workload, {makeCase("vk", "vertex")}, backends, settings, {});
    REQUIRE(failed);
    CHECK(failed->front().status == CaseStatus::failed);
    CHECK(failed->front().reason == "shader vertex.glsl, which the plan includes, does not exist");
}

TEST_CASE("rounds go on until the median is known well enough, or for kMostRounds, or until the time is up") {
    Workload workload = tinyWorkload(1);
    BenchSettings settings;
    settings.frames = 4;
    settings.rounds = 2;
    settings.precision = 1e-12;
    auto results = runBench(workload, {makeCase("cpu", "cpu")}, {}, settings, {});
    REQUIRE(results);
    CHECK(results->at(0).roundSizes == std::vector<size_t>(kMostRounds, 2));
    CHECK(results->at(0).total.size() == kMostRounds * 2);

    settings.timeLimit = 1e-9;
    results = runBench(workload, {makeCase("cpu", "cpu")}, {}, settings, {});
    REQUIRE(results);
    CHECK(results->at(0).roundSizes == std::vector<size_t>{2, 2});

    settings.timeLimit = 0;
    settings.precision = 1e9;
    results = runBench(workload, {makeCase("cpu", "cpu")}, {}, settings, {});
    REQUIRE(results);
    const CaseResult& result = results->at(0);
    CHECK(result.roundSizes == std::vector<size_t>{2, 2});
    REQUIRE(result.figures);
    CHECK(result.figures->interval.low <= summarise(result.total).median);
    CHECK(result.figures->interval.high >= summarise(result.total).median);
}

TEST_CASE("the self-test times every case twice under two names") {
    Workload workload = tinyWorkload(1);
    BenchSettings settings;
    settings.frames = 6;
    settings.selfTest = true;
    auto results = runBench(workload, {makeCase("cpu", "cpu")}, {}, settings, {});
    REQUIRE(results);
    REQUIRE(results->size() == 2);
    CHECK(results->at(0).id == "cpu/cpu/uc");
    CHECK(results->at(1).id == "cpu/cpu/uc+again");
    CHECK(results->at(1).isAgain);
    for (const CaseResult& result : *results) {
        CHECK(result.status == CaseStatus::ok);
        CHECK(result.total.size() == 6);
    }
    CHECK(results->at(0).total != results->at(1).total);
}

TEST_CASE("checkpoints come after every case and round; stopping keeps what was measured") {
    Workload workload = tinyWorkload(1);
    BenchSettings settings;
    settings.frames = 30;
    settings.rounds = 5;
    settings.warmup = 0;
    Case eight = makeCase("cpu", "cpu");
    eight.influences = 8;
    int checkpoints = 0;
    BenchEvents events;
    events.checkpoint = [&](const std::vector<CaseResult>& results) {
        CHECK(results.size() == 2);
        ++checkpoints;
    };
    // Two verifications, then the first round of both cases and no more.
    events.stop = [&] { return checkpoints == 4; };
    auto results = runBench(workload, {makeCase("cpu", "cpu"), eight}, {}, settings, events);
    REQUIRE(results);
    CHECK(checkpoints == 4);
    for (const CaseResult& result : *results) {
        CHECK(result.status == CaseStatus::ok);
        CHECK(result.total.size() == 6);
    }

    checkpoints = 0;
    events.stop = [&] { return checkpoints == 1; };
    results = runBench(workload, {makeCase("cpu", "cpu"), eight}, {}, settings, events);
    REQUIRE(results);
    CHECK(results->at(0).reason == "interrupted before it was timed");
    CHECK(results->at(1).reason == "interrupted before it was verified");
    CHECK(results->at(1).status == CaseStatus::skipped);
}

TEST_CASE("progress never falls, ends at 1, and gives the time left once something was timed") {
    Workload workload = tinyWorkload(1);
    BenchSettings settings;
    settings.frames = 6;
    settings.rounds = 3;
    settings.precision = 1e-9;
    settings.timeLimit = 0.05;
    settings.limits = true;
    Case eight = makeCase("cpu", "cpu");
    eight.influences = 8;
    std::vector<Progress> shown;
    BenchEvents events;
    events.progress = [&](const Progress& progress) { shown.push_back(progress); };
    REQUIRE(runBench(workload, {makeCase("cpu", "cpu"), eight}, {}, settings, events));
    REQUIRE(shown.size() > 8);
    CHECK(std::ranges::is_sorted(shown, {}, &Progress::fraction));
    CHECK(shown.front().fraction == 0);
    CHECK(shown.back().fraction == 1);
    CHECK(!shown.front().secondsLeft);
    for (const Progress& progress : shown) CHECK(progress.secondsLeft.value_or(0) >= 0);
    CHECK(shown[shown.size() - 2].secondsLeft);
}

TEST_CASE("raster modes of one case share its verification") {
    Workload workload = tinyWorkload(2);
    auto null = openNull(generousCaps(Api::vulkan));
    Case plain = makeCase("vk", "vertex"), discard = plain;
    discard.raster = RasterMode::discard;
    const Backends backends{{Api::vulkan, {null.get(), {}}}};
    auto results = runBench(workload, {plain, discard}, backends, {}, {});
    REQUIRE(results);
    CHECK(results->at(0).reason == results->at(1).reason);
    CHECK(results->at(1).id.ends_with("+discard"));
}
