#include <chrono>
#include <format>
#include <map>
#include <utility>

#include "backend_gl/counters.h"
#include "backend_gl/driver_faults.h"
#include "backend_gl/in_flight.h"

namespace skinbench {

namespace {

constexpr uint64_t kSecondsPerFrame = 120;  // a frame that takes longer will never end

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

class GlBackend final : public Backend {
public:
    GlBackend(std::unique_ptr<Context> context, Staging staging);
    ~GlBackend() override;
    Result<void> start();

    const DeviceCaps& caps() const override { return context_->caps; }
    Result<PlanId> prepare(const FramePlan& plan) override;
    Result<std::vector<Timing>> run(PlanId id, std::span<const FrameInput> frames, RunMode mode) override;
    Result<void> begin(PlanId id, const FrameInput& frame) override;
    Result<FinishedFrame> finish(PlanId id) override;
    Result<Image> readImage(PlanId id) override;
    Result<std::vector<std::byte>> readStream(PlanId id, uint32_t slot) override;
    void release(PlanId id) override;
    std::vector<std::string> takeMessages() override { return std::exchange(context_->messages, {}); }

private:
    Result<void> enter();
    Result<void> checkLost();
    Result<void> waitForDevice(GLsync fence, uint64_t frames);
    Result<GlPlan*> enterWith(PlanId id);
    void dropUnusedTargets();

    Result<void> reserve(GlFrameBuffer& frame, uint64_t bytes, GLuint alignment, size_t frames, const GlPlan& plan);
    Result<void> uploadFrames(const GlPlan& plan, std::span<const FrameInput> frames);
    double uploadSkinned(const GlBuffer& stream, const FrameInput& input);
    GlFrameRecord recordOf(const GlPlan& plan, const GlFrameData& data, size_t frame) const;
    Clock::duration recordBatch(const GlPlan& plan, std::span<const FrameInput> frames, RunMode mode,
                                std::vector<Timing>& timings);
    void needQueries(size_t count);

    std::unique_ptr<Context> context_;  // first, so that it goes last
    Staging staging_;
    DeviceMemory memory_;
    ProgramCache programs_;
    std::map<PlanId, GlPlan> plans_;
    std::map<std::pair<uint32_t, uint32_t>, GlTargets> targets_;
    GlFrameData frameData_;
    GlRecorder recorder_;
    std::map<PlanId, GlInFlight> inFlight_;  // of plans that a frame of began
    GLuint paletteAlignment_ = 256, constantsAlignment_ = 256;
    std::vector<GLuint> queries_;
    PlanId nextId_ = 1;
    std::string lost_;  // why the device is gone; empty: it is not
};

GlBackend::GlBackend(std::unique_ptr<Context> context, Staging staging)
    : context_(std::move(context)), staging_(std::move(staging)), recorder_{.context = *context_} {
    auto get = [](GLenum name) {
        GLint value = 0;
        glGetIntegerv(name, &value);
        return static_cast<GLuint>(std::max(value, 1));
    };
    paletteAlignment_ = std::max(get(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT), GLuint{kPaletteAlignment});
    constantsAlignment_ = get(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    recorder_.storageBindings = get(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS);
}

Result<void> GlBackend::start() {
    if (!context_->caps.ext.available) return {};
    auto between = findStaleConstants(context_->drawMeshTasksExt, programs_, staging_);
    SKINBENCH_TRY(between);
    recorder_.betweenMeshDraws = *between;
    return {};
}

GlBackend::~GlBackend() {
    if (!context_->makeCurrent()) return;
    glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

Result<void> GlBackend::enter() {
    if (!lost_.empty()) return deviceError(lost_);
    SKINBENCH_TRY(context_->makeCurrent());
    dropGlErrors();
    return {};
}

Result<void> GlBackend::checkLost() {
    if (glGetGraphicsResetStatus() == GL_NO_ERROR) return {};
    lost_ = std::format("OpenGL: device {} is lost; start again, with fewer copies if it happens again", caps().name);
    return deviceError(lost_);
}

Result<void> GlBackend::waitForDevice(GLsync fence, uint64_t frames) {
    const uint64_t seconds = (frames + 1) * kSecondsPerFrame;  // one leads in
    const GLenum status = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, seconds * 1'000'000'000);
    glDeleteSync(fence);
    SKINBENCH_TRY(checkLost());
    if (status == GL_ALREADY_SIGNALED || status == GL_CONDITION_SATISFIED) return {};
    lost_ = std::format("OpenGL: device {} did not finish {} frames in {} seconds; start again with fewer copies",
                        caps().name, frames, seconds);
    return deviceError(lost_);
}

Result<GlPlan*> GlBackend::enterWith(PlanId id) {
    SKINBENCH_TRY(enter());
    auto found = plans_.find(id);
    if (found == plans_.end()) return unknownPlan(id);
    return &found->second;
}

Result<PlanId> GlBackend::prepare(const FramePlan& plan) {
    SKINBENCH_TRY(enter());
    SKINBENCH_TRY(checkPlan(plan, caps()));
    for (const Stream& stream : plan.streams)
        if ((stream.use & useStorage) && stream.slot >= recorder_.storageBindings)
            return deviceError(std::format("{}: slot {} needs more than the {} storage bindings of {}", plan.label,
                                           stream.slot, recorder_.storageBindings, caps().name));
    auto made = makeGlPlan(plan, programs_, staging_, memory_);
    SKINBENCH_TRY(checkLost());
    SKINBENCH_TRY(made);
    std::pair size{plan.width, plan.height};
    if (drawsImage(plan) && !targets_.contains(size)) {
        auto targets = makeTargets(plan.width, plan.height);
        SKINBENCH_TRY(targets);
        targets_.emplace(size, std::move(*targets));
    }
    plans_.emplace(nextId_, std::move(*made));
    return nextId_++;
}

void GlBackend::release(PlanId id) {
    if (!context_->makeCurrent()) return;
    if (const auto known = inFlight_.find(id); known != inFlight_.end()) {
        FrameSlots& slots = known->second.slots;
        while (slots.begun && lost_.empty()) (void)waitForDevice(known->second.frames[slots.finish()].done, 1);
        inFlight_.erase(known);
    }
    plans_.erase(id);
    dropUnusedTargets();
}

void GlBackend::dropUnusedTargets() {
    std::erase_if(targets_, [&](const auto& entry) {
        return std::ranges::none_of(plans_, [&](const auto& other) {
            const FramePlan& plan = other.second.shape;
            return drawsImage(plan) && std::pair{plan.width, plan.height} == entry.first;
        });
    });
}

Result<void> GlBackend::reserve(GlFrameBuffer& frame, uint64_t bytes, GLuint alignment, size_t frames,
                                const GlPlan& plan) {
    frame.stride = (bytes + alignment - 1) / alignment * alignment;
    uint64_t needed = frame.stride * frames;
    if (needed <= frame.capacity) return {};
    frame.buffer = {};
    frame.capacity = 0;
    auto buffer = makeBuffer(needed, std::format("{}: a batch of {} frames", plan.shape.label, frames));
    SKINBENCH_TRY(buffer);
    frame.buffer = std::move(*buffer);
    frame.capacity = needed;
    return {};
}

Result<void> GlBackend::uploadFrames(const GlPlan& plan, std::span<const FrameInput> frames) {
    SKINBENCH_TRY(reserve(frameData_.constants, sizeof(FrameConstants), constantsAlignment_, frames.size(), plan));
    SKINBENCH_TRY(reserve(frameData_.palettes, plan.shape.paletteBytes, paletteAlignment_, frames.size(), plan));
    for (size_t i = 0; i < frames.size(); ++i) {
        staging_.write(frameData_.constants.buffer, i * frameData_.constants.stride,
                       std::as_bytes(std::span(&frames[i].constants, 1)));
        staging_.write(frameData_.palettes.buffer, i * frameData_.palettes.stride, frames[i].palette);
    }
    staging_.finish();
    return {};
}

double GlBackend::uploadSkinned(const GlBuffer& stream, const FrameInput& input) {
    staging_.finish();  // the frame before this one is not part of the copy's time
    auto start = Clock::now();
    staging_.write(stream, 0, input.skinned);
    staging_.finish();
    return milliseconds(Clock::now() - start);
}

void countFrame(const GlFrameRecord& record, Timing& timing) {
    const GlCounterQueries queries;
    timing.counters.emplace();
    bindFrame(record);
    for (const Pass& pass : record.plan.shape.passes) {
        beginPass(record, pass, pass.clear);
        glMemoryBarrier(GL_ALL_BARRIER_BITS);
        queries.begin();
        issueDraws(record, pass);
        queries.end(pass.kind, *timing.counters);
    }
}

GlFrameRecord GlBackend::recordOf(const GlPlan& plan, const GlFrameData& data, size_t frame) const {
    const auto targets = targets_.find({plan.shape.width, plan.shape.height});
    return {recorder_, plan, data, targets == targets_.end() ? 0 : targets->second.framebuffer.id(), frame};
}

void GlBackend::needQueries(size_t count) {
    const size_t have = queries_.size();
    if (have >= count) return;
    queries_.resize(count);
    glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(count - have), &queries_[have]);
}

// OpenGL begins to execute while the host still records, so that the first frame's dispatches would wait for the host
// (3 % longer on an H200). A device therefore gets that frame once more in front, without timestamps, and is busy with
// it until the timed ones are recorded. Where the host writes vertices between frames there is no such queue.
Clock::duration GlBackend::recordBatch(const GlPlan& plan, std::span<const FrameInput> frames, RunMode mode,
                                       std::vector<Timing>& timings) {
    const Stream* written = hostWrittenStream(plan.shape);
    const bool together = runsTogether(plan.shape, mode);
    auto record = [&](size_t frame, bool timed) {
        const GlFrameRecord record = recordOf(plan, frameData_, frame);
        const size_t pairs = timesOfFrame(plan.shape, mode);
        const GLuint* queries = timed ? queries_.data() + frame * pairs * 2 : nullptr;
        if (mode == RunMode::timed) return recordTimed(record, queries);
        if (!together) return recordOverlapped(record, queries);
        if (timed && frame == 0) {
            glMemoryBarrier(GL_ALL_BARRIER_BITS);
            writeTimestamp(*context_, queries_[0]);
        }
        bindFrame(record);
        recordPasses(record, frame > 0, nullptr);
        if (timed && frame + 1 == frames.size()) writeTimestamp(*context_, queries_[1]);
    };
    if (mode != RunMode::counted && !written && !caps().software) record(0, false);
    Clock::duration spent{};
    for (size_t i = 0; i < frames.size(); ++i) {
        if (written) {
            const GlBuffer& stream = plan.streams[static_cast<size_t>(written - plan.shape.streams.data())];
            timings[i].upload = uploadSkinned(stream, frames[i]);
        }
        auto start = Clock::now();
        if (mode == RunMode::counted)
            countFrame(recordOf(plan, frameData_, i), timings[i]);
        else
            record(i, true);
        spent += Clock::now() - start;
    }
    return spent;
}

Result<std::vector<Timing>> GlBackend::run(PlanId id, std::span<const FrameInput> frames, RunMode mode) {
    auto found = enterWith(id);
    SKINBENCH_TRY(found);
    const GlPlan& plan = **found;
    SKINBENCH_TRY(checkFrames(plan.shape, frames));
    std::vector<Timing> timings(frames.size());
    const bool counted = mode == RunMode::counted;
    if (frames.empty() || (counted && !caps().pipelineStatistics)) return timings;
    SKINBENCH_TRY(uploadFrames(plan, frames));

    GlTargets* targets = drawsImage(plan.shape) ? &targets_.at({plan.shape.width, plan.shape.height}) : nullptr;
    if (targets) targets->renderedBy = 0;
    bindStreams(recorder_, plan);
    const size_t pairs = timesOfFrame(plan.shape, mode);
    needQueries(frames.size() * pairs * 2);
    const Clock::duration record = recordBatch(plan, frames, mode, timings);
    auto start = Clock::now();
    glFlush();
    auto submit = Clock::now() - start;
    SKINBENCH_TRY(waitForDevice(glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0), frames.size()));
    SKINBENCH_TRY(checkGl(plan.shape.label, planBytes(plan.shape)));
    const bool together = runsTogether(plan.shape, mode);
    for (size_t i = 0; i < timings.size(); ++i) {
        Timing& timing = timings[i];
        timing.passes = readTimes(*context_, queries_.data() + (together ? 0 : i * pairs * 2), pairs);
        if (together) timing.passes[0] /= static_cast<double>(frames.size());
        timing.record = milliseconds(record) / static_cast<double>(frames.size());
        timing.submit = milliseconds(submit) / static_cast<double>(frames.size());
    }
    if (targets) targets->renderedBy = id;
    return timings;
}

Result<void> GlBackend::begin(PlanId id, const FrameInput& frame) {
    auto found = enterWith(id);
    SKINBENCH_TRY(found);
    const GlPlan& plan = **found;
    const auto known = inFlight_.find(id);
    SKINBENCH_TRY(checkBegin(plan.shape, frame, known == inFlight_.end() ? 0 : known->second.slots.begun));
    if (known == inFlight_.end()) {
        auto opened = openInFlight(plan.shape);
        SKINBENCH_TRY(opened);
        inFlight_.emplace(id, std::move(*opened));
    }
    GlTargets& targets = targets_.at({plan.shape.width, plan.shape.height});
    targets.renderedBy = 0;
    GlInFlight& inFlight = inFlight_.at(id);
    const GlFrameRecord record = recordOf(plan, inFlight.frames[inFlight.slots.next()].data, 0);
    SKINBENCH_TRY(beginFrame(inFlight, record, targets.color, frame));
    targets.renderedBy = id;
    return {};
}

Result<FinishedFrame> GlBackend::finish(PlanId id) {
    auto found = enterWith(id);
    SKINBENCH_TRY(found);
    const FramePlan& plan = (*found)->shape;
    const auto known = inFlight_.find(id);
    SKINBENCH_TRY(checkFinish(plan, known == inFlight_.end() ? 0 : known->second.slots.begun));
    const GlFrameInFlight& frame = known->second.frames[known->second.slots.finish()];
    SKINBENCH_TRY(waitForDevice(frame.done, 1));
    FinishedFrame finished = finishedFrame(*context_, plan, frame);
    SKINBENCH_TRY(checkGl(plan.label, finished.image.rgba.size()));
    return finished;
}

Result<Image> GlBackend::readImage(PlanId id) {
    auto found = enterWith(id);
    SKINBENCH_TRY(found);
    const FramePlan& plan = (*found)->shape;
    auto targets = targets_.find({plan.width, plan.height});
    SKINBENCH_TRY(checkImage(plan, id, targets == targets_.end() ? 0 : targets->second.renderedBy));
    Image image{plan.width, plan.height, {}};
    image.rgba.resize(size_t{4} * plan.width * plan.height);
    glGetTextureImage(targets->second.color.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(image.rgba.size()),
                      image.rgba.data());
    SKINBENCH_TRY(checkLost());
    SKINBENCH_TRY(checkGl(plan.label, image.rgba.size()));
    return image;
}

Result<std::vector<std::byte>> GlBackend::readStream(PlanId id, uint32_t slot) {
    auto found = enterWith(id);
    SKINBENCH_TRY(found);
    const FramePlan& plan = (*found)->shape;
    auto number = streamOfSlot(plan, slot);
    SKINBENCH_TRY(number);
    std::vector<std::byte> bytes(streamBytes(plan.streams[*number]));
    staging_.read((*found)->streams[*number], bytes);
    SKINBENCH_TRY(checkLost());
    SKINBENCH_TRY(checkGl(plan.label, bytes.size()));
    return bytes;
}

}  // namespace

Result<std::vector<DeviceCaps>> listGlDevices() {
    const Result<GlDevices>& devices = glDevices();
    SKINBENCH_TRY(devices);
    return devices->caps;
}

Result<std::unique_ptr<Backend>> openGl(const BackendOptions& options) {
    const Result<GlDevices>& devices = glDevices();
    SKINBENCH_TRY(devices);
    auto number = deviceNumber(devices->caps, options.device);
    SKINBENCH_TRY(number);
    auto opened = openContext(devices->displays[*number], options.validation);
    SKINBENCH_TRY(opened);
    std::unique_ptr<Context> context = std::move(*opened);
    SKINBENCH_TRY(context->makeCurrent());
    dropGlErrors();
    auto staging = Staging::make();
    SKINBENCH_TRY(staging);
    auto backend = std::make_unique<GlBackend>(std::move(context), std::move(*staging));
    SKINBENCH_TRY(backend->start());
    return backend;
}

}  // namespace skinbench
