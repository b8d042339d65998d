// The container of a glTF 2.0 asset: reads the file, takes a GLB apart, loads the buffers. scene_gltf.cpp gives the
// text in `tree` to tinygltf.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.h"
#include "common/scene/gltf/gltf_tree.h"

namespace skinbench {

struct GltfBuffer {
    std::span<const uint8_t> bytes;
    std::string fault;  // why there are none; what does not use them does not mind
};

struct GltfFile {
    GltfTree tree;
    std::vector<GltfBuffer> buffers;
    std::vector<std::vector<uint8_t>> storage;  // what `buffers` points into; each file once
    uint64_t size = 0;                          // of all files together
};

// Errors do not name the file; the caller does.
Result<GltfFile> readGltfFile(const std::string& path);

}  // namespace skinbench
