#include "apps/view/renderer.h"

#include <algorithm>
#include <format>

#include "common/frame/image.h"
#include "common/measure/drawing.h"
#include "common/measure/picking.h"
#include "common/report/columns.h"

namespace skinbench::view {
namespace {

// One case on its device, as it was last prepared.
struct Lane {
    std::string key;  // what it was prepared for
    std::optional<Prepared> ready;
    std::string error;
    std::optional<MeshletStats> meshlets;
};

// Everything that the thread has.
struct Work {
    RendererOptions options;
    CapsByApi caps;
    std::map<Api, Devices> opened;
    std::string scene;  // that `workload` holds
    std::optional<Workload> workload;
    SceneStats stats;
    std::array<Lane, 2> lanes;
    std::string refused;  // a scene that could not be loaded, and why
    Error why;
};

CapsByApi listDevices(std::string& device) {
    CapsByApi all;
    std::vector<Api> apis;
    for (const ApiDevices& api : thisMachine().apis) apis.push_back(api.api);
    const auto number = pickDevice(thisMachine(), device, apis);
    for (const ApiDevices& api : thisMachine().apis) {
        all[api.api].missing = !api.missing.empty() ? api.missing : number ? "" : number.error().text;
        if (!number) continue;
        const auto entry = entryOf(thisMachine(), *number, api.api);
        if (entry)
            all[api.api].caps = capsOf(thisMachine(), *number, api.devices[entry->number]);
        else if (all[api.api].missing.empty())
            all[api.api].missing = entry.error().text;
    }
    if (number) device = std::to_string(*number);
    return all;
}

Result<Backend*> backendFor(Work& work, const Case& c) {
    Devices& devices = work.opened[c.route->api];
    if (devices.byApi.empty()) {
        auto opened = openDevices({c.route}, work.options.device, work.options.validation);
        SKINBENCH_TRY(opened);
        devices = std::move(*opened);
    }
    const OpenBackend& open = devices.byApi[c.route->api];
    if (!open.backend) return deviceError(open.missing);
    return open.backend;
}

void drop(Lane& lane) {
    if (lane.ready) releaseCase(*lane.ready);
    lane = {};
}

Result<void> loadWorkload(Work& work, const ViewState& state) {
    if (work.workload && work.scene == state.scene) return {};
    if (work.refused == state.scene) return std::unexpected(work.why);
    WorkloadSettings settings;
    settings.steady = true;
    auto workload = attempt([&] { return openWorkload(state.scene, settings); });
    if (workload)
        if (auto prepared = attempt([&] { return sceneFor(*workload, 4); }); !prepared)
            workload = std::unexpected(prepared.error());
    if (!workload) {
        work.refused = state.scene;
        work.why = workload.error();
        return std::unexpected(work.why);
    }
    for (Lane& lane : work.lanes) drop(lane);
    work.workload = std::move(*workload);
    work.scene = state.scene;
    work.stats = sceneStats(**sceneFor(*work.workload, 4));
    work.refused.clear();
    return {};
}

// What the request wants of the workload. A clip that the scene lacks is its first one.
void settle(Work& work, const Request& request) {
    WorkloadSettings& settings = work.workload->settings;
    const ViewState& state = request.state;
    if (settings.clip != state.clip && !chooseClip(*work.workload, state.clip)) chooseClip(*work.workload, "");
    settings.seconds = static_cast<float>(state.seconds);
    settings.copies = state.copies;
    settings.width = request.width;
    settings.height = request.height;
    settings.move = state.camera;
    settings.yaw = state.copies == 1 ? kUsualYaw : 0;
}

Result<void> prepareLane(Work& work, Lane& lane, const Case& c, const glm::vec3& background) {
    const WorkloadSettings& settings = work.workload->settings;
    const std::string key = std::format("{} {} {} {} {} {} {} {}", caseId(c), settings.clip, settings.copies,
                                        settings.width, settings.height, background.x, background.y, background.z);
    if (lane.key == key) return lane.ready ? Result<void>{} : Result<void>(deviceError(lane.error));
    drop(lane);
    lane.key = key;
    auto prepare = [&]() -> Result<Prepared> {
        if (auto reason = reasonAgainst(c, work.caps)) return deviceError(*reason);
        auto backend = backendFor(work, c);
        SKINBENCH_TRY(backend);
        auto planned = planCase(*work.workload, c, *backend, false);
        SKINBENCH_TRY(planned);
        planned->plan.background = {background.x, background.y, background.z, 1};
        return prepareCase(std::move(*planned));
    };
    auto ready = attempt(prepare);
    if (!ready) {
        lane.error = ready.error().text;
        return std::unexpected(ready.error());
    }
    lane.ready = std::move(*ready);
    const PlanInput& input = lane.ready->input;
    if (input.meshlets)
        lane.meshlets = meshletStats(input.records ? input.records->mesh : input.scene->mesh, *input.meshlets);
    return {};
}

std::string accuracyText(Work& work, const Case& c, Backend& backend) {
    auto checked = attempt([&] { return renderPicture(*work.workload, c, backend); });
    if (!checked) return checked.error().text;
    if (!checked->fault.empty() || !checked->accuracy) return checked->fault;
    const Accuracy& accuracy = *checked->accuracy;
    return std::format("position {:.3g} of the diagonal (allowed: {:.3g}), normal {:.3g} rad; by the codec {:.3g}",
                       accuracy.error.position, accuracy.tolerance, accuracy.error.normal,
                       accuracy.codecError.position);
}

// What the pipeline counted in one more such frame; empty where the device does not count.
std::string countersText(Prepared& ready, std::span<const FrameData> frame) {
    auto counted = drawFrames(ready, frame, RunMode::counted);
    std::string text;
    if (!counted || !counted->back().timing.counters) return text;
    for (const CounterField& field : counterFields())
        if (const auto& count = (*counted->back().timing.counters).*field.value; count && *count)
            text += std::format("{}{} {}", text.empty() ? "; " : ", ", field.key, *count);
    std::ranges::replace(text, '_', ' ');
    return text;
}

Result<void> draw(Work& work, const Request& request, size_t pane, Shown& shown) {
    const Case& c = shown.cases[pane];
    Drawn& picture = shown.pictures[pane];
    auto framing = framingOf(*work.workload, c.influences);
    SKINBENCH_TRY(framing);
    shown.look[pane] = lookOf(*framing);
    Lane& lane = work.lanes[pane];
    SKINBENCH_TRY(prepareLane(work, lane, c, request.state.background));
    picture.memory = lane.ready->memory;
    picture.meshlets = lane.meshlets;
    auto frames = framesOfPose(*work.workload, c);
    SKINBENCH_TRY(frames);
    auto drawn = drawFrames(*lane.ready, *frames);
    SKINBENCH_TRY(drawn);
    picture.passes = passTimes(*lane.ready, drawn->back());
    auto image = lane.ready->backend->readImage(*lane.ready->plan);
    SKINBENCH_TRY(image);
    picture.image = std::move(*image);
    if (c.view == View::culled) {
        const auto verdicts = readVerdicts(c, *lane.ready);
        SKINBENCH_TRY(verdicts);
        picture.legend = legendOf(c, countVerdicts(c, lane.ready->input, *verdicts));
    }
    if (request.accuracy)
        picture.accuracy =
            accuracyText(work, c, *lane.ready->backend) + countersText(*lane.ready, std::span(*frames).last(1));
    if (!request.pick || request.pick->pane != pane) return {};
    const auto verdicts = attempt([&] { return verdictsOfPose(*work.workload, c, *lane.ready->backend); });
    picture.picked = pickLines(c, lane.ready->input, frames->back(), request.pick->at,
                               verdicts ? *verdicts : std::vector<uint32_t>());
    return {};
}

void drawBoth(Work& work, const Request& request, Shown& shown) {
    settle(work, request);
    for (const Clip& clip : work.workload->stored.clips) shown.clips.push_back({clip.name, clip.duration});
    if (const Clip* clip = chosenClip(*work.workload)) shown.duration = clip->duration;
    for (size_t pane = 0; pane < 2; ++pane) {
        Drawn& picture = shown.pictures[pane];
        picture.id = caseId(shown.cases[pane]);
        if (auto drawn = attempt([&] { return draw(work, request, pane, shown); }); !drawn)
            picture.error = drawn.error().text;
    }
    const Image &a = shown.pictures[0].image, &b = shown.pictures[1].image;
    if (request.state.mode == Mode::difference && shown.pictures[0].error.empty() && shown.pictures[1].error.empty())
        shown.difference = differenceImage(a, b, request.state.amplify);
}

Shown answer(Work& work, const Request& request) {
    Shown shown;
    shown.number = request.number;
    shown.seconds = request.state.seconds;
    ViewState state = request.state;
    chooseCases(state, work.caps);
    shown.cases = state.cases;
    if (auto loaded = loadWorkload(work, state); !loaded) {
        shown.error = loaded.error().text;
        shown.fault = loaded.error().fault;
    }
    if (work.workload) {
        shown.scene = work.scene;
        shown.stats = work.stats;
        drawBoth(work, request, shown);
    }
    for (auto& [api, devices] : work.opened)
        for (auto& [name, open] : devices.byApi)
            if (open.backend)
                for (std::string& message : open.backend->takeMessages()) shown.messages.push_back(std::move(message));
    return shown;
}

}  // namespace

Renderer::Renderer(const RendererOptions& options)
    : thread_([this, options](const std::stop_token& stop) { work(stop, options); }) {}

Renderer::~Renderer() = default;

void Renderer::post(Request request) {
    std::lock_guard lock(mutex_);
    // What was asked for once is not lost with the frame that asked.
    if (next_) {
        request.accuracy = request.accuracy || next_->accuracy;
        if (!request.pick) request.pick = next_->pick;
    }
    next_ = std::move(request);
    changed_.notify_all();
}

std::shared_ptr<const Shown> Renderer::latest() const {
    std::lock_guard lock(mutex_);
    return latest_;
}

std::shared_ptr<const Shown> Renderer::wait(uint64_t number) const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return latest_ && latest_->number >= number; });
    return latest_;
}

const CapsByApi& Renderer::devices() const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return devices_.has_value(); });
    return *devices_;
}

void Renderer::work(const std::stop_token& stop, const RendererOptions& options) {
    Work work;
    work.options = options;
    work.caps = listDevices(work.options.device);
    {
        std::lock_guard lock(mutex_);
        devices_ = work.caps;
        changed_.notify_all();
    }
    while (true) {
        Request request;
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, stop, [&] { return next_.has_value(); })) break;
            request = std::move(*next_);
            next_.reset();
        }
        auto shown = std::make_shared<const Shown>(answer(work, request));
        {
            std::lock_guard lock(mutex_);
            latest_ = std::move(shown);
            changed_.notify_all();
        }
        options.answered();
    }
    for (Lane& lane : work.lanes) drop(lane);
}

}  // namespace skinbench::view
