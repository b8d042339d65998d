// Pairs of timestamps around what is measured.
#pragma once

#include "backend_vulkan/device.h"

namespace skinbench::vulkan {

struct Timestamps {
    VkQueryPool pool = VK_NULL_HANDLE;
    uint32_t count = 0;
};

// At least so many. Nothing that writes the present ones is in flight.
Result<void> needTimestamps(Device& device, Timestamps& times, uint32_t count);
void destroy(Device& device, Timestamps& times);

// How many of the first `count` were written since they were reset.
uint64_t timestampsDone(const Device& device, const Timestamps& times, uint32_t count);

// Adds the milliseconds of each pair to Timing::passes, `pairs` of them for each timing; waits for them.
Result<void> readTimings(Device& device, const Timestamps& times, uint32_t pairs, std::span<Timing> timings);

}  // namespace skinbench::vulkan
