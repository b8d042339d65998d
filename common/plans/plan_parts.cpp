#include "common/plans/plan_parts.h"

#include <algorithm>
#include <format>
#include <utility>

#include "common/scene/skin_cpu.h"

namespace skinbench {

std::vector<uint32_t> sourcesOf(const PlanInput& input) {
    std::vector<uint32_t> sources = input.encoded->sources;
    if (sources.empty())
        for (uint32_t v = 0; v < input.encoded->vertexCount; ++v) sources.push_back(v);
    if (input.records)
        for (uint32_t& source : sources) source = input.records->sources[source];
    return sources;
}

Mesh decodedMesh(const PlanInput& input) {
    return decodeOnCpu(input.records ? input.records->mesh : input.scene->mesh, *input.encoded);
}

Defines caseDefines(const Case& c, const PlanInput& input) {
    const bool prepass = c.scenario == Scenario::prepass;
    Defines defines = {
        {"CODEC_FILE", std::string("\"") + storedCodec(c).shader + "\""},
        {"SKINNING", c.variant->skins ? "1" : "0"},
        {"VERTEX_COUNT", std::to_string(input.encoded->vertexCount)},
        {"JOINT_COUNT", std::to_string(usesPartition(c) ? c.paletteSlots : input.scene->skeleton.joints.size())},
        {"COPY_COUNT", std::to_string(input.copies)},
        {"LAST_COPY", std::to_string(input.copies - 1)},
        {"PALETTE_UNIFORM", c.shape.uniformPalette || usesPartition(c) ? "1" : "0"},
        {"PALETTE_ROWS", std::to_string(input.palette.rowsOfJoint())},
        {"STAGED_JOINTS", "0"},
        {"COMMON_INFLUENCES", "0"},
        {"EARLY_EXIT", c.compute.earlyExit ? "1" : "0"},
        {"HALF_RATE", c.compute.halfRate ? "1" : "0"},
        {"SKINNED_PACKED", packsVertices(c.compute) ? "1" : "0"},
        {"SKINNED_PREVIOUS", c.compute.previous ? "1" : "0"},
        {"SKINNED_TANGENT", skinsTangents(c.compute) ? "1" : "0"},
        {"SHORT_TANGENT", packsTangents(c.compute) ? "1" : "0"},
        {"UNIT_VECTORS", c.compute.wicked ? "\"byte_vectors.glsl\"" : "\"octahedral.glsl\""},
        {"LISTS_TRIANGLES", "0"},
        {"OTHER_VIEW", "0"},
        {"SAME_DEPTH", prepass ? "1" : "0"},
        {"PREPASS", "0"},
        {"DEPTH_ONLY", "0"},
        {"REUSE_SKINNED", "0"},
        {"CAPTURE", input.capture ? "1" : "0"},
        {"STORES_VERDICTS", "0"},
        {"SPARE_OUTPUT", "0"},
    };
    defines.insert(defines.end(), input.defines.begin(), input.defines.end());
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

Result<Program> makeProgram(const Case& c, const PlanInput& input, const char* label,
                            const std::vector<StageFile>& stages, const Defines& defines) {
    const bool shuffles = std::ranges::any_of(defines, [](const auto& define) {
        return (define.first == "EXCHANGE_SHUFFLE" || define.first == "EXCHANGE_OUTPUTS" ||
                define.first == "TASK_BALLOT") &&
               define.second == "1";
    });
    Program program;
    program.label = label;
    for (const StageFile& stage : stages) {
        Result<ShaderText> text =
            shaderText(*input.shaders, {stage.file, stage.stage, c.route->api, c.route->dialect, shuffles, defines});
        SKINBENCH_TRY(text);
        program.stages.push_back(std::move(*text));
    }
    return program;
}

FramePlan startPlan(const Case& c, const PlanInput& input) {
    FramePlan plan;
    plan.dialect = c.route->dialect;
    plan.width = input.width;
    plan.height = input.height;
    if (auto blocks = paletteBlocks(c, input)) {
        plan.paletteBytes = blocks->stride() * (blocks->joints.size() / blocks->size) * input.copies;
        plan.paletteRange = blocks->bytes();
    } else {
        plan.paletteBytes = uint64_t{input.copies} * input.scene->skeleton.joints.size() * input.palette.bytesOfJoint();
    }
    if (input.capture)
        plan.streams.push_back(
            {.slot = SLOT_CAPTURE, .gpuBytes = 2 * uint64_t{input.encoded->vertexCount} * sizeof(SkinnedVertex)});
    return plan;
}

std::vector<Shown> shownBy(const Case& c, bool firstAlone) {
    std::vector<Shown> all;
    if (c.view == View::culled) {
        for (uint32_t verdict : verdictsOf(c)) {
            if (!all.empty() && all.back().firstView + all.back().views == verdict)
                ++all.back().views;
            else
                all.push_back({true, verdict, 1});
        }
        return all;
    }
    const uint32_t alone = firstAlone && c.views > 1 ? 1 : 0;
    if (alone) all.push_back({false, 1, alone});
    if (c.views > 1 + alone) all.push_back({false, 1 + alone, c.views - 1 - alone});
    if (c.scenario == Scenario::prepass) all.push_back({});
    all.push_back({.image = true});
    return all;
}

uint32_t numbersShown(const Case& c) { return c.view == View::culled ? VERDICT_COUNT : c.views; }

static const char* labelOf(const Shown& shown) {
    return shown.image ? "draw" : shown.firstView == 0 ? "depth" : "views";
}

Pass startPass(const Case& c, PassKind kind, const Shown& shown) {
    Pass pass;
    pass.label = labelOf(shown);
    pass.kind = kind;
    pass.raster = c.raster;
    pass.cullBackFaces = !c.keepBackFaces && c.view != View::culled;
    pass.writeColor = shown.image;
    if (shown.image && c.scenario == Scenario::prepass) {
        pass.depth = DepthTest::equalKeep;
        pass.clear = false;
    }
    return pass;
}

void setView(Defines& defines, const Shown& shown) {
    setDefine(defines, "OTHER_VIEW", !shown.image && shown.firstView > 0 ? "1" : "0");
    if (!shown.image) setDefine(defines, "CAPTURE", "0");
    if (!shown.image && shown.firstView > 0) setDefine(defines, "STORES_VERDICTS", "0");
}

Result<Program> makeDrawing(const Case& c, const PlanInput& input, const Shown& shown, StageFile geometry,
                            Defines defines) {
    setView(defines, shown);
    if (!shown.image) setDefine(defines, "DEPTH_ONLY", "1");
    std::vector<StageFile> stages;
    if (geometry.stage == Stage::mesh && c.clusterCull == ClusterCull::task)
        stages.push_back({Stage::task, "task.glsl"});
    stages.push_back(geometry);
    if (shown.image) stages.push_back({Stage::fragment, "surface.glsl"});
    return makeProgram(c, input, labelOf(shown), stages, defines);
}

uint32_t commandsOfView(const FramePlan& plan, const Case& c) {
    const auto commands =
        std::ranges::find_if(plan.streams, [](const Stream& stream) { return (stream.use & useIndirect) != 0; });
    return commands == plan.streams.end()
               ? 0
               : static_cast<uint32_t>(streamBytes(*commands) / sizeof(DrawCommand)) / numbersShown(c);
}

void addPasses(FramePlan& plan, const Case& c, Program program, const Pass& pass, const Shown& shown) {
    plan.programs.push_back(std::move(program));
    for (uint32_t view = shown.firstView; view < shown.firstView + shown.views; ++view) {
        Pass& own = plan.passes.emplace_back(pass);
        own.program = static_cast<uint32_t>(plan.programs.size() - 1);
        if (c.view == View::culled && view != VERDICT_DRAWN) own.clear = false;
        for (Draw& draw : own.draws) {
            draw.constants[3] = view;
            if (draw.command) *draw.command += view * commandsOfView(plan, c);
        }
    }
}

void orderByView(FramePlan& plan, const Case& c, size_t firstPass) {
    const auto place = [&](const Pass& pass) {
        const uint32_t view = pass.draws.front().constants[3];
        return view == 0 && c.view != View::culled ? MOST_VIEWS : view;
    };
    std::ranges::stable_sort(plan.passes.begin() + static_cast<std::ptrdiff_t>(firstPass), plan.passes.end(), {},
                             place);
}

void addStream(FramePlan& plan, uint32_t slot, uint32_t use, const Bytes& bytes, uint32_t copies) {
    if (bytes && !bytes->empty())
        plan.streams.push_back({.slot = slot, .use = use, .bytes = bytes, .replicas = copies});
}

void addEncoded(FramePlan& plan, const PlanInput& input) {
    addStream(plan, SLOT_VERTEX, useStorage, input.encoded->vertices, input.copies);
    addStream(plan, SLOT_TUPLE, useStorage, input.encoded->tuples, input.copies);
}

SkinnedLayout skinnedLayout(const Case& c) {
    SkinnedLayout layout;
    layout.stride = packsVertices(c.compute) ? 16 : sizeof(SkinnedVertex);
    if (c.compute.previous) layout.previous = std::exchange(layout.stride, layout.stride + 16);
    if (c.compute.tangents) layout.tangent = std::exchange(layout.stride, layout.stride + 16);
    return layout;
}

void addSkinnedStream(FramePlan& plan, const PlanInput& input, uint32_t use, uint32_t stride) {
    plan.streams.push_back(
        {.slot = SLOT_SKINNED, .use = use, .gpuBytes = uint64_t{input.copies} * input.encoded->vertexCount * stride});
}

// Both passes of a pre-pass must start a triangle at the same corner, or their interpolated depths differ in the last
// bit; and a codec may have split what the meshlets name.
std::vector<uint32_t> drawnIndices(const PlanInput& input) {
    if (!input.meshlets) return input.records ? input.records->mesh.indices : input.scene->mesh.indices;
    return triangleList(*input.meshlets);
}

void addIndexedDraws(FramePlan& plan, Pass& pass, const Case& c, const PlanInput& input) {
    const auto count = static_cast<uint32_t>(input.scene->mesh.indices.size());
    const bool batched = c.submission == Submission::batched;
    if (std::ranges::find(plan.streams, uint32_t{SLOT_INDEX}, &Stream::slot) == plan.streams.end()) {
        addStream(plan, SLOT_INDEX, useIndices, toBytes(drawnIndices(input)), input.copies);
        if (batched) plan.streams.back().replicaAdd = input.encoded->vertexCount;
    }
    if (batched) {
        pass.draws.push_back({.count = count * input.copies});
        return;
    }
    std::vector<PartitionCommand> commands{{.triangleCount = count / 3}};
    if (usesPartition(c)) commands = input.records->partition.commands;
    const auto blocks = paletteBlocks(c, input);
    for (uint32_t copy = 0; copy < input.copies; ++copy)
        for (size_t c = 0; c < commands.size(); ++c)
            pass.draws.push_back({.count = commands[c].triangleCount * 3,
                                  .firstIndex = copy * count + commands[c].firstTriangle * 3,
                                  .baseVertex = static_cast<int32_t>(copy * input.encoded->vertexCount),
                                  .constants = {copy, 0, 0, 0},
                                  .paletteOffset = blocks ? blocks->stride() * (copy * commands.size() + c) : 0});
}

void addListedDraws(Pass& pass, const Case& c, const PlanInput& input, uint32_t firstCommand) {
    const auto blocks = paletteBlocks(c, input);
    for (uint32_t copy = 0; copy < (c.submission == Submission::batched ? 1 : input.copies); ++copy)
        pass.draws.push_back({.constants = {copy, 0, 0, 0},
                              .paletteOffset = blocks ? blocks->stride() * copy : 0,
                              .command = firstCommand + copy});
}

// Fewer bits than nearly every rasteriser has would keep more triangles than needed, never drop a visible one.
uint32_t rasterSubpixels(const DeviceCaps& caps) {
    constexpr uint32_t kLeastBits = 4;
    return 1u << std::max(caps.subpixelBits, kLeastBits);
}

void addGroupDraws(Pass& pass, const Case& c, const PlanInput& input, uint32_t groupsOfCopy, uint32_t groupsOfAll,
                   uint32_t most) {
    const bool batched = c.submission == Submission::batched;
    const auto blocks = paletteBlocks(c, input);
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

Result<void> addSkinnedDraw(FramePlan& plan, const Case& c, const PlanInput& input, const Shown& shown) {
    Defines defines = caseDefines(c, input);
    setDefine(defines, "PALETTE_UNIFORM", "0");
    if (c.variant->listsTriangles) setDefine(defines, "CAPTURE", "0");  // the pass that skins captures
    if (c.view == View::velocity) setDefine(defines, "SCENE_DIAGONAL", diagonalText(input.scene->mesh));
    Pass pass = startPass(c, PassKind::drawIndexed, shown);
    Result<Program> program = makeDrawing(c, input, shown, {Stage::vertex, "compute.glsl"}, std::move(defines));
    SKINBENCH_TRY(program);
    const SkinnedLayout layout = skinnedLayout(c);
    if (packsVertices(c.compute))
        program->attributes = {{0, AttributeFormat::uint4, 0}};
    else
        program->attributes = {{0, AttributeFormat::float4, 0}, {1, AttributeFormat::float4, 16}};
    if (c.compute.previous) program->attributes.push_back({2, AttributeFormat::float4, layout.previous});
    if (c.compute.tangents) program->attributes.push_back({3, AttributeFormat::float4, layout.tangent});
    program->attributeSlot = SLOT_SKINNED;
    program->attributeStride = layout.stride;
    if (c.variant->listsTriangles)
        addListedDraws(pass, c, input, 0);
    else
        addIndexedDraws(plan, pass, c, input);
    addPasses(plan, c, std::move(*program), pass, shown);
    return {};
}

}  // namespace skinbench
