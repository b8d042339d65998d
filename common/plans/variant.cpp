#include "common/plans/variant.h"

#include <algorithm>
#include <format>

#include "common/plans/plans.h"
#include "common/scene/pose.h"

namespace skinbench {

const std::vector<Route>& routes() {
    static const std::vector<Route> rows = {
        {"vk", Api::vulkan, MeshDialect::none, "Vulkan, vertex and compute stages"},
        {"vk-ext", Api::vulkan, MeshDialect::ext, "Vulkan, VK_EXT_mesh_shader"},
        {"vk-nv", Api::vulkan, MeshDialect::nv, "Vulkan, VK_NV_mesh_shader"},
        {"gl", Api::opengl, MeshDialect::none, "OpenGL, vertex and compute stages"},
        {"gl-ext", Api::opengl, MeshDialect::ext, "OpenGL, GL_EXT_mesh_shader"},
        {"gl-nv", Api::opengl, MeshDialect::nv, "OpenGL, GL_NV_mesh_shader"},
        {"cpu", Api::cpu, MeshDialect::none, "no graphics API: skinning on all cores"},
    };
    return rows;
}

const std::vector<Variant>& variants() {
    static const std::vector<Variant> rows = {
        {"none", "no skinning: the baseline", true, true, false, false, true, false, planDirect},
        {"vertex", "linear blend skinning in the vertex stage", true, false, false, true, true, true, planDirect},
        {"compute", "a compute pass skins into a buffer, a plain vertex stage draws it", true, false, false, true,
         false, true, planCompute},
        {"mesh", "a mesh-shader work group skins and draws a meshlet", false, true, false, true, false, true,
         planDirect},
        {"mesh-ci", "as mesh, joint ids once per meshlet where its vertices share them", false, true, false, true,
         false, true, planDirect},
        {"palette", "as vertex, in draws whose joints fit the slots of a small uniform palette", true, false, false,
         true, true, false, planDirect},
        {"cpu", "the CPU skins on all cores, uploads, draws", true, false, true, true, false, false, planCpu},
    };
    return rows;
}

template <class Row>
static const Row* findRow(const std::vector<Row>& rows, const std::string& name) {
    auto row = std::ranges::find_if(rows, [&](const Row& candidate) { return name == candidate.name; });
    return row == rows.end() ? nullptr : &*row;
}

const Route* findRoute(const std::string& name) { return findRow(routes(), name); }
const Variant* findVariant(const std::string& name) { return findRow(variants(), name); }

bool runsOn(const Variant& variant, const Route& route) {
    if (route.api == Api::cpu) return variant.onCpuRoute;
    return route.dialect == MeshDialect::none ? variant.onPlainRoutes : variant.onMeshRoutes;
}

// --- words --------------------------------------------------------------------------------------------------------

template <class Value>
static const char* wordOf(Value value, std::initializer_list<const char*> words) {
    const auto place = static_cast<size_t>(value);
    SKINBENCH_ASSERT(place < words.size());
    return words.begin()[place];
}

const char* rasterName(RasterMode raster) { return wordOf(raster, {"full", "no-fragments", "discard"}); }
const char* viewName(View view) {
    return wordOf(view, {"shaded", "meshlets", "weights", "tuples", "velocity", "resolution"});
}
const char* cullName(Cull cull) { return wordOf(cull, {"off", "compact", "primitive", "torabi"}); }
const char* exchangeName(Exchange exchange) { return wordOf(exchange, {"auto", "shuffle", "shared"}); }
const char* scenarioName(Scenario scenario) { return wordOf(scenario, {"direct", "prepass"}); }
const char* jointSourceName(JointSource joints) { return wordOf(joints, {"vertex", "meshlet", "staged"}); }
const char* ciGroupingName(CiGrouping grouping) { return wordOf(grouping, {"meshlets", "triangles"}); }
const char* ciKeyName(CiKey key) { return wordOf(key, {"ordered", "set", "fit"}); }

const std::vector<ComputeWord>& computeWords() {
    static const std::vector<ComputeWord> rows = {
        {"staged", &ComputeOptions::staged},     {"previous", &ComputeOptions::previous},
        {"tangents", &ComputeOptions::tangents}, {"early-exit", &ComputeOptions::earlyExit},
        {"packed", &ComputeOptions::packed},     {"half-rate", &ComputeOptions::halfRate},
    };
    return rows;
}

std::string computeName(const ComputeOptions& options) {
    std::string words;
    for (const ComputeWord& word : computeWords())
        if (options.*word.option) words += (words.empty() ? "" : "+") + std::string(word.name);
    return words.empty() ? "plain" : words;
}

bool sharesJointLists(const Case& which) { return which.variant == findVariant("mesh-ci"); }

bool usesPartition(const Case& which) { return which.variant == findVariant("palette"); }

bool storesSlim(const Case& which) {
    return which.builder && (sharesJointLists(which) || which.shape.joints != JointSource::vertex);
}

static std::string commonWords(const CommonInfluences& common) {
    const CommonInfluences usual;
    std::string words;
    if (common.grouping != usual.grouping) words += std::string("+ci-") + ciGroupingName(common.grouping);
    if (common.key != usual.key) words += std::string("+ci-") + ciKeyName(common.key);
    if (common.minVertices != usual.minVertices) words += std::format("+ci-min-{}", common.minVertices);
    if (common.fat) words += "+fat";
    return words;
}

static std::string shapeWords(const MeshShape& shape) {
    std::string words;
    if (shape.joints != JointSource::vertex) words += std::string("+joints-") + jointSourceName(shape.joints);
    if (shape.clampedLoads) words += "+clamped-loads";
    if (shape.orderedRecords) words += "+ordered-records";
    if (shape.uniformPalette) words += "+uniform-palette";
    return words;
}

std::string caseId(const Case& which) {
    std::string id = std::string(which.route->name) + "/" + which.variant->name + "/" + which.codec->name;
    if (which.builder) {
        id += std::string("/") + which.builder->name + "/" + which.layout->name;
        if (which.limits != MeshletLimits{}) id += std::format("+{}-{}", which.limits.vertices, which.limits.triangles);
        if (which.groupSize != Case{}.groupSize) id += std::format("+group-{}", which.groupSize);
        if (which.route->dialect == MeshDialect::nv && !which.packedWrites) id += "+unpacked-writes";
        if (sharesJointLists(which)) id += commonWords(which.common);
        id += shapeWords(which.shape);
    }
    if (usesPartition(which)) id += std::format("+slots-{}", which.paletteSlots);
    if (which.compute != ComputeOptions{}) id += "+" + computeName(which.compute);
    if (which.influences != 4) id += std::format("+{}-influences", which.influences);
    if (which.fetch == VertexFetch::pull) id += "+pull";
    if (which.submission == Submission::batched) id += "+batched";
    if (which.keepBackFaces) id += "+keep-back-faces";
    if (which.cull != Cull::off) id += std::string("+cull-") + cullName(which.cull);
    if (which.exchange != Exchange::automatic) id += std::string("+") + exchangeName(which.exchange);
    if (which.scenario == Scenario::prepass) id += "+prepass";
    if (which.raster != RasterMode::full) id += std::string("+") + rasterName(which.raster);
    return id;
}

// What one work group keeps in shared memory when it culls.
static uint32_t exchangeBytes(const Case& which) {
    if (which.cull == Cull::off) return 0;
    return which.limits.vertices * 12 + (which.limits.triangles + which.groupSize * 4);
}

static std::optional<std::string> unsupportedOptions(const Case& which, const DeviceCaps& caps) {
    if (which.cull == Cull::primitive && which.route->dialect == MeshDialect::nv)
        return "gl_CullPrimitive exists in the EXT dialect only";
    if ((which.cull == Cull::primitive || which.cull == Cull::torabi) && which.route->dialect == MeshDialect::ext &&
        caps.primitiveCullIgnored)
        return caps.name + " ignores gl_CullPrimitiveEXT";
    if (which.exchange == Exchange::shuffle && which.cull != Cull::compact)
        return std::string("--cull ") + cullName(which.cull) + " exchanges through shared memory only";
    if (which.exchange == Exchange::shuffle && !canShuffle(which, caps))
        return std::format("{} invocations a work group are not one subgroup that can shuffle: {} has {}",
                           which.groupSize, caps.name, caps.subgroupSize);
    const MeshLimitsOfDevice& limits = meshLimits(caps, which.route->dialect);
    if (exchangeBytes(which) > limits.maxSharedBytes)
        return std::format("{} bytes of shared memory: {} allows {}", exchangeBytes(which), caps.name,
                           limits.maxSharedBytes);
    if (storesSlim(which) && which.codec != findCodec("uc"))
        return std::string("codec ") + which.codec->name + " has no record without joint ids";
    if (sharesJointLists(which) && which.shape.joints != JointSource::vertex) return "mesh-ci lists joints its own way";
    return std::nullopt;
}

std::optional<Case> limitCase(const Case& which) {
    if (which.variant == findVariant("cpu") || which.scenario == Scenario::prepass) return std::nullopt;
    Case limit;
    limit.route = which.route;
    limit.variant = findVariant("none");
    limit.codec = findCodec("ids");
    limit.influences = which.influences;  // decides which vertices are welded
    limit.raster = which.raster;
    limit.submission = which.submission;
    limit.keepBackFaces = which.keepBackFaces;
    if (which.route->dialect == MeshDialect::none) {
        limit.fetch = VertexFetch::pull;
        return limit;
    }
    limit.builder = which.builder;
    limit.layout = which.layout;
    limit.limits = which.limits;
    limit.groupSize = which.groupSize;
    limit.packedWrites = which.packedWrites;
    limit.shape.orderedRecords = true;  // so that no vertex id is fetched
    return limit;
}

static std::optional<std::string> unsupportedMeshlets(const Case& which, const DeviceCaps& caps) {
    const MeshLimitsOfDevice& limits = meshLimits(caps, which.route->dialect);
    const char* prefix = which.route->api == Api::vulkan ? "VK" : "GL";
    const char* vendor = which.route->dialect == MeshDialect::nv ? "NV" : "EXT";
    if (!limits.available) return std::format("{} has no {}_{}_mesh_shader", caps.name, prefix, vendor);
    if (which.limits.vertices > limits.maxVertices)
        return std::format("{} vertices a meshlet: {} allows {}", which.limits.vertices, caps.name, limits.maxVertices);
    if (which.limits.triangles > limits.maxTriangles)
        return std::format("{} triangles a meshlet: {} allows {}", which.limits.triangles, caps.name,
                           limits.maxTriangles);
    if (which.groupSize > limits.maxGroupSize)
        return std::format("{} invocations a mesh work group: {} allows {}", which.groupSize, caps.name,
                           limits.maxGroupSize);
    return unsupportedOptions(which, caps);
}

bool canShuffle(const Case& which, const DeviceCaps& caps) {
    return caps.meshSubgroups && caps.subgroupSize == which.groupSize;
}

std::optional<std::string> unsupported(const Case& which, const DeviceCaps& caps) {
    if (which.route->api == Api::cpu) return std::nullopt;
    if (caps.timestampBits == 0) return caps.name + " offers no timestamps, so passes cannot be timed";
    if (which.codec->needsMeshlets && which.route->dialect == MeshDialect::none)
        return std::string("codec ") + which.codec->name + " decodes in mesh stages only";
    if (which.codec == findCodec("ids") && which.variant->skins) return "codec ids stores no joints";
    if (usesPartition(which) && which.codec != findCodec("uc"))
        return std::string("codec ") + which.codec->name + " stores joints, and palette draws need slots";
    if (which.variant->fetches && which.route->dialect == MeshDialect::none && which.fetch == VertexFetch::attributes &&
        !feedsAttributes(*which.codec))
        return std::string("no attribute format carries codec ") + which.codec->name;
    if ((which.shape.uniformPalette || usesPartition(which)) && which.submission == Submission::batched)
        return "a uniform block holds one copy's palette, so copies cannot be drawn at once";
    if (which.compute.staged && which.submission == Submission::batched)
        return "a work group of a batched dispatch spans copies, so it cannot stage the palette of one";
    if (which.route->dialect != MeshDialect::none) return unsupportedMeshlets(which, caps);
    // A vertex stage reads the palette, and the vertices when it pulls; verifying plans add the capture buffer.
    const uint32_t blocks = which.fetch == VertexFetch::pull ? 3 : 2;
    if (caps.storageBlocksVertex < blocks)
        return std::format("{} storage blocks in the vertex stage: {} allows {}", blocks, caps.name,
                           caps.storageBlocksVertex);
    return std::nullopt;
}

uint64_t PaletteBlocks::stride() const {
    const uint64_t bytes = size * sizeof(PaletteEntry);
    return (bytes + kPaletteAlignment - 1) / kPaletteAlignment * kPaletteAlignment;
}

std::optional<PaletteBlocks> paletteBlocks(const Case& which, const PlanInput& input) {
    if (usesPartition(which)) {
        const PartitionPlan& plan = input.records->partition;
        PaletteBlocks blocks{plan.slots, {}};
        for (size_t command = 0; command < plan.commands.size(); ++command) {
            const std::vector<uint16_t> slots = slotsAfter(plan, command);
            blocks.joints.insert(blocks.joints.end(), slots.begin(), slots.end());
        }
        return blocks;
    }
    if (!which.shape.uniformPalette) return std::nullopt;
    PaletteBlocks blocks;
    blocks.size = static_cast<uint32_t>(input.scene->skeleton.joints.size());
    for (uint32_t joint = 0; joint < blocks.size; ++joint) blocks.joints.push_back(static_cast<uint16_t>(joint));
    return blocks;
}

static std::string mebibytes(uint64_t bytes) { return std::format("{:.1f} MiB", static_cast<double>(bytes) / 1048576); }

Result<FramePlan> makePlan(const Case& which, const PlanInput& input, const DeviceCaps& caps) {
    // Vertex, index and group numbers of all copies together are 32 bits, base vertices signed.
    const uint64_t largest = std::max<uint64_t>(input.encoded->vertexCount, input.scene->mesh.indices.size());
    if (largest * input.copies > INT32_MAX)
        return deviceError(
            std::format("{} copies of {} vertices and {} indices exceed 32-bit numbers; use fewer copies", input.copies,
                        input.encoded->vertexCount, input.scene->mesh.indices.size()));
    Result<FramePlan> plan = which.variant->plan(which, input, caps);
    if (!plan) return plan;
    plan->label = caseId(which);
    if (which.route->api == Api::cpu) return plan;
    for (const Stream& stream : plan->streams) {
        const uint64_t bytes = stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas : stream.gpuBytes;
        const bool storage = stream.use & useStorage;
        const uint64_t most = storage ? std::min(caps.maxStorageBytes, caps.maxBufferBytes) : caps.maxBufferBytes;
        if (bytes > most)
            return deviceError(std::format("needs a {}buffer of {} for {} copies: {} allows {}; use fewer copies",
                                           storage ? "storage " : "", mebibytes(bytes), input.copies, caps.name,
                                           mebibytes(most)));
    }
    if (plan->paletteRange > caps.maxUniformBytes)
        return deviceError(std::format("needs a uniform block of {} bytes for {} joints: {} allows {}",
                                       plan->paletteRange, plan->paletteRange / sizeof(PaletteEntry), caps.name,
                                       caps.maxUniformBytes));
    if (!plan->paletteRange && plan->paletteBytes > caps.maxStorageBytes)
        return deviceError(std::format("needs a palette of {} for {} copies: {} allows {}; use fewer copies",
                                       mebibytes(plan->paletteBytes), input.copies, caps.name,
                                       mebibytes(caps.maxStorageBytes)));
    if (caps.deviceBytes && planBytes(*plan) > caps.deviceBytes)
        return deviceError(std::format("needs {} for {} copies: {} has {}; use fewer copies",
                                       mebibytes(planBytes(*plan)), input.copies, caps.name,
                                       mebibytes(caps.deviceBytes)));
    return plan;
}

MemoryBytes memoryOfOneCopy(const FramePlan& plan, uint32_t copies) {
    MemoryBytes memory;
    for (const Stream& stream : plan.streams) {
        const uint64_t bytes =
            stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas / copies : stream.gpuBytes / copies;
        switch (stream.slot) {
            case SLOT_VERTEX:
                memory.vertex += bytes;
                break;
            case SLOT_INDEX:
                memory.index += bytes;
                break;
            case SLOT_MESHLET:
                (plan.dialect == MeshDialect::none ? memory.vertex : memory.meshlet) += bytes;  // or SLOT_TANGENT
                break;
            case SLOT_MESHLET_DATA:
                memory.meshlet += bytes;
                break;
            case SLOT_MESHLET_EXTRA:
                memory.additionalMeshlet += bytes;
                break;
            case SLOT_TUPLE:
                memory.tuple += bytes;
                break;
            case SLOT_SKINNED:
                memory.skinned += bytes;
                break;
            default:
                break;
        }
    }
    memory.palette = plan.paletteBytes / copies;
    return memory;
}

}  // namespace skinbench
