// Output files that are either whole or absent.
#pragma once

#include <string>
#include <string_view>

#include "common/core/result.h"

namespace skinbench {

// Writes to a temporary file beside `path` and renames it, so that a full disk or a signal leaves the old file as it
// was. Missing folders of the path are made.
Result<void> writeWholeFile(const std::string& path, std::string_view bytes);

// At most 1 GiB.
Result<std::string> readWholeFile(const std::string& path);

}  // namespace skinbench
