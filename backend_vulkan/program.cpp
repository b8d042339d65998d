#include "backend_vulkan/program.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <algorithm>
#include <array>
#include <climits>
#include <format>
#include <unordered_map>

#include "backend_vulkan/memory.h"
#include "common/frame/shader_text.h"

namespace skinbench::vulkan {

namespace {

// In the order of Stage.
struct StageNames {
    EShLanguage language;
    VkShaderStageFlagBits flag;
};
constexpr std::array<StageNames, 5> kStages = {{{EShLangVertex, VK_SHADER_STAGE_VERTEX_BIT},
                                                {EShLangFragment, VK_SHADER_STAGE_FRAGMENT_BIT},
                                                {EShLangCompute, VK_SHADER_STAGE_COMPUTE_BIT},
                                                {EShLangTask, VK_SHADER_STAGE_TASK_BIT_EXT},
                                                {EShLangMesh, VK_SHADER_STAGE_MESH_BIT_EXT}}};

// In the order of AttributeFormat.
constexpr std::array kFormats = {VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32B32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT,
                                 VK_FORMAT_R32G32B32A32_UINT};

// What a shader may declare: of work groups and meshlets as much as the device allows, as unsupported() does. Task
// stages and all the rest keep to glslang's own limits, which every device has.
TBuiltInResource resourcesOf(const DeviceCaps& caps) {
    TBuiltInResource resources = *GetDefaultResources();
    auto set = [](int& limit, uint32_t ofDevice) { limit = static_cast<int>(std::min<uint32_t>(ofDevice, INT_MAX)); };
    set(resources.maxComputeWorkGroupSizeX, caps.maxComputeGroupSize);
    if (caps.ext.available) {
        set(resources.maxMeshWorkGroupSizeX_EXT, caps.ext.maxGroupSize);
        set(resources.maxMeshOutputVerticesEXT, caps.ext.maxVertices);
        set(resources.maxMeshOutputPrimitivesEXT, caps.ext.maxTriangles);
    }
    if (caps.nv.available) {
        set(resources.maxMeshWorkGroupSizeX_NV, caps.nv.maxGroupSize);
        set(resources.maxMeshOutputVerticesNV, caps.nv.maxVertices);
        set(resources.maxMeshOutputPrimitivesNV, caps.nv.maxTriangles);
    }
    return resources;
}

Result<Spirv> compileNow(const ShaderText& source, const DeviceCaps& caps) {
    const EShLanguage language = kStages[static_cast<size_t>(source.stage)].language;
    auto failed = [&](const char* log) {
        return deviceError(std::format("{}: {} shader does not compile: {}", source.name, stageName(source.stage),
                                       firstError(log ? log : "")));
    };
    glslang::TShader shader(language);
    const char* text = source.text.c_str();
    const int length = static_cast<int>(source.text.size());
    shader.setStringsWithLengths(&text, &length, 1);
    shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
    const auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
    const TBuiltInResource resources = resourcesOf(caps);
    if (!shader.parse(&resources, 450, false, messages)) return failed(shader.getInfoLog());

    glslang::TProgram program;
    program.addShader(&shader);
    if (!program.link(messages)) return failed(program.getInfoLog());
    auto words = std::make_shared<std::vector<uint32_t>>();
    glslang::SpvOptions options;
    spv::SpvBuildLogger logger;
    glslang::GlslangToSpv(*program.getIntermediate(language), *words, &logger, &options);
    if (words->empty()) return failed(logger.getAllMessages().c_str());
    return words;
}

// The stages of one pipeline; the modules live until it is made.
struct Stages {
    Device& device;
    std::vector<VkPipelineShaderStageCreateInfo> infos;

    explicit Stages(Device& owner) : device(owner) {}
    Stages(const Stages&) = delete;
    ~Stages() {
        for (const auto& info : infos) device.vk.vkDestroyShaderModule(device.handle, info.module, nullptr);
    }
};

Result<void> compileStages(Stages& stages, const Program& program) {
    for (const ShaderText& shader : program.stages) {
        auto words = compileGlsl(shader, stages.device.caps);
        SKINBENCH_TRY(words);
        VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
        info.codeSize = (*words)->size() * sizeof(uint32_t);
        info.pCode = (*words)->data();
        VkPipelineShaderStageCreateInfo stage{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
        stage.stage = kStages[static_cast<size_t>(shader.stage)].flag;
        stage.pName = "main";
        Device& device = stages.device;
        SKINBENCH_TRY(check(device, device.vk.vkCreateShaderModule(device.handle, &info, nullptr, &stage.module),
                            "load the shader " + shader.name));
        stages.infos.push_back(stage);
    }
    return {};
}

VkResult makeCompute(Device& device, VkPipelineCache cache, VkPipelineLayout layout, const Stages& stages,
                     VkPipeline& pipeline) {
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = stages.infos[0];
    info.layout = layout;
    return device.vk.vkCreateComputePipelines(device.handle, cache, 1, &info, nullptr, &pipeline);
}

struct VertexInput {
    VkVertexInputBindingDescription binding{};
    std::vector<VkVertexInputAttributeDescription> attributes;
    VkPipelineVertexInputStateCreateInfo state{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};

    explicit VertexInput(const Program& program) {
        if (program.attributes.empty()) return;
        binding = {0, program.attributeStride, VK_VERTEX_INPUT_RATE_VERTEX};
        for (const VertexAttribute& a : program.attributes)
            attributes.push_back({a.location, 0, kFormats[static_cast<size_t>(a.format)], a.offset});
        state.vertexBindingDescriptionCount = 1;
        state.pVertexBindingDescriptions = &binding;
        state.vertexAttributeDescriptionCount = static_cast<uint32_t>(attributes.size());
        state.pVertexAttributeDescriptions = attributes.data();
    }
    VertexInput(const VertexInput&) = delete;
};

VkResult makeGraphics(Device& device, VkPipelineCache cache, VkPipelineLayout layout, const Program& program,
                      const Stages& stages, bool writeColor, VkPipeline& pipeline) {
    const VertexInput input(program);
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.polygonMode = VK_POLYGON_MODE_FILL;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = VK_TRUE;
    VkPipelineColorBlendAttachmentState attachment{};
    if (writeColor && hasStage(program, Stage::fragment))
        attachment.colorWriteMask =
            VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = 1;
    blend.pAttachments = &attachment;
    constexpr std::array dynamicStates{VK_DYNAMIC_STATE_VIEWPORT,         VK_DYNAMIC_STATE_SCISSOR,
                                       VK_DYNAMIC_STATE_CULL_MODE,        VK_DYNAMIC_STATE_RASTERIZER_DISCARD_ENABLE,
                                       VK_DYNAMIC_STATE_DEPTH_COMPARE_OP, VK_DYNAMIC_STATE_DEPTH_WRITE_ENABLE};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = static_cast<uint32_t>(dynamicStates.size());
    dynamic.pDynamicStates = dynamicStates.data();
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachmentFormats = &kColorFormat;
    rendering.depthAttachmentFormat = kDepthFormat;

    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.pNext = &rendering;
    info.stageCount = static_cast<uint32_t>(stages.infos.size());
    info.pStages = stages.infos.data();
    if (hasStage(program, Stage::vertex)) {
        info.pVertexInputState = &input.state;
        info.pInputAssemblyState = &assembly;
    }
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = layout;
    return device.vk.vkCreateGraphicsPipelines(device.handle, cache, 1, &info, nullptr, &pipeline);
}

}  // namespace

Result<Spirv> compileGlsl(const ShaderText& shader, const DeviceCaps& caps) {
    static std::mutex mutex;
    static std::unordered_map<std::string, Spirv> compiled;
    static const bool ready = glslang::InitializeProcess();
    if (!ready) return deviceError("Vulkan: glslang could not be initialised");
    const std::string key = stageName(shader.stage) + ("\n" + shader.text);
    std::lock_guard lock(mutex);
    if (auto found = compiled.find(key); found != compiled.end()) return found->second;
    auto words = compileNow(shader, caps);
    if (words) compiled.emplace(key, *words);
    return words;
}

Result<VkPipeline> makePipeline(Device& device, VkPipelineCache cache, VkPipelineLayout layout, const Program& program,
                                PassKind kind, bool writeColor) {
    const bool compute = kind == PassKind::dispatch;
    Stages stages(device);
    SKINBENCH_TRY(compileStages(stages, program));
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkResult result = compute ? makeCompute(device, cache, layout, stages, pipeline)
                              : makeGraphics(device, cache, layout, program, stages, writeColor, pipeline);
    SKINBENCH_TRY(check(device, result, "build the pipeline of program '" + program.label + "'"));
    return pipeline;
}

}  // namespace skinbench::vulkan
