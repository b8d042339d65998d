#include "common/bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <format>
#include <random>
#include <thread>

#include "common/image.h"
#include "common/stats.h"
#include "common/verify.h"

namespace skinbench {
namespace {

// Frames that are recorded and submitted together; bounds the memory that their palettes take.
constexpr uint32_t kBatch = 16;

constexpr double kSettled = 0.005;  // relative difference of two warm-up runs
// Milliseconds. An idle GPU holds its low clocks for a while, steadily, and longest after a case was prepared.
constexpr double kShortestWarmup = 300;
constexpr double kShortestFirstWarmup = 1000;
constexpr double kLongestWarmup = 3000;

double milliseconds(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

unsigned allCores() { return std::max(1u, std::thread::hardware_concurrency()); }

bool skinsOnHost(const Case& which) { return which.variant == findVariant("cpu"); }

// The copies' own vertices for skinning on the host, and room for the result.
struct HostSkinning {
    std::vector<Mesh> copies;
    std::vector<Palette> palettes;
    std::vector<SkinnedVertex> out;
};

HostSkinning makeHostSkinning(const Scene& scene, uint32_t copies) {
    HostSkinning host;
    host.copies.assign(copies, scene.mesh);
    host.palettes.resize(copies);
    host.out.resize(size_t{copies} * scene.mesh.positions.size());
    return host;
}

double skinFrame(HostSkinning& host, const FrameData& frame) {
    const auto copies = static_cast<uint32_t>(host.copies.size());
    for (uint32_t copy = 0; copy < copies; ++copy) host.palettes[copy] = paletteOfCopy(frame, copies, copy);
    const auto start = std::chrono::steady_clock::now();
    skinOnCpu({host.copies, host.palettes, host.out}, allCores());
    return milliseconds(start);
}

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
    std::vector<CaseResult> results;
    std::map<std::string, std::pair<std::string, Image>> firstImages;  // by what a picture depends on
    std::map<std::string, size_t> verifiedAs;                          // id without the raster mode -> result
};

void fail(CaseResult& result, CaseStatus status, std::string reason) {
    result.status = status;
    result.reason = std::move(reason);
}

Backend* backendOf(const Runner& runner, const Case& which) {
    auto open = runner.backends.find(which.route->api);
    return open == runner.backends.end() ? nullptr : open->second.backend;
}

std::string missingReason(const Runner& runner, const Case& which) {
    auto open = runner.backends.find(which.route->api);
    return open == runner.backends.end() ? "not opened" : open->second.missing;
}

Result<std::vector<FrameData>> frameRange(Runner& runner, const Case& which, uint32_t first, uint32_t count) {
    std::vector<FrameData> frames;
    for (uint32_t i = 0; i < count; ++i) {
        auto frame = makeFrame(runner.workload, which.influences, first + i);
        if (!frame) return std::unexpected(frame.error());
        frames.push_back(std::move(*frame));
    }
    return frames;
}

// Adds one frame's times to the result; `skin` is the host's share.
void recordFrame(CaseResult& result, const Prepared& ready, const Timing& timing, double skin) {
    double total = 0;
    auto add = [&](const std::string& label, double value) {
        result.passes[label].push_back(value);
        total += value;
    };
    if (ready.host) add("skin", skin);
    if (ready.host && ready.plan) add("upload", timing.upload);
    for (size_t pass = 0; pass < timing.passes.size(); ++pass) add(ready.labels[pass], timing.passes[pass]);
    result.total.push_back(total);
    result.record.push_back(timing.record);
    result.submit.push_back(timing.submit);
}

// Draws the frames and adds their times to `result`.
Result<void> drawFrames(CaseResult& result, Prepared& ready, std::span<const FrameData> frames) {
    // Host skinning happens right before its frame, so such frames are drawn one by one.
    const size_t batch = ready.host ? 1 : kBatch;
    for (size_t start = 0; start < frames.size(); start += batch) {
        double skin = 0;
        std::vector<FrameInput> inputs;
        std::vector<std::vector<std::byte>> blocked;
        for (const FrameData& frame : frames.subspan(start, std::min(batch, frames.size() - start))) {
            FrameInput input;
            input.constants = frame.constants;
            if (ready.host) {
                skin = skinFrame(*ready.host, frame);
                input.skinned = std::as_bytes(std::span(ready.host->out));
            } else if (ready.blocks) {
                blocked.push_back(blockedPalettes(frame, ready.input.copies, *ready.blocks));
                input.palette = blocked.back();
            } else {
                input.palette = std::as_bytes(std::span(frame.palettes));
            }
            inputs.push_back(input);
        }
        std::vector<Timing> timings(inputs.size());
        if (ready.plan) {
            auto run = ready.backend->run(*ready.plan, inputs);
            if (!run) return std::unexpected(run.error());
            timings = std::move(*run);
        }
        for (const Timing& timing : timings) recordFrame(result, ready, timing, skin);
    }
    return {};
}

// Draws the first frames again and again until two runs in a row agree, because a GPU that has waited for the host
// needs a while to raise its clocks. Software drivers and host skinning never settle so well and get one run.
Result<void> warmUp(const BenchSettings& settings, const CaseResult& like, Prepared& ready,
                    std::span<const FrameData> frames, double shortest) {
    const auto some = frames.first(std::min<size_t>(settings.warmup, frames.size()));
    if (some.empty()) return {};
    const bool settles = ready.plan && !ready.host && !ready.backend->caps().software;
    const auto start = std::chrono::steady_clock::now();
    double last = 0;
    for (;;) {
        CaseResult scratch;
        scratch.which = like.which;
        if (auto drawn = drawFrames(scratch, ready, some); !drawn) return drawn;
        const double now = summarise(scratch.total).mean;
        const double passed = milliseconds(start);
        const bool settled = std::abs(now - last) <= kSettled * last && passed >= shortest;
        if (!settles || settled || passed > kLongestWarmup) return {};
        last = now;
    }
}

// Nothing is allocated when it fails; `result` then has the status that the fault deserves.
Result<Prepared> prepareCase(Runner& runner, CaseResult& result, bool capture) {
    Case which = result.which;
    if (capture) which.raster = RasterMode::full;
    auto input = planInput(runner.workload, which);
    if (!input) return std::unexpected(input.error());
    input->capture = capture;
    Prepared ready;
    ready.backend = backendOf(runner, which);
    auto plan = makePlan(which, *input, ready.backend ? ready.backend->caps() : DeviceCaps{});
    if (!plan) {
        result.status = CaseStatus::skipped;
        return std::unexpected(plan.error());
    }
    if (input->meshlets) result.meshlets = static_cast<uint32_t>(input->meshlets->meshlets.size());
    result.memory = memoryOfOneCopy(*plan, input->copies);
    ready.input = *input;
    ready.blocks = paletteBlocks(which, *input);
    for (const Pass& pass : plan->passes) ready.labels.push_back(pass.label);
    if (skinsOnHost(which)) ready.host = std::make_unique<HostSkinning>(makeHostSkinning(*input->scene, input->copies));
    if (ready.backend) {
        auto id = ready.backend->prepare(*plan);
        if (!id) {
            result.status = CaseStatus::failed;
            return std::unexpected(id.error());
        }
        ready.plan = *id;
    }
    return ready;
}

void releaseCase(Prepared& ready) {
    if (ready.plan) ready.backend->release(*ready.plan);
    ready = {};
}

Result<std::vector<SkinnedVertex>> capturedVertices(const Prepared& ready) {
    const size_t vertices = ready.input.encoded->vertexCount;
    std::vector<SkinnedVertex> captured(vertices * 2);
    if (!ready.plan) {
        std::ranges::copy(std::span(ready.host->out).first(vertices), captured.begin());
        std::ranges::copy(std::span(ready.host->out).last(vertices), captured.begin() + vertices);
        return captured;
    }
    auto bytes = ready.backend->readStream(*ready.plan, SLOT_CAPTURE);
    if (!bytes) return std::unexpected(bytes.error());
    SKINBENCH_ASSERT(bytes->size() >= captured.size() * sizeof(SkinnedVertex));
    std::memcpy(captured.data(), bytes->data(), captured.size() * sizeof(SkinnedVertex));
    return captured;
}

Result<void> compareWithFirstImage(Runner& runner, CaseResult& result, Prepared& ready) {
    auto image = ready.backend->readImage(*ready.plan);
    if (!image) return std::unexpected(image.error());
    const Case& which = result.which;
    const std::string words = std::format("{} {} {}", which.variant->skins, which.influences, which.codec->name);
    auto [entry, first] = runner.firstImages.try_emplace(words, result.id, Image{});
    if (first) entry->second.second = std::move(*image);
    result.accuracy->imageReference = entry->second.first;
    if (first) return {};
    const ImageDifference difference = compareImages(entry->second.second, *image, runner.settings.imageThreshold);
    result.accuracy->imageDifference = difference.fraction;
    if (difference.fraction > runner.settings.imageFraction)
        return deviceError(std::format("{:.3f} % of its pixels differ from those of {} (allowed: {:.3f} %)",
                                       difference.fraction * 100, entry->second.first,
                                       runner.settings.imageFraction * 100));
    return {};
}

// The last one is frame 0, whatever the case, so that all images show one pose. Where vertices keep their last
// position, frame 1 comes first; where some copies are skinned every second frame, each pose is drawn twice.
Result<std::vector<FrameData>> framesToVerify(Runner& runner, const Case& which) {
    auto poses = frameRange(runner, which, 0, which.compute.previous ? 2 : 1);
    if (!poses) return poses;
    std::vector<FrameData> frames;
    for (auto pose = poses->rbegin(); pose != poses->rend(); ++pose)
        frames.insert(frames.end(), which.compute.halfRate ? 2 : 1, *pose);
    for (size_t i = 0; i < frames.size(); ++i) frames[i].constants.grid.w = static_cast<float>(i);
    return frames;
}

constexpr double kNormalTolerance = 1e-3;  // positions off by their tolerance seldom tilt a normal by more

Result<void> verifyKept(const BenchSettings& settings, const Case& which, const Prepared& ready,
                        const std::vector<FrameData>& frames) {
    if (!which.compute.previous && !which.compute.tangents) return {};
    auto records = ready.backend->readStream(*ready.plan, SLOT_SKINNED);
    if (!records) return std::unexpected(records.error());
    const KeptError error = keptError(which, ready.input, frames.front(), frames.back(), *records);
    if (!(error.previous <= settings.tolerance))
        return deviceError(std::format("previous positions are off by {:.3g} of the diagonal (allowed: {:.3g})",
                                       error.previous, settings.tolerance));
    if (!(error.tangent <= kNormalTolerance))
        return deviceError(
            std::format("tangents are off by {:.3g} rad (allowed: {:.3g})", error.tangent, kNormalTolerance));
    return {};
}

Result<void> verifyDrawn(Runner& runner, CaseResult& result, Prepared& ready) {
    auto frames = framesToVerify(runner, result.which);
    if (!frames) return std::unexpected(frames.error());
    CaseResult untimed;
    if (auto drawn = drawFrames(untimed, ready, *frames); !drawn) return drawn;
    auto captured = capturedVertices(ready);
    if (!captured) return std::unexpected(captured.error());
    const CapturedError errors = capturedError(result.which, ready.input, frames->back(), *captured);
    const SkinError* error = &errors.decoded;
    result.accuracy = Accuracy{errors.decoded, runner.settings.tolerance, errors.source, 0, {}};
    if (!(error->position <= runner.settings.tolerance))
        return deviceError(std::format("positions are off by {:.3g} of the diagonal (allowed: {:.3g})", error->position,
                                       runner.settings.tolerance));
    if (!(error->normal <= kNormalTolerance))
        return deviceError(
            std::format("normals are off by {:.3g} rad (allowed: {:.3g})", error->normal, kNormalTolerance));
    if (auto kept = verifyKept(runner.settings, result.which, ready, *frames); !kept) return kept;
    return ready.plan ? compareWithFirstImage(runner, result, ready) : Result<void>{};
}

// A message of the validation layer fails the case that caused it.
bool failOnMessages(CaseResult& result, Backend* backend) {
    if (!backend) return false;
    const std::vector<std::string> messages = backend->takeMessages();
    if (messages.empty()) return false;
    fail(
        result, CaseStatus::failed,
        std::format("{} validation message{}: {}", messages.size(), messages.size() == 1 ? "" : "s", messages.front()));
    return true;
}

void verifyCase(Runner& runner, CaseResult& result) {
    const Case& which = result.which;
    Backend* backend = backendOf(runner, which);
    if (!backend && which.route->api != Api::cpu)
        return fail(result, CaseStatus::skipped, missingReason(runner, which));
    if (backend)
        if (auto reason = unsupported(which, backend->caps())) return fail(result, CaseStatus::skipped, *reason);

    // Raster modes share their shaders and buffers, so the first one's verification stands for all.
    Case plain = which;
    plain.raster = RasterMode::full;
    auto [known, fresh] = runner.verifiedAs.try_emplace(caseId(plain), &result - runner.results.data());
    if (!fresh) {
        const CaseResult& same = runner.results[known->second];
        result.status = same.status;
        result.reason = same.reason;
        result.accuracy = same.accuracy;
        result.meshlets = same.meshlets;
        return;
    }
    auto ready = prepareCase(runner, result, true);
    if (!ready) return fail(result, result.status, ready.error().text);
    auto verified = verifyDrawn(runner, result, *ready);
    releaseCase(*ready);
    if (failOnMessages(result, backend)) return;
    if (!verified) return fail(result, CaseStatus::failed, verified.error().text);
    result.status = CaseStatus::ok;
}

// Prepared plans stay on the device between rounds as long as they fit in half of its memory.
uint64_t residentBudget(const Backend* backend) {
    const uint64_t device = backend && !backend->caps().software ? backend->caps().deviceBytes : 0;
    return device ? device / 2 : uint64_t{4} << 30;
}

struct Resident {
    std::map<size_t, Prepared> plans;  // by result number
    std::map<Backend*, uint64_t> bytes;
};

void timeCase(Runner& runner, size_t number, uint32_t round, Resident& resident) {
    CaseResult& result = runner.results[number];
    auto place = resident.plans.find(number);
    const bool fresh = place == resident.plans.end();
    if (fresh) {
        auto ready = prepareCase(runner, result, false);
        if (!ready) return fail(result, CaseStatus::failed, ready.error().text);
        place = resident.plans.emplace(number, std::move(*ready)).first;
        resident.bytes[place->second.backend] += result.memory->total() * runner.workload.settings.copies;
    }
    Prepared& ready = place->second;
    const BenchSettings& settings = runner.settings;
    const uint32_t from = settings.frames * round / settings.rounds,
                   to = settings.frames * (round + 1) / settings.rounds;
    // Frames are posed a batch at a time: a hundred thousand of them would not fit in memory.
    Result<void> drawn;
    for (uint32_t first = from; first < to && drawn; first += kBatch) {
        auto frames = frameRange(runner, result.which, first, std::min(kBatch, to - first));
        if (!frames) drawn = std::unexpected(frames.error());
        const double shortest = fresh ? kShortestFirstWarmup : kShortestWarmup;
        if (drawn && first == from) drawn = warmUp(settings, result, ready, *frames, shortest);
        if (drawn) drawn = drawFrames(result, ready, *frames);
    }
    if (!drawn) fail(result, CaseStatus::failed, drawn.error().text);
    failOnMessages(result, ready.backend);
    if (resident.bytes[ready.backend] > residentBudget(ready.backend) || result.status == CaseStatus::failed) {
        resident.bytes[ready.backend] -= result.memory->total() * runner.workload.settings.copies;
        releaseCase(ready);
        resident.plans.erase(place);
    }
}

// A seeded Fisher-Yates shuffle: std::shuffle's order differs between standard libraries.
void shuffle(std::vector<size_t>& order, std::mt19937& random) {
    for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
}

Result<void> timeAll(Runner& runner) {
    std::vector<size_t> order;
    for (size_t i = 0; i < runner.results.size(); ++i)
        if (runner.results[i].status == CaseStatus::ok) order.push_back(i);
    std::mt19937 random(runner.settings.seed);
    Resident resident;
    Result<void> outcome;
    bool stopped = false;
    const double steps = static_cast<double>(order.size()) * runner.settings.rounds;
    double done = 0;
    for (uint32_t round = 0; round < runner.settings.rounds && !stopped && outcome; ++round) {
        shuffle(order, random);
        for (size_t number : order) {
            if ((stopped = runner.events.stop && runner.events.stop())) break;
            CaseResult& result = runner.results[number];
            if (runner.events.progress) runner.events.progress(result.id, 0.3 + 0.7 * done / steps);
            if (result.status == CaseStatus::ok) timeCase(runner, number, round, resident);
            ++done;
            if (runner.events.checkpoint) outcome = runner.events.checkpoint(runner.results);
            if (!outcome) break;
        }
    }
    for (auto& [number, ready] : resident.plans) releaseCase(ready);
    return outcome;
}

}  // namespace

Result<std::vector<CaseResult>> runBench(Workload& workload, const std::vector<Case>& cases, const Backends& backends,
                                         const BenchSettings& settings, const BenchEvents& events) {
    Runner runner{workload, backends, settings, events, {}, {}, {}};
    for (const Case& which : cases) {
        CaseResult result;
        result.which = which;
        result.id = caseId(which);
        result.reason = "interrupted before it was verified";
        runner.results.push_back(std::move(result));
    }
    for (size_t i = 0; i < cases.size(); ++i) {
        if (events.stop && events.stop()) break;
        if (events.progress)
            events.progress("verify " + runner.results[i].id,
                            (settings.timed ? 0.3 : 1.0) * static_cast<double>(i) / static_cast<double>(cases.size()));
        if (auto scene = sceneFor(workload, cases[i].influences); !scene) return std::unexpected(scene.error());
        verifyCase(runner, runner.results[i]);
        if (events.checkpoint)
            if (auto kept = events.checkpoint(runner.results); !kept) return std::unexpected(kept.error());
    }
    if (settings.timed)
        if (auto timed = timeAll(runner); !timed) return std::unexpected(timed.error());
    for (CaseResult& result : runner.results)
        if (settings.timed && result.status == CaseStatus::ok && result.total.empty())
            fail(result, CaseStatus::skipped, "interrupted before it was timed");
    if (events.progress) events.progress("", 1);
    return std::move(runner.results);
}

Result<Image> renderImage(Workload& workload, const Case& which, Backend& backend) {
    if (auto reason = unsupported(which, backend.caps())) return deviceError(*reason);
    const Backends backends{{which.route->api, {&backend, {}}}};
    const BenchSettings settings;
    Runner runner{workload, backends, settings, {}, {}, {}, {}};
    CaseResult result;
    result.which = which;
    result.id = caseId(which);
    auto ready = prepareCase(runner, result, true);
    if (!ready) return std::unexpected(ready.error());
    auto verified = verifyDrawn(runner, result, *ready);
    Result<Image> image = verified ? backend.readImage(*ready->plan) : std::unexpected(verified.error());
    releaseCase(*ready);
    return image;
}

}  // namespace skinbench
