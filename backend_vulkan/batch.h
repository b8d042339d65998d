// RunMode::batch.
#pragma once

#include "backend_vulkan/record.h"

namespace skinbench::vulkan {

// All frames behind one another, between the first two timestamps of `queries`. A software device, which may take
// minutes, shows by another one for each frame that it goes on.
void recordBatch(const Plan& plan, const FrameData& data, VkCommandBuffer commands, size_t frames, VkQueryPool queries);

// What batches over two queues need. Both semaphores are timelines that count frames from the first batch on.
struct TwoQueues {
    Device& device;
    VkCommandPool aheadPool = VK_NULL_HANDLE, drawPool = VK_NULL_HANDLE;
    std::vector<VkCommandBuffer> ahead, draws;  // one of each for every frame of the largest batch
    VkSemaphore prepared = VK_NULL_HANDLE;      // frames whose passes ahead are done
    VkSemaphore drawn = VK_NULL_HANDLE;         // frames that are done, and batches that began
    uint64_t count = 0;                         // what both will reach with what was submitted

    explicit TwoQueues(Device& owner) : device(owner) {}
    TwoQueues(const TwoQueues&) = delete;
    ~TwoQueues();
};
Result<std::unique_ptr<TwoQueues>> openTwoQueues(Device& device);

// The same with the plan's passes ahead on the second queue, waits for it, and gives the host times of recording and
// submitting, in milliseconds.
struct HostTimes {
    double record = 0, submit = 0;
};
Result<HostTimes> runOverTwoQueues(TwoQueues& queues, const Plan& plan, const FrameData& data, size_t frames,
                                   VkQueryPool queries);

}  // namespace skinbench::vulkan
