#include "common/plans.h"

#include <algorithm>

#include "common/skin_cpu.h"

namespace skinbench {
namespace {

Defines commonDefines(const Case& which, const PlanInput& input, bool spareOutput = false) {
    Defines defines = {
        {"CODEC_FILE", std::string("\"") + which.codec->shader + "\""},
        {"INFLUENCES", std::to_string(which.influences)},
        {"SKINNING", which.variant->skins ? "1" : "0"},
        {"VERTEX_COUNT", std::to_string(input.encoded->vertexCount)},
        {"JOINT_COUNT", std::to_string(input.scene->skeleton.joints.size())},
        {"COPY_COUNT", std::to_string(input.copies)},
        {"LAST_COPY", std::to_string(input.copies - 1)},
        {"BATCHED", which.submission == Submission::batched ? "1" : "0"},
        {"FETCH_PULL", which.fetch == VertexFetch::pull ? "1" : "0"},
        {"PACKED_WRITES", which.packedWrites ? "1" : "0"},
        {"CAPTURE", input.capture ? "1" : "0"},
        {"VIEW", std::to_string(static_cast<int>(which.view))},
        {"SPARE_OUTPUT", spareOutput ? "1" : "0"},
    };
    defines.insert(defines.end(), input.encoded->defines.begin(), input.encoded->defines.end());
    return defines;
}

struct StageFile {
    Stage stage;
    const char* file;
};

Result<Program> makeProgram(const Case& which, const PlanInput& input, const char* label,
                            std::initializer_list<StageFile> stages, const Defines& defines) {
    Program program;
    program.label = label;
    for (const StageFile& stage : stages) {
        Result<ShaderText> text =
            shaderText(*input.shaders, {stage.file, stage.stage, which.route->api, which.route->dialect, defines});
        if (!text) return std::unexpected(text.error());
        program.stages.push_back(std::move(*text));
    }
    return program;
}

FramePlan startPlan(const Case& which, const PlanInput& input) {
    FramePlan plan;
    plan.dialect = which.route->dialect;
    plan.width = input.width;
    plan.height = input.height;
    plan.paletteBytes = uint64_t{input.copies} * input.scene->skeleton.joints.size() * sizeof(PaletteEntry);
    if (input.capture)
        plan.streams.push_back(
            {.slot = SLOT_CAPTURE, .gpuBytes = 2 * uint64_t{input.encoded->vertexCount} * sizeof(SkinnedVertex)});
    return plan;
}

Pass startDraw(const Case& which, PassKind kind) {
    Pass pass;
    pass.label = "draw";
    pass.kind = kind;
    pass.raster = which.raster;
    pass.cullBackFaces = !which.keepBackFaces;
    return pass;
}

void addStream(FramePlan& plan, uint32_t slot, uint32_t use, const Bytes& bytes, uint32_t copies) {
    if (bytes && !bytes->empty())
        plan.streams.push_back({.slot = slot, .use = use, .bytes = bytes, .replicas = copies});
}

// An indexed draw a copy, or one for all: then the indices of copy c already count from c * vertexCount.
void addIndexedDraws(FramePlan& plan, Pass& pass, const Case& which, const PlanInput& input) {
    const auto count = static_cast<uint32_t>(input.scene->mesh.indices.size());
    addStream(plan, SLOT_INDEX, useIndices, toBytes(input.scene->mesh.indices), input.copies);
    if (which.submission == Submission::batched) {
        plan.streams.back().replicaAdd = input.encoded->vertexCount;
        pass.draws.push_back({.count = count * input.copies});
        return;
    }
    for (uint32_t copy = 0; copy < input.copies; ++copy)
        pass.draws.push_back({.count = count,
                              .firstIndex = copy * count,
                              .baseVertex = static_cast<int32_t>(copy * input.encoded->vertexCount),
                              .constants = {copy, 0, 0, 0}});
}

// Work groups for every copy, or for all at once; draws are split where the device allows fewer groups.
void addGroupDraws(Pass& pass, const Case& which, const PlanInput& input, uint32_t groupsOfCopy, uint32_t groupsOfAll,
                   uint32_t most) {
    const bool batched = which.submission == Submission::batched;
    for (uint32_t copy = 0; copy < (batched ? 1 : input.copies); ++copy) {
        const uint32_t groups = batched ? groupsOfAll : groupsOfCopy;
        for (uint32_t first = 0; first < groups; first += most)
            pass.draws.push_back({.count = std::min(most, groups - first), .constants = {copy, first, 0, 0}});
    }
}

Result<FramePlan> planMesh(const Case& which, const PlanInput& input, const DeviceCaps& caps) {
    const PackedMeshlets packed = which.layout->pack(*input.meshlets);
    const bool glExt = which.route->api == Api::opengl && which.route->dialect == MeshDialect::ext;
    Defines defines = commonDefines(which, input, glExt && caps.lastMeshOutputLost);
    const auto meshlets = static_cast<uint32_t>(input.meshlets->meshlets.size());
    // Packed index writes store four triangles at a time, so the declared limit covers whole groups of four.
    defines.insert(defines.end(), {{"MESHLET_COUNT", std::to_string(meshlets)},
                                   {"MESHLET_DATA_WORDS", std::to_string(packed.data.size())},
                                   {"MESHLET_VERTICES", std::to_string(which.limits.vertices)},
                                   {"MESHLET_TRIANGLES", std::to_string((which.limits.triangles + 3) / 4 * 4)},
                                   {"GROUP_SIZE", std::to_string(which.groupSize)}});
    auto program =
        makeProgram(which, input, "draw", {{Stage::mesh, "mesh.glsl"}, {Stage::fragment, "surface.glsl"}}, defines);
    if (!program) return std::unexpected(program.error());

    FramePlan plan = startPlan(which, input);
    plan.programs.push_back(std::move(*program));
    addStream(plan, SLOT_VERTEX, useStorage, input.encoded->vertices, input.copies);
    addStream(plan, SLOT_TUPLE, useStorage, input.encoded->tuples, input.copies);
    addStream(plan, SLOT_MESHLET, useStorage, toBytes(packed.descriptors), input.copies);
    addStream(plan, SLOT_MESHLET_DATA, useStorage, toBytes(packed.data), input.copies);
    addStream(plan, SLOT_MESHLET_EXTRA, useStorage, input.encoded->meshletExtra, input.copies);
    Pass pass = startDraw(which, PassKind::drawMesh);
    const uint32_t most = std::max(1u, meshLimits(caps, which.route->dialect).maxGroupCount);
    addGroupDraws(pass, which, input, meshlets, meshlets * input.copies, std::min(most, 65535u));
    plan.passes.push_back(std::move(pass));
    return plan;
}

// The draw that `compute` and `cpu` share: a plain vertex stage over SkinnedVertex attributes.
Result<void> addSkinnedDraw(FramePlan& plan, const Case& which, const PlanInput& input, const Defines& defines) {
    auto program = makeProgram(which, input, "draw",
                               {{Stage::vertex, "compute.glsl"}, {Stage::fragment, "surface.glsl"}}, defines);
    if (!program) return std::unexpected(program.error());
    program->attributes = {{0, AttributeFormat::float4, 0}, {1, AttributeFormat::float4, 16}};
    program->attributeSlot = SLOT_SKINNED;
    program->attributeStride = sizeof(SkinnedVertex);
    plan.programs.push_back(std::move(*program));
    Pass pass = startDraw(which, PassKind::drawIndexed);
    pass.program = static_cast<uint32_t>(plan.programs.size() - 1);
    addIndexedDraws(plan, pass, which, input);
    plan.passes.push_back(std::move(pass));
    return {};
}

}  // namespace

Result<FramePlan> planDirect(const Case& which, const PlanInput& input, const DeviceCaps& caps) {
    if (which.route->dialect != MeshDialect::none) return planMesh(which, input, caps);
    auto program =
        makeProgram(which, input, "draw", {{Stage::vertex, "vertex.glsl"}, {Stage::fragment, "surface.glsl"}},
                    commonDefines(which, input));
    if (!program) return std::unexpected(program.error());
    FramePlan plan = startPlan(which, input);
    if (which.fetch == VertexFetch::pull) {
        addStream(plan, SLOT_VERTEX, useStorage, input.encoded->vertices, input.copies);
        addStream(plan, SLOT_TUPLE, useStorage, input.encoded->tuples, input.copies);
    } else {
        program->attributes = input.encoded->attributes;
        program->attributeStride = input.encoded->attributeStride;
        addStream(plan, SLOT_VERTEX, useAttributes, input.encoded->vertices, input.copies);
    }
    plan.programs.push_back(std::move(*program));
    Pass pass = startDraw(which, PassKind::drawIndexed);
    addIndexedDraws(plan, pass, which, input);
    plan.passes.push_back(std::move(pass));
    return plan;
}

Result<FramePlan> planCompute(const Case& which, const PlanInput& input, const DeviceCaps& caps) {
    const Defines defines = commonDefines(which, input);
    auto program = makeProgram(which, input, "skin", {{Stage::compute, "compute.glsl"}}, defines);
    if (!program) return std::unexpected(program.error());
    FramePlan plan = startPlan(which, input);
    plan.programs.push_back(std::move(*program));
    addStream(plan, SLOT_VERTEX, useStorage, input.encoded->vertices, input.copies);
    addStream(plan, SLOT_TUPLE, useStorage, input.encoded->tuples, input.copies);
    plan.streams.push_back({.slot = SLOT_SKINNED,
                            .use = useStorage | useAttributes,
                            .gpuBytes = uint64_t{input.copies} * input.encoded->vertexCount * sizeof(SkinnedVertex)});
    Pass skin;
    skin.label = "skin";
    skin.kind = PassKind::dispatch;
    const uint64_t vertices = input.encoded->vertexCount;
    addGroupDraws(skin, which, input, static_cast<uint32_t>((vertices + 63) / 64),
                  static_cast<uint32_t>((vertices * input.copies + 63) / 64),
                  std::max(1u, std::min(caps.maxComputeGroupCount, 65535u)));
    plan.passes.push_back(std::move(skin));
    if (auto added = addSkinnedDraw(plan, which, input, defines); !added) return std::unexpected(added.error());
    return plan;
}

Result<FramePlan> planCpu(const Case& which, const PlanInput& input, const DeviceCaps&) {
    FramePlan plan = startPlan(which, input);
    // The CPU reads vertices and palette from its own memory; the device holds only what it draws.
    plan.paletteBytes = 0;
    if (which.route->api == Api::cpu) return plan;
    plan.streams.push_back({.slot = SLOT_SKINNED,
                            .use = useAttributes,
                            .gpuBytes = uint64_t{input.copies} * input.encoded->vertexCount * sizeof(SkinnedVertex),
                            .hostWritten = true});
    if (auto added = addSkinnedDraw(plan, which, input, commonDefines(which, input)); !added)
        return std::unexpected(added.error());
    return plan;
}

}  // namespace skinbench
