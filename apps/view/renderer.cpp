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

// A request whose pictures are on the way.
struct Begun {
    Request request;
    Shown shown;  // all but what the devices still work on
    std::array<bool, 2> inFlight{};
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
    auto workload = attempt([&] { return openWorkload(state.scene, {}); });
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

// What a lane is prepared for.
std::string keyOf(const Request& request, const Case& c) {
    const ViewState& state = request.state;
    const glm::vec3& background = state.background;
    return std::format("{} {} {} {} {} {} {} {}", caseId(c), state.clip, state.copies, request.width, request.height,
                       background.x, background.y, background.z);
}

// Whether no lane is prepared anew for the request, which would take away what is in flight.
bool follows(const Work& work, const Request& request) {
    ViewState state = request.state;
    chooseCases(state, work.caps);
    return state.scene == work.scene && work.lanes[0].key == keyOf(request, state.cases[0]) &&
           work.lanes[1].key == keyOf(request, state.cases[1]);
}

Result<void> prepareLane(Work& work, Lane& lane, const Case& c, const Request& request) {
    const std::string key = keyOf(request, c);
    if (lane.key == key) return lane.ready ? Result<void>{} : Result<void>(deviceError(lane.error));
    drop(lane);
    lane.key = key;
    auto prepare = [&]() -> Result<Prepared> {
        if (auto reason = reasonAgainst(c, work.caps)) return deviceError(*reason);
        auto backend = backendFor(work, c);
        SKINBENCH_TRY(backend);
        auto planned = planCase(*work.workload, c, *backend, false);
        SKINBENCH_TRY(planned);
        const glm::vec3& background = request.state.background;
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

// The picture of a pane, or for a case that the device skins its begin. What the host skins is drawn one by one.
Result<void> begin(Work& work, Begun& begun, size_t pane) {
    const Request& request = begun.request;
    const Case& c = begun.shown.cases[pane];
    Drawn& picture = begun.shown.pictures[pane];
    picture.id = caseId(c);
    auto framing = framingOf(*work.workload, c.influences);
    SKINBENCH_TRY(framing);
    begun.shown.look[pane] = lookOf(*framing);
    Lane& lane = work.lanes[pane];
    SKINBENCH_TRY(prepareLane(work, lane, c, request));
    Prepared& ready = *lane.ready;
    picture.memory = ready.memory;
    picture.meshlets = lane.meshlets;
    auto frames = framesOfPose(*work.workload, c);
    SKINBENCH_TRY(frames);
    const std::span<const FrameData> all(*frames);
    auto drawn = drawFrames(ready, ready.host ? all : all.first(all.size() - 1));
    SKINBENCH_TRY(drawn);
    if (ready.host) {
        picture.passes = passTimes(ready, drawn->back());
        auto image = ready.backend->readImage(*ready.plan);
        SKINBENCH_TRY(image);
        picture.image = std::move(*image);
    } else {
        SKINBENCH_TRY(beginFrame(ready, all.back()));
        begun.inFlight[pane] = true;
    }
    if (c.view == View::culled) {
        const auto verdicts = readVerdicts(c, ready);
        SKINBENCH_TRY(verdicts);
        picture.legend = legendOf(c, countVerdicts(c, ready.input, *verdicts));
    }
    if (request.accuracy) picture.accuracy = accuracyText(work, c, *ready.backend) + countersText(ready, all.last(1));
    if (!request.pick || request.pick->pane != pane) return {};
    const auto verdicts = attempt([&] { return verdictsOfPose(*work.workload, c, *ready.backend); });
    picture.picked =
        pickLines(c, ready.input, all.back(), request.pick->at, verdicts ? *verdicts : std::vector<uint32_t>());
    return {};
}

Result<void> finish(Prepared& ready, Drawn& picture) {
    auto finished = ready.backend->finish(*ready.plan);
    SKINBENCH_TRY(finished);
    picture.passes = passTimes(ready, {std::move(finished->timing), 0});
    picture.image = std::move(finished->image);
    return {};
}

// What a step says of a pane becomes the pane's error.
template <class Step>
void attemptPane(Drawn& picture, const Step& step) {
    if (auto done = attempt(step); !done && picture.error.empty()) picture.error = done.error().text;
}

Begun begin(Work& work, Request request) {
    Begun begun{std::move(request), {}};
    Shown& shown = begun.shown;
    shown.number = begun.request.number;
    shown.seconds = begun.request.state.seconds;
    shown.wanted = begun.request.state.scene;
    ViewState state = begun.request.state;
    chooseCases(state, work.caps);
    shown.cases = state.cases;
    if (auto loaded = loadWorkload(work, state); !loaded) {
        shown.error = loaded.error().text;
        shown.fault = loaded.error().fault;
    }
    if (!work.workload) return begun;
    shown.scene = work.scene;
    shown.stats = work.stats;
    settle(work, begun.request);
    for (const Clip& clip : work.workload->stored.clips) shown.clips.push_back({clip.name, clip.duration});
    if (const Clip* clip = chosenClip(*work.workload)) shown.duration = clip->duration;
    for (size_t pane = 0; pane < 2; ++pane) attemptPane(shown.pictures[pane], [&] { return begin(work, begun, pane); });
    return begun;
}

Shown finish(Work& work, Begun begun) {
    Shown& shown = begun.shown;
    for (size_t pane = 0; pane < 2; ++pane)
        if (Drawn& picture = shown.pictures[pane]; begun.inFlight[pane])
            attemptPane(picture, [&] { return finish(*work.lanes[pane].ready, picture); });
    const auto& [a, b] = shown.pictures;
    const bool both = a.image.width && b.image.width && a.error.empty() && b.error.empty();
    if (begun.request.state.mode == Mode::difference && both)
        shown.difference = differenceImage(a.image, b.image, begun.request.state.amplify);
    for (auto& [api, devices] : work.opened)
        for (auto& [name, open] : devices.byApi)
            if (open.backend)
                for (std::string& message : open.backend->takeMessages()) shown.messages.push_back(std::move(message));
    return std::move(shown);
}

}  // namespace

Renderer::Renderer(const RendererOptions& options)
    : options_(options), thread_([this](const std::stop_token& stop) { work(stop); }) {}

Renderer::~Renderer() {
    std::lock_guard lock(mutex_);
    requests_.clear();  // nobody waits for them
}

void Renderer::post(Request request) {
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

std::shared_ptr<const Shown> Renderer::take() {
    std::lock_guard lock(mutex_);
    if (answers_.empty()) return nullptr;
    auto answer = std::move(answers_.front());
    answers_.pop_front();
    return answer;
}

std::shared_ptr<const Shown> Renderer::wait() {
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !answers_.empty(); });
    }
    return take();
}

const CapsByApi& Renderer::devices() const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return devices_.has_value(); });
    return *devices_;
}

void Renderer::work(const std::stop_token& stop) {
    Work work;
    work.options = options_;
    work.caps = listDevices(work.options.device);
    {
        std::lock_guard lock(mutex_);
        devices_ = work.caps;
        changed_.notify_all();
    }
    std::deque<Begun> begun;
    while (true) {
        std::optional<Request> next;
        {
            std::unique_lock lock(mutex_);
            if (begun.empty() && !changed_.wait(lock, stop, [&] { return !requests_.empty(); })) break;
            const bool room = begun.empty() || (begun.size() < kFramesInFlight && !requests_.empty() &&
                                                follows(work, requests_.front()));
            if (room) {
                next = std::move(requests_.front());
                requests_.pop_front();
            }
        }
        if (next) {
            begun.push_back(begin(work, std::move(*next)));
            continue;
        }
        auto shown = std::make_shared<const Shown>(finish(work, std::move(begun.front())));
        begun.pop_front();
        {
            std::lock_guard lock(mutex_);
            answers_.push_back(std::move(shown));
            changed_.notify_all();
        }
        options_.answered();
    }
    for (Lane& lane : work.lanes) drop(lane);
}

}  // namespace skinbench::view
