#include "backend_vulkan/instance.h"

#include <algorithm>
#include <cstring>
#include <format>
#include <map>

#include "common/frame/devices.h"

namespace skinbench::vulkan {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

Result<void> loadLoader() {
    static std::once_flag once;
    static VkResult loaded = VK_NOT_READY;
    std::call_once(once, [] { loaded = volkInitialize(); });
    if (loaded != VK_SUCCESS)
        return deviceError("Vulkan: no loader (libvulkan.so.1) on this machine; install a Vulkan driver");
    if (volkGetInstanceVersion() < VK_API_VERSION_1_1)
        return deviceError("Vulkan: the loader knows Vulkan 1.0 only; install a newer one");
    return {};
}

VKAPI_ATTR VkBool32 VKAPI_CALL collectMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                              const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& log = *static_cast<MessageLog*>(user);
    std::lock_guard lock(log.mutex);
    log.texts.emplace_back(data->pMessage ? data->pMessage : "");
    return VK_FALSE;
}

// GENERAL is left out: it is the loader's talk about drivers and layers that it did not find.
VkDebugUtilsMessengerCreateInfoEXT messengerInfo(MessageLog& log) {
    VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = collectMessage;
    info.pUserData = &log;
    return info;
}

bool hasLayer(const char* name) {
    uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::ranges::any_of(layers, [&](const auto& layer) { return std::strcmp(layer.layerName, name) == 0; });
}

bool layerOffers(const char* layer, const char* extension) {
    uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(layer, &count, nullptr);
    std::vector<VkExtensionProperties> all(count);
    vkEnumerateInstanceExtensionProperties(layer, &count, all.data());
    return std::ranges::any_of(all, [&](const auto& e) { return std::strcmp(e.extensionName, extension) == 0; });
}

std::vector<std::string> deviceExtensions(VkPhysicalDevice device) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> all(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data());
    std::vector<std::string> names;
    for (uint32_t i = 0; i < count; ++i) names.emplace_back(all[i].extensionName);
    std::ranges::sort(names);
    return names;
}

// Chains a structure in front of what `head` already leads to.
template <class Head, class T>
void chain(Head& head, T& next) {
    next.pNext = head.pNext;
    head.pNext = &next;
}

void fillQueue(Adapter& adapter) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(adapter.handle, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(adapter.handle, &count, families.data());
    constexpr VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t i = 0; i < count && !adapter.queueFamily; ++i) {
        if ((families[i].queueFlags & wanted) != wanted) continue;
        adapter.queueFamily = i;
        adapter.caps.timestampBits = families[i].timestampValidBits;
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (i == adapter.queueFamily || !(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
        const bool alone = !(families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT);
        if (!adapter.secondFamily || alone) adapter.secondFamily = i;
        if (alone) break;
    }
    adapter.caps.secondQueue = adapter.queueFamily && adapter.secondFamily;
}

void fillMemory(Adapter& adapter) {
    VkPhysicalDeviceMemoryProperties memory{};
    vkGetPhysicalDeviceMemoryProperties(adapter.handle, &memory);
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
        if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
            adapter.caps.deviceBytes = std::max<uint64_t>(adapter.caps.deviceBytes, memory.memoryHeaps[i].size);
}

void fillLimits(Adapter& adapter) {
    const VkPhysicalDeviceProperties& p = adapter.properties;
    DeviceCaps& caps = adapter.caps;
    caps.api = Api::vulkan;
    caps.name = p.deviceName;
    caps.vendor = p.vendorID <= 0xffff ? p.vendorID : 0;  // above: Khronos' numbers for who has none of PCI
    caps.driver = std::to_string(p.driverVersion);
    caps.version = std::format("Vulkan {}.{}.{}", VK_API_VERSION_MAJOR(p.apiVersion),
                               VK_API_VERSION_MINOR(p.apiVersion), VK_API_VERSION_PATCH(p.apiVersion));
    caps.software = p.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    caps.meshDepthDiffers = caps.software;
    caps.timestampPeriodNs = p.limits.timestampPeriod;
    caps.maxComputeGroupSize = std::min(p.limits.maxComputeWorkGroupInvocations, p.limits.maxComputeWorkGroupSize[0]);
    caps.maxComputeGroupCount = p.limits.maxComputeWorkGroupCount[0];
    caps.maxComputeSharedBytes = p.limits.maxComputeSharedMemorySize;
    caps.subpixelBits = p.limits.subPixelPrecisionBits;
    caps.maxImageSize =
        std::min({p.limits.maxFramebufferWidth, p.limits.maxFramebufferHeight, p.limits.maxImageDimension2D});
    caps.maxStorageBytes = p.limits.maxStorageBufferRange;
    caps.maxUniformBytes = p.limits.maxUniformBufferRange;
    caps.storageBlocksVertex = p.limits.maxPerStageDescriptorStorageBuffers;
}

MeshLimitsOfDevice limitsOf(const VkPhysicalDeviceMeshShaderPropertiesEXT& p, bool taskStages) {
    return {.available = true,
            .maxVertices = p.maxMeshOutputVertices,
            .maxTriangles = p.maxMeshOutputPrimitives,
            .maxGroupSize = std::min(p.maxMeshWorkGroupInvocations, p.maxMeshWorkGroupSize[0]),
            .maxGroupCount = std::min(p.maxMeshWorkGroupTotalCount, p.maxMeshWorkGroupCount[0]),
            .maxOutputBytes = p.maxMeshOutputMemorySize,
            .maxSharedBytes = p.maxMeshSharedMemorySize,
            .preferredGroupSize = p.maxPreferredMeshWorkGroupInvocations,
            .taskStages = taskStages};
}

// NV has one limit for outputs and shared memory together.
MeshLimitsOfDevice limitsOf(const VkPhysicalDeviceMeshShaderPropertiesNV& p, bool taskStages) {
    return {.available = true,
            .maxVertices = p.maxMeshOutputVertices,
            .maxTriangles = p.maxMeshOutputPrimitives,
            .maxGroupSize = std::min(p.maxMeshWorkGroupInvocations, p.maxMeshWorkGroupSize[0]),
            .maxGroupCount = p.maxDrawMeshTasksCount,
            .maxOutputBytes = p.maxMeshTotalMemorySize,
            .maxSharedBytes = p.maxMeshTotalMemorySize,
            .preferredGroupSize = 0,
            .taskStages = taskStages};
}

// What needs vkGetPhysicalDevice…2; a structure is chained only where the device knows it.
void fillExtended(Adapter& adapter) {
    DeviceCaps& caps = adapter.caps;
    auto offered = [&](const char* name) { return std::ranges::binary_search(caps.extensions, name); };
    const bool hasExt = offered(VK_EXT_MESH_SHADER_EXTENSION_NAME);
    const bool hasNv = offered(VK_NV_MESH_SHADER_EXTENSION_NAME);
    const bool hasPci = offered(VK_EXT_PCI_BUS_INFO_EXTENSION_NAME);

    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    VkPhysicalDeviceIDProperties identity{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
    VkPhysicalDevicePCIBusInfoPropertiesEXT pci{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PCI_BUS_INFO_PROPERTIES_EXT};
    VkPhysicalDeviceMaintenance3Properties allocation{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
    VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceMaintenance4Properties buffer{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
    VkPhysicalDeviceMeshShaderPropertiesEXT ext{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_PROPERTIES_EXT};
    VkPhysicalDeviceMeshShaderPropertiesNV nv{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_PROPERTIES_NV};
    VkPhysicalDeviceSubgroupSizeControlProperties subgroupRange{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES};
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceMeshShaderFeaturesEXT extFeatures{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT};
    VkPhysicalDeviceMeshShaderFeaturesNV nvFeatures{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_NV};

    chain(properties, identity);
    chain(properties, allocation);
    chain(properties, subgroup);
    if (hasPci) chain(properties, pci);
    if (adapter.apiVersion >= VK_API_VERSION_1_2) chain(properties, driver);
    if (adapter.apiVersion >= VK_API_VERSION_1_3) chain(properties, buffer), chain(properties, subgroupRange);
    if (hasExt) chain(properties, ext), chain(features, extFeatures);
    if (hasNv) chain(properties, nv), chain(features, nvFeatures);
    vkGetPhysicalDeviceProperties2(adapter.handle, &properties);
    vkGetPhysicalDeviceFeatures2(adapter.handle, &features);

    caps.uuid = uuidText(std::to_array(identity.deviceUUID));
    if (hasPci) caps.pci = pciText(pci.pciDomain, pci.pciBus, pci.pciDevice, pci.pciFunction);
    caps.subgroupSize = subgroup.subgroupSize;
    const VkSubgroupFeatureFlags wanted =
        VK_SUBGROUP_FEATURE_VOTE_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;
    const bool tasks = extFeatures.taskShader || nvFeatures.taskShader;
    const VkShaderStageFlags stages = VK_SHADER_STAGE_MESH_BIT_EXT | (tasks ? VK_SHADER_STAGE_TASK_BIT_EXT : 0);
    caps.meshSubgroups = (subgroup.supportedStages & stages) == stages &&
                         (subgroup.supportedOperations & wanted) == wanted &&
                         subgroupRange.minSubgroupSize == subgroupRange.maxSubgroupSize;
    caps.pipelineStatistics = features.features.pipelineStatisticsQuery;
    caps.meshCounters = caps.pipelineStatistics && extFeatures.meshShaderQueries;
    if (*driver.driverName)
        caps.driver = driver.driverName + (*driver.driverInfo ? " " + std::string(driver.driverInfo) : "");
    caps.maxBufferBytes = allocation.maxMemoryAllocationSize;  // a buffer has an allocation of its own
    if (buffer.maxBufferSize) caps.maxBufferBytes = std::min(caps.maxBufferBytes, buffer.maxBufferSize);
    if (hasExt && extFeatures.meshShader) caps.ext = limitsOf(ext, extFeatures.taskShader);
    if (hasNv && nvFeatures.meshShader) caps.nv = limitsOf(nv, nvFeatures.taskShader);
}

}  // namespace

const char* resultName(VkResult result) {
    static const std::map<VkResult, const char*> names = {
        {VK_ERROR_OUT_OF_HOST_MEMORY, "VK_ERROR_OUT_OF_HOST_MEMORY"},
        {VK_ERROR_OUT_OF_DEVICE_MEMORY, "VK_ERROR_OUT_OF_DEVICE_MEMORY"},
        {VK_ERROR_OUT_OF_POOL_MEMORY, "VK_ERROR_OUT_OF_POOL_MEMORY"},
        {VK_ERROR_INITIALIZATION_FAILED, "VK_ERROR_INITIALIZATION_FAILED"},
        {VK_ERROR_DEVICE_LOST, "VK_ERROR_DEVICE_LOST"},
        {VK_ERROR_MEMORY_MAP_FAILED, "VK_ERROR_MEMORY_MAP_FAILED"},
        {VK_ERROR_LAYER_NOT_PRESENT, "VK_ERROR_LAYER_NOT_PRESENT"},
        {VK_ERROR_EXTENSION_NOT_PRESENT, "VK_ERROR_EXTENSION_NOT_PRESENT"},
        {VK_ERROR_FEATURE_NOT_PRESENT, "VK_ERROR_FEATURE_NOT_PRESENT"},
        {VK_ERROR_INCOMPATIBLE_DRIVER, "VK_ERROR_INCOMPATIBLE_DRIVER"},
        {VK_ERROR_TOO_MANY_OBJECTS, "VK_ERROR_TOO_MANY_OBJECTS"},
        {VK_ERROR_FORMAT_NOT_SUPPORTED, "VK_ERROR_FORMAT_NOT_SUPPORTED"},
        {VK_ERROR_INVALID_SHADER_NV, "VK_ERROR_INVALID_SHADER_NV"},
    };
    auto found = names.find(result);
    return found == names.end() ? "VK_ERROR_UNKNOWN" : found->second;
}

Instance::~Instance() {
    if (!handle) return;
    if (messenger) {
        auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(handle, "vkDestroyDebugUtilsMessengerEXT"));
        destroy(handle, messenger, nullptr);
    }
    vkDestroyInstance(handle, nullptr);
}

Result<std::unique_ptr<Instance>> openInstance(bool validation) {
    SKINBENCH_TRY(loadLoader());
    auto instance = std::make_unique<Instance>();

    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.pApplicationName = "skinbench";
    application.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pApplicationInfo = &application;

    VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(instance->messages);
    const VkBool32 on = VK_TRUE;
    const VkLayerSettingEXT setting{kValidationLayer, "validate_sync", VK_LAYER_SETTING_TYPE_BOOL32_EXT, 1, &on};
    VkLayerSettingsCreateInfoEXT settings{VK_STRUCTURE_TYPE_LAYER_SETTINGS_CREATE_INFO_EXT};
    settings.settingCount = 1;
    settings.pSettings = &setting;
    std::vector<const char*> extensions;
    if (validation) {
        if (!hasLayer(kValidationLayer))
            return deviceError(std::string("Vulkan: validation was asked for, but the layer ") + kValidationLayer +
                               " is not installed (package vulkan-validationlayers)");
        if (!layerOffers(kValidationLayer, VK_EXT_LAYER_SETTINGS_EXTENSION_NAME))
            return deviceError(std::string("Vulkan: the installed ") + kValidationLayer +
                               " is too old to check synchronisation (no VK_EXT_layer_settings); install a newer one");
        extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_LAYER_SETTINGS_EXTENSION_NAME};
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &kValidationLayer;
        chain(info, messenger);
        chain(info, settings);
    }
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    VkResult result = vkCreateInstance(&info, nullptr, &instance->handle);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        return deviceError("Vulkan: no driver on this machine; install the driver of your GPU, or Mesa's lavapipe");
    if (result != VK_SUCCESS) return deviceError(std::string("Vulkan: could not start: ") + resultName(result));
    volkLoadInstanceOnly(instance->handle);

    if (validation) {
        messenger.pNext = nullptr;
        auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance->handle, "vkCreateDebugUtilsMessengerEXT"));
        result = create(instance->handle, &messenger, nullptr, &instance->messenger);
        if (result != VK_SUCCESS)
            return deviceError(std::string("Vulkan: could not listen to the validation layer: ") + resultName(result));
    }
    return instance;
}

Result<std::vector<Adapter>> listAdapters(const Instance& instance) {
    uint32_t count = 0;
    VkResult result = vkEnumeratePhysicalDevices(instance.handle, &count, nullptr);
    std::vector<VkPhysicalDevice> handles(count);
    if (result == VK_SUCCESS && count) result = vkEnumeratePhysicalDevices(instance.handle, &count, handles.data());
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return deviceError(std::string("Vulkan: could not list the devices: ") + resultName(result));
    handles.resize(count);
    if (handles.empty())
        return deviceError("Vulkan: no device on this machine; install the driver of your GPU, or Mesa's lavapipe");
    std::vector<Adapter> adapters;
    for (VkPhysicalDevice handle : handles) {
        Adapter& adapter = adapters.emplace_back();
        adapter.handle = handle;
        vkGetPhysicalDeviceProperties(handle, &adapter.properties);
        adapter.apiVersion = adapter.properties.apiVersion;
        adapter.caps.extensions = deviceExtensions(handle);
        fillLimits(adapter);
        fillQueue(adapter);
        fillMemory(adapter);
        if (adapter.apiVersion >= VK_API_VERSION_1_1) fillExtended(adapter);
    }
    return adapters;
}

}  // namespace skinbench::vulkan

namespace skinbench {

Result<std::vector<DeviceCaps>> listVulkanDevices() {
    auto instance = vulkan::openInstance(false);
    SKINBENCH_TRY(instance);
    auto adapters = vulkan::listAdapters(**instance);
    SKINBENCH_TRY(adapters);
    std::vector<DeviceCaps> all;
    for (vulkan::Adapter& adapter : *adapters) all.push_back(std::move(adapter.caps));
    return all;
}

}  // namespace skinbench
