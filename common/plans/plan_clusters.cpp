// Culling of whole meshlets, in front of the stages that draw them.
#include <algorithm>
#include <format>

#include "common/plans/plan_parts.h"

namespace skinbench {
namespace {

// A work group a copy; where a draw sees one copy's palette alone, a draw a copy.
Pass copyPass(const char* label, const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    Pass pass;
    pass.label = label;
    pass.kind = PassKind::dispatch;
    const auto blocks = paletteBlocks(c, input);
    const uint32_t most = blocks ? 1 : std::max(1u, std::min(caps.maxComputeGroupCount, 65535u));
    for (uint32_t copy = 0; copy < input.copies; copy += most)
        pass.draws.push_back({.count = std::min(most, input.copies - copy),
                              .constants = {copy, 0, 0, 0},
                              .paletteOffset = blocks ? blocks->stride() * copy : 0});
    return pass;
}

Result<void> addCopyPass(FramePlan& plan, const char* label, const char* file, const Case& c, const PlanInput& input,
                         const DeviceCaps& caps, Defines defines, const Shown& shown) {
    setDefine(defines, "SPARE_OUTPUT", "0");  // of mesh stages alone
    auto program = makeProgram(c, input, label, {{Stage::compute, file}}, defines);
    SKINBENCH_TRY(program);
    addPasses(plan, c, std::move(*program), copyPass(label, c, input, caps), shown);
    return {};
}

void addVerdicts(FramePlan& plan, const Case& c, const PlanInput& input, Defines& defines) {
    const uint64_t meshlets = input.meshlets ? uint64_t{input.meshlets->meshlets.size()} * input.copies : 0;
    const uint64_t counted = c.clusterCull != ClusterCull::off ? meshlets : 0, fours = counted + COUNTED_WORDS;
    setDefine(defines, "FIRST_COUNTED", std::to_string(counted));
    setDefine(defines, "FIRST_FOURS", std::to_string(fours));
    if (!storesVerdicts(c, input)) return;
    setDefine(defines, "STORES_VERDICTS", "1");
    const uint64_t words = fours + meshlets * storedTriangles(c) / 4;
    plan.streams.push_back({.slot = SLOT_VERDICT, .gpuBytes = words * sizeof(uint32_t)});
}

}  // namespace

bool storesVerdicts(const Case& c, const PlanInput& input) {
    const bool culled = c.view == View::culled, tests = c.clusterCull != ClusterCull::off;
    return (input.capture || culled) && (tests || c.variant->listsTriangles || storedTriangles(c) > 0);
}

uint32_t storedTriangles(const Case& c) {
    // With more views the pass that skins, and culls, is not one of the main view.
    const bool elsewhere = c.scenario == Scenario::prepass && c.views > 1;
    return c.cull != Cull::off && !elsewhere ? declaredTriangles(c) : 0;
}

void addClusters(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps, Defines& defines) {
    addVerdicts(plan, c, input, defines);
    if (c.clusterCull == ClusterCull::off) return;
    const ClusterSet set = boundClusters(decodedMesh(input), *input.meshlets, c.clusterBounds);
    const PackedClusters packed = packClusters(set, *input.meshlets, c.clusterBounds);
    addStream(plan, SLOT_CLUSTER, useStorage, toBytes(packed.clusters), input.copies);
    addStream(plan, SLOT_CLUSTER_PART, useStorage, toBytes(packed.parts), input.copies);
    if (c.clusterBounds == ClusterBounds::instance)
        plan.streams.push_back({.slot = SLOT_INSTANCE, .gpuBytes = uint64_t{input.copies} * 2 * sizeof(glm::vec4)});
    if (c.clusterCull == ClusterCull::list)
        plan.streams.push_back(
            {.slot = SLOT_CLUSTER_LIST, .gpuBytes = input.meshlets->meshlets.size() * sizeof(uint32_t) * input.copies});
    if (c.clusterCull == ClusterCull::list && !c.variant->listsTriangles)
        plan.streams.push_back({.slot = SLOT_COMMAND,
                                .use = useStorage | useIndirect,
                                .bytes = toBytes(std::vector<DrawCommand>(input.copies * numbersShown(c),
                                                                          groupCommand(0, c.route->dialect)))});
    const bool ballots = c.clusterCull == ClusterCull::task && caps.meshSubgroups && caps.subgroupSize == TASK_GROUP;
    const std::pair<const char*, std::string> more[] = {
        {"MESHLET_COUNT", std::to_string(input.meshlets->meshlets.size())},
        {"CLUSTER_PARTS", std::to_string(set.parts.size())},
        {"CLUSTER_SCALE", std::format("{:.9e}", packed.scale)},
        {"WEIGHT_ERROR", std::format("{:.9e}", set.weightError)},
        {"COMMANDS_OF_VIEW", std::to_string(commandsOfView(plan, c))},
        {"FIRST_GROUP_COMMAND", c.variant->listsTriangles ? std::to_string(input.copies) : "0"},
        {"TASK_BALLOT", ballots ? "1" : "0"},
        {"SUBPIXELS", std::to_string(rasterSubpixels(caps))},
        {"IMAGE_WIDTH", std::to_string(input.width)},
        {"IMAGE_HEIGHT", std::to_string(input.height)}};
    for (const auto& [name, value] : more) setDefine(defines, name, value);
}

Result<void> addInstanceBounds(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                               const Defines& defines) {
    const bool tests = c.clusterCull != ClusterCull::off && (c.clusterTests & CLUSTER_TEST_FRUSTUM) != 0;
    if (!tests || c.clusterBounds != ClusterBounds::instance) return {};
    return addCopyPass(plan, "bounds", "bound_instances.glsl", c, input, caps, defines, {});
}

Result<void> addClusterList(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                            Defines defines, const Shown& shown) {
    if (c.clusterCull != ClusterCull::list) return {};
    setView(defines, shown);
    return addCopyPass(plan, "cluster", "list_clusters.glsl", c, input, caps, defines, shown);
}

}  // namespace skinbench
