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
        words.push_back(c.compute.wicked ? packTangentBytes(tangents[source]) : packTangent(tangents[source]));
    }
    return packsTangents(c.compute) ? toBytes(words) : toBytes(stored);
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

void addDispatches(FramePlan& plan, const char* label, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                   uint64_t each, uint32_t groupSize) {
    Pass pass;
    pass.label = label;
    pass.kind = PassKind::dispatch;
    pass.program = static_cast<uint32_t>(plan.programs.size() - 1);
    auto groups = [&](uint64_t count) { return static_cast<uint32_t>((count + groupSize - 1) / groupSize); };
    addGroupDraws(pass, c, input, groups(each), groups(each * input.copies),
                  std::max(1u, std::min(caps.maxComputeGroupCount, 65535u)));
    plan.passes.push_back(std::move(pass));
}

Result<void> addSkinPass(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                         const Defines& more) {
    Defines defines = caseDefines(c, input);
    for (const auto& [name, value] : more) setDefine(defines, name, value);
    if (c.compute.staged) SKINBENCH_TRY(stagePalette(defines, input, caps));
    auto program = makeProgram(c, input, "skin", {{Stage::compute, "compute.glsl"}}, defines);
    SKINBENCH_TRY(program);
    plan.programs.push_back(std::move(*program));
    addDispatches(plan, "skin", c, input, caps, input.encoded->vertexCount, COMPUTE_GROUP);
    return {};
}

Result<FramePlan> planCompute(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    FramePlan plan = startPlan(c, input);
    addEncoded(plan, input);
    if (skinsTangents(c.compute)) addStream(plan, SLOT_TANGENT, useStorage, tangentBytes(c, input), input.copies);
    if (packsTangents(c.compute))
        plan.streams.push_back({.slot = SLOT_SKINNED_TANGENT,
                                .gpuBytes = uint64_t{input.copies} * input.encoded->vertexCount * sizeof(uint32_t)});
    addSkinnedStream(plan, input, useStorage | useAttributes, skinnedLayout(c).stride);
    SKINBENCH_TRY(addSkinPass(plan, c, input, caps));
    if (c.scenario == Scenario::prepass) SKINBENCH_TRY(addSkinnedDraw(plan, c, input, true));
    SKINBENCH_TRY(addSkinnedDraw(plan, c, input));
    return plan;
}

// The commands of all draws: the device counts the indices, the rest stays. With listed meshlets a command a copy more,
// of the work groups that test triangles.
static Bytes drawCommands(const Case& c, const PlanInput& input) {
    const auto indices = static_cast<uint32_t>(input.scene->mesh.indices.size());
    std::vector<DrawCommand> commands;
    for (uint32_t copy = 0; copy < (c.submission == Submission::batched ? 1 : input.copies); ++copy)
        commands.push_back(
            {.firstIndex = copy * indices, .baseVertex = static_cast<int32_t>(copy * input.encoded->vertexCount)});
    if (c.clusterCull == ClusterCull::list) commands.resize(2 * input.copies, groupCommand(0, MeshDialect::none));
    return toBytes(commands);
}

Result<FramePlan> planComputeCull(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    const std::vector<uint32_t> indices = drawnIndices(input);
    FramePlan plan = startPlan(c, input);
    addEncoded(plan, input);
    addSkinnedStream(plan, input, useStorage | useAttributes);
    addStream(plan, SLOT_INDEX, useStorage, toBytes(indices), input.copies);
    if (c.submission == Submission::batched) plan.streams.back().replicaAdd = input.encoded->vertexCount;
    plan.streams.push_back({.slot = SLOT_VISIBLE,
                            .use = useStorage | useIndices,
                            .gpuBytes = indices.size() * sizeof(uint32_t) * input.copies});
    plan.streams.push_back({.slot = SLOT_COMMAND, .use = useStorage | useIndirect, .bytes = drawCommands(c, input)});
    Defines defines = caseDefines(c, input);
    addClusters(plan, c, input, caps, defines);
    Defines skinning = defines;
    setDefine(skinning, "LISTS_TRIANGLES", "1");
    SKINBENCH_TRY(addSkinPass(plan, c, input, caps, skinning));
    SKINBENCH_TRY(addClusterPasses(plan, c, input, caps, defines));

    const std::pair<const char*, uint64_t> more[] = {{"REUSE_SKINNED", 1},
                                                     {"TRIANGLE_COUNT", indices.size() / 3},
                                                     {"SUBPIXELS", rasterSubpixels(caps)},
                                                     {"IMAGE_WIDTH", input.width},
                                                     {"IMAGE_HEIGHT", input.height}};
    for (const auto& [name, value] : more) setDefine(defines, name, std::to_string(value));
    auto program = makeProgram(c, input, "cull", {{Stage::compute, "cull_triangles.glsl"}}, defines);
    SKINBENCH_TRY(program);
    plan.programs.push_back(std::move(*program));
    addDispatches(plan, "cull", c, input, caps, indices.size() / 3, CULL_GROUP);
    if (c.clusterCull == ClusterCull::list) {
        plan.passes.back().draws.clear();
        addListedDraws(plan.passes.back(), c, input, input.copies);
    }
    SKINBENCH_TRY(addSkinnedDraw(plan, c, input));
    return plan;
}

}  // namespace skinbench
