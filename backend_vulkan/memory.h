// Buffers and targets in device memory, and the ways between them and the host.
#pragma once

#include <span>

#include "backend_vulkan/device.h"

namespace skinbench::vulkan {

enum class Memory {
    device,        // only the device reaches it
    deviceMapped,  // in the device's memory and written by the host; not every device has room for it
    upload,        // written by the host in order
    download,      // read by the host
};

// At least 16 bytes, rounded up to whole words. `mapped` is set for all but Memory::device. Only `shared` buffers may
// be read and written by both queues.
VkResult tryCreateBuffer(Device& device, uint64_t bytes, VkBufferUsageFlags usage, Memory memory, Buffer& buffer,
                         bool shared = false);
void destroy(Device& device, Buffer& buffer);

// The same with an error, "<who> needs 812 MiB of device memory, …" where there is not enough.
using Who = std::function<std::string()>;
Result<void> createBuffer(Device& device, uint64_t bytes, VkBufferUsageFlags usage, Memory memory, Buffer& buffer,
                          const Who& who, bool shared = false);

// Copies `bytes` bytes to the start of the buffer in chunks; `fill` writes the chunk that begins at byte `from`.
using Fill = std::function<void(std::span<std::byte> chunk, uint64_t from)>;
Result<void> upload(Device& device, const Buffer& target, uint64_t bytes, const Fill& fill);
Result<void> fillZero(Device& device, const Buffer& target);
Result<std::vector<std::byte>> download(Device& device, const Buffer& source, uint64_t bytes);

// Makes what the host wrote into mapped memory visible to the device; for submissions after it.
Result<void> flush(Device& device, const Buffer& buffer);

// What a plan draws into: colour in COLOR_ATTACHMENT_OPTIMAL and depth in DEPTH_ATTACHMENT_OPTIMAL at all times.
// Plans of one size share it, because they run one after another.
struct Target {
    Device& device;
    VkExtent2D size{};
    VkImage color = VK_NULL_HANDLE;
    VkImage depth = VK_NULL_HANDLE;
    VmaAllocation colorMemory = VK_NULL_HANDLE;
    VmaAllocation depthMemory = VK_NULL_HANDLE;
    VkImageView colorView = VK_NULL_HANDLE;
    VkImageView depthView = VK_NULL_HANDLE;
    PlanId lastPlan = 0;  // who drew the image that it holds; 0: nobody

    explicit Target(Device& owner) : device(owner) {}
    Target(const Target&) = delete;
    ~Target();
};

inline constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_UNORM;
inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

Result<std::shared_ptr<Target>> createTarget(Device& device, VkExtent2D size);
Result<Image> downloadImage(Device& device, const Target& target);

// The colour of whole rows, to the start of a buffer that the host reads once the commands are done.
void recordImageCopy(VkCommandBuffer commands, const Target& target, uint32_t firstRow, uint32_t rows,
                     const Buffer& to);

// Makes what the device wrote into mapped memory visible to the host.
Result<void> invalidate(Device& device, const Buffer& buffer);

// A rendering scope over the whole target, which keeps the content or clears it to the background first.
void beginRendering(VkCommandBuffer commands, const Target& target, VkAttachmentLoadOp load,
                    const std::array<float, 4>& background);

}  // namespace skinbench::vulkan
