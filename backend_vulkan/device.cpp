#include "backend_vulkan/device.h"

#include <algorithm>
#include <format>

#include "backend_vulkan/memory.h"

namespace skinbench::vulkan {

namespace {

// Every structure of vkCreateDevice; the chain runs through the members, so it must not be moved.
struct Features {
    VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceMeshShaderFeaturesEXT ext{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT};
    VkPhysicalDeviceMeshShaderFeaturesNV nv{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_NV};

    Features(bool withExt, bool withNv) {
        core.pNext = &v11;
        v11.pNext = &v12;
        v12.pNext = &v13;
        void** end = &v13.pNext;
        if (withExt) *end = &ext, end = &ext.pNext;
        if (withNv) *end = &nv;
    }
    Features(const Features&) = delete;
};

void chooseFeatures(VkPhysicalDevice physical, Features& enabled, bool withExt, bool withNv) {
    Features offered(withExt, withNv);
    vkGetPhysicalDeviceFeatures2(physical, &offered.core);
    enabled.core.features.pipelineStatisticsQuery = offered.core.features.pipelineStatisticsQuery;
    enabled.core.features.vertexPipelineStoresAndAtomics = offered.core.features.vertexPipelineStoresAndAtomics;
    enabled.core.features.fragmentStoresAndAtomics = offered.core.features.fragmentStoresAndAtomics;
    enabled.v11.shaderDrawParameters = offered.v11.shaderDrawParameters;
    enabled.v12.timelineSemaphore = VK_TRUE;
    enabled.v13.dynamicRendering = VK_TRUE;
    enabled.v13.synchronization2 = VK_TRUE;
    enabled.v13.maintenance4 = VK_TRUE;
    enabled.v13.shaderTerminateInvocation = VK_TRUE;
    enabled.v13.shaderDemoteToHelperInvocation = VK_TRUE;
    enabled.v13.subgroupSizeControl = offered.v13.subgroupSizeControl;
    enabled.v13.computeFullSubgroups = offered.v13.computeFullSubgroups;
    enabled.ext.meshShader = offered.ext.meshShader;
    enabled.ext.taskShader = offered.ext.taskShader;
    enabled.ext.meshShaderQueries = offered.ext.meshShaderQueries;
    enabled.nv.meshShader = offered.nv.meshShader;
    enabled.nv.taskShader = offered.nv.taskShader;
}

bool offers(const DeviceCaps& caps, const char* extension) {
    return std::ranges::binary_search(caps.extensions, extension);
}

VkResult createDevice(Device& device, bool withExt, bool withNv) {
    Features features(withExt, withNv);
    chooseFeatures(device.adapter.handle, features, withExt, withNv);
    std::vector<const char*> extensions;
    if (withExt) extensions.push_back(VK_EXT_MESH_SHADER_EXTENSION_NAME);
    if (withNv) extensions.push_back(VK_NV_MESH_SHADER_EXTENSION_NAME);
    if (offers(device.caps, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME))
        extensions.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);

    const float priority = 1;
    std::vector<VkDeviceQueueCreateInfo> queues;
    for (const std::optional<uint32_t>& family : {device.adapter.queueFamily, device.adapter.secondFamily}) {
        if (!family) continue;
        VkDeviceQueueCreateInfo& queue = queues.emplace_back();
        queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
        queue.queueFamilyIndex = *family;
        queue.queueCount = 1;
        queue.pQueuePriorities = &priority;
    }
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = &features.core;
    info.queueCreateInfoCount = static_cast<uint32_t>(queues.size());
    info.pQueueCreateInfos = queues.data();
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    VkResult result = vkCreateDevice(device.adapter.handle, &info, nullptr, &device.handle);
    if (result != VK_SUCCESS) device.handle = VK_NULL_HANDLE;
    return result;
}

Result<void> createAllocator(Device& device) {
    VmaVulkanFunctions functions{};
    functions.vkGetInstanceProcAddr = vkGetInstanceProcAddr;
    functions.vkGetDeviceProcAddr = vkGetDeviceProcAddr;
    VmaAllocatorCreateInfo info{};
    if (offers(device.caps, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME))
        info.flags = VMA_ALLOCATOR_CREATE_EXT_MEMORY_BUDGET_BIT;
    info.physicalDevice = device.adapter.handle;
    info.device = device.handle;
    info.instance = device.instance->handle;
    info.vulkanApiVersion = VK_API_VERSION_1_3;
    info.pVulkanFunctions = &functions;
    return check(device, vmaCreateAllocator(&info, &device.allocator), "create the memory allocator");
}

Result<void> createOwnCommands(Device& device) {
    const auto pool = createPool(device, *device.adapter.queueFamily);
    SKINBENCH_TRY(pool);
    device.pool = *pool;
    SKINBENCH_TRY(createCommands(device, device.pool, {&device.commands, 1}));
    const auto fence = createFence(device);
    SKINBENCH_TRY(fence);
    device.fence = *fence;
    return {};
}

Result<Adapter> chooseAdapter(const Instance& instance, std::optional<size_t> wanted) {
    auto adapters = listAdapters(instance);
    SKINBENCH_TRY(adapters);
    std::vector<DeviceCaps> all;
    for (const Adapter& adapter : *adapters) all.push_back(adapter.caps);
    auto number = deviceNumber(all, wanted);
    SKINBENCH_TRY(number);
    Adapter& adapter = (*adapters)[*number];
    if (adapter.apiVersion < VK_API_VERSION_1_3)
        return deviceError(
            std::format("{}: offers {}, and skinbench needs 1.3; update its driver or choose another device",
                        adapter.caps.name, adapter.caps.version));
    if (!adapter.queueFamily)
        return deviceError(adapter.caps.name + ": has no queue for graphics and compute; choose another device");
    return std::move(adapter);
}

}  // namespace

Device::~Device() {
    if (hung) {
        (void)instance.release();
        return;
    }
    if (!handle) return;
    vk.vkDeviceWaitIdle(handle);
    destroy(*this, staging);
    destroy(*this, readback);
    vk.vkDestroyFence(handle, fence, nullptr);
    vk.vkDestroyCommandPool(handle, pool, nullptr);
    vmaDestroyAllocator(allocator);
    vk.vkDestroyDevice(handle, nullptr);
}

Result<std::unique_ptr<Device>> openDevice(const BackendOptions& options) {
    auto device = std::make_unique<Device>();
    auto instance = openInstance(options.validation);
    SKINBENCH_TRY(instance);
    device->instance = std::move(*instance);
    auto adapter = chooseAdapter(*device->instance, options.device);
    SKINBENCH_TRY(adapter);
    device->adapter = std::move(*adapter);
    device->caps = device->adapter.caps;

    const bool ext = device->caps.ext.available;
    bool nv = device->caps.nv.available;
    VkResult result = createDevice(*device, ext, nv);
    if (result != VK_SUCCESS && ext && nv) {
        nv = false;
        device->caps.nv = {};
        result = createDevice(*device, ext, nv);
    }
    if (result != VK_SUCCESS)
        return deviceError(
            std::format("{}: the driver could not open the device: {}", device->caps.name, resultName(result)));
    volkLoadDeviceTable(&device->vk, device->handle);
    device->vk.vkGetDeviceQueue(device->handle, *device->adapter.queueFamily, 0, &device->queue);
    if (device->adapter.secondFamily)
        device->vk.vkGetDeviceQueue(device->handle, *device->adapter.secondFamily, 0, &device->secondQueue);

    device->stages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT;
    if (ext || nv) device->stages |= VK_SHADER_STAGE_MESH_BIT_EXT;
    if (device->caps.ext.taskStages || device->caps.nv.taskStages) device->stages |= VK_SHADER_STAGE_TASK_BIT_EXT;
    SKINBENCH_TRY(createAllocator(*device));
    SKINBENCH_TRY(createOwnCommands(*device));
    return device;
}

Result<void> check(Device& device, VkResult result, std::string_view what) {
    if (result >= 0) return {};
    if (result == VK_ERROR_DEVICE_LOST) {
        device.lost = Error{Fault::device, std::format("{}: device lost while trying to {}; see the driver's log, then "
                                                       "start again",
                                                       device.caps.name, what)};
        return std::unexpected(*device.lost);
    }
    return deviceError(std::format("{}: could not {}: {}", device.caps.name, what, resultName(result)));
}

Result<VkCommandPool> createPool(Device& device, uint32_t family, VkCommandPoolCreateFlags flags) {
    VkCommandPoolCreateInfo info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    info.flags = flags;
    info.queueFamilyIndex = family;
    VkCommandPool pool = VK_NULL_HANDLE;
    SKINBENCH_TRY(
        check(device, device.vk.vkCreateCommandPool(device.handle, &info, nullptr, &pool), "create a command pool"));
    return pool;
}

Result<void> createCommands(Device& device, VkCommandPool pool, std::span<VkCommandBuffer> made) {
    VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    info.commandPool = pool;
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = static_cast<uint32_t>(made.size());
    return check(device, device.vk.vkAllocateCommandBuffers(device.handle, &info, made.data()),
                 "create command buffers");
}

Result<VkFence> createFence(Device& device) {
    VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkFence fence = VK_NULL_HANDLE;
    SKINBENCH_TRY(check(device, device.vk.vkCreateFence(device.handle, &info, nullptr, &fence), "create a fence"));
    return fence;
}

Result<void> beginRecording(Device& device, VkCommandBuffer commands) {
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    return check(device, device.vk.vkBeginCommandBuffer(commands, &info), "begin recording");
}

Result<void> endRecording(Device& device, VkCommandBuffer commands) {
    return check(device, device.vk.vkEndCommandBuffer(commands), "record the commands");
}

Result<VkCommandBuffer> beginCommands(Device& device) {
    SKINBENCH_TRY(check(device, device.vk.vkResetCommandPool(device.handle, device.pool, 0), "reset the commands"));
    SKINBENCH_TRY(beginRecording(device, device.commands));
    return device.commands;
}

Result<void> endCommands(Device& device) { return endRecording(device, device.commands); }

Result<double> submitAndWait(Device& device, const std::function<uint64_t()>& progress) {
    const auto milliseconds = submit(device, device.commands, device.fence);
    SKINBENCH_TRY(milliseconds);
    SKINBENCH_TRY(waitForFence(device, device.fence, progress));
    return milliseconds;
}

Result<double> submit(Device& device, VkCommandBuffer commands, VkFence fence) {
    SKINBENCH_TRY(check(device, device.vk.vkResetFences(device.handle, 1, &fence), "reset a fence"));
    VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    buffer.commandBuffer = commands;
    VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &buffer;
    const auto start = std::chrono::steady_clock::now();
    const VkResult result = device.vk.vkQueueSubmit2(device.queue, 1, &info, fence);
    const double milliseconds = elapsedMs(start);
    SKINBENCH_TRY(check(device, result, "submit the commands"));
    return milliseconds;
}

Result<void> waitForFence(Device& device, VkFence fence, const std::function<uint64_t()>& progress) {
    uint64_t done = 0;
    VkResult result = VK_SUCCESS;
    for (;;) {
        result = device.vk.vkWaitForFences(device.handle, 1, &fence, VK_TRUE, kWatchdogSeconds * 1'000'000'000);
        if (result != VK_TIMEOUT) break;
        const uint64_t now = progress ? progress() : 0;
        if (now <= done) {
            device.hung = true;
            device.lost =
                Error{Fault::device, std::format("{}: no answer from the device for {} s; see the driver's log, "
                                                 "then start again with a smaller scene or fewer copies",
                                                 device.caps.name, kWatchdogSeconds)};
            return std::unexpected(*device.lost);
        }
        done = now;
    }
    if (result != VK_SUCCESS && result != VK_ERROR_DEVICE_LOST) device.vk.vkDeviceWaitIdle(device.handle);
    return check(device, result, "finish the submitted commands");
}

void fullBarrier(const Device& device, VkCommandBuffer commands) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &barrier;
    device.vk.vkCmdPipelineBarrier2(commands, &info);
}

double elapsedMs(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

}  // namespace skinbench::vulkan
