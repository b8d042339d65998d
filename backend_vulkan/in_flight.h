// Frames of a plan that the device draws while the host goes on.
#pragma once

#include "backend_vulkan/record.h"
#include "backend_vulkan/timestamps.h"

namespace skinbench::vulkan {

// What one frame has to itself until it is finished.
struct FrameInFlight {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    Timestamps times;
    Buffer image;  // read by the host
    double record = 0, submit = 0;
};

struct InFlight {
    Device& device;
    uint32_t passes = 0, width = 0, height = 0;  // of the plan
    VkCommandPool pool = VK_NULL_HANDLE;
    FrameData data{.otherwise = Memory::upload};  // a frame's number in it is that of its slot
    std::array<FrameInFlight, kFramesInFlight> frames;
    FrameSlots slots;

    explicit InFlight(Device& owner) : device(owner) {}
    InFlight(const InFlight&) = delete;
    ~InFlight();  // waits for what has begun
};

// For a plan that draws.
Result<std::unique_ptr<InFlight>> openInFlight(Device& device, const Plan& plan);

// checkBegin and checkFinish have let it pass.
Result<void> beginFrame(InFlight& inFlight, Plan& plan, const FrameInput& input);
Result<FinishedFrame> finishFrame(InFlight& inFlight);

// Until the device is done with all of them; they are still to be finished.
Result<void> waitForFrames(const InFlight& inFlight);

}  // namespace skinbench::vulkan
