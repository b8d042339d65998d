#include <chrono>
#include <format>
#include <map>
#include <utility>

#include "backend_gl/context.h"
#include "backend_gl/counters.h"
#include "backend_gl/driver_faults.h"
#include "backend_gl/plan.h"

namespace skinbench {

namespace {

constexpr uint64_t kSecondsPerFrame = 120;  // a frame that takes longer will never end

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

// Buffers of the backend that grow to what the largest batch needs.
struct FrameBuffer {
    GlBuffer buffer;
    uint64_t capacity = 0;
    uint64_t stride = 0;  // of one frame in the current batch
};

class GlBackend final : public Backend {
public:
    GlBackend(std::unique_ptr<Context> context, Staging staging);
    ~GlBackend() override;
    Result<void> start();

    const DeviceCaps& caps() const override { return context_->caps; }
    Result<PlanId> prepare(const FramePlan& plan) override;
    Result<std::vector<Timing>> run(PlanId id, std::span<const FrameInput> frames, RunMode mode) override;
    Result<Image> readImage(PlanId id) override;
    Result<std::vector<std::byte>> readStream(PlanId id, uint32_t slot) override;
    void release(PlanId id) override;
    std::vector<std::string> takeMessages() override { return std::exchange(context_->messages, {}); }

private:
    Result<void> enter();
    Result<void> checkLost();
    Result<void> waitForDevice(uint64_t frames);
    Result<GlPlan*> enterWith(PlanId id);
    void dropUnusedTargets();

    Result<void> reserve(FrameBuffer& frame, uint64_t bytes, GLuint alignment, size_t frames, const GlPlan& plan);
    Result<void> uploadFrames(const GlPlan& plan, std::span<const FrameInput> frames);
    void bindStreams(const GlPlan& plan);
    void bindFrame(const GlPlan& plan, size_t frame);
    double uploadSkinned(const GlBuffer& stream, const FrameInput& input);
    void recordFrame(const GlPlan& plan, size_t frame, bool timed);
    void recordPasses(const GlPlan& plan, size_t frame, bool waits, const Pass* cleared);
    void recordOverlapped(const GlPlan& plan, size_t frame, bool timed);
    void countFrame(const GlPlan& plan, size_t frame, Timing& timing);
    Clock::duration recordBatch(const GlPlan& plan, std::span<const FrameInput> frames, RunMode mode,
                                std::vector<Timing>& timings);
    void drawMesh(const GlPlan& plan, const LinkedProgram& program, const Draw& draw);
    void issueDraws(const GlPlan& plan, const Pass& pass, size_t frame);
    void beginPass(const GlPlan& plan, const Pass& pass, bool clear);
    void timestamp(GLuint query);
    void recordPass(const GlPlan& plan, const Pass& pass, size_t frame, const GLuint* queries);
    void needQueries(size_t count);
    void readTimes(size_t pairs, std::vector<Timing>& timings);

    std::unique_ptr<Context> context_;  // first, so that it goes last
    Staging staging_;
    DeviceMemory memory_;
    ProgramCache programs_;
    std::map<PlanId, GlPlan> plans_;
    std::map<std::pair<uint32_t, uint32_t>, GlTargets> targets_;
    FrameBuffer palettes_, constants_;
    GLuint paletteAlignment_ = 256, constantsAlignment_ = 256;
    GLuint storageBindings_ = 0;
    LinkedProgram betweenMeshDraws_;  // see driver_faults.h
    std::vector<GLuint> queries_;
    PlanId nextId_ = 1;
    std::string lost_;  // why the device is gone; empty: it is not
};

GlBackend::GlBackend(std::unique_ptr<Context> context, Staging staging)
    : context_(std::move(context)), staging_(std::move(staging)) {
    auto get = [](GLenum name) {
        GLint value = 0;
        glGetIntegerv(name, &value);
        return static_cast<GLuint>(std::max(value, 1));
    };
    paletteAlignment_ = std::max(get(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT), GLuint{kPaletteAlignment});
    constantsAlignment_ = get(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    storageBindings_ = get(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS);
}

Result<void> GlBackend::start() {
    if (!context_->caps.ext.available) return {};
    auto between = findStaleConstants(context_->drawMeshTasksExt, programs_, staging_);
    SKINBENCH_TRY(between);
    betweenMeshDraws_ = *between;
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

Result<void> GlBackend::waitForDevice(uint64_t frames) {
    const uint64_t seconds = (frames + 1) * kSecondsPerFrame;  // one leads in
    GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    GLenum status = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, seconds * 1'000'000'000);
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
        if ((stream.use & useStorage) && stream.slot >= storageBindings_)
            return deviceError(std::format("{}: slot {} needs more than the {} storage bindings of {}", plan.label,
                                           stream.slot, storageBindings_, caps().name));
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

Result<void> GlBackend::reserve(FrameBuffer& frame, uint64_t bytes, GLuint alignment, size_t frames,
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
    SKINBENCH_TRY(reserve(constants_, sizeof(FrameConstants), constantsAlignment_, frames.size(), plan));
    SKINBENCH_TRY(reserve(palettes_, plan.shape.paletteBytes, paletteAlignment_, frames.size(), plan));
    for (size_t i = 0; i < frames.size(); ++i) {
        staging_.write(constants_.buffer, i * constants_.stride, std::as_bytes(std::span(&frames[i].constants, 1)));
        staging_.write(palettes_.buffer, i * palettes_.stride, frames[i].palette);
    }
    staging_.finish();
    return {};
}

// All slots at once, so that nothing of an earlier plan stays bound.
void GlBackend::bindStreams(const GlPlan& plan) {
    std::array<GLuint, SLOT_COUNT> storage{}, uniform{};
    GLuint commands = 0;
    for (size_t i = 0; i < plan.streams.size(); ++i) {
        const Stream& stream = plan.shape.streams[i];
        if (stream.use & useStorage) storage[stream.slot] = plan.streams[i].id();
        if (stream.use & useUniform) uniform[stream.slot] = plan.streams[i].id();
        if (stream.use & useIndirect) commands = plan.streams[i].id();
    }
    for (GLenum target : {GL_DRAW_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER}) glBindBuffer(target, commands);
    auto count = static_cast<GLsizei>(std::min<GLuint>(SLOT_COUNT, storageBindings_));
    glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, count, storage.data());
    glBindBuffersBase(GL_UNIFORM_BUFFER, 0, SLOT_COUNT, uniform.data());
}

void GlBackend::bindFrame(const GlPlan& plan, size_t frame) {
    glBindBufferRange(GL_UNIFORM_BUFFER, SLOT_FRAME, constants_.buffer.id(),
                      static_cast<GLintptr>(frame * constants_.stride), sizeof(FrameConstants));
    if (plan.shape.paletteBytes > 0 && plan.shape.paletteRange == 0)
        glBindBufferRange(GL_SHADER_STORAGE_BUFFER, SLOT_PALETTE, palettes_.buffer.id(),
                          static_cast<GLintptr>(frame * palettes_.stride),
                          static_cast<GLsizeiptr>(plan.shape.paletteBytes));
}

double GlBackend::uploadSkinned(const GlBuffer& stream, const FrameInput& input) {
    staging_.finish();  // the frame before this one is not part of the copy's time
    auto start = Clock::now();
    staging_.write(stream, 0, input.skinned);
    staging_.finish();
    return milliseconds(Clock::now() - start);
}

void applyRaster(const Pass& pass) {
    bool keep = pass.depth == DepthTest::equalKeep;
    bool never = pass.raster == RasterMode::noFragments;
    glDepthFunc(never ? GL_NEVER : keep ? GL_EQUAL : GL_LESS);
    glDepthMask(!never && !keep);
    glColorMask(pass.writeColor, pass.writeColor, pass.writeColor, pass.writeColor);
    (pass.cullBackFaces ? glEnable : glDisable)(GL_CULL_FACE);
    (pass.raster == RasterMode::discard ? glEnable : glDisable)(GL_RASTERIZER_DISCARD);
}

// Masks and rasteriser discard hold for clears too.
void clearTargets(GLuint framebuffer, const std::array<float, 4>& background) {
    glDisable(GL_RASTERIZER_DISCARD);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const GLfloat depth = 1;
    glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, background.data());
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &depth);
}

GLintptr placeOf(uint32_t command) { return static_cast<GLintptr>(command) * GLintptr{sizeof(DrawCommand)}; }

void GlBackend::drawMesh(const GlPlan& plan, const LinkedProgram& program, const Draw& draw) {
    if (plan.shape.dialect == MeshDialect::nv) {
        if (draw.command)
            glDrawMeshTasksIndirectNV(placeOf(*draw.command));
        else
            glDrawMeshTasksNV(0, draw.count);
        return;
    }
    if (betweenMeshDraws_.id && program.constants >= 0) {
        glUseProgram(betweenMeshDraws_.id);
        context_->drawMeshTasksExt(0, 1, 1);
        glUseProgram(program.id);
    }
    if (draw.command)
        context_->drawMeshTasksIndirectExt(placeOf(*draw.command));
    else
        context_->drawMeshTasksExt(draw.count, 1, 1);
}

void GlBackend::issueDraws(const GlPlan& plan, const Pass& pass, size_t frame) {
    const LinkedProgram& program = plan.programs[pass.program].linked;
    for (const Draw& draw : pass.draws) {
        if (plan.shape.paletteRange)
            glBindBufferRange(GL_UNIFORM_BUFFER, SLOT_PALETTE, palettes_.buffer.id(),
                              static_cast<GLintptr>(frame * palettes_.stride + draw.paletteOffset),
                              plan.shape.paletteRange);
        if (program.constants >= 0) glUniform4uiv(program.constants, 1, draw.constants.data());
        switch (pass.kind) {
            case PassKind::dispatch:
                if (draw.command)
                    glDispatchComputeIndirect(placeOf(*draw.command));
                else
                    glDispatchCompute(draw.count, 1, 1);
                break;
            case PassKind::drawIndexed:
                if (draw.command)
                    glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                                           reinterpret_cast<const void*>(placeOf(*draw.command)));
                else
                    glDrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(draw.count), GL_UNSIGNED_INT,
                                             reinterpret_cast<const void*>(uintptr_t{draw.firstIndex} * 4),
                                             draw.baseVertex);
                break;
            case PassKind::drawMesh:
                drawMesh(plan, program, draw);
                break;
        }
    }
}

void GlBackend::beginPass(const GlPlan& plan, const Pass& pass, bool clear) {
    const GlProgram& program = plan.programs[pass.program];
    if (pass.kind != PassKind::dispatch) {
        GLuint framebuffer = targets_.at({plan.shape.width, plan.shape.height}).framebuffer.id();
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        glViewport(0, 0, static_cast<GLsizei>(plan.shape.width), static_cast<GLsizei>(plan.shape.height));
        if (clear) clearTargets(framebuffer, plan.shape.background);
        applyRaster(pass);
        glBindVertexArray(program.vertexArray.id());
    }
    glUseProgram(program.linked.id);
}

// Mesa's software driver puts a timestamp into its queue of tiles, and runs the geometry stages while the host records.
// So the queue is empty on both sides; a GPU is not waited for here.
void GlBackend::timestamp(GLuint query) {
    if (caps().software) glFinish();
    glQueryCounter(query, GL_TIMESTAMP);
    if (caps().software) glFinish();
}

// OpenGL has no execution barrier. What stands for it: a timestamp is taken "after all previous commands … have been
// fully realized" (OpenGL 4.6, 4.3), and glMemoryBarrier makes later commands wait for shader writes, which drivers
// do by draining the pipeline. So the first timestamp follows the clear and the pass before, and the second one the
// last pixel. What remains is that the head of a pass may overlap the tail of a pass whose results it does not use:
// then its interval starts late, at the end of that tail.
void GlBackend::recordPass(const GlPlan& plan, const Pass& pass, size_t frame, const GLuint* queries) {
    beginPass(plan, pass, pass.clear);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    if (queries) timestamp(queries[0]);
    issueDraws(plan, pass, frame);
    if (queries) timestamp(queries[1]);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

void GlBackend::recordFrame(const GlPlan& plan, size_t frame, bool timed) {
    bindFrame(plan, frame);
    for (size_t i = 0; i < plan.shape.passes.size(); ++i) {
        const GLuint* queries = timed ? &queries_[(frame * plan.shape.passes.size() + i) * 2] : nullptr;
        recordPass(plan, plan.shape.passes[i], frame, queries);
    }
}

// All passes, the first one too behind what it needs if it `waits`. Each clears in its turn, but for `cleared`.
void GlBackend::recordPasses(const GlPlan& plan, size_t frame, bool waits, const Pass* cleared) {
    for (const Pass& pass : plan.shape.passes) {
        if (waits)
            glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                            GL_ELEMENT_ARRAY_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
        beginPass(plan, pass, pass.clear && &pass != cleared);
        issueDraws(plan, pass, frame);
        waits = true;
    }
}

void GlBackend::recordOverlapped(const GlPlan& plan, size_t frame, bool timed) {
    bindFrame(plan, frame);
    const GLuint* queries = timed ? &queries_[frame * 2] : nullptr;
    const Pass* const first = firstDrawing(plan.shape);
    if (first && first->clear) beginPass(plan, *first, true);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    if (queries) timestamp(queries[0]);
    recordPasses(plan, frame, false, first);
    if (queries) timestamp(queries[1]);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

void GlBackend::countFrame(const GlPlan& plan, size_t frame, Timing& timing) {
    const GlCounterQueries queries;
    timing.counters.emplace();
    bindFrame(plan, frame);
    for (const Pass& pass : plan.shape.passes) {
        beginPass(plan, pass, pass.clear);
        glMemoryBarrier(GL_ALL_BARRIER_BITS);
        queries.begin();
        issueDraws(plan, pass, frame);
        queries.end(pass.kind, *timing.counters);
    }
}

void GlBackend::needQueries(size_t count) {
    const size_t have = queries_.size();
    if (have >= count) return;
    queries_.resize(count);
    glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(count - have), &queries_[have]);
}

void GlBackend::readTimes(size_t pairs, std::vector<Timing>& timings) {
    uint32_t bits = caps().timestampBits;
    uint64_t mask = bits >= 64 ? UINT64_MAX : (uint64_t{1} << bits) - 1;
    for (size_t frame = 0; frame < timings.size(); ++frame) {
        timings[frame].passes.assign(pairs, 0.0);
        for (size_t i = 0; i < pairs; ++i) {
            const GLuint* queries = &queries_[(frame * pairs + i) * 2];
            GLuint64 begin = 0, end = 0;
            glGetQueryObjectui64v(queries[0], GL_QUERY_RESULT, &begin);
            glGetQueryObjectui64v(queries[1], GL_QUERY_RESULT, &end);
            timings[frame].passes[i] = static_cast<double>((end - begin) & mask) * 1e-6;
        }
    }
}

// OpenGL begins to execute while the host still records, so that the first frame's dispatches would wait for the host
// (3 % longer on an H200). A device therefore gets that frame once more in front, without timestamps, and is busy with
// it until the timed ones are recorded. Where the host writes vertices between frames there is no such queue.
Clock::duration GlBackend::recordBatch(const GlPlan& plan, std::span<const FrameInput> frames, RunMode mode,
                                       std::vector<Timing>& timings) {
    const Stream* written = hostWrittenStream(plan.shape);
    const bool together = runsTogether(plan.shape, mode);
    auto record = [&](size_t frame, bool timed) {
        if (mode == RunMode::timed) return recordFrame(plan, frame, timed);
        if (!together) return recordOverlapped(plan, frame, timed);
        if (timed && frame == 0) {
            glMemoryBarrier(GL_ALL_BARRIER_BITS);
            timestamp(queries_[0]);
        }
        bindFrame(plan, frame);
        recordPasses(plan, frame, frame > 0, nullptr);
        if (timed && frame + 1 == frames.size()) timestamp(queries_[1]);
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
            countFrame(plan, i, timings[i]);
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
    bindStreams(plan);
    const size_t pairs = timesOfFrame(plan.shape, mode);
    needQueries(frames.size() * pairs * 2);
    const Clock::duration record = recordBatch(plan, frames, mode, timings);
    auto start = Clock::now();
    glFlush();
    auto submit = Clock::now() - start;
    SKINBENCH_TRY(waitForDevice(frames.size()));
    SKINBENCH_TRY(checkGl(plan.shape.label, planBytes(plan.shape)));
    if (runsTogether(plan.shape, mode)) {
        std::vector<Timing> all(1);
        readTimes(1, all);
        for (Timing& timing : timings) timing.passes = {all[0].passes[0] / static_cast<double>(frames.size())};
    } else {
        readTimes(pairs, timings);
    }
    for (Timing& timing : timings) {
        timing.record = milliseconds(record) / static_cast<double>(frames.size());
        timing.submit = milliseconds(submit) / static_cast<double>(frames.size());
    }
    if (targets) targets->renderedBy = id;
    return timings;
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
