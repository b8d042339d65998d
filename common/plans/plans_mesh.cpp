// Frames whose geometry comes from a mesh stage.
#include <algorithm>
#include <format>

#include "common/plans/plan_parts.h"

namespace skinbench {
namespace {

// What the meshlets' own words need beside them: lists of joints, or what the codec adds.
struct Extra {
    Bytes bytes;
    std::vector<uint32_t> start;
    uint32_t words = 0;
    uint32_t stagedJoints = 0;
};

Result<Extra> makeExtra(const Case& c, const PlanInput& input) {
    Extra extra;
    extra.bytes = input.encoded->meshletExtra;
    if (c.shape.orderedRecords) extra.start = input.encoded->firstBytes;
    if (c.shape.joints == JointSource::vertex) return extra;
    const Mesh& mesh = input.records ? input.records->mesh : input.scene->mesh;
    auto joints = packMeshletJoints(mesh, *input.meshlets, c.influences);
    SKINBENCH_TRY(joints);
    extra.bytes = toBytes(joints->words);
    extra.start = std::move(joints->start);
    extra.words = static_cast<uint32_t>(joints->words.size());
    if (c.shape.joints == JointSource::staged) extra.stagedJoints = joints->most;
    return extra;
}

// Per meshlet, the last influence of its vertices that weighs anything, counted from 1.
std::vector<uint8_t> influencesOf(const PlanInput& input) {
    const Mesh decoded = decodedMesh(input);
    std::vector<uint8_t> counts;
    for (const Meshlet& meshlet : input.meshlets->meshlets) {
        int most = 1;
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
            const Influences& own = decoded.influences[input.meshlets->vertices[meshlet.firstVertex + i]];
            for (int k = most; k < kMaxInfluences; ++k)
                if (own.weights[k] > 0) most = k + 1;
        }
        counts.push_back(static_cast<uint8_t>(most));
    }
    return counts;
}

Defines meshDefines(const Case& c, const PlanInput& input, const DeviceCaps& caps, const PackedMeshlets& packed,
                    const Extra& extra) {
    Defines defines = caseDefines(c, input);
    auto set = [&](const char* name, uint64_t value) { setDefine(defines, name, std::to_string(value)); };
    const Exchange exchange = exchangeOf(c, caps);
    set("SPARE_OUTPUT", caps.lastMeshOutputLost);
    set("MESHLET_COUNT", input.meshlets->meshlets.size());
    set("MESHLET_DATA_WORDS", packed.data.size());
    set("MESHLET_WORDS", packed.fixedWords);
    set("MESHLET_EXTRA_WORDS", extra.words);
    set("MESHLET_VERTICES", c.limits.vertices);
    set("MESHLET_TRIANGLES", declaredTriangles(c));
    set("LAYOUT_FIXED", packed.fixedWords > 0);
    set("STAGED_JOINTS", extra.stagedJoints);
    set("COMMON_INFLUENCES", sharesJointLists(c));
    set("COMMON_MESHLETS", input.records ? input.records->commonMeshlets : 0);
    set("EXCHANGE_SHUFFLE", c.cull != Cull::off && exchange == Exchange::shuffle);
    set("EXCHANGE_OUTPUTS", c.cull != Cull::off && exchange == Exchange::outputs);
    set("WRITES_FIRST", c.cull == Cull::compact && writesFirst(c));
    set("SUBPIXELS", rasterSubpixels(caps));
    set("IMAGE_WIDTH", input.width);
    set("IMAGE_HEIGHT", input.height);
    return defines;
}

// skins where it draws; keeps what it has skinned there for reuse; reads what a pass before has skinned.
enum class MeshPass { skins, keeps, reads };

Result<void> addMeshPass(FramePlan& plan, MeshPass kind, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                         Defines defines, const Shown& shown) {
    setDefine(defines, "PREPASS", kind == MeshPass::keeps ? "1" : "0");
    setDefine(defines, "REUSE_SKINNED", kind == MeshPass::reads ? "1" : "0");
    // The first pass of a pre-pass has stored them.
    if (kind == MeshPass::reads && c.scenario == Scenario::prepass) setDefine(defines, "STORES_VERDICTS", "0");
    auto program = makeDrawing(c, input, shown, {Stage::mesh, "mesh.glsl"}, std::move(defines));
    SKINBENCH_TRY(program);
    Pass pass = startPass(c, PassKind::drawMesh, shown);
    const uint32_t most = std::max(1u, meshLimits(caps, c.route->dialect).maxGroupCount);
    const auto meshlets = static_cast<uint32_t>(input.meshlets->meshlets.size());
    const uint32_t each = c.clusterCull == ClusterCull::task ? TASK_GROUP : 1;
    if (c.clusterCull == ClusterCull::list && meshlets > most)
        return deviceError(
            std::format("lists {} meshlets: {} starts {} work groups at once", meshlets, caps.name, most));
    if (c.clusterCull == ClusterCull::list)
        addListedDraws(pass, c, input, 0);
    else
        addGroupDraws(pass, c, input, (meshlets + each - 1) / each, (meshlets * input.copies + each - 1) / each,
                      std::min(most, 65535u));
    addPasses(plan, c, std::move(*program), pass, shown);
    return {};
}

}  // namespace

uint32_t declaredTriangles(const Case& c) { return (c.limits.triangles + 3) / 4 * 4; }

// Streams of the meshlets, and the defines of the stages that read them.
static Result<Defines> addMeshlets(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    auto extra = makeExtra(c, input);
    SKINBENCH_TRY(extra);
    const bool counts = c.zeroWeights == ZeroWeights::count;
    const PackedMeshlets packed =
        c.layout->pack(*input.meshlets, {.orderedRecords = c.shape.orderedRecords,
                                         .commonMeshlets = input.records ? input.records->commonMeshlets : 0,
                                         .extraStart = extra->start,
                                         .blendBytes = input.encoded->blendBytes,
                                         .influences = counts ? influencesOf(input) : std::vector<uint8_t>()});
    addStream(plan, SLOT_MESHLET, useStorage, toBytes(packed.descriptors), input.copies);
    addStream(plan, SLOT_MESHLET_DATA, useStorage, toBytes(packed.data), input.copies);
    addStream(plan, SLOT_MESHLET_EXTRA, useStorage, extra->bytes, input.copies);
    return meshDefines(c, input, caps, packed, *extra);
}

Result<FramePlan> planMesh(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    const bool prepass = c.scenario == Scenario::prepass;
    FramePlan plan = startPlan(c, input);
    addEncoded(plan, input);
    auto defines = addMeshlets(plan, c, input, caps);
    SKINBENCH_TRY(defines);
    addClusters(plan, c, input, caps, *defines);
    SKINBENCH_TRY(addInstanceBounds(plan, c, input, caps, *defines));
    if (prepass) addSkinnedStream(plan, input, useStorage | useAttributes);
    const size_t first = plan.passes.size();
    bool kept = false;
    for (const Shown& shown : shownBy(c, prepass)) {
        SKINBENCH_TRY(addClusterList(plan, c, input, caps, *defines, shown));
        const MeshPass kind = kept ? MeshPass::reads : prepass ? MeshPass::keeps : MeshPass::skins;
        if (kept && !caps.meshDepthDiffers)
            SKINBENCH_TRY(addSkinnedDraw(plan, c, input, shown));
        else
            SKINBENCH_TRY(addMeshPass(plan, kind, c, input, caps, *defines, shown));
        kept = prepass;
    }
    orderByView(plan, c, first);
    return plan;
}

Result<FramePlan> planComputeMesh(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    FramePlan plan = startPlan(c, input);
    addEncoded(plan, input);
    auto defines = addMeshlets(plan, c, input, caps);
    SKINBENCH_TRY(defines);
    addClusters(plan, c, input, caps, *defines);
    addSkinnedStream(plan, input, useStorage);
    SKINBENCH_TRY(addSkinPass(plan, c, input, caps));
    SKINBENCH_TRY(addInstanceBounds(plan, c, input, caps, *defines));
    const size_t first = plan.passes.size();
    for (const Shown& shown : shownBy(c)) {
        SKINBENCH_TRY(addClusterList(plan, c, input, caps, *defines, shown));
        SKINBENCH_TRY(addMeshPass(plan, MeshPass::reads, c, input, caps, *defines, shown));
    }
    orderByView(plan, c, first);
    return plan;
}

}  // namespace skinbench
