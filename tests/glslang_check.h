// Compiles one shader text with the reference compiler, for either API.
#pragma once

#include <string>

#include "common/frame/backend.h"

namespace skinbench {

// Empty when the text compiles, else the compiler's log.
std::string glslangErrors(const ShaderText& shader, Api api);

}  // namespace skinbench
