#include "common/plans/plans.h"

#include "common/plans/plan_parts.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

static Result<FramePlan> planVertex(const Case& which, const PlanInput& input) {
    const bool prepass = which.scenario == Scenario::prepass;
    Defines defines = commonDefines(which, input);
    Result<Program> program;
    if (prepass) {
        setDefine(defines, "PREPASS", "1");
        setDefine(defines, "DEPTH_ONLY", "1");
        program = makeProgram(which, input, "depth", {{Stage::vertex, "vertex.glsl"}}, defines);
    } else {
        program = makeProgram(which, input, "draw", {{Stage::vertex, "vertex.glsl"}, {Stage::fragment, "surface.glsl"}},
                              defines);
    }
    if (!program) return std::unexpected(program.error());
    FramePlan plan = startPlan(which, input);
    if (which.fetch == VertexFetch::pull) {
        addEncoded(plan, input);
    } else {
        program->attributes = input.encoded->attributes;
        program->attributeStride = input.encoded->attributeStride;
        addStream(plan, SLOT_VERTEX, useAttributes, input.encoded->vertices, input.copies);
    }
    plan.programs.push_back(std::move(*program));
    Pass pass = prepass ? startDepth(which, PassKind::drawIndexed) : startDraw(which, PassKind::drawIndexed);
    addIndexedDraws(plan, pass, which, input);
    plan.passes.push_back(std::move(pass));
    if (!prepass) return plan;
    addSkinnedStream(plan, input, useStorage | useAttributes);
    if (auto added = addSkinnedDraw(plan, which, input); !added) return std::unexpected(added.error());
    return plan;
}

Result<FramePlan> planDirect(const Case& which, const PlanInput& input, const DeviceCaps& caps) {
    return which.route->dialect == MeshDialect::none ? planVertex(which, input) : planMesh(which, input, caps);
}

Result<FramePlan> planCpu(const Case& which, const PlanInput& input, const DeviceCaps&) {
    FramePlan plan = startPlan(which, input);
    // The CPU reads vertices and palette from its own memory; the device holds only what it draws.
    plan.paletteBytes = 0;
    if (which.route->api == Api::cpu) return plan;
    addSkinnedStream(plan, input, useAttributes);
    plan.streams.back().hostWritten = true;
    if (auto added = addSkinnedDraw(plan, which, input); !added) return std::unexpected(added.error());
    return plan;
}

}  // namespace skinbench
