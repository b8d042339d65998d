// A FramePlan as GPU objects.
#pragma once

#include "backend_vulkan/memory.h"
#include "backend_vulkan/program.h"
#include "common/frame/check_plan.h"

namespace skinbench::vulkan {

// The streams as a frame sees them.
struct Bound {
    VkDescriptorSet descriptors = VK_NULL_HANDLE;
    std::vector<VkBuffer> vertexBuffers;  // one a pass; null: the pass has no attributes
    VkBuffer indexBuffer = VK_NULL_HANDLE;
    VkBuffer commandBuffer = VK_NULL_HANDLE;  // of indirect draws
};

struct Plan {
    Device& device;
    FramePlan shape;
    std::array<std::vector<Buffer>, 2> streams;  // each has one for each of the shape's; the second ones of those that
                                                 // are not in turn are empty
    std::array<Bound, 2> turns;                  // frames 0, 2, 4, … of a batch, and the others
    size_t lastTurn = 0;                         // of the last frame that ran
    std::vector<VkPipeline> pipelines;           // one a pass
    std::optional<size_t> hostWritten;           // into streams
    Buffer hostStaging;                          // of its size
    VkDescriptorSetLayout setLayout = VK_NULL_HANDLE;
    VkDescriptorPool descriptorPool = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::shared_ptr<Target> target;  // null: no pass draws
    uint64_t frameDataVersion = 0;   // the FrameData that the descriptors point to

    Plan(Device& owner, const FramePlan& plan) : device(owner), shape(planShape(plan)) {}
    Plan(const Plan&) = delete;
    ~Plan();
};

// The buffer that a frame of that turn sees of stream `number`.
const Buffer& bufferOf(const Plan& plan, size_t number, size_t turn);

// Constants and palettes of all frames of a batch, shared by all plans: constants first, then palettes.
struct FrameData {
    Buffer buffer;
    Memory otherwise = Memory::device;  // where the host cannot write into the device's memory
    bool shared = false;                // by both queues
    uint64_t version = 0;               // no two buffers of a device have the same
    uint64_t constantsStride = 0;
    uint64_t paletteStart = 0;
    uint64_t paletteStride = 0;
};

// Descriptor range of the palette; never empty, so that a program may declare it in a plan without one.
uint64_t paletteRange(const Plan& plan);

// `target` is what the passes draw into; null where no pass draws.
Result<std::unique_ptr<Plan>> makePlanObjects(Device& device, VkPipelineCache cache, const FramePlan& source,
                                              std::shared_ptr<Target> target);

// Room for so many frames, in a larger buffer where the present one is too small, with the plan's descriptors pointed
// at it; gives the bytes in use. Nothing that reads either is in flight.
Result<uint64_t> needFrames(Device& device, FrameData& data, Plan& plan, size_t frames);

// Constants and palette of frame `number`, into memory that begins at `out`.
void writeFrame(const FrameData& data, size_t number, const FrameInput& frame, std::byte* out);

// Writes constants and palettes of all frames, in a larger buffer where the present one is too small, and points the
// plan's descriptors at it.
Result<void> uploadFrames(Device& device, FrameData& data, Plan& plan, std::span<const FrameInput> frames);

}  // namespace skinbench::vulkan
