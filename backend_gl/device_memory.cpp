#include "backend_gl/device_memory.h"

#include <unistd.h>

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <volk.h>

#include "backend_gl/context.h"

namespace skinbench {

namespace {

constexpr uint64_t kLeastImported = uint64_t{32} << 20;
constexpr uint64_t kPage = uint64_t{2} << 20;  // the largest that the GPU maps

using Uuid = std::array<uint8_t, VK_UUID_SIZE>;

template <class Function>
Function load(VkInstance instance, const char* name) {
    return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

}  // namespace

// The instance's functions are its own, so that the Vulkan backend's stay as they are.
struct VulkanMemory {
    VkInstance instance = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VolkDeviceTable functions{};
    uint32_t memoryType = UINT32_MAX;

    bool open(const Uuid& wanted);
    bool openDevice(VkPhysicalDevice physical);
    int exportedFd(uint64_t bytes) const;  // -1: none; the caller's to close

    ~VulkanMemory() {
        if (device) functions.vkDestroyDevice(device, nullptr);
        if (instance) load<PFN_vkDestroyInstance>(instance, "vkDestroyInstance")(instance, nullptr);
    }
};

bool VulkanMemory::open(const Uuid& wanted) {
    if (volkInitialize() != VK_SUCCESS) return false;
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    if (load<PFN_vkCreateInstance>(nullptr, "vkCreateInstance")(&info, nullptr, &instance) != VK_SUCCESS) return false;
    const auto enumerate = load<PFN_vkEnumeratePhysicalDevices>(instance, "vkEnumeratePhysicalDevices");
    const auto properties = load<PFN_vkGetPhysicalDeviceProperties2>(instance, "vkGetPhysicalDeviceProperties2");
    uint32_t count = 0;
    if (enumerate(instance, &count, nullptr) != VK_SUCCESS) return false;
    std::vector<VkPhysicalDevice> physical(count);
    if (enumerate(instance, &count, physical.data()) < 0) return false;
    for (VkPhysicalDevice one : physical) {
        VkPhysicalDeviceIDProperties id{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
        VkPhysicalDeviceProperties2 all{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &id};
        properties(one, &all);
        if (std::ranges::equal(id.deviceUUID, wanted)) return openDevice(one);
    }
    return false;
}

bool VulkanMemory::openDevice(VkPhysicalDevice physical) {
    VkPhysicalDeviceMemoryProperties memory{};
    load<PFN_vkGetPhysicalDeviceMemoryProperties>(instance, "vkGetPhysicalDeviceMemoryProperties")(physical, &memory);
    for (uint32_t i = 0; i < memory.memoryTypeCount && memoryType == UINT32_MAX; ++i)
        if (memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) memoryType = i;
    if (memoryType == UINT32_MAX) return false;
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue{
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    const char* const extension = VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME;
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledExtensionCount = 1,
                                  .ppEnabledExtensionNames = &extension};
    const auto create = load<PFN_vkCreateDevice>(instance, "vkCreateDevice");
    if (create(physical, &info, nullptr, &device) != VK_SUCCESS) return false;
    const auto find = load<PFN_vkGetDeviceProcAddr>(instance, "vkGetDeviceProcAddr");
    functions.vkDestroyDevice = reinterpret_cast<PFN_vkDestroyDevice>(find(device, "vkDestroyDevice"));
    functions.vkAllocateMemory = reinterpret_cast<PFN_vkAllocateMemory>(find(device, "vkAllocateMemory"));
    functions.vkFreeMemory = reinterpret_cast<PFN_vkFreeMemory>(find(device, "vkFreeMemory"));
    functions.vkGetMemoryFdKHR = reinterpret_cast<PFN_vkGetMemoryFdKHR>(find(device, "vkGetMemoryFdKHR"));
    return functions.vkGetMemoryFdKHR != nullptr;
}

int VulkanMemory::exportedFd(uint64_t bytes) const {
    const VkExportMemoryAllocateInfo exported{.sType = VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO,
                                              .handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .pNext = &exported,
                                    .allocationSize = bytes,
                                    .memoryTypeIndex = memoryType};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    if (functions.vkAllocateMemory(device, &info, nullptr, &memory) != VK_SUCCESS) return -1;
    const VkMemoryGetFdInfoKHR get{.sType = VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR,
                                   .memory = memory,
                                   .handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
    int fd = -1;
    if (functions.vkGetMemoryFdKHR(device, &get, &fd) != VK_SUCCESS) fd = -1;
    functions.vkFreeMemory(device, memory, nullptr);  // the descriptor holds it
    return fd;
}

namespace {

std::unique_ptr<VulkanMemory> openVulkanMemory() {
    const auto* vendor = reinterpret_cast<const char*>(glGetString(GL_VENDOR));
    if (!GLAD_GL_EXT_memory_object_fd || !vendor || !std::string_view(vendor).contains("NVIDIA")) return nullptr;
    const auto uuid = contextUuid();
    auto vulkan = std::make_unique<VulkanMemory>();
    return uuid && vulkan->open(*uuid) ? std::move(vulkan) : nullptr;
}

// Takes the descriptor. The buffer holds the memory from then on.
GlBuffer importedBuffer(int fd, uint64_t memoryBytes, uint64_t bytes) {
    GLuint memory = 0, id = 0;
    glCreateMemoryObjectsEXT(1, &memory);
    glImportMemoryFdEXT(memory, memoryBytes, GL_HANDLE_TYPE_OPAQUE_FD_EXT, fd);
    if (glGetError() != GL_NO_ERROR) {
        close(fd);
        glDeleteMemoryObjectsEXT(1, &memory);
        return {};
    }
    glCreateBuffers(1, &id);
    GlBuffer buffer(id);
    glNamedBufferStorageMemEXT(id, static_cast<GLsizeiptr>(bytes), memory, 0);
    glDeleteMemoryObjectsEXT(1, &memory);
    if (glGetError() != GL_NO_ERROR) return {};
    return buffer;
}

}  // namespace

DeviceMemory::DeviceMemory() = default;
DeviceMemory::~DeviceMemory() = default;

Result<GlBuffer> DeviceMemory::make(uint64_t bytes, const std::string& what) {
    if (bytes < kLeastImported) return makeBuffer(bytes, what);
    if (!std::exchange(tried_, true)) vulkan_ = openVulkanMemory();
    const uint64_t memoryBytes = (bytes + kPage - 1) / kPage * kPage;
    const int fd = vulkan_ ? vulkan_->exportedFd(memoryBytes) : -1;
    if (fd >= 0) {
        GlBuffer buffer = importedBuffer(fd, memoryBytes, bytes);
        if (buffer.id()) return buffer;
        dropGlErrors();
    }
    return makeBuffer(bytes, what);
}

}  // namespace skinbench
