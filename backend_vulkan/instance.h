// The Vulkan loader, an instance with its messages, and the facts of every device on this machine.
#pragma once

#include <volk.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/frame/backend.h"

namespace skinbench::vulkan {

// Filled from the validation layer's threads.
struct MessageLog {
    std::mutex mutex;
    std::vector<std::string> texts;
};

struct Instance {
    VkInstance handle = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    MessageLog messages;

    Instance() = default;
    Instance(const Instance&) = delete;
    ~Instance();
};

struct Adapter {
    VkPhysicalDevice handle = VK_NULL_HANDLE;
    uint32_t apiVersion = 0;
    std::optional<uint32_t> queueFamily;   // the first with graphics and compute
    std::optional<uint32_t> secondFamily;  // the first with compute and without graphics, else another one with compute
    VkPhysicalDeviceProperties properties{};
    DeviceCaps caps;
};

const char* resultName(VkResult result);

Result<std::unique_ptr<Instance>> openInstance(bool validation);
// Without a device it is an error.
Result<std::vector<Adapter>> listAdapters(const Instance& instance);

}  // namespace skinbench::vulkan
