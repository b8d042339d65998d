#include <cstring>
#include <filesystem>
#include <format>

#include "backend_vulkan/program.h"
#include "common/core/file.h"

namespace skinbench::vulkan {

namespace {

namespace fs = std::filesystem;

// In front of the driver's data, because a driver may trust what it reads.
struct FileHeader {
    char magic[8] = {'S', 'K', 'I', 'N', 'P', 'C', '0', '1'};
    uint64_t bytes = 0;
    uint64_t hash = 0;
};

// Drivers' caches of all our pipelines take a few MiB; more is no cache of ours, and is not read.
constexpr uint64_t kLargestFile = uint64_t{256} << 20;

// FNV-1a.
uint64_t hashBytes(std::string_view data) {
    uint64_t hash = 0xcbf29ce484222325;
    for (char c : data) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    return hash;
}

// Empty: there is nowhere to keep it.
fs::path cacheFile(const Device& device) {
    const VkPhysicalDeviceProperties& p = device.adapter.properties;
    std::string name = std::format("vulkan-{:04x}-{:04x}-{:08x}-", p.vendorID, p.deviceID, p.driverVersion);
    for (uint8_t byte : p.pipelineCacheUUID) name += std::format("{:02x}", byte);
    return userFile("XDG_CACHE_HOME", ".cache", name + ".bin");
}

bool isOfThisDevice(const Device& device, std::string_view data) {
    VkPipelineCacheHeaderVersionOne header{};
    if (data.size() < sizeof header) return false;
    std::memcpy(&header, data.data(), sizeof header);
    const VkPhysicalDeviceProperties& p = device.adapter.properties;
    return header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE && header.vendorID == p.vendorID &&
           header.deviceID == p.deviceID &&
           std::memcmp(header.pipelineCacheUUID, p.pipelineCacheUUID, VK_UUID_SIZE) == 0;
}

// Empty: there is none that can be used.
std::string readCache(const Device& device, const fs::path& path) {
    std::error_code error;
    const uint64_t size = fs::file_size(path, error);
    if (error || size < sizeof(FileHeader) || size > kLargestFile) return {};
    const auto file = readWholeFile(path.string());
    FileHeader header, expected;
    if (!file || file->size() < sizeof header) return {};
    std::memcpy(&header, file->data(), sizeof header);
    std::string data = file->substr(sizeof header);
    expected.bytes = data.size();
    expected.hash = hashBytes(data);
    return std::memcmp(&header, &expected, sizeof header) == 0 && isOfThisDevice(device, data) ? data : "";
}

void writeCache(const fs::path& path, const std::string& data) {
    const FileHeader header{.bytes = data.size(), .hash = hashBytes(data)};
    // A cache that cannot be written is made anew by the next run.
    (void)writeWholeFile(path.string(), std::string(reinterpret_cast<const char*>(&header), sizeof header) + data);
}

}  // namespace

Result<VkPipelineCache> openPipelineCache(Device& device) {
    const fs::path path = cacheFile(device);
    const std::string data = path.empty() ? "" : readCache(device, path);
    VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    info.initialDataSize = data.size();
    info.pInitialData = data.data();
    VkPipelineCache cache = VK_NULL_HANDLE;
    VkResult result = device.vk.vkCreatePipelineCache(device.handle, &info, nullptr, &cache);
    if (result != VK_SUCCESS && !data.empty()) {
        info.initialDataSize = 0;
        result = device.vk.vkCreatePipelineCache(device.handle, &info, nullptr, &cache);
    }
    SKINBENCH_TRY(check(device, result, "create a pipeline cache"));
    return cache;
}

void closePipelineCache(Device& device, VkPipelineCache cache) {
    if (!cache || device.lost) {
        if (cache && !device.hung) device.vk.vkDestroyPipelineCache(device.handle, cache, nullptr);
        return;
    }
    size_t size = 0;
    std::string data;
    VkResult result = device.vk.vkGetPipelineCacheData(device.handle, cache, &size, nullptr);
    if (result == VK_SUCCESS) {
        data.resize(size);
        result = device.vk.vkGetPipelineCacheData(device.handle, cache, &size, data.data());
        data.resize(size);
    }
    device.vk.vkDestroyPipelineCache(device.handle, cache, nullptr);
    const fs::path path = cacheFile(device);
    if (result == VK_SUCCESS && !data.empty() && !path.empty() && readCache(device, path) != data)
        writeCache(path, data);
}

}  // namespace skinbench::vulkan
