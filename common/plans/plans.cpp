#include "common/plans/plans.h"

#include "common/plans/plan_parts.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

static Result<FramePlan> planVertex(const Case& c, const PlanInput& input) {
    const bool prepass = c.scenario == Scenario::prepass;
    Defines defines = caseDefines(c, input);
    Result<Program> program;
    if (prepass) {
        setDefine(defines, "PREPASS", "1");
        setDefine(defines, "DEPTH_ONLY", "1");
        program = makeProgram(c, input, "depth", {{Stage::vertex, "vertex.glsl"}}, defines);
    } else {
        program =
            makeProgram(c, input, "draw", {{Stage::vertex, "vertex.glsl"}, {Stage::fragment, "surface.glsl"}}, defines);
    }
    SKINBENCH_TRY(program);
    FramePlan plan = startPlan(c, input);
    if (c.fetch == VertexFetch::pull) {
        addEncoded(plan, input);
    } else {
        program->attributes = input.encoded->attributes;
        program->attributeStride = input.encoded->attributeStride;
        addStream(plan, SLOT_VERTEX, useAttributes, input.encoded->vertices, input.copies);
    }
    plan.programs.push_back(std::move(*program));
    Pass pass = prepass ? startDepth(c, PassKind::drawIndexed) : startDraw(c, PassKind::drawIndexed);
    addIndexedDraws(plan, pass, c, input);
    plan.passes.push_back(std::move(pass));
    if (!prepass) return plan;
    addSkinnedStream(plan, input, useStorage | useAttributes);
    SKINBENCH_TRY(addSkinnedDraw(plan, c, input));
    return plan;
}

Result<FramePlan> planDirect(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    return c.route->dialect == MeshDialect::none ? planVertex(c, input) : planMesh(c, input, caps);
}

Result<FramePlan> planCpu(const Case& c, const PlanInput& input, const DeviceCaps&) {
    FramePlan plan = startPlan(c, input);
    // The CPU reads vertices and palette from its own memory; the device holds only what it draws.
    plan.paletteBytes = 0;
    if (c.route->api == Api::cpu) return plan;
    addSkinnedStream(plan, input, useAttributes);
    plan.streams.back().hostWritten = true;
    SKINBENCH_TRY(addSkinnedDraw(plan, c, input));
    return plan;
}

}  // namespace skinbench
