#include "common/frame/shader_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "common/core/file.h"

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
        auto text = readWholeFile(entry.path().string());
        SKINBENCH_TRY(text);
        library.files[prefix + entry.path().filename().string()] = std::move(*text);
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
        return programError("shader " + name + ", which " + from + " includes, does not exist");
    if (std::ranges::count(expansion.open, name))
        return programError("shader " + name + " includes itself through " + from);
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
        if (!included.empty()) SKINBENCH_TRY(expand(included, name, expansion));
        expansion.text += "#line " + std::to_string(count + 1) + " " + number + "\n";
    }
    expansion.open.pop_back();
    expansion.text += "#endif\n";
    return {};
}

constexpr std::array kStageDefines = {"STAGE_VERTEX", "STAGE_FRAGMENT", "STAGE_COMPUTE", "STAGE_TASK", "STAGE_MESH"};

}  // namespace

Result<ShaderText> shaderText(const ShaderLibrary& library, const ShaderRequest& request) {
    Defines defines = request.defines;
    for (size_t stage = 0; stage < kStageDefines.size(); ++stage)
        defines.emplace_back(kStageDefines[stage], stage == static_cast<size_t>(request.stage) ? "1" : "0");
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
    if (request.subgroups && (request.stage == Stage::mesh || request.stage == Stage::task))
        for (const char* part : {"basic", "vote", "ballot", "shuffle"})
            text += std::string("#extension GL_KHR_shader_subgroup_") + part + " : require\n";
    for (const auto& [name, value] : defines)
        if (value.empty() || value.front() != '"') text += "#define " + name + " " + value + "\n";
    return ShaderText{request.stage, request.file + " (" + stageName(request.stage) + ")", text + expansion.text};
}

static std::string_view trim(std::string_view text) {
    auto isIdle = [](char c) { return std::isspace(static_cast<unsigned char>(c)) || c == '.' || c == '\0'; };
    while (!text.empty() && isIdle(text.front())) text.remove_prefix(1);
    while (!text.empty() && isIdle(text.back())) text.remove_suffix(1);
    return text;
}

std::string firstError(std::string_view log) {
    auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
    constexpr std::string_view word = "error", prefix = "ERROR: ";
    std::string_view first;
    while (!log.empty()) {
        const size_t end = std::min(log.find('\n'), log.size());
        std::string_view line = trim(log.substr(0, end));
        log.remove_prefix(std::min(end + 1, log.size()));
        if (line.starts_with(prefix)) return std::string(line.substr(prefix.size()));
        if (!std::ranges::search(line, word, same).empty()) return std::string(line);
        if (first.empty()) first = line;
    }
    return first.empty() ? "the compiler gives no reason" : std::string(first);
}

}  // namespace skinbench
