#include "backend_vulkan/timestamps.h"

#include <algorithm>

namespace skinbench::vulkan {

void destroy(Device& device, Timestamps& times) {
    if (!device.hung) device.vk.vkDestroyQueryPool(device.handle, times.pool, nullptr);
    times = {};
}

Result<void> needTimestamps(Device& device, Timestamps& times, uint32_t count) {
    if (count <= times.count) return {};
    destroy(device, times);
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = count;
    SKINBENCH_TRY(check(device, device.vk.vkCreateQueryPool(device.handle, &info, nullptr, &times.pool),
                        "create the timestamps"));
    times.count = count;
    return {};
}

uint64_t timestampsDone(const Device& device, const Timestamps& times, uint32_t count) {
    if (count == 0) return 0;
    struct Query {
        uint64_t time, available;
    };
    std::vector<Query> all(count);
    device.vk.vkGetQueryPoolResults(device.handle, times.pool, 0, count, count * sizeof(Query), all.data(),
                                    sizeof(Query), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
    return static_cast<uint64_t>(std::ranges::count_if(all, [](const Query& q) { return q.available != 0; }));
}

Result<void> readTimings(Device& device, const Timestamps& times, uint32_t pairs, std::span<Timing> timings) {
    const size_t count = timings.size() * pairs * 2;
    if (count == 0) return {};
    std::vector<uint64_t> ticks(count);
    SKINBENCH_TRY(check(device,
                        device.vk.vkGetQueryPoolResults(device.handle, times.pool, 0, static_cast<uint32_t>(count),
                                                        count * sizeof(uint64_t), ticks.data(), sizeof(uint64_t),
                                                        VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
                        "read the timestamps"));
    const uint32_t bits = device.caps.timestampBits;
    const uint64_t mask = bits >= 64 ? UINT64_MAX : (uint64_t{1} << bits) - 1;
    for (size_t i = 0; i < timings.size(); ++i)
        for (size_t pair = 0; pair < pairs; ++pair) {
            const uint64_t* ends = &ticks[(i * pairs + pair) * 2];
            timings[i].passes.push_back(static_cast<double>((ends[1] - ends[0]) & mask) *
                                        device.caps.timestampPeriodNs * 1e-6);
        }
    return {};
}

}  // namespace skinbench::vulkan
