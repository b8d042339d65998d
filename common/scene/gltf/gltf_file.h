// The container of a glTF 2.0 asset: reads the file, takes a GLB apart, loads the buffers and hands on JSON in which
// every index and size is known to be a whole number that is not negative. scene_gltf.cpp gives that text to tinygltf.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.h"

namespace skinbench {

struct GltfFile {
    std::string json;                               // without images, materials, cameras, buffers and extras
    std::vector<std::span<const uint8_t>> buffers;  // empty for the fallback buffers of EXT_meshopt_compression
    std::vector<std::vector<uint8_t>> storage;      // what `buffers` points into
};

// Errors do not name the file; the caller does.
Result<GltfFile> readGltfFile(const std::string& path);

}  // namespace skinbench
