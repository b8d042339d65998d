// A FramePlan as GPU objects.
#pragma once

#include "backend_vulkan/memory.h"
#include "backend_vulkan/program.h"

namespace skinbench::vulkan {

struct StreamBuffer {
    uint32_t slot = 0;
    Buffer buffer;
    uint64_t bytes = 0;
};

struct Plan {
    Device& device;
    std::string label;
    MeshDialect dialect = MeshDialect::none;
    uint64_t paletteBytes = 0;
    uint32_t paletteRange = 0;
    std::vector<Pass> passes;
    std::vector<StreamBuffer> streams;
    std::vector<VkPipeline> pipelines;    // one a pass
    std::vector<VkBuffer> vertexBuffers;  // one a pass; null: the pass has no attributes
    VkBuffer indexBuffer = VK_NULL_HANDLE;
    std::optional<size_t> hostWritten;  // into streams
    Buffer hostStaging;                 // of its size
    VkDescriptorSetLayout setLayout = VK_NULL_HANDLE;
    VkDescriptorPool descriptorPool = VK_NULL_HANDLE;
    VkDescriptorSet descriptors = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::shared_ptr<Target> target;  // null: no pass draws
    uint64_t frameDataVersion = 0;   // the FrameData that the descriptors point to

    explicit Plan(Device& owner) : device(owner) {}
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

// Refuses what the device cannot do, before anything is made.
Result<void> checkPlan(const Device& device, const FramePlan& plan);

// Writes constants and palettes of all frames, in a larger buffer where the present one is too small, and points the
// plan's descriptors at it.
Result<void> uploadFrames(Device& device, FrameData& data, Plan& plan, std::span<const FrameInput> frames);

}  // namespace skinbench::vulkan
