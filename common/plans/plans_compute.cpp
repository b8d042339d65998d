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

Pass dispatchPass(const char* label, const Case& c, const PlanInput& input, const DeviceCaps& caps, uint64_t each,
                  uint32_t groupSize) {
    Pass pass;
    pass.label = label;
    pass.kind = PassKind::dispatch;
    auto groups = [&](uint64_t count) { return static_cast<uint32_t>((count + groupSize - 1) / groupSize); };
    addGroupDraws(pass, c, input, groups(each), groups(each * input.copies),
                  std::max(1u, std::min(caps.maxComputeGroupCount, 65535u)));
    return pass;
}

Result<void> addSkinPass(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                         const Defines& more) {
    Defines defines = caseDefines(c, input);
    for (const auto& [name, value] : more) setDefine(defines, name, value);
    if (c.compute.staged) SKINBENCH_TRY(stagePalette(defines, input, caps));
    auto program = makeProgram(c, input, "skin", {{Stage::compute, "compute.glsl"}}, defines);
    SKINBENCH_TRY(program);
    addPasses(plan, c, std::move(*program),
              dispatchPass("skin", c, input, caps, input.encoded->vertexCount, COMPUTE_GROUP), {});
    return {};
}

void runAhead(FramePlan& plan, const Case& c) {
    const auto skins = [](const Pass& pass) { return pass.label == "skin"; };
    plan.passesAhead = static_cast<uint32_t>(std::ranges::find_if_not(plan.passes, skins) - plan.passes.begin());
    for (Stream& stream : plan.streams) {
        const bool skinned = stream.slot == SLOT_SKINNED || stream.slot == SLOT_SKINNED_TANGENT;
        // compute.glsl clears the counts of the passes that come next, and captures.
        const bool counted = stream.slot == SLOT_COMMAND || stream.slot == SLOT_VERDICT || stream.slot == SLOT_CAPTURE;
        stream.inTurn = skinned || (counted && c.variant->listsTriangles);
    }
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
    for (const Shown& shown : shownBy(c)) SKINBENCH_TRY(addSkinnedDraw(plan, c, input, shown));
    return plan;
}

// The commands of all draws, view after view: the device counts the indices, the rest stays. With listed meshlets a
// view has a command a copy more, of the work groups that test triangles.
static Bytes drawCommands(const Case& c, const PlanInput& input) {
    const auto indices = static_cast<uint32_t>(input.scene->mesh.indices.size());
    std::vector<DrawCommand> commands;
    for (uint32_t view = 0; view < numbersShown(c); ++view) {
        for (uint32_t copy = 0; copy < (c.submission == Submission::batched ? 1 : input.copies); ++copy)
            commands.push_back(
                {.firstIndex = copy * indices, .baseVertex = static_cast<int32_t>(copy * input.encoded->vertexCount)});
        if (c.clusterCull == ClusterCull::list)
            commands.resize(commands.size() + input.copies, groupCommand(0, MeshDialect::none));
    }
    return toBytes(commands);
}

// Tests the triangles of each view that is shown, and lists those that are left.
static Result<void> addCullPasses(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                                  Defines defines, const Shown& shown) {
    const size_t triangles = input.scene->mesh.indices.size() / 3;
    const std::pair<const char*, uint64_t> more[] = {{"REUSE_SKINNED", 1},
                                                     {"TRIANGLE_COUNT", triangles},
                                                     {"SUBPIXELS", rasterSubpixels(caps)},
                                                     {"IMAGE_WIDTH", input.width},
                                                     {"IMAGE_HEIGHT", input.height}};
    for (const auto& [name, value] : more) setDefine(defines, name, std::to_string(value));
    setView(defines, shown);
    auto program = makeProgram(c, input, "cull", {{Stage::compute, "cull_triangles.glsl"}}, defines);
    SKINBENCH_TRY(program);
    Pass pass = dispatchPass("cull", c, input, caps, triangles, CULL_GROUP);
    if (c.clusterCull == ClusterCull::list) {
        pass.draws.clear();
        addListedDraws(pass, c, input, input.copies);
    }
    addPasses(plan, c, std::move(*program), pass, shown);
    return {};
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
    setDefine(defines, "COMMANDS_OF_VIEW", std::to_string(commandsOfView(plan, c)));
    Defines skinning = defines;
    setDefine(skinning, "LISTS_TRIANGLES", "1");
    setDefine(skinning, "VIEWS", std::to_string(numbersShown(c)));
    SKINBENCH_TRY(addSkinPass(plan, c, input, caps, skinning));
    SKINBENCH_TRY(addInstanceBounds(plan, c, input, caps, defines));
    const size_t first = plan.passes.size();
    for (const Shown& shown : shownBy(c)) {
        SKINBENCH_TRY(addClusterList(plan, c, input, caps, defines, shown));
        SKINBENCH_TRY(addCullPasses(plan, c, input, caps, defines, shown));
        SKINBENCH_TRY(addSkinnedDraw(plan, c, input, shown));
    }
    orderByView(plan, c, first);
    return plan;
}

}  // namespace skinbench
