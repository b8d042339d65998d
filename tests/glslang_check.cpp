#include "tests/glslang_check.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

namespace skinbench {

static EShLanguage languageOf(Stage stage) {
    switch (stage) {
        case Stage::vertex:
            return EShLangVertex;
        case Stage::fragment:
            return EShLangFragment;
        case Stage::compute:
            return EShLangCompute;
        case Stage::task:
            return EShLangTask;
        case Stage::mesh:
            return EShLangMesh;
    }
    return EShLangVertex;
}

std::string glslangErrors(const ShaderText& shader, Api api) {
    static const bool ready = glslang::InitializeProcess();
    if (!ready) return "glslang did not start";
    const char* text = shader.text.c_str();
    glslang::TShader compiled(languageOf(shader.stage));
    compiled.setStrings(&text, 1);
    EShMessages rules = EShMsgSpvRules;
    if (api == Api::opengl) {
        // GL_EXT_mesh_shader needs SPIR-V 1.4 in glslang, which without a target assumes 1.0.
        compiled.setEnvInput(glslang::EShSourceGlsl, languageOf(shader.stage), glslang::EShClientOpenGL, 100);
        compiled.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
        compiled.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_4);
    } else {
        compiled.setEnvInput(glslang::EShSourceGlsl, languageOf(shader.stage), glslang::EShClientVulkan, 100);
        compiled.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
        compiled.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
        rules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
    }
    return compiled.parse(GetDefaultResources(), 450, false, rules) ? "" : compiled.getInfoLog();
}

}  // namespace skinbench
