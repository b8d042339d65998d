// Frames whose geometry comes from a mesh stage.
#include <algorithm>

#include "common/plans/plan_parts.h"

namespace skinbench {
namespace {

// Fewer bits than nearly every rasteriser has would keep more back faces than needed, never drop a visible one.
constexpr uint32_t kLeastSubpixelBits = 4;

// What the meshlets' own words need beside them: lists of joints, or what the codec adds.
struct Extra {
    Bytes bytes;
    std::vector<uint32_t> start;
    uint32_t words = 0;
    uint32_t stagedJoints = 0;
};

Result<Extra> makeExtra(const Case& which, const PlanInput& input) {
    Extra extra;
    extra.bytes = input.encoded->meshletExtra;
    if (which.shape.orderedRecords) extra.start = input.encoded->firstBytes;
    if (which.shape.joints == JointSource::vertex) return extra;
    const Mesh& mesh = input.records ? input.records->mesh : input.scene->mesh;
    auto joints = packMeshletJoints(mesh, *input.meshlets, which.influences);
    if (!joints) return std::unexpected(joints.error());
    extra.bytes = toBytes(joints->words);
    extra.start = std::move(joints->start);
    extra.words = static_cast<uint32_t>(joints->words.size());
    if (which.shape.joints == JointSource::staged) extra.stagedJoints = joints->most;
    return extra;
}

Defines meshDefines(const Case& which, const PlanInput& input, const DeviceCaps& caps, const PackedMeshlets& packed,
                    const Extra& extra) {
    Defines defines = commonDefines(which, input);
    auto set = [&](const char* name, uint64_t value) { setDefine(defines, name, std::to_string(value)); };
    const bool glExt = which.route->api == Api::opengl && which.route->dialect == MeshDialect::ext;
    const bool shuffles =
        which.exchange == Exchange::automatic ? canShuffle(which, caps) : which.exchange == Exchange::shuffle;
    set("SPARE_OUTPUT", glExt && caps.lastMeshOutputLost);
    set("PACKED_WRITES", which.packedWrites);
    set("MESHLET_COUNT", input.meshlets->meshlets.size());
    set("MESHLET_DATA_WORDS", packed.data.size());
    set("MESHLET_WORDS", packed.fixedWords);
    set("MESHLET_EXTRA_WORDS", extra.words);
    set("MESHLET_VERTICES", which.limits.vertices);
    // Packed index writes store four triangles at a time, so the declared limit covers whole groups of four.
    set("MESHLET_TRIANGLES", (which.limits.triangles + 3) / 4 * 4);
    set("GROUP_SIZE", which.groupSize);
    set("LAYOUT_FIXED", packed.fixedWords > 0);
    set("RECORDS_ORDERED", which.shape.orderedRecords);
    set("CLAMPED_LOADS", which.shape.clampedLoads);
    set("JOINTS", static_cast<uint32_t>(which.shape.joints));
    set("STAGED_JOINTS", extra.stagedJoints);
    set("COMMON_INFLUENCES", sharesJointLists(which));
    set("COMMON_MESHLETS", input.records ? input.records->commonMeshlets : 0);
    set("CULL", static_cast<uint32_t>(which.cull));
    set("EXCHANGE_SHUFFLE", which.cull == Cull::compact && shuffles);
    set("SUBPIXELS", 1u << std::max(caps.subpixelBits, kLeastSubpixelBits));
    set("IMAGE_WIDTH", input.width);
    set("IMAGE_HEIGHT", input.height);
    return defines;
}

enum class MeshPass { direct, depth, reuse };

Result<void> addMeshPass(FramePlan& plan, MeshPass kind, const Case& which, const PlanInput& input,
                         const DeviceCaps& caps, Defines defines) {
    Pass pass = kind == MeshPass::depth ? startDepth(which, PassKind::drawMesh) : startDraw(which, PassKind::drawMesh);
    Result<Program> program;
    if (kind == MeshPass::depth) {
        setDefine(defines, "PREPASS", "1");
        setDefine(defines, "DEPTH_ONLY", "1");
        program = makeProgram(which, input, "depth", {{Stage::mesh, "mesh.glsl"}}, defines);
    } else {
        setDefine(defines, "REUSE_SKINNED", kind == MeshPass::reuse ? "1" : "0");
        program =
            makeProgram(which, input, "draw", {{Stage::mesh, "mesh.glsl"}, {Stage::fragment, "surface.glsl"}}, defines);
    }
    if (!program) return std::unexpected(program.error());
    if (kind == MeshPass::reuse) drawWhereEqual(pass);
    plan.programs.push_back(std::move(*program));
    pass.program = static_cast<uint32_t>(plan.programs.size() - 1);
    const uint32_t most = std::max(1u, meshLimits(caps, which.route->dialect).maxGroupCount);
    const auto meshlets = static_cast<uint32_t>(input.meshlets->meshlets.size());
    addGroupDraws(pass, which, input, meshlets, meshlets * input.copies, std::min(most, 65535u));
    plan.passes.push_back(std::move(pass));
    return {};
}

}  // namespace

Result<FramePlan> planMesh(const Case& which, const PlanInput& input, const DeviceCaps& caps) {
    auto extra = makeExtra(which, input);
    if (!extra) return std::unexpected(extra.error());
    const PackedMeshlets packed =
        which.layout->pack(*input.meshlets, {.orderedRecords = which.shape.orderedRecords,
                                             .commonMeshlets = input.records ? input.records->commonMeshlets : 0,
                                             .extraStart = extra->start,
                                             .blendBytes = input.encoded->blendBytes});
    const Defines defines = meshDefines(which, input, caps, packed, *extra);
    const bool prepass = which.scenario == Scenario::prepass;
    FramePlan plan = startPlan(which, input);
    addEncoded(plan, input);
    addStream(plan, SLOT_MESHLET, useStorage, toBytes(packed.descriptors), input.copies);
    addStream(plan, SLOT_MESHLET_DATA, useStorage, toBytes(packed.data), input.copies);
    addStream(plan, SLOT_MESHLET_EXTRA, useStorage, extra->bytes, input.copies);
    auto add = [&](MeshPass kind) { return addMeshPass(plan, kind, which, input, caps, defines); };
    if (auto added = add(prepass ? MeshPass::depth : MeshPass::direct); !added) return std::unexpected(added.error());
    if (!prepass) return plan;
    addSkinnedStream(plan, input, useStorage | useAttributes);
    auto second = caps.meshDepthDiffers ? add(MeshPass::reuse) : addSkinnedDraw(plan, which, input);
    if (!second) return std::unexpected(second.error());
    return plan;
}

}  // namespace skinbench
