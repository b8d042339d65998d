#include "backend_gl/in_flight.h"

#include <chrono>
#include <format>

namespace skinbench {

namespace {

using Clock = std::chrono::steady_clock;

uint64_t imageBytes(const FramePlan& plan) { return uint64_t{plan.width} * plan.height * 4; }

Result<void> openFrame(const FramePlan& plan, GlFrameInFlight& frame) {
    // Written by commands, behind all that reads what they overwrite.
    for (auto [buffer, bytes] : {std::pair(&frame.data.constants, uint64_t{sizeof(FrameConstants)}),
                                 std::pair(&frame.data.palettes, plan.paletteBytes)}) {
        auto made = makeBuffer(bytes, plan.label + ": a frame in flight", GL_DYNAMIC_STORAGE_BIT);
        SKINBENCH_TRY(made);
        buffer->buffer = std::move(*made);
    }
    constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const std::string what = plan.label + ": the copy of an image for the host";
    auto pixels = makeBuffer(imageBytes(plan), what, kAccess | GL_CLIENT_STORAGE_BIT);
    SKINBENCH_TRY(pixels);
    frame.pixels = std::move(*pixels);
    frame.image = static_cast<const std::byte*>(
        glMapNamedBufferRange(frame.pixels.id(), 0, static_cast<GLsizeiptr>(imageBytes(plan)), kAccess));
    frame.queries.resize(plan.passes.size() * 2);
    glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(frame.queries.size()), frame.queries.data());
    SKINBENCH_TRY(checkGl(what, imageBytes(plan)));
    if (!frame.image) return deviceError(what + " cannot be mapped");
    return {};
}

}  // namespace

GlFrameInFlight::~GlFrameInFlight() { glDeleteQueries(static_cast<GLsizei>(queries.size()), queries.data()); }

Result<GlInFlight> openInFlight(const FramePlan& plan) {
    GlInFlight inFlight;
    for (GlFrameInFlight& frame : inFlight.frames) SKINBENCH_TRY(openFrame(plan, frame));
    return inFlight;
}

Result<void> beginFrame(GlInFlight& inFlight, const GlFrameRecord& record, const GlTexture& color,
                        const FrameInput& input) {
    const FramePlan& plan = record.plan.shape;
    GlFrameInFlight& frame = inFlight.frames[inFlight.slots.next()];
    glNamedBufferSubData(frame.data.constants.buffer.id(), 0, sizeof(FrameConstants), &input.constants);
    glNamedBufferSubData(frame.data.palettes.buffer.id(), 0, static_cast<GLsizeiptr>(input.palette.size()),
                         input.palette.data());
    auto start = Clock::now();
    bindStreams(record.recorder, record.plan);
    recordTimed(record, frame.queries.data());
    frame.record = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    glBindBuffer(GL_PIXEL_PACK_BUFFER, frame.pixels.id());
    glGetTextureImage(color.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(imageBytes(plan)), nullptr);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    SKINBENCH_TRY(checkGl(plan.label, planBytes(plan)));
    frame.done = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    start = Clock::now();
    glFlush();
    frame.submit = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    inFlight.slots.begin();
    return {};
}

FinishedFrame finishedFrame(const Context& context, const FramePlan& plan, const GlFrameInFlight& frame) {
    FinishedFrame finished;
    finished.timing.passes = readTimes(context, frame.queries.data(), plan.passes.size());
    finished.timing.record = frame.record;
    finished.timing.submit = frame.submit;
    const auto* pixels = reinterpret_cast<const uint8_t*>(frame.image);
    finished.image = {plan.width, plan.height, {pixels, pixels + imageBytes(plan)}};
    return finished;
}

}  // namespace skinbench
