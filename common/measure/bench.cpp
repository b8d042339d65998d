#include "common/measure/bench_parts.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <format>
#include <set>

#include "common/core/stats.h"
#include "common/core/text.h"
#include "common/frame/image.h"
#include "common/measure/verify.h"
#include "common/scene/tangents.h"

namespace skinbench {
namespace {

double milliseconds(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

std::string missingReason(const Runner& runner, const Case& c) {
    auto open = runner.backends.find(c.route->api);
    return open == runner.backends.end() ? "not opened" : open->second.missing;
}

}  // namespace

void failCase(CaseResult& result, CaseStatus status, std::string reason) {
    const std::string place = result.id + ": ";  // the label of its plan
    if (reason.starts_with(place)) reason.erase(0, place.size());
    result.status = status;
    result.reason = std::move(reason);
}

Backend* backendOf(const Runner& runner, const Case& c) {
    auto open = runner.backends.find(c.route->api);
    return open == runner.backends.end() ? nullptr : open->second.backend;
}

bool failOnMessages(CaseResult& result, Backend* backend) {
    if (!backend) return false;
    const std::vector<std::string> messages = backend->takeMessages();
    if (messages.empty()) return false;
    failCase(result, CaseStatus::failed, counted(messages.size(), "validation message") + ": " + messages.front());
    return true;
}

Result<Prepared> prepareCase(Runner& runner, CaseResult& result, bool capture) {
    Case c = result.theCase;
    if (capture) c.raster = RasterMode::full;
    result.status = CaseStatus::failed;  // whatever is thrown from here on
    auto planned = planCase(runner.workload, c, backendOf(runner, c), capture);
    if (!planned) {
        if (planned.error().fault != Fault::program) result.status = CaseStatus::skipped;
        return std::unexpected(planned.error());
    }
    planned->plan.label = result.id;
    result.meshlets = planned->ready.meshlets;
    result.memory = planned->ready.memory;
    auto ready = prepareCase(std::move(*planned));
    if (ready) result.status = CaseStatus::ok;
    return ready;
}

namespace {

Result<std::vector<SkinnedVertex>> capturedVertices(const Prepared& ready) {
    const size_t vertices = ready.input.encoded->vertexCount;
    std::vector<SkinnedVertex> captured(vertices * 2);
    if (!ready.plan) {
        std::ranges::copy(std::span(ready.host->out).first(vertices), captured.begin());
        std::ranges::copy(std::span(ready.host->out).last(vertices), captured.begin() + vertices);
        return captured;
    }
    auto bytes = ready.backend->readStream(*ready.plan, SLOT_CAPTURE);
    SKINBENCH_TRY(bytes);
    SKINBENCH_ASSERT(bytes->size() >= captured.size() * sizeof(SkinnedVertex));
    std::memcpy(captured.data(), bytes->data(), captured.size() * sizeof(SkinnedVertex));
    return captured;
}

Result<void> compareWithFirstImage(Runner& runner, CaseResult& result, Prepared& ready) {
    auto image = ready.backend->readImage(*ready.plan);
    SKINBENCH_TRY(image);
    const Case& c = result.theCase;
    // Where positions follow from the numbers of vertices, ordered records show another picture.
    const bool numbered = result.isLimit && c.builder;
    auto [entry, first] =
        runner.firstImages.try_emplace(pictureOf(c) + (numbered ? " numbered" : ""), result.id, Image{});
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

// Many cases draw the same vertices in the same pose. A few hundred mebibytes of references stay.
constexpr size_t kKeptReferences = 8'000'000;  // vertices, of both copies

const References& referencesFor(Runner& runner, const Case& c, const PlanInput& input, const FrameData& frame) {
    const std::tuple key{input.encoded, posesVertices(c), input.palette};
    if (auto known = runner.references.find(key); known != runner.references.end()) return known->second;
    size_t kept = size_t{input.encoded->vertexCount} * 2;
    for (const auto& [other, references] : runner.references)
        kept += references.copies.size() * references.copies.front().source.positions.size();
    if (kept > kKeptReferences) runner.references.clear();
    return runner.references[key] = makeReferences(c, input, frame);
}

// Positions off by their tolerance seldom tilt a normal by more than a thousandth; keeping it in bytes adds what that
// may.
double normalTolerance(const Case& c) { return 1e-3 + (c.compute.wicked ? mostTurnOfBytes() : 0); }

Result<void> verifyKept(const BenchSettings& settings, const Case& c, const Prepared& ready,
                        const std::vector<FrameData>& frames) {
    if (!c.compute.previous && !skinsTangents(c.compute)) return {};
    auto records = ready.backend->readStream(*ready.plan, SLOT_SKINNED);
    SKINBENCH_TRY(records);
    KeptBytes bytes{std::move(*records), {}};
    if (packsTangents(c.compute)) {
        auto tangents = ready.backend->readStream(*ready.plan, SLOT_SKINNED_TANGENT);
        SKINBENCH_TRY(tangents);
        bytes.tangents = std::move(*tangents);
    }
    const KeptError error = keptError(c, ready.input, frames.front(), frames.back(), bytes);
    if (!(error.previous <= settings.tolerance))
        return deviceError(std::format("previous positions are off by {:.3g} of the diagonal (allowed: {:.3g})",
                                       error.previous, settings.tolerance));
    if (!(error.tangent <= normalTolerance(c)))
        return deviceError(
            std::format("tangents are off by {:.3g} rad (allowed: {:.3g})", error.tangent, normalTolerance(c)));
    return {};
}

Result<void> verifyDrawn(Runner& runner, CaseResult& result, Prepared& ready) {
    auto frames = framesOfPose(runner.workload, result.theCase);
    SKINBENCH_TRY(frames);
    SKINBENCH_TRY(drawFrames(ready, *frames, modeOf(result.theCase)));
    auto captured = capturedVertices(ready);
    SKINBENCH_TRY(captured);
    const References& references = referencesFor(runner, result.theCase, ready.input, frames->back());
    auto verdicts = readVerdicts(result.theCase, ready);
    SKINBENCH_TRY(verdicts);
    const CapturedError errors =
        capturedError(references, *captured, verticesLeftOut(result.theCase, ready.input, *verdicts));
    const SkinError* error = &errors.decoded;
    const std::optional<double>& bound = references.bound;
    result.accuracy =
        Accuracy{errors.decoded, runner.settings.tolerance, errors.source, 0, {}, bound, references.rowsError};
    if (!(error->position <= runner.settings.tolerance))
        return deviceError(std::format("positions are off by {:.3g} of the diagonal (allowed: {:.3g})", error->position,
                                       runner.settings.tolerance));
    const double most = normalTolerance(result.theCase);
    if (!(error->normal <= most))
        return deviceError(std::format("normals are off by {:.3g} rad (allowed: {:.3g})", error->normal, most));
    // What is left out must be rare, or the rest says little.
    if (error->undecided * 20 > captured->size() / 2)
        return deviceError(std::format("the sign of a quaternion is undecided for {} of {} vertices", error->undecided,
                                       captured->size() / 2));
    if (bound && !(errors.source.position <= *bound + runner.settings.tolerance))
        return deviceError(std::format("codec {} moves positions by {:.3g} of the diagonal (its bound: {:.3g})",
                                       result.theCase.codec->name, errors.source.position, *bound));
    if (!verdicts->empty()) result.culling = cullingOf(result.theCase, ready.input, frames->back(), *verdicts);
    if (result.culling && result.culling->wrong)
        return deviceError(std::format("{} of {} meshlets were left out that can be seen", result.culling->wrong,
                                       result.culling->meshlets));
    if (auto kept = verifyKept(runner.settings, result.theCase, ready, *frames); !kept) return kept;
    return ready.plan ? compareWithFirstImage(runner, result, ready) : Result<void>{};
}

void verifyCase(Runner& runner, CaseResult& result) {
    const Case& c = result.theCase;
    Backend* backend = backendOf(runner, c);
    if (!backend && c.route->api != Api::cpu) return failCase(result, CaseStatus::skipped, missingReason(runner, c));
    if (backend)
        if (auto reason = unsupported(c, backend->caps())) return failCase(result, CaseStatus::skipped, *reason);

    // Raster modes share their shaders and buffers, so the first one's verification stands for all.
    auto [known, fresh] = runner.verifiedAs.try_emplace(keyOf(c, Changes::plan), &result - runner.results.data());
    if (!fresh) {
        const CaseResult& same = runner.results[known->second];
        result.status = same.status;
        result.reason = same.reason;
        result.accuracy = same.accuracy;
        result.culling = same.culling;
        result.meshlets = same.meshlets;
        result.memory = same.memory;
        return;
    }
    auto ready = attempt([&] { return prepareCase(runner, result, true); });
    if (!ready) return failCase(result, result.status, ready.error().text);
    auto verified = attempt([&] { return verifyDrawn(runner, result, *ready); });
    releaseCase(*ready);
    if (failOnMessages(result, backend)) return;
    if (!verified) return failCase(result, CaseStatus::failed, verified.error().text);
    result.status = CaseStatus::ok;
}

}  // namespace

static CaseResult resultFor(const Case& c) {
    CaseResult result;
    result.theCase = c;
    result.id = caseId(c);
    result.reason = "interrupted before it was verified";
    return result;
}

void showProgress(Runner& runner, const std::string& what, double fraction, std::optional<double> secondsLeft) {
    runner.shown = std::max(runner.shown, fraction);
    if (runner.events.progress) runner.events.progress({what, runner.shown, secondsLeft});
}

// Verifies results[i], one of `count`.
static Result<void> verifyResult(Runner& runner, size_t i, size_t count) {
    CaseResult& result = runner.results[i];
    const double share = static_cast<double>(i) / static_cast<double>(count);
    const double passed = milliseconds(runner.start) * 1e-3;
    showProgress(runner, "verify " + result.id, share * (runner.settings.timed ? kVerifyShare : 1),
                 runner.settings.timed || i == 0 ? std::nullopt : std::optional(passed * (1 - share) / share));
    auto scene = attempt([&] { return sceneFor(runner.workload, result.theCase.influences); });
    if (!scene && scene.error().fault == Fault::input) return std::unexpected(scene.error());
    if (scene)
        verifyCase(runner, result);
    else
        failCase(result, CaseStatus::failed, scene.error().text);
    if (runner.events.checkpoint) runner.events.checkpoint(runner.results);
    return {};
}

// The limits of the cases that are right, each once.
static void addLimits(std::vector<CaseResult>& results) {
    const size_t cases = results.size();
    std::map<std::string, bool> known;
    for (size_t i = 0; i < cases; ++i) {
        if (results[i].status != CaseStatus::ok) continue;
        const std::optional<Case> limit = limitCase(results[i].theCase);
        if (!limit) continue;
        results[i].limitId = caseId(*limit);
        if (!known.try_emplace(results[i].limitId).second) continue;
        results.push_back(resultFor(*limit));
        results.back().isLimit = true;
    }
}

// As many as addLimits adds when every case is right.
static size_t countLimits(const std::vector<CaseResult>& results) {
    std::set<std::string> ids;
    for (const CaseResult& result : results)
        if (const std::optional<Case> limit = limitCase(result.theCase)) ids.insert(caseId(*limit));
    return ids.size();
}

Result<std::vector<CaseResult>> runBench(Workload& workload, const std::vector<Case>& cases, const Backends& backends,
                                         const BenchSettings& settings, const BenchEvents& events) {
    Runner runner{workload, backends, settings, events};
    for (const Case& c : cases) {
        runner.results.push_back(resultFor(c));
        if (!settings.selfTest) continue;
        runner.results.push_back(resultFor(c));
        runner.results.back().id += "+again";
        runner.results.back().isAgain = true;
    }
    auto stopped = [&] { return events.stop && events.stop(); };
    const size_t asked = runner.results.size();
    const bool limits = settings.timed && settings.limits;
    const size_t count = asked + (limits ? countLimits(runner.results) : 0);
    for (size_t i = 0; i < asked && !stopped(); ++i) SKINBENCH_TRY(verifyResult(runner, i, count));
    if (limits) addLimits(runner.results);
    for (size_t i = asked; i < runner.results.size() && !stopped(); ++i) SKINBENCH_TRY(verifyResult(runner, i, count));
    if (settings.timed) timeCases(runner);
    for (CaseResult& result : runner.results)
        if (settings.timed && result.status == CaseStatus::ok && result.total.empty())
            failCase(result, CaseStatus::skipped, "interrupted before it was timed");
    showProgress(runner, "", 1, 0);
    return std::move(runner.results);
}

Result<Picture> renderPicture(Workload& workload, const Case& c, Backend& backend) {
    if (auto reason = unsupported(c, backend.caps())) return deviceError(*reason);
    const Backends backends{{c.route->api, {&backend, {}}}};
    const BenchSettings settings;
    const BenchEvents events;
    Runner runner{workload, backends, settings, events};
    CaseResult result;
    result.theCase = c;
    result.id = caseId(c);
    auto ready = prepareCase(runner, result, true);
    SKINBENCH_TRY(ready);
    const auto verified = verifyDrawn(runner, result, *ready);
    Result<Image> image = backend.readImage(*ready->plan);
    releaseCase(*ready);
    if (!image) return std::unexpected(verified ? image.error() : verified.error());
    return Picture{std::move(*image), verified ? "" : verified.error().text, result.accuracy, result.culling};
}

Result<Image> renderImage(Workload& workload, const Case& c, Backend& backend) {
    auto picture = renderPicture(workload, c, backend);
    SKINBENCH_TRY(picture);
    if (!picture->fault.empty()) return deviceError(picture->fault);
    return std::move(picture->image);
}

}  // namespace skinbench
