// Output files that are either whole or absent, and input files read at once. An error is Fault::input where another
// path helps, and Fault::device where the machine has no room, no memory or a broken disk.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/core/result.h"

namespace skinbench {

// Writes to a new file beside `path` and renames it, so that a full disk or a signal leaves the old file as it was and
// processes never share an unfinished file. Missing folders of the path are made. What is no regular file is never
// replaced: bytes go through to a pipe, a character device or an open descriptor (/dev/stdout); a folder, a symbolic
// link and a block device are refused.
Result<void> writeWholeFile(const std::string& path, std::string_view bytes);

// Several regular files, each a path and its bytes, that belong together: the first old one is replaced when all new
// ones are written beside them, so that a full disk leaves all old ones as they were. `beforeReplacing` is called in
// between.
Result<void> writeWholeFiles(const std::vector<std::pair<std::string, std::string>>& files,
                             const std::function<void()>& beforeReplacing = {});

// What would stop writeWholeFile, before there is anything to write: the same refusals, a folder in which no file can
// be made, and an output that is one of `inputs`. Makes the folder.
Result<void> checkOutput(const std::string& path, std::span<const std::string> inputs = {});

// A pipe is read to its end. At most 1 GiB.
Result<std::string> readWholeFile(const std::string& path);

// The program's file of that name among the user's own, as the XDG Base Directory Specification has it:
// $VARIABLE/skinbench/NAME, or ~/FOLDER/skinbench/NAME where the variable holds no absolute path. Empty: there is no
// home.
std::string userFile(const char* variable, const char* folder, const std::string& name);

}  // namespace skinbench
