// Pipeline statistics of a batch of frames.
#pragma once

#include "backend_vulkan/plan.h"

namespace skinbench::vulkan {

// Query pools of a plan's passes, one query a frame in each; null where the device does not count.
struct PassQueries {
    VkQueryPool statistics = VK_NULL_HANDLE;
    VkQueryPool meshPrimitives = VK_NULL_HANDLE;
    VkQueryPipelineStatisticFlags flags = 0;
};

struct CounterQueries {
    Device& device;
    std::vector<PassQueries> passes;

    explicit CounterQueries(Device& owner) : device(owner) {}
    CounterQueries(const CounterQueries&) = delete;
    ~CounterQueries();
};

Result<std::unique_ptr<CounterQueries>> makeCounterQueries(Device& device, const Plan& plan, uint32_t frames);

// Outside of a rendering scope, around the draws of one pass of one frame.
void resetCounters(const CounterQueries& queries, VkCommandBuffer commands, uint32_t frames);
void beginCounting(const CounterQueries& queries, VkCommandBuffer commands, size_t pass, uint32_t frame);
void endCounting(const CounterQueries& queries, VkCommandBuffer commands, size_t pass, uint32_t frame);

// Sums over the passes; the commands must have completed.
Result<Counters> readCounters(const CounterQueries& queries, uint32_t frame);

}  // namespace skinbench::vulkan
