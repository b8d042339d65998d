// What lies under the pointer: the nearest triangle of the frame, its meshlet and the vertex next to it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/cases/workload.h"

namespace skinbench {

// Lines for people: copy, meshlet, codec, vertex; none where no triangle is hit. `frame` is what was drawn, `at` a
// point of its picture as shares of width and height. `verdicts` are the words of SLOT_VERDICT in that frame; none: not
// known.
std::vector<std::string> pickLines(const Case& c, const PlanInput& input, const FrameData& frame, glm::vec2 at,
                                   std::span<const uint32_t> verdicts = {});

}  // namespace skinbench
