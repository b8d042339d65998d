// What a case that culls has left out, beside what could be left out at the most (the oracle), and whether it was
// right.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/cases/workload.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

// Of one test. `possible` is the oracle's count, from positions in double precision.
struct LeftOut {
    uint64_t count = 0;
    uint64_t possible = 0;
};

// Of all copies in one frame. A test sees what the tests before it, in this order, left.
struct Culling {
    uint64_t meshlets = 0;    // that were tested; 0: Case::clusterCull is off
    LeftOut frustum;          // no triangle of the meshlet meets the view volume
    LeftOut cone;             // all of them face away
    uint64_t triangles = 0;   // that were tested one by one; 0: no pass of the case does
    LeftOut triangleFrustum;  // it does not meet the view volume
    LeftOut triangleBack;     // it faces away
    LeftOut triangleSmall;    // it covers no centre of a pixel
    uint64_t wrong = 0;       // meshlets that were left out though a triangle of theirs can be seen
};

// `verdicts` are the words of SLOT_VERDICT as a plan of the case left them: a verifying one, or one of View::culled.
// The oracle of a test that the case does not make is 0.
Culling cullingOf(const Case& c, const PlanInput& input, const FrameData& frame, std::span<const uint32_t> verdicts);

// The same without the oracle, which takes the host far longer than the device takes to draw.
Culling countVerdicts(const Case& c, const PlanInput& input, std::span<const uint32_t> verdicts);

// What a colour of View::culled means, and how much of it there is: "bounds outside of the view: 700 of 2048 meshlets
// (34.2 %)".
struct LegendRow {
    glm::vec3 color{0};  // red, green, blue, where the light falls
    std::string name;    // of the colour
    std::string text;
};
std::vector<LegendRow> legendOf(const Case& c, const Culling& culling);

// For each encoded vertex of the first, then of the last copy, whether no meshlet that is drawn has it; of a case that
// skins where it draws. Empty where meshlets are not tested, and in View::culled, which draws them all.
std::vector<char> verticesLeftOut(const Case& c, const PlanInput& input, std::span<const uint32_t> verdicts);

}  // namespace skinbench
