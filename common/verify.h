// What a plan captured, compared with the reference.
#pragma once

#include <span>

#include "common/skin_cpu.h"
#include "common/variant.h"
#include "common/workload.h"

namespace skinbench {

struct CapturedError {
    SkinError decoded;  // against the reference skinned from what the codec decodes to
    SkinError source;   // against the reference skinned from the scene's own vertices
};

// `captured` holds the encoded vertices of the first copy, then those of the last one, as `frame` poses them. A single
// copy is captured in the first half only.
CapturedError capturedError(const Case& which, const PlanInput& input, const FrameData& frame,
                            std::span<const SkinnedVertex> captured);

}  // namespace skinbench
