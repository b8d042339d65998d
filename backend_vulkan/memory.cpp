#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#define VMA_IMPLEMENTATION
#include "backend_vulkan/device.h"
#pragma GCC diagnostic pop

#include <algorithm>
#include <cstring>
#include <format>

#include "backend_vulkan/memory.h"

namespace skinbench::vulkan {

namespace {

VmaAllocationCreateInfo allocationInfo(Memory memory) {
    VmaAllocationCreateInfo info{};
    info.usage = VMA_MEMORY_USAGE_AUTO;
    // Within the budget: a software device would otherwise take memory until the system ends the process.
    info.flags = VMA_ALLOCATION_CREATE_WITHIN_BUDGET_BIT;
    switch (memory) {
        case Memory::device:
            info.requiredFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
            break;
        case Memory::deviceMapped:
            info.flags |= VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT;
            info.requiredFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
            break;
        case Memory::upload:
            info.usage = VMA_MEMORY_USAGE_AUTO_PREFER_HOST;
            info.flags |= VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT;
            break;
        case Memory::download:
            info.usage = VMA_MEMORY_USAGE_AUTO_PREFER_HOST;
            info.flags |= VMA_ALLOCATION_CREATE_HOST_ACCESS_RANDOM_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT;
            break;
    }
    return info;
}

// Error text for what could not be allocated: "<who> needs 812 MiB of device memory, …".
std::unexpected<Error> memoryError(Device& device, const std::string& who, uint64_t bytes, VkResult result) {
    if (result == VK_ERROR_DEVICE_LOST) return std::unexpected(check(device, result, "take memory").error());
    return deviceError(
        std::format("{} needs {} MiB of device memory, and {} gave out of it ({}); use fewer copies or a smaller scene",
                    who, (bytes + (1 << 20) - 1) >> 20, device.caps.name, resultName(result)));
}

Result<void> needBuffer(Device& device, Buffer& buffer, Memory memory, VkBufferUsageFlags usage) {
    if (buffer.handle) return {};
    return createBuffer(device, kChunkBytes, usage, memory, buffer,
                        [&] { return device.caps.name + ": the copy between host and device"; });
}

void hostBarrier(const Device& device, VkCommandBuffer commands) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &barrier;
    device.vk.vkCmdPipelineBarrier2(commands, &info);
}

Result<void> finishDownload(Device& device) {
    SKINBENCH_TRY(endCommands(device));
    SKINBENCH_TRY(submitAndWait(device));
    return invalidate(device, device.readback);
}

void imageBarrier(const Device& device, VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect,
                  VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {aspect, 0, 1, 0, 1};
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    device.vk.vkCmdPipelineBarrier2(commands, &info);
}

Result<void> createAttachment(Target& target, VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect,
                              VkImage& image, VmaAllocation& memory, VkImageView& view) {
    Device& device = target.device;
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {target.size.width, target.size.height, 1};
    info.mipLevels = 1;
    info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = usage;
    VmaAllocationCreateInfo allocation = allocationInfo(Memory::device);
    VkResult result = vmaCreateImage(device.allocator, &info, &allocation, &image, &memory, nullptr);
    const uint64_t bytes = uint64_t{target.size.width} * target.size.height * 4;
    if (result != VK_SUCCESS)
        return memoryError(device, std::format("the {}x{} image", target.size.width, target.size.height), bytes,
                           result);
    VkImageViewCreateInfo viewInfo{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    viewInfo.image = image;
    viewInfo.viewType = VK_IMAGE_VIEW_TYPE_2D;
    viewInfo.format = format;
    viewInfo.subresourceRange = {aspect, 0, 1, 0, 1};
    return check(device, device.vk.vkCreateImageView(device.handle, &viewInfo, nullptr, &view), "create an image view");
}

}  // namespace

// Where a driver asks for less than a vertex's 64 bytes, what lies before a buffer would show in its times: up to 1.19
// times on an H200, which asks for 16 (docs/studies/alignment.md).
constexpr VkDeviceSize kBufferAlignment = 256;

VkResult tryCreateBuffer(Device& device, uint64_t bytes, VkBufferUsageFlags usage, Memory memory, Buffer& buffer,
                         bool shared) {
    const std::array families{device.adapter.queueFamily.value_or(0), device.adapter.secondFamily.value_or(0)};
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = std::max<uint64_t>((bytes + 3) / 4 * 4, 16);
    info.usage = usage;
    if (shared) {
        info.sharingMode = VK_SHARING_MODE_CONCURRENT;
        info.queueFamilyIndexCount = static_cast<uint32_t>(families.size());
        info.pQueueFamilyIndices = families.data();
    }
    VmaAllocationCreateInfo allocation = allocationInfo(memory);
    VmaAllocationInfo made{};
    VkResult result = vmaCreateBufferWithAlignment(device.allocator, &info, &allocation, kBufferAlignment,
                                                   &buffer.handle, &buffer.allocation, &made);
    if (result != VK_SUCCESS) {
        buffer = {};
        return result;
    }
    buffer.mapped = memory == Memory::device ? nullptr : static_cast<std::byte*>(made.pMappedData);
    buffer.bytes = info.size;
    return VK_SUCCESS;
}

void destroy(Device& device, Buffer& buffer) {
    if (buffer.handle && !device.hung) vmaDestroyBuffer(device.allocator, buffer.handle, buffer.allocation);
    buffer = {};
}

Result<void> createBuffer(Device& device, uint64_t bytes, VkBufferUsageFlags usage, Memory memory, Buffer& buffer,
                          const Who& who, bool shared) {
    const VkResult result = tryCreateBuffer(device, bytes, usage, memory, buffer, shared);
    if (result != VK_SUCCESS) return memoryError(device, who(), bytes, result);
    return {};
}

Result<void> upload(Device& device, const Buffer& target, uint64_t bytes, const Fill& fill) {
    if (bytes == 0) return {};
    SKINBENCH_TRY(needBuffer(device, device.staging, Memory::upload, VK_BUFFER_USAGE_TRANSFER_SRC_BIT));
    for (uint64_t from = 0; from < bytes; from += kChunkBytes) {
        const uint64_t part = std::min(kChunkBytes, bytes - from);
        fill({device.staging.mapped, part}, from);
        SKINBENCH_TRY(flush(device, device.staging));
        auto commands = beginCommands(device);
        SKINBENCH_TRY(commands);
        const VkBufferCopy region{0, from, part};
        device.vk.vkCmdCopyBuffer(*commands, device.staging.handle, target.handle, 1, &region);
        fullBarrier(device, *commands);
        SKINBENCH_TRY(endCommands(device));
        SKINBENCH_TRY(submitAndWait(device));
    }
    return {};
}

Result<void> fillZero(Device& device, const Buffer& target) {
    auto commands = beginCommands(device);
    SKINBENCH_TRY(commands);
    device.vk.vkCmdFillBuffer(*commands, target.handle, 0, VK_WHOLE_SIZE, 0);
    fullBarrier(device, *commands);
    SKINBENCH_TRY(endCommands(device));
    SKINBENCH_TRY(submitAndWait(device));
    return {};
}

Result<std::vector<std::byte>> download(Device& device, const Buffer& source, uint64_t bytes) {
    SKINBENCH_TRY(needBuffer(device, device.readback, Memory::download, VK_BUFFER_USAGE_TRANSFER_DST_BIT));
    std::vector<std::byte> result(bytes);
    for (uint64_t from = 0; from < bytes; from += kChunkBytes) {
        const uint64_t part = std::min(kChunkBytes, bytes - from);
        auto commands = beginCommands(device);
        SKINBENCH_TRY(commands);
        const VkBufferCopy region{from, 0, part};
        device.vk.vkCmdCopyBuffer(*commands, source.handle, device.readback.handle, 1, &region);
        hostBarrier(device, *commands);
        SKINBENCH_TRY(finishDownload(device));
        std::memcpy(result.data() + from, device.readback.mapped, part);
    }
    return result;
}

Result<void> flush(Device& device, const Buffer& buffer) {
    return check(device, vmaFlushAllocation(device.allocator, buffer.allocation, 0, VK_WHOLE_SIZE), "write memory");
}

Result<void> invalidate(Device& device, const Buffer& buffer) {
    return check(device, vmaInvalidateAllocation(device.allocator, buffer.allocation, 0, VK_WHOLE_SIZE),
                 "read memory back");
}

Target::~Target() {
    if (device.hung) return;
    device.vk.vkDestroyImageView(device.handle, colorView, nullptr);
    device.vk.vkDestroyImageView(device.handle, depthView, nullptr);
    if (color) vmaDestroyImage(device.allocator, color, colorMemory);
    if (depth) vmaDestroyImage(device.allocator, depth, depthMemory);
}

Result<std::shared_ptr<Target>> createTarget(Device& device, VkExtent2D size) {
    auto target = std::make_shared<Target>(device);
    target->size = size;
    SKINBENCH_TRY(createAttachment(*target, kColorFormat,
                                   VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                   VK_IMAGE_ASPECT_COLOR_BIT, target->color, target->colorMemory, target->colorView));
    SKINBENCH_TRY(createAttachment(*target, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                                   VK_IMAGE_ASPECT_DEPTH_BIT, target->depth, target->depthMemory, target->depthView));
    auto commands = beginCommands(device);
    SKINBENCH_TRY(commands);
    imageBarrier(device, *commands, target->color, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    imageBarrier(device, *commands, target->depth, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                 VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    beginRendering(*commands, *target, VK_ATTACHMENT_LOAD_OP_CLEAR, FramePlan{}.background);
    device.vk.vkCmdEndRendering(*commands);
    SKINBENCH_TRY(endCommands(device));
    SKINBENCH_TRY(submitAndWait(device));
    return target;
}

void recordImageCopy(VkCommandBuffer commands, const Target& target, uint32_t firstRow, uint32_t rows,
                     const Buffer& to) {
    const Device& device = target.device;
    imageBarrier(device, commands, target.color, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                 VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageOffset = {0, static_cast<int32_t>(firstRow), 0};
    region.imageExtent = {target.size.width, rows, 1};
    device.vk.vkCmdCopyImageToBuffer(commands, target.color, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.handle, 1,
                                     &region);
    imageBarrier(device, commands, target.color, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    hostBarrier(device, commands);
}

Result<Image> downloadImage(Device& device, const Target& target) {
    SKINBENCH_TRY(needBuffer(device, device.readback, Memory::download, VK_BUFFER_USAGE_TRANSFER_DST_BIT));
    const auto [width, height] = target.size;
    Image image{width, height, std::vector<uint8_t>(size_t{width} * height * 4)};
    const uint32_t rowBytes = width * 4;
    const uint32_t rowsAtOnce = static_cast<uint32_t>(std::min<uint64_t>(kChunkBytes / rowBytes, height));
    for (uint32_t row = 0; row < height; row += rowsAtOnce) {
        const uint32_t rows = std::min(rowsAtOnce, height - row);
        auto commands = beginCommands(device);
        SKINBENCH_TRY(commands);
        recordImageCopy(*commands, target, row, rows, device.readback);
        SKINBENCH_TRY(finishDownload(device));
        std::memcpy(image.rgba.data() + size_t{row} * rowBytes, device.readback.mapped, size_t{rows} * rowBytes);
    }
    return image;
}

void beginRendering(VkCommandBuffer commands, const Target& target, VkAttachmentLoadOp load,
                    const std::array<float, 4>& background) {
    VkRenderingAttachmentInfo color{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    color.imageView = target.colorView;
    color.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    color.loadOp = load;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    std::ranges::copy(background, color.clearValue.color.float32);
    VkRenderingAttachmentInfo depth = color;
    depth.imageView = target.depthView;
    depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
    depth.clearValue.depthStencil = {1.0f, 0};
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea.extent = target.size;
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &color;
    info.pDepthAttachment = &depth;
    target.device.vk.vkCmdBeginRendering(commands, &info);
}

}  // namespace skinbench::vulkan
