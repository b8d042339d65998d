// How each variant becomes passes; the functions behind the rows of variants().
#pragma once

#include "common/plans/plan.h"

namespace skinbench {

// One pass "draw" that skins where it draws: a mesh stage on mesh routes, a vertex stage on the others. As a pre-pass:
// "depth", which keeps what it has skinned, then "draw" with a plain vertex stage, the same for all variants; where
// DeviceCaps::meshDepthDiffers, a mesh stage that reads what was kept follows a mesh stage.
Result<FramePlan> planDirect(const Case& c, const PlanInput& input, const DeviceCaps& caps);
Result<FramePlan> planMesh(const Case& c, const PlanInput& input, const DeviceCaps& caps);

// A pass "skin" of compute work groups, 64 vertices each, then "draw" with a plain vertex stage; as a pre-pass "depth"
// between them.
Result<FramePlan> planCompute(const Case& c, const PlanInput& input, const DeviceCaps& caps);

// "skin", then "cull": a triangle an invocation is tested, and the indices of those left go into a list by one atomic
// addition a work group; then "draw", indirect, from that list. Where in the list a work group's triangles lie differs
// from frame to frame, so triangles that coincide may be drawn in another order.
Result<FramePlan> planComputeCull(const Case& c, const PlanInput& input, const DeviceCaps& caps);

// The same "skin", then "draw" with a mesh stage that reads the skinned vertices.
Result<FramePlan> planComputeMesh(const Case& c, const PlanInput& input, const DeviceCaps& caps);

// A pass "draw" over the skinned vertices that FrameInput::skinned brings; on route cpu no pass at all.
Result<FramePlan> planCpu(const Case& c, const PlanInput& input, const DeviceCaps& caps);

}  // namespace skinbench
