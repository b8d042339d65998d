#include "backend_gl/program.h"

#include <array>
#include <format>
#include <vector>

#include "backend_gl/mesh_ext.h"
#include "common/frame/shader_text.h"

namespace skinbench {

namespace {

// In the order of Stage.
constexpr std::array<GLenum, 5> kStages = {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER, GL_COMPUTE_SHADER, kTaskShader,
                                           kMeshShader};

std::string infoLog(GLuint id, PFNGLGETSHADERIVPROC get, PFNGLGETSHADERINFOLOGPROC getLog) {
    GLint length = 0;
    get(id, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 1)), '\0');
    getLog(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
    return log;
}

Result<GlShader> compile(const ShaderText& shader) {
    GlShader object(glCreateShader(kStages[static_cast<size_t>(shader.stage)]));
    if (!object.id()) {
        dropGlErrors();
        return deviceError(std::format("{}: the device has no {} stage", shader.name, stageName(shader.stage)));
    }
    const char* text = shader.text.data();
    auto length = static_cast<GLint>(shader.text.size());
    glShaderSource(object.id(), 1, &text, &length);
    glCompileShader(object.id());
    GLint compiled = 0;
    glGetShaderiv(object.id(), GL_COMPILE_STATUS, &compiled);
    if (compiled) return object;
    const std::string log = infoLog(object.id(), glGetShaderiv, glGetShaderInfoLog);
    return deviceError(
        std::format("{}: {} shader does not compile: {}", shader.name, stageName(shader.stage), firstError(log)));
}

Result<GlProgramObject> link(const Program& program) {
    std::vector<GlShader> shaders;
    for (const ShaderText& text : program.stages) {
        auto shader = compile(text);
        SKINBENCH_TRY(shader);
        shaders.push_back(std::move(*shader));
    }
    GlProgramObject object(glCreateProgram());
    for (const GlShader& shader : shaders) glAttachShader(object.id(), shader.id());
    glLinkProgram(object.id());
    for (const GlShader& shader : shaders) glDetachShader(object.id(), shader.id());
    GLint linked = 0;
    glGetProgramiv(object.id(), GL_LINK_STATUS, &linked);
    if (linked) return object;
    const std::string log = infoLog(object.id(), glGetProgramiv, glGetProgramInfoLog);
    return deviceError(std::format("{}: program does not link: {}", program.label, firstError(log)));
}

}  // namespace

Result<LinkedProgram> ProgramCache::get(const Program& program) {
    std::string key;
    for (const ShaderText& shader : program.stages) key += stageName(shader.stage) + ('\0' + shader.text) + '\0';
    auto found = entries_.find(key);
    if (found == entries_.end()) {
        auto object = link(program);
        SKINBENCH_TRY(object);
        GLint constants = glGetUniformLocation(object->id(), "drawConstants");
        found = entries_.emplace(std::move(key), Entry{std::move(*object), constants}).first;
    }
    return LinkedProgram{found->second.object.id(), found->second.constants};
}

}  // namespace skinbench
