// What lies under the pointer: the nearest triangle of the frame, its meshlet and the vertex next to it.
#pragma once

#include "common/cases/workload.h"

namespace skinbench {

// Lines for people: copy, meshlet, codec, vertex; none where no triangle is hit. `frame` is what was drawn, `at` a
// point of its picture as shares of width and height.
std::vector<std::string> pickLines(const Case& c, const PlanInput& input, const FrameData& frame, glm::vec2 at);

}  // namespace skinbench
