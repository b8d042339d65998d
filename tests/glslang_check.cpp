#include "tests/glslang_check.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

#include <array>

namespace skinbench {

std::string glslangErrors(const ShaderText& shader, Api api) {
    static const bool ready = glslang::InitializeProcess();
    if (!ready) return "glslang did not start";
    constexpr std::array languages = {EShLangVertex, EShLangFragment, EShLangCompute, EShLangTask, EShLangMesh};
    const EShLanguage language = languages[static_cast<size_t>(shader.stage)];
    const char* text = shader.text.c_str();
    glslang::TShader compiled(language);
    compiled.setStrings(&text, 1);
    EShMessages rules = EShMsgSpvRules;
    if (api == Api::opengl) {
        // GL_EXT_mesh_shader needs SPIR-V 1.4 in glslang, which without a target assumes 1.0.
        compiled.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientOpenGL, 100);
        compiled.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
        compiled.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_4);
    } else {
        compiled.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, 100);
        compiled.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
        compiled.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
        rules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
    }
    return compiled.parse(GetDefaultResources(), 450, false, rules) ? "" : compiled.getInfoLog();
}

}  // namespace skinbench
