// What shells complete: subcommands, options, and the values that the table of axes lists.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "common/core/result.h"

namespace skinbench {

// The script that the shell reads (bash, zsh, fish). The error lists these.
Result<std::string> completionScript(const CLI::App& program, const std::string& shell);

}  // namespace skinbench
