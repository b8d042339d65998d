#include "common/plans/plan_parts.h"

#include <algorithm>
#include <format>
#include <utility>

#include "common/scene/skin_cpu.h"

namespace skinbench {

Defines commonDefines(const Case& which, const PlanInput& input) {
    const bool prepass = which.scenario == Scenario::prepass;
    Defines defines = {
        {"CODEC_FILE", storesSlim(which) ? "\"codecs/uc_slim.glsl\"" : std::string("\"") + which.codec->shader + "\""},
        {"INFLUENCES", std::to_string(which.influences)},
        {"SKINNING", which.variant->skins ? "1" : "0"},
        {"VERTEX_COUNT", std::to_string(input.encoded->vertexCount)},
        {"JOINT_COUNT",
         std::to_string(usesPartition(which) ? which.paletteSlots : input.scene->skeleton.joints.size())},
        {"COPY_COUNT", std::to_string(input.copies)},
        {"LAST_COPY", std::to_string(input.copies - 1)},
        {"BATCHED", which.submission == Submission::batched ? "1" : "0"},
        {"FETCH_PULL", which.fetch == VertexFetch::pull ? "1" : "0"},
        {"PALETTE_UNIFORM", which.shape.uniformPalette || usesPartition(which) ? "1" : "0"},
        {"STAGED_JOINTS", "0"},
        {"EARLY_EXIT", which.compute.earlyExit ? "1" : "0"},
        {"HALF_RATE", which.compute.halfRate ? "1" : "0"},
        {"SKINNED_PACKED", which.compute.packed ? "1" : "0"},
        {"SKINNED_PREVIOUS", which.compute.previous ? "1" : "0"},
        {"SKINNED_TANGENT", which.compute.tangents ? "1" : "0"},
        {"SAME_DEPTH", prepass ? "1" : "0"},
        {"PREPASS", "0"},
        {"DEPTH_ONLY", "0"},
        {"REUSE_SKINNED", "0"},
        {"CAPTURE", input.capture ? "1" : "0"},
        {"VIEW", std::to_string(static_cast<int>(which.view))},
        {"SPARE_OUTPUT", "0"},
    };
    defines.insert(defines.end(), input.encoded->defines.begin(), input.encoded->defines.end());
    return defines;
}

void setDefine(Defines& defines, const std::string& name, const std::string& value) {
    auto known = std::ranges::find(defines, name, &Defines::value_type::first);
    if (known == defines.end())
        defines.emplace_back(name, value);
    else
        known->second = value;
}

Result<Program> makeProgram(const Case& which, const PlanInput& input, const char* label,
                            std::initializer_list<StageFile> stages, const Defines& defines) {
    const bool shuffles = std::ranges::count(defines, Defines::value_type{"EXCHANGE_SHUFFLE", "1"}) > 0;
    Program program;
    program.label = label;
    for (const StageFile& stage : stages) {
        Result<ShaderText> text = shaderText(
            *input.shaders, {stage.file, stage.stage, which.route->api, which.route->dialect, shuffles, defines});
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
    if (auto blocks = paletteBlocks(which, input)) {
        plan.paletteBytes = blocks->stride() * (blocks->joints.size() / blocks->size) * input.copies;
        plan.paletteRange = blocks->size * static_cast<uint32_t>(sizeof(PaletteEntry));
    } else {
        plan.paletteBytes = uint64_t{input.copies} * input.scene->skeleton.joints.size() * sizeof(PaletteEntry);
    }
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

Pass startDepth(const Case& which, PassKind kind) {
    Pass pass = startDraw(which, kind);
    pass.label = "depth";
    pass.writeColor = false;
    return pass;
}

void drawWhereEqual(Pass& pass) {
    pass.depth = DepthTest::equalKeep;
    pass.clear = false;
}

void addStream(FramePlan& plan, uint32_t slot, uint32_t use, const Bytes& bytes, uint32_t copies) {
    if (bytes && !bytes->empty())
        plan.streams.push_back({.slot = slot, .use = use, .bytes = bytes, .replicas = copies});
}

void addEncoded(FramePlan& plan, const PlanInput& input) {
    addStream(plan, SLOT_VERTEX, useStorage, input.encoded->vertices, input.copies);
    addStream(plan, SLOT_TUPLE, useStorage, input.encoded->tuples, input.copies);
}

SkinnedLayout skinnedLayout(const Case& which) {
    SkinnedLayout layout;
    layout.stride = which.compute.packed ? 16 : sizeof(SkinnedVertex);
    if (which.compute.previous) layout.previous = std::exchange(layout.stride, layout.stride + 16);
    if (which.compute.tangents) layout.tangent = std::exchange(layout.stride, layout.stride + 16);
    return layout;
}

void addSkinnedStream(FramePlan& plan, const PlanInput& input, uint32_t use, uint32_t stride) {
    plan.streams.push_back(
        {.slot = SLOT_SKINNED, .use = use, .gpuBytes = uint64_t{input.copies} * input.encoded->vertexCount * stride});
}

// The vertices that the triangles name, as the case stores them. Both passes of a pre-pass must start a triangle at the
// same corner, or their interpolated depths differ in the last bit; and a codec may have split what the meshlets name.
static std::vector<uint32_t> drawnIndices(const PlanInput& input) {
    if (!input.meshlets) return input.records ? input.records->mesh.indices : input.scene->mesh.indices;
    return triangleList(*input.meshlets);
}

void addIndexedDraws(FramePlan& plan, Pass& pass, const Case& which, const PlanInput& input) {
    const auto count = static_cast<uint32_t>(input.scene->mesh.indices.size());
    const bool batched = which.submission == Submission::batched;
    if (std::ranges::find(plan.streams, uint32_t{SLOT_INDEX}, &Stream::slot) == plan.streams.end()) {
        addStream(plan, SLOT_INDEX, useIndices, toBytes(drawnIndices(input)), input.copies);
        if (batched) plan.streams.back().replicaAdd = input.encoded->vertexCount;
    }
    if (batched) {
        pass.draws.push_back({.count = count * input.copies});
        return;
    }
    std::vector<PartitionCommand> commands{{.triangleCount = count / 3}};
    if (usesPartition(which)) commands = input.records->partition.commands;
    const auto blocks = paletteBlocks(which, input);
    for (uint32_t copy = 0; copy < input.copies; ++copy)
        for (size_t c = 0; c < commands.size(); ++c)
            pass.draws.push_back({.count = commands[c].triangleCount * 3,
                                  .firstIndex = copy * count + commands[c].firstTriangle * 3,
                                  .baseVertex = static_cast<int32_t>(copy * input.encoded->vertexCount),
                                  .constants = {copy, 0, 0, 0},
                                  .paletteOffset = blocks ? blocks->stride() * (copy * commands.size() + c) : 0});
}

void addGroupDraws(Pass& pass, const Case& which, const PlanInput& input, uint32_t groupsOfCopy, uint32_t groupsOfAll,
                   uint32_t most) {
    const bool batched = which.submission == Submission::batched;
    const auto blocks = paletteBlocks(which, input);
    for (uint32_t copy = 0; copy < (batched ? 1 : input.copies); ++copy) {
        const uint32_t groups = batched ? groupsOfAll : groupsOfCopy;
        for (uint32_t first = 0; first < groups; first += most)
            pass.draws.push_back({.count = std::min(most, groups - first),
                                  .constants = {copy, first, 0, 0},
                                  .paletteOffset = blocks ? blocks->stride() * copy : 0});
    }
}

// Of the bind pose.
static std::string diagonalText(const Mesh& mesh) {
    Bounds bounds{mesh.positions.front(), mesh.positions.front()};
    for (const glm::vec3& position : mesh.positions)
        bounds = {glm::min(bounds.min, position), glm::max(bounds.max, position)};
    return std::format("{:.9e}", bounds.diagonal());
}

Result<void> addSkinnedDraw(FramePlan& plan, const Case& which, const PlanInput& input, bool depthOnly) {
    Defines defines = commonDefines(which, input);
    setDefine(defines, "PALETTE_UNIFORM", "0");
    if (which.view == View::velocity) setDefine(defines, "SCENE_DIAGONAL", diagonalText(input.scene->mesh));
    Pass pass = depthOnly ? startDepth(which, PassKind::drawIndexed) : startDraw(which, PassKind::drawIndexed);
    Result<Program> program;
    if (depthOnly) {
        setDefine(defines, "DEPTH_ONLY", "1");
        setDefine(defines, "CAPTURE", "0");
        program = makeProgram(which, input, "depth", {{Stage::vertex, "compute.glsl"}}, defines);
    } else {
        program = makeProgram(which, input, "draw",
                              {{Stage::vertex, "compute.glsl"}, {Stage::fragment, "surface.glsl"}}, defines);
    }
    if (!program) return std::unexpected(program.error());
    const SkinnedLayout layout = skinnedLayout(which);
    if (which.compute.packed)
        program->attributes = {{0, AttributeFormat::uint4, 0}};
    else
        program->attributes = {{0, AttributeFormat::float4, 0}, {1, AttributeFormat::float4, 16}};
    if (which.compute.previous) program->attributes.push_back({2, AttributeFormat::float4, layout.previous});
    if (which.compute.tangents) program->attributes.push_back({3, AttributeFormat::float4, layout.tangent});
    program->attributeSlot = SLOT_SKINNED;
    program->attributeStride = layout.stride;
    plan.programs.push_back(std::move(*program));
    pass.program = static_cast<uint32_t>(plan.programs.size() - 1);
    if (which.scenario == Scenario::prepass && !depthOnly) drawWhereEqual(pass);
    addIndexedDraws(plan, pass, which, input);
    plan.passes.push_back(std::move(pass));
    return {};
}

}  // namespace skinbench
