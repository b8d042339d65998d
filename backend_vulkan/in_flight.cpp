#include "backend_vulkan/in_flight.h"

#include <cstring>

namespace skinbench::vulkan {

namespace {

uint64_t imageBytes(const InFlight& inFlight) { return uint64_t{inFlight.width} * inFlight.height * 4; }

Result<void> openFrame(InFlight& inFlight, FrameInFlight& frame) {
    Device& device = inFlight.device;
    SKINBENCH_TRY(createCommands(device, inFlight.pool, {&frame.commands, 1}));
    const auto fence = createFence(device);
    SKINBENCH_TRY(fence);
    frame.fence = *fence;
    SKINBENCH_TRY(needTimestamps(device, frame.times, inFlight.passes * 2));
    return createBuffer(device, imageBytes(inFlight), VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::download, frame.image,
                        [&] { return device.caps.name + ": the copy of an image for the host"; });
}

Result<void> record(const InFlight& inFlight, const Plan& plan, size_t slot) {
    Device& device = inFlight.device;
    const FrameInFlight& frame = inFlight.frames[slot];
    SKINBENCH_TRY(beginRecording(device, frame.commands));
    device.vk.vkCmdResetQueryPool(frame.commands, frame.times.pool, 0, frame.times.count);
    fullBarrier(device, frame.commands);
    const FrameRecord record{plan, inFlight.data, frame.commands, slot};
    bindFrame(record);
    recordTimed(record, frame.times.pool, 0);
    recordImageCopy(frame.commands, *plan.target, 0, inFlight.height, frame.image);
    return endRecording(device, frame.commands);
}

Result<void> wait(const InFlight& inFlight, const FrameInFlight& frame) {
    Device& device = inFlight.device;
    return waitForFence(device, frame.fence, [&] { return timestampsDone(device, frame.times, frame.times.count); });
}

}  // namespace

InFlight::~InFlight() {
    if (!device.lost) (void)waitForFrames(*this);
    for (FrameInFlight& frame : frames) {
        destroy(device, frame.image);
        destroy(device, frame.times);
        if (!device.hung) device.vk.vkDestroyFence(device.handle, frame.fence, nullptr);
    }
    destroy(device, data.buffer);
    if (!device.hung) device.vk.vkDestroyCommandPool(device.handle, pool, nullptr);
}

Result<std::unique_ptr<InFlight>> openInFlight(Device& device, const Plan& plan) {
    auto inFlight = std::make_unique<InFlight>(device);
    inFlight->passes = static_cast<uint32_t>(plan.shape.passes.size());
    inFlight->width = plan.shape.width;
    inFlight->height = plan.shape.height;
    const auto pool = createPool(device, *device.adapter.queueFamily, VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT);
    SKINBENCH_TRY(pool);
    inFlight->pool = *pool;
    for (FrameInFlight& frame : inFlight->frames) SKINBENCH_TRY(openFrame(*inFlight, frame));
    return inFlight;
}

Result<void> beginFrame(InFlight& inFlight, Plan& plan, const FrameInput& input) {
    Device& device = inFlight.device;
    const size_t slot = inFlight.slots.next();
    FrameInFlight& frame = inFlight.frames[slot];
    SKINBENCH_TRY(needFrames(device, inFlight.data, plan, kFramesInFlight));
    writeFrame(inFlight.data, slot, input, inFlight.data.buffer.mapped);
    SKINBENCH_TRY(flush(device, inFlight.data.buffer));
    const auto start = std::chrono::steady_clock::now();
    SKINBENCH_TRY(record(inFlight, plan, slot));
    frame.record = elapsedMs(start);
    const auto submitted = submit(device, frame.commands, frame.fence);
    SKINBENCH_TRY(submitted);
    frame.submit = *submitted;
    plan.lastTurn = slot % plan.turns.size();
    inFlight.slots.begin();
    return {};
}

Result<FinishedFrame> finishFrame(InFlight& inFlight) {
    Device& device = inFlight.device;
    const FrameInFlight& frame = inFlight.frames[inFlight.slots.finish()];
    SKINBENCH_TRY(wait(inFlight, frame));
    FinishedFrame finished;
    SKINBENCH_TRY(readTimings(device, frame.times, inFlight.passes, {&finished.timing, 1}));
    finished.timing.record = frame.record;
    finished.timing.submit = frame.submit;
    SKINBENCH_TRY(invalidate(device, frame.image));
    finished.image = {inFlight.width, inFlight.height, std::vector<uint8_t>(imageBytes(inFlight))};
    std::memcpy(finished.image.rgba.data(), frame.image.mapped, finished.image.rgba.size());
    return finished;
}

Result<void> waitForFrames(const InFlight& inFlight) {
    for (size_t i = 0; i < inFlight.slots.begun; ++i)
        SKINBENCH_TRY(wait(inFlight, inFlight.frames[(inFlight.slots.oldest + i) % kFramesInFlight]));
    return {};
}

}  // namespace skinbench::vulkan
