#include "common/measure/drawing.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <format>

#include "common/core/host_memory.h"
#include "common/core/parallel.h"
#include "common/plans/plan_parts.h"

namespace skinbench {
namespace {

// Refused like a buffer that does not fit: a host that gives out of memory takes the whole run with it.
Result<std::unique_ptr<HostSkinning>> makeHostSkinning(const Scene& scene, uint32_t copies) {
    constexpr uint64_t kVertexBytes =
        sizeof(Mesh::positions[0]) + sizeof(Mesh::normals[0]) + sizeof(Mesh::uvs[0]) + sizeof(Influences);
    const uint64_t vertices = scene.mesh.positions.size(), joints = scene.skeleton.joints.size();
    const uint64_t bytes = copies * (vertices * (kVertexBytes + sizeof(SkinnedVertex)) + joints * sizeof(PaletteEntry));
    if (const uint64_t free = freeHostMemory(); free && bytes > free)
        return deviceError(
            std::format("needs {} MiB of the host's memory for {} copies: {} MiB are free; use fewer copies",
                        bytes >> 20, copies, free >> 20));
    auto host = std::make_unique<HostSkinning>();
    Mesh skinned = scene.mesh;
    skinned.indices = {};  // skinning reads none
    host->copies.assign(copies, skinned);
    host->palettes.resize(copies);
    host->out.resize(copies * vertices);
    return host;
}

double skinFrame(HostSkinning& host, const FrameData& frame) {
    const auto copies = static_cast<uint32_t>(host.copies.size());
    for (uint32_t copy = 0; copy < copies; ++copy) host.palettes[copy] = paletteOfCopy(frame, copy);
    const auto start = std::chrono::steady_clock::now();
    skinOnCpu({host.copies, host.palettes, host.out}, static_cast<unsigned>(coreCount()));
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Result<Planned> planCase(Workload& workload, const Case& c, Backend* backend, bool capture) {
    auto input = planInput(workload, c);
    SKINBENCH_TRY(input);
    input->capture = capture;
    auto plan = makePlan(c, *input, backend ? backend->caps() : DeviceCaps{});
    SKINBENCH_TRY(plan);
    plan->label = caseId(c);
    Prepared ready;
    ready.backend = backend;
    if (input->meshlets) ready.meshlets = static_cast<uint32_t>(input->meshlets->meshlets.size());
    ready.memory = memoryOfOneCopy(*plan, input->copies);
    ready.input = *input;
    ready.blocks = paletteBlocks(c, *input);
    for (const Pass& pass : plan->passes) ready.labels.push_back(pass.label);
    if (c.variant->skinsOnHost) {
        auto host = makeHostSkinning(*input->scene, input->copies);
        SKINBENCH_TRY(host);
        ready.host = std::move(*host);
    }
    return Planned{std::move(*plan), std::move(ready)};
}

Result<Prepared> prepareCase(Planned planned) {
    if (planned.ready.backend) {
        auto id = planned.ready.backend->prepare(planned.plan);
        SKINBENCH_TRY(id);
        planned.ready.plan = *id;
    }
    return std::move(planned.ready);
}

void releaseCase(Prepared& ready) {
    if (ready.plan) ready.backend->release(*ready.plan);
    ready = {};
}

Result<std::vector<FrameData>> frameRange(Workload& workload, const Case& c, uint32_t first, uint32_t count) {
    std::vector<FrameData> frames;
    for (uint32_t i = 0; i < count; ++i) {
        auto frame = makeFrame(workload, c.influences, first + i);
        SKINBENCH_TRY(frame);
        frames.push_back(std::move(*frame));
    }
    return frames;
}

Result<std::vector<FrameData>> framesOfPose(Workload& workload, const Case& c) {
    const bool async = c.queues == Queues::async;
    auto poses = frameRange(workload, c, 0, c.compute.previous || async ? 2 : 1);
    if (!poses) return poses;
    std::vector<FrameData> frames;
    for (auto pose = poses->rbegin(); pose != poses->rend(); ++pose)
        frames.insert(frames.end(), c.compute.halfRate ? 2 : 1, *pose);
    if (async) frames.insert(frames.begin(), 3, frames.front());
    for (size_t i = 0; i < frames.size(); ++i) frames[i].constants.grid.w = static_cast<float>(i);
    return frames;
}

Result<std::vector<uint32_t>> readVerdicts(const Case& c, const Prepared& ready) {
    if (!storesVerdicts(c, ready.input)) return std::vector<uint32_t>();
    auto bytes = ready.backend->readStream(*ready.plan, SLOT_VERDICT);
    SKINBENCH_TRY(bytes);
    std::vector<uint32_t> verdicts(bytes->size() / sizeof(uint32_t));
    std::memcpy(verdicts.data(), bytes->data(), verdicts.size() * sizeof(uint32_t));
    return verdicts;
}

std::vector<std::pair<std::string, double>> passTimes(const Prepared& ready, const DrawnFrame& frame) {
    std::vector<std::pair<std::string, double>> times;
    if (ready.host) times.emplace_back("skin", frame.skin);
    if (ready.host && ready.plan) times.emplace_back("upload", frame.timing.upload);
    for (size_t pass = 0; pass < frame.timing.passes.size(); ++pass) {
        const auto known = std::ranges::find(times, ready.labels[pass], &std::pair<std::string, double>::first);
        if (known == times.end())
            times.emplace_back(ready.labels[pass], frame.timing.passes[pass]);
        else
            known->second += frame.timing.passes[pass];
    }
    return times;
}

RunMode modeOf(const Case& c) { return c.queues == Queues::async ? RunMode::batch : RunMode::timed; }

Result<std::vector<uint32_t>> verdictsOfPose(Workload& workload, const Case& c, Backend& backend) {
    if (verdictsOf(c).size() < 2) return std::vector<uint32_t>();
    auto planned = planCase(workload, c, &backend, true);
    SKINBENCH_TRY(planned);
    auto ready = prepareCase(std::move(*planned));
    SKINBENCH_TRY(ready);
    const auto read = [&]() -> Result<std::vector<uint32_t>> {
        auto frames = framesOfPose(workload, c);
        SKINBENCH_TRY(frames);
        SKINBENCH_TRY(drawFrames(*ready, *frames));
        return readVerdicts(c, *ready);
    };
    auto verdicts = attempt(read);
    releaseCase(*ready);
    return verdicts;
}

Result<std::vector<DrawnFrame>> drawFrames(Prepared& ready, std::span<const FrameData> frames, RunMode mode) {
    // Host skinning happens right before its frame, so such frames are drawn one by one.
    const size_t batch = ready.host ? 1 : mode == RunMode::batch ? std::max<size_t>(frames.size(), 1) : kBatch;
    std::vector<DrawnFrame> drawn;
    for (size_t start = 0; start < frames.size(); start += batch) {
        double skin = 0;
        std::vector<FrameInput> inputs;
        std::vector<std::vector<std::byte>> palettes;  // what the inputs see
        for (const FrameData& frame : frames.subspan(start, std::min(batch, frames.size() - start))) {
            FrameInput input;
            input.constants = frame.constants;
            if (ready.host) {
                skin = skinFrame(*ready.host, frame);
                input.skinned = std::as_bytes(std::span(ready.host->out));
            } else {
                auto bytes = paletteBytes(ready.input, ready.blocks, frame);
                SKINBENCH_TRY(bytes);
                palettes.push_back(std::move(*bytes));
                input.palette = palettes.back();
            }
            inputs.push_back(input);
        }
        std::vector<Timing> timings(inputs.size());
        if (ready.plan) {
            auto run = ready.backend->run(*ready.plan, inputs, mode);
            SKINBENCH_TRY(run);
            timings = std::move(*run);
        }
        for (Timing& timing : timings) drawn.push_back({std::move(timing), skin});
    }
    return drawn;
}

Result<void> beginPicture(Prepared& ready, std::span<const FrameData> frames) {
    const auto drawn = drawFrames(ready, ready.host ? frames : frames.first(frames.size() - 1));
    SKINBENCH_TRY(drawn);
    if (!ready.host) {
        const FrameData& last = frames.back();
        const auto palette = paletteBytes(ready.input, ready.blocks, last);
        SKINBENCH_TRY(palette);
        return ready.backend->begin(*ready.plan, {.constants = last.constants, .palette = *palette, .skinned = {}});
    }
    auto image = ready.backend->readImage(*ready.plan);
    SKINBENCH_TRY(image);
    ready.pictures.push_back({std::move(*image), passTimes(ready, drawn->back())});
    return {};
}

Result<DrawnPicture> finishPicture(Prepared& ready) {
    if (!ready.pictures.empty()) {
        DrawnPicture picture = std::move(ready.pictures.front());
        ready.pictures.pop_front();
        return picture;
    }
    auto finished = ready.backend->finish(*ready.plan);
    SKINBENCH_TRY(finished);
    return DrawnPicture{std::move(finished->image), passTimes(ready, {std::move(finished->timing), 0})};
}

}  // namespace skinbench
