// The opened device with what lives as long as it does: queue, allocator, one command buffer, staging memory.
#pragma once

#include "backend_vulkan/instance.h"

#define VMA_STATIC_VULKAN_FUNCTIONS 0
#define VMA_DYNAMIC_VULKAN_FUNCTIONS 1
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#include <vk_mem_alloc.h>
#pragma GCC diagnostic pop

#include <chrono>
#include <functional>
#include <span>

namespace skinbench::vulkan {

struct Buffer {
    VkBuffer handle = VK_NULL_HANDLE;
    VmaAllocation allocation = VK_NULL_HANDLE;
    std::byte* mapped = nullptr;  // null: the host cannot reach it
    uint64_t bytes = 0;
};

struct Device {
    std::unique_ptr<Instance> instance;
    Adapter adapter;
    DeviceCaps caps;
    VkDevice handle = VK_NULL_HANDLE;
    VolkDeviceTable vk{};
    VkQueue queue = VK_NULL_HANDLE;
    VkQueue secondQueue = VK_NULL_HANDLE;  // null: DeviceCaps::secondQueue
    VkShaderStageFlags stages = 0;         // every stage that a pipeline may have
    VmaAllocator allocator = VK_NULL_HANDLE;
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    Buffer staging;   // host to device, kChunkBytes
    Buffer readback;  // device to host, kChunkBytes

    std::optional<Error> lost;       // set once; every later call answers it
    uint64_t frameDataVersions = 0;  // that there were
    bool hung = false;               // work may still be in flight, so nothing can be freed any more

    Device() = default;
    Device(const Device&) = delete;
    ~Device();
};

inline constexpr uint64_t kChunkBytes = uint64_t{64} << 20;

Result<std::unique_ptr<Device>> openDevice(const BackendOptions& options);

// Turns a VkResult into an error "Vulkan: could not <what>: VK_…" and remembers a lost device.
Result<void> check(Device& device, VkResult result, std::string_view what);

Result<VkCommandPool> createPool(Device& device, uint32_t family, VkCommandPoolCreateFlags flags = 0);
Result<void> createCommands(Device& device, VkCommandPool pool, std::span<VkCommandBuffer> made);
Result<VkFence> createFence(Device& device);

// A command buffer is recorded between these two, to be submitted once.
Result<void> beginRecording(Device& device, VkCommandBuffer commands);
Result<void> endRecording(Device& device, VkCommandBuffer commands);

// Begins the device's one command buffer anew; nothing of it is in flight.
Result<VkCommandBuffer> beginCommands(Device& device);
Result<void> endCommands(Device& device);

// Submits the ended command buffer and waits; gives the milliseconds of the submitting call. Work that does not end
// within kWatchdogSeconds, and whose `progress` does not grow either, makes the device a lost one.
inline constexpr uint64_t kWatchdogSeconds = 120;
Result<double> submitAndWait(Device& device, const std::function<uint64_t()>& progress = {});

// Its two halves, for any command buffer that has ended and a fence of its own.
Result<double> submit(Device& device, VkCommandBuffer commands, VkFence fence);
Result<void> waitForFence(Device& device, VkFence fence, const std::function<uint64_t()>& progress);

// Everything that the device did before it happens before everything that the device does after it.
void fullBarrier(const Device& device, VkCommandBuffer commands);

double elapsedMs(std::chrono::steady_clock::time_point since);

}  // namespace skinbench::vulkan
