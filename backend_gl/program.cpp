#include "backend_gl/program.h"

#include <cctype>
#include <format>
#include <string_view>
#include <vector>

#include "backend_gl/mesh_ext.h"

namespace skinbench {

namespace {

GLenum stageEnum(Stage stage) {
    switch (stage) {
        case Stage::vertex:
            return GL_VERTEX_SHADER;
        case Stage::fragment:
            return GL_FRAGMENT_SHADER;
        case Stage::compute:
            return GL_COMPUTE_SHADER;
        case Stage::task:
            return kTaskShader;
        case Stage::mesh:
            return kMeshShader;
    }
    return 0;
}

std::string_view trim(std::string_view text) {
    auto isIdle = [](char c) { return std::isspace(static_cast<unsigned char>(c)) || c == '.' || c == '\0'; };
    while (!text.empty() && isIdle(text.front())) text.remove_prefix(1);
    while (!text.empty() && isIdle(text.back())) text.remove_suffix(1);
    return text;
}

bool saysError(std::string_view line) {
    for (size_t i = 0; i + 5 <= line.size(); ++i) {
        bool equal = true;
        for (size_t j = 0; j < 5; ++j)
            equal = equal && std::tolower(static_cast<unsigned char>(line[i + j])) == "error"[j];
        if (equal) return true;
    }
    return false;
}

// The first line with an error in it, else the first line: warnings may come before.
std::string firstError(std::string_view log) {
    std::string_view first;
    while (!log.empty()) {
        size_t end = std::min(log.find('\n'), log.size());
        std::string_view line = trim(log.substr(0, end));
        log.remove_prefix(std::min(end + 1, log.size()));
        if (saysError(line)) return std::string(line);
        if (first.empty()) first = line;
    }
    return first.empty() ? "the driver gives no reason" : std::string(first);
}

Result<GlShader> compile(const ShaderText& shader) {
    GlShader object(glCreateShader(stageEnum(shader.stage)));
    if (!object.id()) {
        dropGlErrors();
        return deviceError(std::format("{}: the device has no {} stage", shader.name, stageName(shader.stage)));
    }
    const char* text = shader.text.data();
    auto length = static_cast<GLint>(shader.text.size());
    glShaderSource(object.id(), 1, &text, &length);
    glCompileShader(object.id());
    GLint compiled = 0, logLength = 0;
    glGetShaderiv(object.id(), GL_COMPILE_STATUS, &compiled);
    if (compiled) return object;
    glGetShaderiv(object.id(), GL_INFO_LOG_LENGTH, &logLength);
    std::string log(static_cast<size_t>(std::max(logLength, 1)), '\0');
    glGetShaderInfoLog(object.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
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
    GLint linked = 0, logLength = 0;
    glGetProgramiv(object.id(), GL_LINK_STATUS, &linked);
    if (linked) return object;
    glGetProgramiv(object.id(), GL_INFO_LOG_LENGTH, &logLength);
    std::string log(static_cast<size_t>(std::max(logLength, 1)), '\0');
    glGetProgramInfoLog(object.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
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
