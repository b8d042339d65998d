#include <algorithm>
#include <format>
#include <map>

#include "backend_gl/context.h"
#include "backend_gl/memory.h"

namespace skinbench {

namespace {

constexpr GLenum kGpuMemoryDedicatedNvx = 0x9047;  // GL_NVX_gpu_memory_info, KiB

std::string getString(GLenum name) {
    auto text = reinterpret_cast<const char*>(glGetString(name));
    return text ? text : "";
}

uint32_t getUint(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return static_cast<uint32_t>(std::max(value, 0));
}

uint32_t getUintX(GLenum name) {
    GLint value = 0;
    glGetIntegeri_v(name, 0, &value);
    return static_cast<uint32_t>(std::max(value, 0));
}

uint64_t getUint64(GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return static_cast<uint64_t>(std::max<GLint64>(value, 0));
}

std::vector<std::string> getExtensions() {
    std::vector<std::string> names;
    uint32_t count = getUint(GL_NUM_EXTENSIONS);
    for (uint32_t i = 0; i < count; ++i)
        if (auto name = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, i))) names.emplace_back(name);
    std::ranges::sort(names);
    return names;
}

MeshLimitsOfDevice getExtLimits() {
    MeshLimitsOfDevice limits;
    limits.available = true;
    limits.maxVertices = getUint(kMaxMeshOutputVertices);
    limits.maxTriangles = getUint(kMaxMeshOutputPrimitives);
    limits.maxGroupSize = getUint(kMaxMeshWorkGroupInvocations);
    limits.maxGroupCount = std::min(getUintX(kMaxMeshWorkGroupCount), getUint(kMaxMeshWorkGroupTotalCount));
    limits.maxOutputBytes = getUint(kMaxMeshOutputMemorySize);
    limits.maxSharedBytes = getUint(kMaxMeshSharedMemorySize);
    limits.preferredGroupSize = getUint(kMaxPreferredMeshWorkGroupInvocations);
    limits.taskStages = true;
    return limits;
}

// GL_NV_mesh_shader has one limit for outputs and shared memory together.
MeshLimitsOfDevice getNvLimits() {
    MeshLimitsOfDevice limits;
    limits.available = true;
    limits.maxVertices = getUint(GL_MAX_MESH_OUTPUT_VERTICES_NV);
    limits.maxTriangles = getUint(GL_MAX_MESH_OUTPUT_PRIMITIVES_NV);
    limits.maxGroupSize = getUint(GL_MAX_MESH_WORK_GROUP_INVOCATIONS_NV);
    limits.maxGroupCount = getUint(GL_MAX_DRAW_MESH_TASKS_COUNT_NV);
    limits.maxOutputBytes = getUint(GL_MAX_MESH_TOTAL_MEMORY_SIZE_NV);
    limits.maxSharedBytes = limits.maxOutputBytes;
    limits.taskStages = true;
    return limits;
}

bool isSoftware(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "SwiftShader"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

}  // namespace

DeviceCaps queryCaps() {
    DeviceCaps caps;
    caps.api = Api::opengl;
    caps.name = getString(GL_RENDERER);
    caps.software = isSoftware(caps.name);
    // NVIDIA appends the bus and the host's instruction set ("/PCIe/SSE2"), which are not the device's name.
    if (size_t bus = caps.name.find("/PCIe"); bus != std::string::npos) caps.name.resize(bus);
    caps.driver = getString(GL_VENDOR) + " " + getString(GL_VERSION);
    caps.version = std::format("OpenGL {}.{}", getUint(GL_MAJOR_VERSION), getUint(GL_MINOR_VERSION));
    caps.extensions = getExtensions();
    auto has = [&](const char* name) { return std::ranges::binary_search(caps.extensions, name); };

    GLint bits = 0;
    glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
    caps.timestampBits = static_cast<uint32_t>(std::max(bits, 0));
    caps.timestampPeriodNs = bits > 0 ? 1 : 0;
    if (has("GL_EXT_mesh_shader")) caps.ext = getExtLimits();
    if (has("GL_NV_mesh_shader")) caps.nv = getNvLimits();
    if (has("GL_KHR_shader_subgroup")) {
        caps.subgroupSize = getUint(GL_SUBGROUP_SIZE_KHR);
        const uint32_t wanted =
            GL_SUBGROUP_FEATURE_VOTE_BIT_KHR | GL_SUBGROUP_FEATURE_BALLOT_BIT_KHR | GL_SUBGROUP_FEATURE_SHUFFLE_BIT_KHR;
        // OpenGL does not say whether the size varies; where it may, drivers other than NVIDIA's use shared memory.
        const uint32_t stages = GL_MESH_SHADER_BIT_NV | GL_TASK_SHADER_BIT_NV;
        caps.meshSubgroups = (getUint(GL_SUBGROUP_SUPPORTED_STAGES_KHR) & stages) == stages &&
                             (getUint(GL_SUBGROUP_SUPPORTED_FEATURES_KHR) & wanted) == wanted &&
                             has("GL_NV_mesh_shader");
    }
    caps.meshDepthDiffers = caps.software;
    caps.subpixelBits = getUint(GL_SUBPIXEL_BITS);
    caps.maxImageSize = getUint(GL_MAX_TEXTURE_SIZE);
    caps.maxComputeSharedBytes = getUint(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
    caps.maxComputeGroupSize = getUint(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
    caps.maxComputeGroupCount = getUintX(GL_MAX_COMPUTE_WORK_GROUP_COUNT);
    caps.maxStorageBytes = getUint64(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    caps.maxUniformBytes = getUint(GL_MAX_UNIFORM_BLOCK_SIZE);
    caps.storageBlocksVertex = getUint(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS);
    // A software device answers with some number about the host.
    if (has("GL_NVX_gpu_memory_info") && !caps.software)
        caps.deviceBytes = uint64_t{getUint(kGpuMemoryDedicatedNvx)} * 1024;
    caps.pipelineStatistics = caps.version >= "OpenGL 4.6" || has("GL_ARB_pipeline_statistics_query");
    dropGlErrors();
    return caps;
}

const char* glErrorName(GLenum error) {
    static const std::map<GLenum, const char*> names = {
        {GL_NO_ERROR, "GL_NO_ERROR"},
        {GL_INVALID_ENUM, "GL_INVALID_ENUM"},
        {GL_INVALID_VALUE, "GL_INVALID_VALUE"},
        {GL_INVALID_OPERATION, "GL_INVALID_OPERATION"},
        {GL_INVALID_FRAMEBUFFER_OPERATION, "GL_INVALID_FRAMEBUFFER_OPERATION"},
        {GL_OUT_OF_MEMORY, "GL_OUT_OF_MEMORY"},
        {GL_CONTEXT_LOST, "GL_CONTEXT_LOST"},
    };
    auto found = names.find(error);
    return found == names.end() ? "an unknown OpenGL error" : found->second;
}

}  // namespace skinbench
