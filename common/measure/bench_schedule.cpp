// Rounds over the cases: which are resident, in what order they run, when a median is known well enough.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <format>
#include <random>
#include <utility>

#include "common/core/text.h"
#include "common/measure/bench_parts.h"

namespace skinbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSettled = 0.005;  // relative difference of two warm-up runs
// Seconds. An idle GPU holds its low clocks for a while, steadily, and longest after cases were prepared.
constexpr double kShortestWarmup = 0.05;
constexpr double kFirstWarmup = 1;
constexpr double kLongestWarmup = 3;

double seconds(Clock::time_point since) { return std::chrono::duration<double>(Clock::now() - since).count(); }

// Prepared plans stay on the device between rounds as long as they fit in half of its memory.
uint64_t residentBudget(const Backend* backend) {
    const uint64_t device = backend && !backend->caps().software ? backend->caps().deviceBytes : 0;
    return device ? device / 2 : uint64_t{4} << 30;
}

struct Timer {
    Runner& runner;
    std::map<size_t, Prepared> resident;                                // by result number
    std::map<std::pair<int, uint32_t>, std::vector<FrameData>> frames;  // of this round, by influences and first frame

    CaseResult& result(size_t number) { return runner.results[number]; }
    Backend* backend(size_t number) { return backendOf(runner, result(number).theCase); }
    uint64_t bytes(size_t number) {
        const CaseResult& of = result(number);
        return of.memory ? of.memory->total() * runner.workload.settings.copies : 0;
    }
    bool batches = false;  // cases are timed in RunMode::batch too
    bool began = false;    // the first warm-up is over
    Clock::time_point start = Clock::now();
    std::map<size_t, double> took;  // seconds of a case's last round, by result number
    double preparing = 0;           // seconds of the last round that prepared cases
    bool stopped() const { return runner.events.stop && runner.events.stop(); }
};

void drop(Timer& timer, size_t number) {
    releaseCase(timer.resident.at(number));
    timer.resident.erase(number);
}

// Consecutive cases that fit on their devices together; a case that fits on none is alone.
std::vector<std::span<const size_t>> groupsOf(Timer& timer, std::span<const size_t> order) {
    std::vector<std::span<const size_t>> groups;
    std::map<Backend*, uint64_t> filled;
    size_t start = 0;
    for (size_t i = 0; i < order.size(); ++i) {
        Backend* const backend = timer.backend(order[i]);
        const uint64_t bytes = timer.bytes(order[i]);
        if (i > start && filled[backend] + bytes > residentBudget(backend)) {
            groups.push_back(order.subspan(start, i - start));
            filled.clear();
            start = i;
        }
        filled[backend] += bytes;
    }
    if (start < order.size()) groups.push_back(order.subspan(start));
    return groups;
}

// Releases what is not in the group while the group does not fit beside it.
void makeRoom(Timer& timer, std::span<const size_t> group) {
    std::map<Backend*, uint64_t> filled;
    for (size_t number : group) filled[timer.backend(number)] += timer.bytes(number);
    std::vector<size_t> others;
    for (const auto& [number, ready] : timer.resident)
        if (std::ranges::find(group, number) == group.end()) others.push_back(number);
    for (size_t number : others) {
        Backend* const backend = timer.backend(number);
        filled[backend] += timer.bytes(number);
        if (filled[backend] > residentBudget(backend)) drop(timer, number);
    }
}

// One untimed frame with the pipeline's own counters.
Result<void> countCase(Timer& timer, CaseResult& result, Prepared& ready) {
    if (!ready.plan || !ready.backend->caps().pipelineStatistics) return {};
    auto frame = frameRange(timer.runner.workload, result.theCase, 0, 1);
    SKINBENCH_TRY(frame);
    auto drawn = drawFrames(ready, *frame, RunMode::counted);
    SKINBENCH_TRY(drawn);
    result.counters = drawn->front().timing.counters;
    return {};
}

void dropAll(Timer& timer) {
    for (auto& [number, ready] : timer.resident) releaseCase(ready);
    timer.resident.clear();
}

// Gives whether anything was prepared; what cannot be is failed.
bool prepareGroup(Timer& timer, std::span<const size_t> group) {
    bool any = false;
    for (size_t number : group) {
        CaseResult& result = timer.result(number);
        if (timer.stopped()) return any;
        if (result.status != CaseStatus::ok || timer.resident.contains(number)) continue;
        auto ready = attempt([&] { return prepareCase(timer.runner, result, false); });
        if (!ready) {
            failCase(result, CaseStatus::failed, ready.error().text);
            continue;
        }
        any = true;
        Prepared& kept = timer.resident.emplace(number, std::move(*ready)).first->second;
        if (result.counters) continue;
        if (auto counted = attempt([&] { return countCase(timer, result, kept); }); !counted) {
            failCase(result, CaseStatus::failed, counted.error().text);
            drop(timer, number);
        }
    }
    return any;
}

double sum(const Prepared& ready, std::span<const DrawnFrame> drawn) {
    double total = 0;
    for (const DrawnFrame& frame : drawn)
        for (const auto& [pass, time] : passTimes(ready, frame)) total += time;
    return total;
}

// Draws the first frames again and again until two runs in a row agree, because a GPU that has waited for the host
// needs a while to raise its clocks. Software drivers and host skinning never settle so well and get one run.
Result<void> warmUp(const BenchSettings& settings, Prepared& ready, std::span<const FrameData> frames,
                    double shortest) {
    const auto some = frames.first(std::min<size_t>(settings.warmup, frames.size()));
    if (some.empty()) return {};
    const bool settles = ready.plan && !ready.host && !ready.backend->caps().software;
    const auto start = Clock::now();
    double last = 0;
    for (;;) {
        auto drawn = drawFrames(ready, some);
        SKINBENCH_TRY(drawn);
        const double now = sum(ready, *drawn), passed = seconds(start);
        const bool settled = std::abs(now - last) <= kSettled * last && passed >= shortest;
        if (!settles || settled || passed > kLongestWarmup) return {};
        last = now;
    }
}

constexpr double kClockSkew = 1.02, kClockStep = 1;  // the device's clock against the host's: a factor, milliseconds

// Draws frames and refuses times that no device can have taken: none, less, or more than the host waited. Timestamps
// that stay 0 or run backwards give such times.
Result<std::vector<DrawnFrame>> drawTimed(Prepared& ready, std::span<const FrameData> frames, RunMode mode) {
    const auto start = Clock::now();
    auto drawn = drawFrames(ready, frames, mode);
    const double waited = seconds(start) * 1e3;
    if (!drawn || !ready.plan) return drawn;
    double all = 0;
    for (const DrawnFrame& frame : *drawn) {
        double taken = 0;
        for (double pass : frame.timing.passes) taken += pass >= 0 ? pass : -INFINITY;
        if (!(taken > 0))
            return deviceError("the device's timestamps cannot be right: they stand still or run backwards in a frame");
        all += taken;
    }
    if (!(all <= waited * kClockSkew + kClockStep))
        return deviceError(
            std::format("the device's timestamps cannot be right: {} took {:g} ms by them, and the host waited {:g} ms",
                        counted(drawn->size(), "frame"), all, waited));
    return drawn;
}

void record(CaseResult& result, const Prepared& ready, std::span<const DrawnFrame> drawn) {
    for (const DrawnFrame& frame : drawn) {
        double total = 0;
        for (const auto& [pass, time] : passTimes(ready, frame)) {
            result.passes[pass].push_back(time);
            total += time;
        }
        result.total.push_back(total);
        result.record.push_back(frame.timing.record);
        result.submit.push_back(frame.timing.submit);
    }
}

// Posed once a round for all cases that show them.
Result<std::span<const FrameData>> framesFrom(Timer& timer, const Case& c, uint32_t first, uint32_t count) {
    std::vector<FrameData>& kept = timer.frames[{c.influences, first}];
    if (kept.empty()) {
        // A hundred thousand frames would not fit in memory: only those that are drawn together stay.
        std::erase_if(timer.frames, [&](const auto& entry) { return entry.first.second != first; });
        auto made = frameRange(timer.runner.workload, c, first, count);
        SKINBENCH_TRY(made);
        kept = std::move(*made);
    }
    return std::span<const FrameData>(kept);
}

// Frames of one batch, those of the round again and again: as many as make what a batch begins and ends with small, and
// palettes fit.
constexpr uint64_t kBatchFrames = 64, kBatchPalettes = uint64_t{256} << 20;
constexpr int kBatchesOfRound = 3;

Result<void> timeBatches(CaseResult& result, Prepared& ready, std::span<const FrameData> round) {
    const bool software = ready.backend->caps().software;
    auto bytes = paletteBytes(ready.input, ready.blocks, round.front());
    SKINBENCH_TRY(bytes);
    const uint64_t most = std::max<uint64_t>(kBatchPalettes / std::max<uint64_t>(bytes->size(), 1), kBatch);
    const size_t count = software ? round.size() : std::min(kBatchFrames, most);
    std::vector<FrameData> frames;
    for (size_t i = 0; i < count; ++i) frames.push_back(round[i % round.size()]);
    for (int batch = 0; batch < (software ? 1 : kBatchesOfRound); ++batch) {
        auto drawn = drawTimed(ready, frames, RunMode::batch);
        SKINBENCH_TRY(drawn);
        result.batches.push_back(drawn->front().timing.passes.front());
    }
    return {};
}

// One round of one case: warm-up, timed frames, for several passes as many frames that overlap, and batches.
Result<void> timeRound(Timer& timer, CaseResult& result, Prepared& ready, uint32_t from, uint32_t count,
                       double shortest) {
    const bool overlaps = ready.plan && !ready.host && ready.labels.size() > 1;
    for (uint32_t done = 0; done < count; done += kBatch) {
        auto frames = framesFrom(timer, result.theCase, from + done, std::min(kBatch, count - done));
        SKINBENCH_TRY(frames);
        if (done == 0)
            if (auto warm = warmUp(timer.runner.settings, ready, *frames, shortest); !warm) return warm;
        if (!std::exchange(timer.began, true) && timer.runner.events.timing) timer.runner.events.timing();
        auto drawn = drawTimed(ready, *frames, RunMode::timed);
        SKINBENCH_TRY(drawn);
        record(result, ready, *drawn);
        if (!overlaps) continue;
        auto overlapped = drawTimed(ready, *frames, RunMode::overlap);
        SKINBENCH_TRY(overlapped);
        for (const DrawnFrame& frame : *overlapped) result.overlapped.push_back(frame.timing.passes.front());
    }
    if (!timer.batches || !ready.plan || ready.host || count == 0) return {};
    const size_t before = result.batches.size();
    auto frames = framesFrom(timer, result.theCase, from, std::min(kBatch, count));
    SKINBENCH_TRY(frames);
    SKINBENCH_TRY(timeBatches(result, ready, *frames));
    result.batchRounds.push_back(result.batches.size() - before);
    return {};
}

void timeCase(Timer& timer, size_t number, uint32_t from, uint32_t count, double shortest) {
    CaseResult& result = timer.result(number);
    auto place = timer.resident.find(number);
    if (result.status != CaseStatus::ok || place == timer.resident.end()) return;
    const size_t before = result.total.size();
    auto timed = attempt([&] { return timeRound(timer, result, place->second, from, count, shortest); });
    if (!timed) failCase(result, CaseStatus::failed, timed.error().text);
    if (result.total.size() > before) result.roundSizes.push_back(result.total.size() - before);
    failOnMessages(result, place->second.backend);
    if (result.status == CaseStatus::failed) return drop(timer, number);
    if (!result.total.empty()) result.figures = figuresOf(result);
}

// The frames of a round: the settings' frames over their rounds, and as many as in the first in each that is added.
std::pair<uint32_t, uint32_t> framesOfRound(const BenchSettings& settings, uint32_t round) {
    if (round >= settings.rounds) {
        const uint32_t more = std::max(1u, settings.frames / settings.rounds);
        return {settings.frames + (round - settings.rounds) * more, more};
    }
    const uint64_t frames = settings.frames;
    const auto from = static_cast<uint32_t>(frames * round / settings.rounds);
    return {from, static_cast<uint32_t>(frames * (round + 1) / settings.rounds) - from};
}

bool needsRound(const BenchSettings& settings, const CaseResult& result, uint32_t round) {
    if (result.status != CaseStatus::ok) return false;
    if (round < settings.rounds) return true;
    if (settings.precision <= 0 || round >= std::max(kMostRounds, settings.rounds) || !result.figures) return false;
    if (result.total.size() < 2) return true;
    return relativeHalfWidth(result.figures->interval, result.figures->total.median) > settings.precision;
}

// A seeded Fisher-Yates shuffle: std::shuffle's order differs between standard libraries.
void shuffle(std::vector<size_t>& order, std::mt19937& random) {
    for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
}

// How many more rounds than the settings' a case will need: an interval narrows with the root of the samples.
double moreRounds(const BenchSettings& settings, const CaseResult& result, uint32_t round) {
    const double most = std::max(kMostRounds, settings.rounds) - std::max(round + 1, settings.rounds);
    if (settings.precision <= 0 || most <= 0) return 0;
    if (!result.figures || result.roundSizes.size() < 2) return most;
    const double wide = relativeHalfWidth(result.figures->interval, result.figures->total.median) / settings.precision;
    const auto had = static_cast<double>(result.roundSizes.size());
    return wide <= 1 ? 0 : std::clamp(had * wide * wide - std::max<double>(round + 1, settings.rounds), 1.0, most);
}

// Seconds until the last round ends, when every case takes as long as it did; `rest` are those that this round still
// has.
double secondsLeft(const Timer& timer, std::span<const size_t> rest, uint32_t round) {
    const BenchSettings& settings = timer.runner.settings;
    double known = 0;
    for (const auto& [number, took] : timer.took) known += took / static_cast<double>(timer.took.size());
    auto of = [&](size_t number) { return timer.took.contains(number) ? timer.took.at(number) : known; };
    const double planned = round + 1 < settings.rounds ? settings.rounds - round - 1 : 0;
    double sure = settings.freshPlacement ? planned * timer.preparing : 0, more = 0;
    for (size_t number : rest) sure += of(number);
    for (size_t number = 0; number < timer.runner.results.size(); ++number) {
        const CaseResult& result = timer.runner.results[number];
        if (result.status != CaseStatus::ok) continue;
        sure += planned * of(number);
        more += moreRounds(settings, result, round) * of(number);
    }
    const double limit = settings.timeLimit - seconds(timer.start) - sure;
    return sure + (settings.timeLimit > 0 ? std::clamp(more, 0.0, std::max(0.0, limit)) : more);
}

// `rest` of the round begins with the case that is timed next.
void showTiming(const Timer& timer, std::span<const size_t> rest, uint32_t round) {
    const std::string& id = timer.runner.results[rest.front()].id;
    if (timer.took.empty()) return showProgress(timer.runner, id, kVerifyShare, {});
    const double left = secondsLeft(timer, rest, round), passed = seconds(timer.start);
    showProgress(timer.runner, id, kVerifyShare + (1 - kVerifyShare) * passed / (passed + left), left);
}

}  // namespace

void timeCases(Runner& runner) {
    const BenchSettings& settings = runner.settings;
    Timer timer{runner, {}, {}};
    timer.batches = std::ranges::any_of(
        runner.results, [](const CaseResult& result) { return result.theCase.queues == Queues::async; });
    std::mt19937 random(settings.seed);
    for (uint32_t round = 0; !timer.stopped(); ++round) {
        if (round >= settings.rounds && settings.timeLimit > 0 && seconds(timer.start) > settings.timeLimit) break;
        std::vector<size_t> order;
        for (size_t i = 0; i < runner.results.size(); ++i)
            if (needsRound(settings, runner.results[i], round)) order.push_back(i);
        if (order.empty()) break;
        shuffle(order, random);
        if (settings.freshPlacement) dropAll(timer);
        const auto [from, count] = framesOfRound(settings, round);
        size_t done = 0;
        for (const std::span<const size_t> group : groupsOf(timer, order)) {
            const auto began = Clock::now();
            makeRoom(timer, group);
            bool cold = prepareGroup(timer, group);
            if (cold) timer.preparing = seconds(began);
            for (size_t number : group) {
                if (timer.stopped()) break;
                showTiming(timer, std::span(order).subspan(done++), round);
                const auto start = Clock::now();
                const bool first = std::exchange(cold, false);
                timeCase(timer, number, from, count, first ? kFirstWarmup : kShortestWarmup);
                if (!first) timer.took[number] = seconds(start);
                if (runner.events.checkpoint) runner.events.checkpoint(runner.results);
            }
        }
    }
    if (timer.began && runner.events.timing) runner.events.timing();
    dropAll(timer);
}

}  // namespace skinbench
