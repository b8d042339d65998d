// Frames of a plan that the device draws while the host goes on.
#pragma once

#include "backend_gl/record.h"

namespace skinbench {

// What one frame has to itself until it is finished.
struct GlFrameInFlight {
    GlFrameData data;
    GlBuffer pixels;
    const std::byte* image = nullptr;  // what `pixels` holds
    std::vector<GLuint> queries;       // two a pass
    GLsync done = nullptr;             // signalled behind the copy of the image
    double record = 0, submit = 0;     // milliseconds

    GlFrameInFlight() = default;
    GlFrameInFlight(GlFrameInFlight&&) = default;
    ~GlFrameInFlight();
};

struct GlInFlight {
    std::array<GlFrameInFlight, kFramesInFlight> frames;
    FrameSlots slots;
};

// For a plan that draws.
Result<GlInFlight> openInFlight(const FramePlan& plan);

// `record` is of the next slot's data; `color` is what the plan draws into. checkBegin has let the frame pass.
Result<void> beginFrame(GlInFlight& inFlight, const GlFrameRecord& record, const GlTexture& color,
                        const FrameInput& input);

// Of a frame that is done.
FinishedFrame finishedFrame(const Context& context, const FramePlan& plan, const GlFrameInFlight& frame);

}  // namespace skinbench
