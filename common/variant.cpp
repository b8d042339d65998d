#include "common/variant.h"

#include <algorithm>
#include <format>

#include "common/plans.h"

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
        {"none", "no skinning: the baseline", true, true, false, false, true, planDirect},
        {"vertex", "linear blend skinning in the vertex stage", true, false, false, true, true, planDirect},
        {"compute", "a compute pass skins into a buffer, a plain vertex stage draws it", true, false, false, true,
         false, planCompute},
        {"mesh", "a mesh-shader work group skins and draws a meshlet", false, true, false, true, false, planDirect},
        {"cpu", "the CPU skins on all cores, uploads, draws", true, false, true, true, false, planCpu},
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

const char* rasterName(RasterMode raster) {
    switch (raster) {
        case RasterMode::full:
            return "full";
        case RasterMode::noFragments:
            return "no-fragments";
        case RasterMode::discard:
            return "discard";
    }
    return "?";
}

const char* viewName(View view) {
    switch (view) {
        case View::shaded:
            return "shaded";
        case View::meshlets:
            return "meshlets";
        case View::weights:
            return "weights";
        case View::tuples:
            return "tuples";
    }
    return "?";
}

std::string caseId(const Case& which) {
    std::string id = std::string(which.route->name) + "/" + which.variant->name + "/" + which.codec->name;
    if (which.builder) {
        id += std::string("/") + which.builder->name + "/" + which.layout->name;
        if (which.limits != MeshletLimits{}) id += std::format("+{}-{}", which.limits.vertices, which.limits.triangles);
        if (which.groupSize != Case{}.groupSize) id += std::format("+group-{}", which.groupSize);
        if (which.route->dialect == MeshDialect::nv && !which.packedWrites) id += "+unpacked-writes";
    }
    if (which.influences != 4) id += std::format("+{}-influences", which.influences);
    if (which.fetch == VertexFetch::pull) id += "+pull";
    if (which.submission == Submission::batched) id += "+batched";
    if (which.keepBackFaces) id += "+keep-back-faces";
    if (which.raster != RasterMode::full) id += std::string("+") + rasterName(which.raster);
    return id;
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
    return std::nullopt;
}

std::optional<std::string> unsupported(const Case& which, const DeviceCaps& caps) {
    if (which.route->api == Api::cpu) return std::nullopt;
    if (caps.timestampBits == 0) return caps.name + " offers no timestamps, so passes cannot be timed";
    if (which.route->dialect != MeshDialect::none) return unsupportedMeshlets(which, caps);
    // A vertex stage reads the palette, and the vertices when it pulls; verifying plans add the capture buffer.
    const uint32_t blocks = which.fetch == VertexFetch::pull ? 3 : 2;
    if (caps.storageBlocksVertex < blocks)
        return std::format("{} storage blocks in the vertex stage: {} allows {}", blocks, caps.name,
                           caps.storageBlocksVertex);
    return std::nullopt;
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
        if ((stream.use & useStorage) && bytes > caps.maxStorageBytes)
            return deviceError(std::format("needs a storage buffer of {} for {} copies: {} allows {}; use fewer copies",
                                           mebibytes(bytes), input.copies, caps.name, mebibytes(caps.maxStorageBytes)));
    }
    if (plan->paletteBytes > caps.maxStorageBytes)
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
