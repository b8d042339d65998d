#include "common/plans/plans.h"

#include "common/plans/plan_parts.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

// Skins where it draws, and with a pre-pass keeps what it has skinned.
static Result<void> addVertexPasses(FramePlan& plan, const Case& c, const PlanInput& input, const Shown& shown) {
    Defines defines = caseDefines(c, input);
    if (c.scenario == Scenario::prepass) setDefine(defines, "PREPASS", "1");
    auto program = makeDrawing(c, input, shown, {Stage::vertex, "vertex.glsl"}, std::move(defines));
    SKINBENCH_TRY(program);
    if (c.fetch == VertexFetch::attributes) {
        program->attributes = input.encoded->attributes;
        program->attributeStride = input.encoded->attributeStride;
    }
    Pass pass = startPass(c, PassKind::drawIndexed, shown);
    addIndexedDraws(plan, pass, c, input);
    addPasses(plan, c, std::move(*program), pass, shown);
    return {};
}

static Result<FramePlan> planVertex(const Case& c, const PlanInput& input) {
    const bool prepass = c.scenario == Scenario::prepass;
    FramePlan plan = startPlan(c, input);
    if (c.fetch == VertexFetch::pull)
        addEncoded(plan, input);
    else
        addStream(plan, SLOT_VERTEX, useAttributes, input.encoded->vertices, input.copies);
    if (prepass) addSkinnedStream(plan, input, useStorage | useAttributes);
    bool kept = false;
    for (const Shown& shown : shownBy(c, prepass)) {
        SKINBENCH_TRY(kept ? addSkinnedDraw(plan, c, input, shown) : addVertexPasses(plan, c, input, shown));
        kept = prepass;
    }
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
    for (const Shown& shown : shownBy(c)) SKINBENCH_TRY(addSkinnedDraw(plan, c, input, shown));
    return plan;
}

}  // namespace skinbench
