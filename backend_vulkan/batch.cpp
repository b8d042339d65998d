#include "backend_vulkan/batch.h"

namespace skinbench::vulkan {

void recordBatch(const Plan& plan, const FrameData& data, VkCommandBuffer commands, size_t frames,
                 VkQueryPool queries) {
    writeTimestamp(plan.device, commands, queries, 0);
    const Pass* last = nullptr;
    for (size_t frame = 0; frame < frames; ++frame) {
        const FrameRecord record{plan, data, commands, frame};
        bindFrame(record);
        last = recordPasses(record, 0, plan.shape.passes.size(), last);
        if (plan.device.caps.software) writeTimestamp(plan.device, commands, queries, static_cast<uint32_t>(2 + frame));
    }
    writeTimestamp(plan.device, commands, queries, 1);
    fullBarrier(plan.device, commands);
}

namespace {

Result<VkSemaphore> makeTimeline(Device& device) {
    VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    info.pNext = &type;
    VkSemaphore semaphore = VK_NULL_HANDLE;
    SKINBENCH_TRY(
        check(device, device.vk.vkCreateSemaphore(device.handle, &info, nullptr, &semaphore), "create a semaphore"));
    return semaphore;
}

Result<void> needCommands(Device& device, VkCommandPool pool, std::vector<VkCommandBuffer>& commands, size_t count) {
    SKINBENCH_TRY(check(device, device.vk.vkResetCommandPool(device.handle, pool, 0), "reset the commands"));
    if (commands.size() >= count) return {};
    std::vector<VkCommandBuffer> more(count - commands.size());
    SKINBENCH_TRY(createCommands(device, pool, more));
    commands.insert(commands.end(), more.begin(), more.end());
    return {};
}

template <class Record>
Result<void> recordInto(Device& device, VkCommandBuffer commands, const Record& record) {
    SKINBENCH_TRY(beginRecording(device, commands));
    record();
    return endRecording(device, commands);
}

// draws[0] begins the batch: its first timestamp is what both queues wait for. draws[1 + f] is the rest of frame f.
Result<void> recordFrames(TwoQueues& queues, const Plan& plan, const FrameData& data, size_t frames,
                          VkQueryPool queries) {
    Device& device = queues.device;
    SKINBENCH_TRY(needCommands(device, queues.aheadPool, queues.ahead, frames));
    SKINBENCH_TRY(needCommands(device, queues.drawPool, queues.draws, 1 + frames));
    SKINBENCH_TRY(recordInto(device, queues.draws[0], [&] {
        device.vk.vkCmdResetQueryPool(queues.draws[0], queries, 0, 2);
        fullBarrier(device, queues.draws[0]);
        writeTimestamp(device, queues.draws[0], queries, 0);
    }));
    const size_t first = plan.shape.passesAhead, all = plan.shape.passes.size();
    const Pass* last = nullptr;
    for (size_t frame = 0; frame < frames; ++frame) {
        SKINBENCH_TRY(recordInto(device, queues.ahead[frame], [&] {
            const FrameRecord record{plan, data, queues.ahead[frame], frame, true};
            bindFrame(record);
            recordPasses(record, 0, first, nullptr);
        }));
        const VkCommandBuffer commands = queues.draws[1 + frame];
        SKINBENCH_TRY(recordInto(device, commands, [&] {
            const FrameRecord record{plan, data, commands, frame};
            bindFrame(record);
            last = recordPasses(record, first, all, last);
            if (frame + 1 == frames) writeTimestamp(device, commands, queries, 1);
        }));
    }
    return {};
}

// One command buffer that waits for a value of one semaphore, if it is above 0, and signals one of another.
struct Step {
    VkSemaphoreSubmitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
    VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
    VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};

    Step(VkCommandBuffer buffer, VkSemaphore waited, uint64_t waitValue, VkSemaphore signalled, uint64_t signalValue) {
        commands.commandBuffer = buffer;
        wait.semaphore = waited;
        wait.value = waitValue;
        signal.semaphore = signalled;
        signal.value = signalValue;
        wait.stageMask = signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    }
};

VkResult submit(const Device& device, VkQueue queue, const std::vector<Step>& steps, VkFence fence) {
    std::vector<VkSubmitInfo2> infos;
    for (const Step& step : steps) {
        VkSubmitInfo2& info = infos.emplace_back();
        info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
        info.waitSemaphoreInfoCount = step.wait.value > 0;
        info.pWaitSemaphoreInfos = &step.wait;
        info.commandBufferInfoCount = 1;
        info.pCommandBufferInfos = &step.commands;
        info.signalSemaphoreInfoCount = 1;
        info.pSignalSemaphoreInfos = &step.signal;
    }
    return device.vk.vkQueueSubmit2(queue, static_cast<uint32_t>(infos.size()), infos.data(), fence);
}

// The value `start` is that the batch began, start + 1 + f that frame f is done. The passes ahead of frame f overwrite
// what frame f - 2 has read.
Result<void> submitFrames(TwoQueues& queues, size_t frames) {
    Device& device = queues.device;
    const uint64_t start = queues.count + 1;
    std::vector<Step> ahead, draws{{queues.draws[0], queues.prepared, 0, queues.drawn, start}};
    for (size_t frame = 0; frame < frames; ++frame) {
        const uint64_t done = start + 1 + frame;
        ahead.emplace_back(queues.ahead[frame], queues.drawn, frame < 2 ? start : done - 2, queues.prepared, done);
        draws.emplace_back(queues.draws[1 + frame], queues.prepared, done, queues.drawn, done);
    }
    queues.count = start + frames;
    SKINBENCH_TRY(check(device, device.vk.vkResetFences(device.handle, 1, &device.fence), "reset a fence"));
    SKINBENCH_TRY(check(device, submit(device, device.secondQueue, ahead, VK_NULL_HANDLE), "submit the commands"));
    const VkResult result = submit(device, device.queue, draws, device.fence);
    if (result == VK_SUCCESS) return {};
    // The second queue would wait for ever.
    VkSemaphoreSignalInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO};
    signal.semaphore = queues.drawn;
    signal.value = queues.count;
    if (result != VK_ERROR_DEVICE_LOST && device.vk.vkSignalSemaphore(device.handle, &signal) == VK_SUCCESS)
        device.vk.vkQueueWaitIdle(device.secondQueue);
    return check(device, result, "submit the commands");
}

}  // namespace

TwoQueues::~TwoQueues() {
    if (device.hung) return;
    device.vk.vkDestroyCommandPool(device.handle, aheadPool, nullptr);
    device.vk.vkDestroyCommandPool(device.handle, drawPool, nullptr);
    device.vk.vkDestroySemaphore(device.handle, prepared, nullptr);
    device.vk.vkDestroySemaphore(device.handle, drawn, nullptr);
}

Result<std::unique_ptr<TwoQueues>> openTwoQueues(Device& device) {
    auto queues = std::make_unique<TwoQueues>(device);
    for (auto [pool, family] : {std::pair(&queues->aheadPool, *device.adapter.secondFamily),
                                std::pair(&queues->drawPool, *device.adapter.queueFamily)}) {
        auto made = createPool(device, family);
        SKINBENCH_TRY(made);
        *pool = *made;
    }
    for (VkSemaphore* semaphore : {&queues->prepared, &queues->drawn}) {
        auto made = makeTimeline(device);
        SKINBENCH_TRY(made);
        *semaphore = *made;
    }
    return queues;
}

Result<HostTimes> runOverTwoQueues(TwoQueues& queues, const Plan& plan, const FrameData& data, size_t frames,
                                   VkQueryPool queries) {
    Device& device = queues.device;
    HostTimes times;
    auto start = std::chrono::steady_clock::now();
    SKINBENCH_TRY(recordFrames(queues, plan, data, frames, queries));
    times.record = elapsedMs(start);
    start = std::chrono::steady_clock::now();
    SKINBENCH_TRY(submitFrames(queues, frames));
    times.submit = elapsedMs(start);
    SKINBENCH_TRY(waitForFence(device, device.fence, [&] {
        uint64_t done = 0;
        device.vk.vkGetSemaphoreCounterValue(device.handle, queues.drawn, &done);
        return done;
    }));
    // It is idle since its last frame was drawn, which older validation layers learn by this call only.
    SKINBENCH_TRY(check(device, device.vk.vkQueueWaitIdle(device.secondQueue), "finish the submitted commands"));
    return times;
}

}  // namespace skinbench::vulkan
