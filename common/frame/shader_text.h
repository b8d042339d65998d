// Turns the files of shaders_glsl/ into the complete GLSL text of one stage in one dialect: version, extension lines,
// defines, and the file with its includes expanded. Nothing is written to disk.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/frame/backend.h"

namespace skinbench {

// Path below shaders_glsl/ -> text.
struct ShaderLibrary {
    std::map<std::string, std::string> files;
};

// The folder that holds the shaders: $SKINBENCH_SHADERS, else share/skinbench/shaders_glsl beside an installed
// program, else the source tree that built this program. The error names all places that were tried.
Result<std::string> findShaderFolder();

// Reads every file of the folder and of its folder codecs/.
Result<ShaderLibrary> loadShaders(const std::string& folder);

using Defines = std::vector<std::pair<std::string, std::string>>;

struct ShaderRequest {
    std::string file;
    Stage stage = Stage::vertex;
    Api api = Api::vulkan;
    MeshDialect dialect = MeshDialect::none;
    bool subgroups = false;  // the mesh and the task stage shuffle and vote
    Defines defines{};       // STAGE_*, MESH_NV come by themselves
};

// `#include "file"` and `#include NAME`, where the define NAME holds a quoted file, are compiled once a file. Line
// numbers in compiler messages stay true: "3:17" is line 17 of the third file of the list in the text's second line.
Result<ShaderText> shaderText(const ShaderLibrary& library, const ShaderRequest& request);

// The first line of a compiler's log that names an error, since warnings may come before; else its first line.
std::string firstError(std::string_view log);

}  // namespace skinbench
