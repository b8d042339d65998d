// GLSL to linked programs.
#pragma once

#include <string>
#include <unordered_map>

#include "backend_gl/memory.h"
#include "common/frame/backend.h"

namespace skinbench {

struct LinkedProgram {
    GLuint id = 0;
    GLint constants = -1;  // location of drawConstants; -1: the program does not read it
};

// Keeps every program it has linked, by its text, as variants of a benchmark come back again and again.
class ProgramCache {
public:
    // On failure the compiler's first error line, behind the name of the shader.
    Result<LinkedProgram> get(const Program& program);

private:
    struct Entry {
        GlProgramObject object;
        GLint constants = -1;
    };
    std::unordered_map<std::string, Entry> entries_;
};

}  // namespace skinbench
