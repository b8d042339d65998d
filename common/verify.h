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

// What the variant `compute` keeps beside positions and normals: the larger error of the first and the last copy, 0 for
// what the case does not keep.
struct KeptError {
    double previous = 0;  // of positions, relative to the posed bounding box's diagonal
    double tangent = 0;   // radians; infinite where a tangent's side is wrong
};

// `records` is the content of SLOT_SKINNED once `before` and then `frame` were drawn, with ComputeOptions::halfRate
// each twice, so that every copy showed both.
KeptError keptError(const Case& which, const PlanInput& input, const FrameData& before, const FrameData& frame,
                    std::span<const std::byte> records);

// For each encoded vertex the vertex of the scene that it came from.
std::vector<uint32_t> sourcesOf(const PlanInput& input);

}  // namespace skinbench
