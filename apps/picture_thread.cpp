#include "apps/picture_thread.h"

#include <algorithm>
#include <format>

#include "common/core/text.h"
#include "common/measure/picking.h"
#include "common/plans/plan_parts.h"
#include "common/report/columns.h"

namespace skinbench {
namespace {

// One case on its device, as it was last prepared.
struct Lane {
    std::string key;  // what it was prepared for
    Result<Prepared> ready;
    std::vector<std::string> facts;
};

// Everything that the thread has.
struct Work {
    Devices devices;
    std::optional<Error> refused;  // the device that was named
    SceneInfo scene;
    std::optional<Workload> workload;  // of the scene
    std::vector<Lane> lanes;
};

void openBoth(Work& work, const PictureOptions& options) {
    const std::vector<const Route*> routes = {findRoute("vk"), findRoute("gl")};
    auto devices = attempt([&] { return openDevices(routes, options.device, options.validation); });
    if (devices) {
        work.devices = std::move(*devices);
        return;
    }
    work.refused = devices.error();
    for (const Route* route : routes) work.devices.byApi[route->api].missing = devices.error().text;
}

void drop(Lane& lane) {
    if (lane.ready) releaseCase(*lane.ready);
    lane = {};
}

Result<void> loadScene(Work& work, const PictureRequest& request) {
    const std::string& name = request.scene;
    if (work.workload && work.scene.name == name) return {};
    auto workload = attempt([&]() -> Result<Workload> {
        auto opened = openWorkload(name, {.prepare = request.settings.prepare});
        SKINBENCH_TRY(opened);
        SKINBENCH_TRY(sceneFor(*opened, 4));
        return opened;
    });
    SKINBENCH_TRY(workload);
    for (Lane& lane : work.lanes) drop(lane);
    work.workload = std::move(*workload);
    work.scene = {name, sceneText(sceneStats(**sceneFor(*work.workload, 4))), {}};
    for (const Clip& clip : work.workload->stored.clips) work.scene.clips.push_back(clip.name);
    return {};
}

// What the request wants of the workload. A clip that the scene lacks is an error, and its first one.
Result<void> settle(Workload& workload, const WorkloadSettings& wanted) {
    const auto chosen = workload.settings.clip == wanted.clip ? Result<void>() : chooseClip(workload, wanted.clip);
    if (!chosen) chooseClip(workload, "");
    const std::string clip = workload.settings.clip;
    workload.settings = wanted;
    workload.settings.clip = clip;
    return chosen;
}

// What a lane is prepared for.
std::string keyOf(const PictureRequest& request, const Case& c) {
    const WorkloadSettings& settings = request.settings;
    const glm::vec3& background = request.background;
    return std::format("{} {} {} {} {} {} {} {}", caseId(c), settings.clip, settings.copies, settings.width,
                       settings.height, background.x, background.y, background.z);
}

// Whether no lane is prepared anew for the request, which would take away what is in flight.
bool follows(const Work& work, const PictureRequest& request) {
    const auto isReady = [&](const Lane& lane, const Case& c) { return lane.key == keyOf(request, c); };
    return request.scene == work.scene.name && std::ranges::equal(work.lanes, request.cases, isReady);
}

// The figures of a result under one key of result files: "memory_bytes: vertex 331776, index 12288".
std::string figuresText(const CaseResult& result, const std::string& key) {
    nlohmann::ordered_json row;
    putColumns(row, {RunContext(), {}, result}, {key});
    std::string text;
    for (const auto& [name, value] : row[key].items())
        if (value.is_number() && value != 0)
            text += std::format("{} {} {}", text.empty() ? key + ":" : ",", name,
                                value.is_number_float() ? std::format("{:.3g}", value.get<double>()) : value.dump());
    return text;
}

void prepareLane(Work& work, Lane& lane, const PictureRequest& request, const Case& c) {
    std::string key = keyOf(request, c);
    if (lane.key == key) return;
    drop(lane);
    lane.key = std::move(key);
    lane.ready = attempt([&]() -> Result<Prepared> {
        if (auto reason = reasonAgainst(c, work.devices.byApi)) return deviceError(*reason);
        auto planned = planCase(*work.workload, c, work.devices.byApi[c.route->api].backend, false);
        SKINBENCH_TRY(planned);
        const glm::vec3& background = request.background;
        planned->plan.background = {background.x, background.y, background.z, 1};
        return prepareCase(std::move(*planned));
    });
    if (!lane.ready) return;
    CaseResult result;
    result.memory = lane.ready->memory;
    lane.facts = {figuresText(result, "memory_bytes")};
    const PlanInput& input = lane.ready->input;
    if (!input.meshlets) return;
    const MeshletStats stats = meshletStats(decodedMesh(input), *input.meshlets);
    lane.facts.push_back(
        std::format("{}: {:.1f} vertices, {:.1f} triangles, {:.1f} tuples each; each vertex {:.2f} times",
                    counted(stats.meshlets, "meshlet"), stats.meanVertices, stats.meanTriangles, stats.meanUniqueTuples,
                    stats.vertexReuse));
}

// The error of the picture, and what the pipeline counts in one more such frame where the device counts.
Result<void> verify(Workload& workload, const Case& c, Prepared& ready, const FrameData& frame, CasePicture& picture) {
    const auto checked = renderPicture(workload, c, *ready.backend);
    SKINBENCH_TRY(checked);
    picture.fault = checked->fault;
    CaseResult result;
    result.accuracy = checked->accuracy;
    if (const auto counted = drawFrames(ready, {&frame, 1}, RunMode::counted))
        result.counters = counted->back().timing.counters;
    picture.accuracy = {checked->fault.empty() ? figuresText(result, "accuracy") : checked->fault,
                        figuresText(result, "counters")};
    return {};
}

Result<void> begin(Work& work, Pictures& pictures, size_t number) {
    const PictureRequest& request = pictures.request;
    const Case& c = request.cases[number];
    CasePicture& picture = pictures.all[number];
    Lane& lane = work.lanes[number];
    picture.id = caseId(c);
    prepareLane(work, lane, request, c);
    if (!lane.ready) return std::unexpected(lane.ready.error());
    Prepared& ready = *lane.ready;
    picture.facts = lane.facts;
    const auto frames = framesOfPose(*work.workload, c);
    SKINBENCH_TRY(frames);
    SKINBENCH_TRY(beginPicture(ready, *frames));
    picture.begun = true;
    if (c.view == View::culled) {
        const auto verdicts = readVerdicts(c, ready);
        SKINBENCH_TRY(verdicts);
        picture.legend = legendOf(c, countVerdicts(c, ready.input, *verdicts));
    }
    if (request.accuracy) SKINBENCH_TRY(verify(*work.workload, c, ready, frames->back(), picture));
    if (!request.pick || request.pick->picture != number) return {};
    const auto verdicts = attempt([&] { return verdictsOfPose(*work.workload, c, *ready.backend); });
    picture.picked =
        pickLines(c, ready.input, frames->back(), request.pick->at, verdicts ? *verdicts : std::vector<uint32_t>());
    return {};
}

Pictures begin(Work& work, PictureRequest wanted) {
    Pictures pictures;
    pictures.request = std::move(wanted);
    const PictureRequest& request = pictures.request;
    pictures.all.resize(request.cases.size());
    pictures.error = work.refused;
    if (work.refused) return pictures;
    if (auto loaded = loadScene(work, request); !loaded) pictures.error = loaded.error();
    if (!work.workload) return pictures;
    pictures.scene = work.scene;
    if (auto settled = settle(*work.workload, request.settings); !settled && !pictures.error)
        pictures.error = settled.error();
    if (const Clip* clip = chosenClip(*work.workload)) pictures.duration = clip->duration;
    const int influences = request.cases.front().influences;
    if (const auto framing = framingOf(*work.workload, influences)) {
        pictures.look = lookOf(*framing);
        pictures.overview = overviewOf(*framing);
    }
    if (request.accuracy)
        if (const auto seen = inView(*work.workload, influences)) pictures.warning = viewWarning(*work.workload, *seen);
    while (work.lanes.size() > request.cases.size()) {
        drop(work.lanes.back());
        work.lanes.pop_back();
    }
    work.lanes.resize(request.cases.size());
    for (size_t i = 0; i < request.cases.size(); ++i)
        if (const auto done = attempt([&] { return begin(work, pictures, i); }); !done)
            pictures.all[i].error = done.error();
    return pictures;
}

void finish(Work& work, Pictures& pictures) {
    for (size_t i = 0; i < pictures.all.size(); ++i) {
        CasePicture& picture = pictures.all[i];
        if (picture.begun) {
            auto finished = attempt([&] { return finishPicture(*work.lanes[i].ready); });
            if (!finished && !picture.error) picture.error = finished.error();
            if (finished) picture.passes = std::move(finished->passes);
            if (finished) picture.image = std::move(finished->image);
        }
        for (const auto& [name, ms] : picture.passes) picture.total += ms;
        picture.title = std::format("{:.3f} ms  {}", picture.total, picture.id);
    }
    const uint32_t amplify = pictures.request.amplify;
    if (amplify && pictures.all.size() == 2 && pictures.all[0].image.width && pictures.all[1].image.width) {
        const Image &a = pictures.all[0].image, &b = pictures.all[1].image;
        DifferenceImage found = differenceImage(a, b, amplify);
        CasePicture difference;
        difference.title = std::format("|A - B| x {}: {} of {} pixels differ, by {} of 255 at the most", amplify,
                                       found.pixels, a.width * a.height, found.largest);
        difference.image = std::move(found.image);
        pictures.all.push_back(std::move(difference));
    }
    for (const auto& backend : work.devices.owned)
        for (std::string& message : backend->takeMessages()) pictures.messages.push_back(std::move(message));
}

}  // namespace

PictureThread::PictureThread(const PictureOptions& options)
    : options_(options), thread_([this](const std::stop_token& stop) { work(stop); }) {}

PictureThread::~PictureThread() {
    std::lock_guard lock(mutex_);
    requests_.clear();  // nobody waits for them
}

void PictureThread::post(PictureRequest request) {
    std::lock_guard lock(mutex_);
    // What was asked for once is not lost with the frame that asked.
    if (!options_.every && !requests_.empty()) {
        request.accuracy = request.accuracy || requests_.back().accuracy;
        if (!request.pick) request.pick = requests_.back().pick;
        requests_.clear();
    }
    requests_.push_back(std::move(request));
    changed_.notify_all();
}

std::shared_ptr<const Pictures> PictureThread::take(bool waits) {
    std::unique_lock lock(mutex_);
    if (waits) changed_.wait(lock, [&] { return !answers_.empty(); });
    if (answers_.empty()) return nullptr;
    auto answer = std::move(answers_.front());
    answers_.pop_front();
    return answer;
}

const Backends& PictureThread::backends() const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !backends_.empty(); });
    return backends_;
}

void PictureThread::work(const std::stop_token& stop) {
    Work work;
    openBoth(work, options_);
    {
        std::lock_guard lock(mutex_);
        backends_ = work.devices.byApi;
        changed_.notify_all();
    }
    std::deque<Pictures> begun;
    while (true) {
        std::optional<PictureRequest> next;
        {
            std::unique_lock lock(mutex_);
            if (begun.empty() && !changed_.wait(lock, stop, [&] { return !requests_.empty(); })) break;
            const bool room = begun.size() < kFramesInFlight && !requests_.empty();
            if (room && (begun.empty() || follows(work, requests_.front()))) {
                next = std::move(requests_.front());
                requests_.pop_front();
            }
        }
        if (next) {
            begun.push_back(begin(work, std::move(*next)));
            continue;
        }
        finish(work, begun.front());
        {
            std::lock_guard lock(mutex_);
            answers_.push_back(std::make_shared<const Pictures>(std::move(begun.front())));
            changed_.notify_all();
        }
        begun.pop_front();
        options_.answered();
    }
    for (Lane& lane : work.lanes) drop(lane);
}

}  // namespace skinbench
