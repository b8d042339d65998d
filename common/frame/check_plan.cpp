#include "common/frame/check_plan.h"

#include <algorithm>
#include <bitset>
#include <format>

namespace skinbench {

namespace {

std::string mebibytes(uint64_t bytes) { return std::format("{:.1f} MiB", static_cast<double>(bytes) / 1048576); }

std::unexpected<Error> tooLarge(const FramePlan& plan, const std::string& what, uint64_t bytes,
                                const std::string& allowed) {
    uint32_t copies = 1;  // of the scene
    for (const Stream& stream : plan.streams) copies = std::max(copies, stream.replicas);
    return deviceError(std::format("needs {}{}{}: {}; use {}", what, mebibytes(bytes),
                                   copies > 1 ? std::format(" for {} copies", copies) : "", allowed,
                                   copies > 1 ? "fewer copies" : "a smaller scene"));
}

Result<void> checkMemory(const FramePlan& plan, const DeviceCaps& caps) {
    auto allows = [&](uint64_t bytes) { return caps.name + " allows " + mebibytes(bytes); };
    for (const Stream& stream : plan.streams) {
        uint64_t most = caps.maxBufferBytes;
        if (stream.use & useStorage) most = std::min(most, caps.maxStorageBytes);
        if (stream.use & useUniform) most = std::min(most, caps.maxUniformBytes);
        const char* kind = stream.use & useUniform ? "uniform " : stream.use & useStorage ? "storage " : "";
        const uint64_t bytes = streamBytes(stream);
        if (bytes > most) return tooLarge(plan, std::format("a {}buffer of ", kind), bytes, allows(most));
    }
    if (plan.paletteRange > caps.maxUniformBytes)
        return deviceError(std::format("needs a uniform block of {} bytes for joints: {} allows {}", plan.paletteRange,
                                       caps.name, caps.maxUniformBytes));
    const uint64_t most = std::min(caps.maxStorageBytes, caps.maxBufferBytes);
    if (!plan.paletteRange && plan.paletteBytes > most)
        return tooLarge(plan, "a palette of ", plan.paletteBytes, allows(most));
    if (caps.deviceBytes && planBytes(plan) > caps.deviceBytes)
        return tooLarge(plan, "", planBytes(plan), caps.name + " has " + mebibytes(caps.deviceBytes));
    return {};
}

Result<void> checkStreams(const FramePlan& plan) {
    std::bitset<SLOT_COUNT> slots;
    uint32_t indices = 0, indirect = 0, hostWritten = 0;
    for (const Stream& stream : plan.streams) {
        if (stream.slot == SLOT_FRAME || stream.slot == SLOT_PALETTE || stream.slot >= SLOT_COUNT)
            return inputError(std::format("slot {} is not one that a stream may have", stream.slot));
        if (slots[stream.slot]) return inputError(std::format("two streams at slot {}", stream.slot));
        slots.set(stream.slot);
        if (stream.inTurn && (stream.hostWritten || plan.passesAhead == 0))
            return inputError(std::format("the stream at slot {} is in turn, and {}", stream.slot,
                                          stream.hostWritten ? "the host writes it" : "no pass runs ahead"));
        if (stream.bytes && stream.replicaAdd && stream.bytes->size() % sizeof stream.replicaAdd)
            return inputError(
                std::format("the stream at slot {} adds to 32-bit words, and is not made of them", stream.slot));
        indices += (stream.use & useIndices) != 0;
        indirect += (stream.use & useIndirect) != 0;
        hostWritten += stream.hostWritten;
    }
    if (indices > 1) return inputError("two streams feed indexed draws");
    if (indirect > 1) return inputError("two streams hold the commands of indirect draws");
    if (hostWritten > 1) return inputError("two streams are written by the host");
    if (hostWritten && plan.passesAhead) return inputError("passes run ahead of what the host writes for each frame");
    return {};
}

Result<void> checkAhead(const FramePlan& plan, const DeviceCaps& caps) {
    if (plan.passesAhead == 0) return {};
    if (plan.passesAhead > plan.passes.size())
        return inputError(std::format("{} passes run ahead, and there are {}", plan.passesAhead, plan.passes.size()));
    for (const Pass& pass : std::span(plan.passes).first(plan.passesAhead))
        if (pass.kind != PassKind::dispatch)
            return inputError("pass '" + pass.label + "' draws, so that it cannot run ahead");
    if (!caps.secondQueue) return deviceError(caps.name + " has no second queue for passes that run ahead");
    return {};
}

Result<void> checkProgram(const FramePlan& plan, const Pass& pass) {
    if (pass.program >= plan.programs.size())
        return inputError(std::format("names program {} of {}", pass.program, plan.programs.size()));
    const Program& program = plan.programs[pass.program];
    const Stage first = pass.kind == PassKind::dispatch      ? Stage::compute
                        : pass.kind == PassKind::drawIndexed ? Stage::vertex
                                                             : Stage::mesh;
    for (const ShaderText& text : program.stages) {
        const bool fits = text.stage == first || (first != Stage::compute && text.stage == Stage::fragment) ||
                          (first == Stage::mesh && text.stage == Stage::task);
        if (!fits)
            return inputError(std::format("program '{}' has a {} stage, which this kind of pass has not", program.label,
                                          stageName(text.stage)));
    }
    if (!hasStage(program, first))
        return inputError(std::format("program '{}' has no {} stage", program.label, stageName(first)));
    if (program.attributes.empty()) return {};
    for (const Stream& stream : plan.streams)
        if (stream.slot == program.attributeSlot && (stream.use & useAttributes)) return {};
    return inputError(std::format("program '{}' takes its attributes from slot {}, where no stream feeds any",
                                  program.label, program.attributeSlot));
}

// The most that one draw may count: indices from its first, or work groups.
Result<uint64_t> mostOfDraw(const FramePlan& plan, const Pass& pass, const DeviceCaps& caps) {
    if (pass.kind == PassKind::dispatch) return caps.maxComputeGroupCount;
    if (pass.kind == PassKind::drawIndexed) {
        for (const Stream& stream : plan.streams)
            if (stream.use & useIndices) return streamBytes(stream) / sizeof(uint32_t);
        return inputError("no stream feeds its indexed draws");
    }
    if (plan.dialect == MeshDialect::none) return inputError("draws meshlets in no dialect");
    const MeshLimitsOfDevice& limits = meshLimits(caps, plan.dialect);
    if (!limits.available)
        return deviceError(std::format("{} has no {}_{}_mesh_shader", caps.name, namesOf(caps.api).prefix,
                                       plan.dialect == MeshDialect::nv ? "NV" : "EXT"));
    if (hasStage(plan.programs[pass.program], Stage::task) && !limits.taskStages)
        return deviceError(caps.name + " has no task stages");
    return limits.maxGroupCount;
}

Result<void> checkIndirect(const FramePlan& plan, uint32_t command) {
    const auto stream =
        std::ranges::find_if(plan.streams, [](const Stream& stream) { return (stream.use & useIndirect) != 0; });
    const uint64_t commands = stream == plan.streams.end() ? 0 : streamBytes(*stream) / sizeof(DrawCommand);
    if (command < commands) return {};
    return inputError(std::format("a draw reads command {}, and there are {}", command, commands));
}

Result<void> checkPass(const FramePlan& plan, const Pass& pass, const DeviceCaps& caps) {
    SKINBENCH_TRY(checkProgram(plan, pass));
    const auto most = mostOfDraw(plan, pass, caps);
    SKINBENCH_TRY(most);
    for (const Draw& draw : pass.draws) {
        if (draw.command) SKINBENCH_TRY(checkIndirect(plan, *draw.command));
        if (pass.kind == PassKind::drawIndexed && uint64_t{draw.firstIndex} + draw.count > *most)
            return inputError(std::format("draws {} indices from number {} on, and there are {}", draw.count,
                                          draw.firstIndex, *most));
        if (pass.kind != PassKind::drawIndexed && draw.count > *most)
            return deviceError(
                std::format("has a draw of {} work groups: {} allows {}; split it", draw.count, caps.name, *most));
        if (plan.paletteRange &&
            (draw.paletteOffset % kPaletteAlignment || draw.paletteOffset + plan.paletteRange > plan.paletteBytes))
            return inputError(std::format("a draw sees {} bytes of palette from byte {} on, and a frame has {}",
                                          plan.paletteRange, draw.paletteOffset, plan.paletteBytes));
    }
    return {};
}

Result<void> checkAll(const FramePlan& plan, const DeviceCaps& caps) {
    SKINBENCH_TRY(checkStreams(plan));
    for (const Pass& pass : plan.passes)
        if (auto checked = checkPass(plan, pass, caps); !checked)
            return errorAt("pass '" + pass.label + "'", checked.error());
    SKINBENCH_TRY(checkAhead(plan, caps));
    if (!plan.passes.empty() && caps.timestampBits == 0)
        return deviceError(caps.name + " offers no timestamps, so passes cannot be timed");
    if (std::min(plan.width, plan.height) == 0 || std::max(plan.width, plan.height) > caps.maxImageSize)
        return deviceError(std::format("needs an image of {}x{} pixels: {} draws 1x1 to {}x{}", plan.width, plan.height,
                                       caps.name, caps.maxImageSize, caps.maxImageSize));
    return checkMemory(plan, caps);
}

std::unexpected<Error> refuse(const FramePlan& plan, const std::string& why) {
    return inputError((plan.label.empty() ? "" : plan.label + ": ") + why);
}

}  // namespace

Result<void> checkPlan(const FramePlan& plan, const DeviceCaps& caps) {
    auto checked = checkAll(plan, caps);
    return checked || plan.label.empty() ? checked : errorAt(plan.label, checked.error());
}

FramePlan planShape(const FramePlan& plan) {
    FramePlan shape = plan;
    for (Program& program : shape.programs) program.stages.clear();
    for (Stream& stream : shape.streams) {
        stream.gpuBytes = streamBytes(stream);
        stream.bytes.reset();
    }
    return shape;
}

const Pass* firstDrawing(const FramePlan& plan) {
    const auto first =
        std::ranges::find_if(plan.passes, [](const Pass& pass) { return pass.kind != PassKind::dispatch; });
    return first == plan.passes.end() ? nullptr : &*first;
}

bool drawsImage(const FramePlan& plan) { return firstDrawing(plan) != nullptr; }

const Stream* hostWrittenStream(const FramePlan& plan) {
    auto written = std::ranges::find(plan.streams, true, &Stream::hostWritten);
    return written == plan.streams.end() ? nullptr : &*written;
}

size_t timesOfFrame(const FramePlan& plan, RunMode mode) {
    return mode == RunMode::timed ? plan.passes.size() : mode == RunMode::counted ? 0 : 1;
}

bool runsTogether(const FramePlan& plan, RunMode mode) { return mode == RunMode::batch && !hostWrittenStream(plan); }

Result<void> checkFrames(const FramePlan& plan, std::span<const FrameInput> frames) {
    const Stream* written = hostWrittenStream(plan);
    const uint64_t skinned = written ? streamBytes(*written) : 0;
    for (size_t i = 0; i < frames.size(); ++i) {
        if (frames[i].palette.size() != plan.paletteBytes)
            return refuse(plan, std::format("frame {} has a palette of {} bytes, and the plan needs {}", i,
                                            frames[i].palette.size(), plan.paletteBytes));
        if (frames[i].skinned.size() != skinned)
            return refuse(plan, std::format("frame {} has {} bytes of skinned vertices, and the plan needs {}", i,
                                            frames[i].skinned.size(), skinned));
    }
    return {};
}

Result<void> checkBegin(const FramePlan& plan, const FrameInput& frame, size_t begun) {
    if (!drawsImage(plan)) return refuse(plan, "draws no image");
    if (hostWrittenStream(plan)) return refuse(plan, "the host writes its vertices; run its frames one by one");
    if (begun == kFramesInFlight)
        return refuse(plan, std::format("{} frames have begun; finish one of them first", begun));
    return checkFrames(plan, {&frame, 1});
}

Result<void> checkFinish(const FramePlan& plan, size_t begun) {
    if (begun == 0) return refuse(plan, "no frame has begun");
    return {};
}

Result<size_t> streamOfSlot(const FramePlan& plan, uint32_t slot) {
    auto stream = std::ranges::find(plan.streams, slot, &Stream::slot);
    if (stream == plan.streams.end()) return refuse(plan, std::format("no stream at slot {}", slot));
    return static_cast<size_t>(stream - plan.streams.begin());
}

Result<void> checkImage(const FramePlan& plan, PlanId id, PlanId lastOfSize) {
    if (!drawsImage(plan)) return refuse(plan, "draws no image");
    if (lastOfSize == id) return {};
    return refuse(plan, "its image is not there: not run yet, or another plan of its size ran after it; run it again");
}

std::unexpected<Error> unknownPlan(PlanId id) { return inputError(std::format("there is no plan {}", id)); }

}  // namespace skinbench
