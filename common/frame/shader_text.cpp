#include "common/frame/shader_text.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace skinbench {
namespace fs = std::filesystem;

Result<std::string> findShaderFolder() {
    std::vector<fs::path> places;
    if (const char* given = std::getenv("SKINBENCH_SHADERS")) {
        places.emplace_back(given);
    } else {
        std::error_code none;
        fs::path program = fs::read_symlink("/proc/self/exe", none);
        if (!none) places.push_back(program.parent_path().parent_path() / "share/skinbench/shaders_glsl");
        places.emplace_back(SKINBENCH_SOURCE_DIR "/shaders_glsl");
    }
    std::string tried;
    for (const fs::path& place : places) {
        std::error_code none;
        if (fs::is_regular_file(place / "shared.h", none)) return place.string();
        tried += (tried.empty() ? "" : ", ") + place.string();
    }
    return inputError("no shaders in " + tried + "; set SKINBENCH_SHADERS to the folder shaders_glsl");
}

static Result<void> readFolder(const fs::path& folder, const std::string& prefix, ShaderLibrary& library) {
    std::error_code failed;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
        if (!entry.is_regular_file()) continue;
        std::ifstream file(entry.path());
        std::ostringstream text;
        text << file.rdbuf();
        if (!file) return inputError(entry.path().string() + ": cannot be read");
        library.files[prefix + entry.path().filename().string()] = std::move(text).str();
    }
    if (failed) return inputError(folder.string() + ": " + failed.message());
    return {};
}

Result<ShaderLibrary> loadShaders(const std::string& folder) {
    ShaderLibrary library;
    SKINBENCH_TRY(readFolder(folder, "", library));
    SKINBENCH_TRY(readFolder(fs::path(folder) / "codecs", "codecs/", library));
    return library;
}

namespace {

struct Expansion {
    const ShaderLibrary& library;
    const Defines& defines;
    std::vector<std::string> files{};  // in order of their #line numbers, from 1
    std::vector<std::string> open{};   // the includes around the current place
    std::string text{};
};

// The quoted file of an include line, directly or through a define; empty for lines that are none of ours.
std::string includedFile(const std::string& line, const Defines& defines) {
    size_t start = line.find_first_not_of(" \t");
    if (start == std::string::npos || line.compare(start, 8, "#include") != 0) return {};
    std::string what = line.substr(line.find_first_not_of(" \t", start + 8));
    for (const auto& [name, value] : defines)
        if (what == name) what = value;
    return what.size() > 2 && what.front() == '"' ? what.substr(1, what.rfind('"') - 1) : std::string();
}

// A file may stand in a branch that the preprocessor drops and be needed in the next one, so every include is expanded
// and a guard, not the expansion, keeps it from being compiled twice.
Result<void> expand(const std::string& name, const std::string& from, Expansion& expansion) {
    auto file = expansion.library.files.find(name);
    if (file == expansion.library.files.end())
        return inputError("shader " + name + ", which " + from + " includes, does not exist");
    if (std::ranges::count(expansion.open, name))
        return inputError("shader " + name + " includes itself through " + from);
    if (!std::ranges::count(expansion.files, name)) expansion.files.push_back(name);
    const auto place = std::ranges::find(expansion.files, name) - expansion.files.begin();
    const std::string number = std::to_string(place + 1);
    const std::string guard = "INCLUDED_" + number;
    expansion.text += "#ifndef " + guard + "\n#define " + guard + "\n#line 1 " + number + "\n";

    expansion.open.push_back(name);
    std::istringstream lines(file->second);
    std::string line;
    for (int count = 1; std::getline(lines, line); ++count) {
        if (line.find("#include") == std::string::npos) {
            expansion.text += line + "\n";
            continue;
        }
        std::string included = includedFile(line, expansion.defines);
        if (!included.empty())
            if (auto done = expand(included, name, expansion); !done) return done;
        expansion.text += "#line " + std::to_string(count + 1) + " " + number + "\n";
    }
    expansion.open.pop_back();
    expansion.text += "#endif\n";
    return {};
}

const char* stageDefine(Stage stage) {
    switch (stage) {
        case Stage::vertex:
            return "STAGE_VERTEX";
        case Stage::fragment:
            return "STAGE_FRAGMENT";
        case Stage::compute:
            return "STAGE_COMPUTE";
        case Stage::task:
            return "STAGE_TASK";
        case Stage::mesh:
            return "STAGE_MESH";
    }
    return "?";
}

}  // namespace

Result<ShaderText> shaderText(const ShaderLibrary& library, const ShaderRequest& request) {
    Defines defines = request.defines;
    for (Stage stage : {Stage::vertex, Stage::fragment, Stage::compute, Stage::task, Stage::mesh})
        defines.emplace_back(stageDefine(stage), stage == request.stage ? "1" : "0");
    defines.emplace_back("MESH_NV", request.dialect == MeshDialect::nv ? "1" : "0");

    Expansion expansion{library, defines};
    SKINBENCH_TRY(expand(request.file, "the plan", expansion));

    std::string text = "#version 450\n//";
    for (size_t i = 0; i < expansion.files.size(); ++i) text += " " + std::to_string(i + 1) + "=" + expansion.files[i];
    text += "\n";
    if (request.stage == Stage::mesh || request.stage == Stage::task)
        text += std::string("#extension ") +
                (request.dialect == MeshDialect::nv ? "GL_NV_mesh_shader" : "GL_EXT_mesh_shader") + " : require\n";
    if (request.api == Api::vulkan) text += "#extension GL_EXT_control_flow_attributes : require\n";
    if (request.subgroups && request.stage == Stage::mesh)
        for (const char* part : {"basic", "vote", "ballot", "shuffle"})
            text += std::string("#extension GL_KHR_shader_subgroup_") + part + " : require\n";
    for (const auto& [name, value] : defines)
        if (value.empty() || value.front() != '"') text += "#define " + name + " " + value + "\n";
    return ShaderText{request.stage, request.file + " (" + stageName(request.stage) + ")", text + expansion.text};
}

}  // namespace skinbench
