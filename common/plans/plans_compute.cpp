// Frames whose vertices a compute pass skins.
#include <algorithm>
#include <format>

#include "common/plans/plan_parts.h"
#include "common/scene/tangents.h"

namespace skinbench {
namespace {

// Vertex after vertex as the case stores them.
Bytes tangentBytes(const Case& c, const PlanInput& input) {
    const std::vector<glm::vec4> tangents = vertexTangents(input.scene->mesh);
    std::vector<glm::vec4> stored;
    std::vector<uint32_t> words;
    for (uint32_t source : sourcesOf(input)) {
        stored.push_back(tangents[source]);
        words.push_back(packTangent(tangents[source]));
    }
    return c.compute.shortTangents ? toBytes(words) : toBytes(stored);
}

Result<void> stagePalette(Defines& defines, const PlanInput& input, const DeviceCaps& caps) {
    const size_t joints = input.scene->skeleton.joints.size();
    const size_t bytes = joints * input.palette.rowsOfJoint() * sizeof(glm::vec4);
    if (bytes > caps.maxComputeSharedBytes)
        return deviceError(std::format("needs {} bytes of shared memory for {} joints: {} allows {}", bytes, joints,
                                       caps.name, caps.maxComputeSharedBytes));
    setDefine(defines, "STAGED_JOINTS", std::to_string(joints));
    return {};
}

}  // namespace

Result<void> addSkinPass(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    Defines defines = caseDefines(c, input);
    if (c.compute.staged) SKINBENCH_TRY(stagePalette(defines, input, caps));
    auto program = makeProgram(c, input, "skin", {{Stage::compute, "compute.glsl"}}, defines);
    SKINBENCH_TRY(program);
    plan.programs.push_back(std::move(*program));
    Pass skin;
    skin.label = "skin";
    skin.kind = PassKind::dispatch;
    skin.program = static_cast<uint32_t>(plan.programs.size() - 1);
    const uint64_t vertices = input.encoded->vertexCount;
    auto groups = [](uint64_t count) { return static_cast<uint32_t>((count + COMPUTE_GROUP - 1) / COMPUTE_GROUP); };
    addGroupDraws(skin, c, input, groups(vertices), groups(vertices * input.copies),
                  std::max(1u, std::min(caps.maxComputeGroupCount, 65535u)));
    plan.passes.push_back(std::move(skin));
    return {};
}

Result<FramePlan> planCompute(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    FramePlan plan = startPlan(c, input);
    addEncoded(plan, input);
    if (c.compute.tangents || c.compute.shortTangents)
        addStream(plan, SLOT_TANGENT, useStorage, tangentBytes(c, input), input.copies);
    if (c.compute.shortTangents)
        plan.streams.push_back({.slot = SLOT_SKINNED_TANGENT,
                                .gpuBytes = uint64_t{input.copies} * input.encoded->vertexCount * sizeof(uint32_t)});
    addSkinnedStream(plan, input, useStorage | useAttributes, skinnedLayout(c).stride);
    SKINBENCH_TRY(addSkinPass(plan, c, input, caps));
    if (c.scenario == Scenario::prepass) SKINBENCH_TRY(addSkinnedDraw(plan, c, input, true));
    SKINBENCH_TRY(addSkinnedDraw(plan, c, input));
    return plan;
}

}  // namespace skinbench
