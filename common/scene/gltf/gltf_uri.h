// Where the bytes of a buffer lie: in a data URI, or in a file at or below the glTF file's own folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.h"

namespace skinbench {

// Regular files up to 4 GiB, which is where a GLB's count of its bytes ends. A Git LFS pointer is named as one.
Result<std::vector<uint8_t>> readGltfBytes(const std::filesystem::path& path);

bool isDataUri(const std::string& uri);
Result<std::vector<uint8_t>> decodeDataUri(const std::string& uri);

// Refuses schemes, absolute paths, "..", and links that lead out of `folder`; a backslash separates folders as a slash
// does. The result has no links in it, so that two names of one file are equal.
Result<std::filesystem::path> resolveUri(const std::string& uri, const std::filesystem::path& folder);

}  // namespace skinbench
