// A FramePlan as GPU objects.
#pragma once

#include "backend_vulkan/memory.h"
#include "backend_vulkan/program.h"
#include "common/frame/check_plan.h"

namespace skinbench::vulkan {

struct Plan {
    Device& device;
    FramePlan shape;
    std::vector<Buffer> streams;          // one for each of the shape's
    std::vector<VkPipeline> pipelines;    // one a pass
    std::vector<VkBuffer> vertexBuffers;  // one a pass; null: the pass has no attributes
    VkBuffer indexBuffer = VK_NULL_HANDLE;
    VkBuffer commandBuffer = VK_NULL_HANDLE;  // of indirect draws
    std::optional<size_t> hostWritten;  // into streams
    Buffer hostStaging;                 // of its size
    VkDescriptorSetLayout setLayout = VK_NULL_HANDLE;
    VkDescriptorPool descriptorPool = VK_NULL_HANDLE;
    VkDescriptorSet descriptors = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::shared_ptr<Target> target;  // null: no pass draws
    uint64_t frameDataVersion = 0;   // the FrameData that the descriptors point to

    Plan(Device& owner, const FramePlan& plan) : device(owner), shape(planShape(plan)) {}
    Plan(const Plan&) = delete;
    ~Plan();
};

// Constants and palettes of all frames of a batch, shared by all plans: constants first, then palettes.
struct FrameData {
    Buffer buffer;
    uint64_t version = 0;  // counts the buffers that there were
    uint64_t constantsStride = 0;
    uint64_t paletteStart = 0;
    uint64_t paletteStride = 0;
};

// Descriptor range of the palette; never empty, so that a program may declare it in a plan without one.
uint64_t paletteRange(const Plan& plan);

// `target` is what the passes draw into; null where no pass draws.
Result<std::unique_ptr<Plan>> makePlanObjects(Device& device, VkPipelineCache cache, const FramePlan& source,
                                              std::shared_ptr<Target> target);

// Writes constants and palettes of all frames, in a larger buffer where the present one is too small, and points the
// plan's descriptors at it.
Result<void> uploadFrames(Device& device, FrameData& data, Plan& plan, std::span<const FrameInput> frames);

}  // namespace skinbench::vulkan
