// What every backend asks before it does anything, so that one fault has one sentence on all of them, behind the plan's
// label where it has one.
#pragma once

#include <utility>

#include "common/frame/backend.h"

namespace skinbench {

// Fault::input for a plan that no device could run: slots, programs, attributes, passes, draws. Fault::device where
// this one cannot: no such mesh stage, no timestamps, too large an image, stream, palette or draw, too little memory.
Result<void> checkPlan(const FramePlan& plan, const DeviceCaps& caps);

// What a backend keeps of a plan: no texts and no bytes, Stream::gpuBytes is the size of every stream.
FramePlan planShape(const FramePlan& plan);

// The first pass that draws, and whether there is one; null: none.
const Pass* firstDrawing(const FramePlan& plan);
bool drawsImage(const FramePlan& plan);
const Stream* hostWrittenStream(const FramePlan& plan);  // null: there is none

// How many times a Timing of that mode has.
size_t timesOfFrame(const FramePlan& plan, RunMode mode);

// Whether all frames are between two timestamps: RunMode::batch, but not where the host writes before each frame.
bool runsTogether(const FramePlan& plan, RunMode mode);

// Whether palettes and skinned bytes of every frame have the plan's sizes.
Result<void> checkFrames(const FramePlan& plan, std::span<const FrameInput> frames);

// Which of a plan's frames are on the way: slots of them, taken in turn.
struct FrameSlots {
    size_t begun = 0;   // frames that are on the way
    size_t oldest = 0;  // the slot of the one that began first
    size_t next() const { return (oldest + begun) % kFramesInFlight; }
    void begin() { ++begun; }
    size_t finish() {
        --begun;
        return std::exchange(oldest, (oldest + 1) % kFramesInFlight);
    }
};

// Whether a frame of the plan may begin, and one be finished, while so many are on the way. The plan draws an image,
// the host does not write its vertices, and the frame is one that checkFrames lets pass.
Result<void> checkBegin(const FramePlan& plan, const FrameInput& frame, size_t begun);
Result<void> checkFinish(const FramePlan& plan, size_t begun);

// Into FramePlan::streams.
Result<size_t> streamOfSlot(const FramePlan& plan, uint32_t slot);

// Whether plan `id` draws an image and was the last of its size to do so.
Result<void> checkImage(const FramePlan& plan, PlanId id, PlanId lastOfSize);

std::unexpected<Error> unknownPlan(PlanId id);  // Fault::input, as what checkFrames, streamOfSlot and checkImage refuse

}  // namespace skinbench
