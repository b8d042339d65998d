// Commands of one frame of a plan.
#pragma once

#include "backend_vulkan/plan.h"

namespace skinbench::vulkan {

struct FrameRecord {
    const Plan& plan;
    const FrameData& data;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    size_t frame = 0;          // of what `data` holds
    bool secondQueue = false;  // where nothing is drawn
    const Bound& bound() const { return plan.turns[frame % 2]; }
};

// The streams, with the frame's constants and its palettes from `paletteOffset` on.
void bindFrame(const FrameRecord& record, uint64_t paletteOffset = 0);

// The target's colour to the background and its depth to 1.
void clearTarget(const FrameRecord& record);

// The pipeline of a pass with its state.
void bindPass(const FrameRecord& record, size_t number);

// The draws of a bound pass, each with its constants; `load` is what a drawing pass does with the target first.
void recordDraws(const FrameRecord& record, const Pass& pass, VkAttachmentLoadOp load = VK_ATTACHMENT_LOAD_OP_LOAD);

// Passes from number `from` to before `to`, the first one too behind what it needs of `before`, the pass that the queue
// was given last (null: none). Each clears in its turn, but for `cleared`. Gives the last one.
const Pass* recordPasses(const FrameRecord& record, size_t from, size_t to, const Pass* before,
                         const Pass* cleared = nullptr);

// One pass as RunMode::timed has it; measure(0) and measure(1) record what comes right before and right after its
// draws.
void recordPass(const FrameRecord& record, size_t number, const std::function<void(uint32_t end)>& measure);

// All of them, with two timestamps each from query `first` on.
void recordTimed(const FrameRecord& record, VkQueryPool pool, uint32_t first);

// Mesa's software driver puts a timestamp into the queue of tiles that a barrier empties, and runs the geometry stages
// before that queue. So the queue is empty on both sides; a GPU gets no barrier here.
void writeTimestamp(const Device& device, VkCommandBuffer commands, VkQueryPool pool, uint32_t query);

// What a pass needs of the one before it: skinned vertices, lists and commands, and after a drawing pass its depth, or
// that nothing reads its lists and targets any more.
void narrowBarrier(const Device& device, VkCommandBuffer commands, bool afterDispatch);

}  // namespace skinbench::vulkan
