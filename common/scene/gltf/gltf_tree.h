// The JSON of a glTF asset: hands on text in which every index and size is known to be a whole number that is not
// negative, for tinygltf to take apart, and beside it what that library does not keep.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/core/result.h"
#include "common/scene/gltf/gltf_data.h"
#include "common/scene/gltf/gltf_extensions.h"
#include "common/scene/gltf/gltf_notes.h"

namespace skinbench {

// A part of the file that is broken by itself: what does not use it does not mind. Index -> what is wrong.
using GltfFaults = std::map<size_t, std::string>;

struct GltfTree {
    std::string json;                         // without images, materials, cameras, buffers and extras
    std::map<size_t, CompressedView> packed;  // bufferView -> how it is compressed; `bytes` is still empty
    std::set<size_t> hidden;                  // nodes
    GltfFaults views, accessors, meshes, skins, animations;  // each is an empty one in `json`
    FoundExtensions extensions;
    std::map<size_t, GltfBounds> bounds;  // of accessors
    bool quantization = false;            // KHR_mesh_quantization is listed
    GltfNotes notes;
};

// `bytes`: UTF-8, with or without a byte order mark.
Result<nlohmann::json> parseGltfJson(std::span<const uint8_t> bytes);

// Takes from `tree` what it needs; buffers stay.
Result<GltfTree> checkGltfTree(nlohmann::json& tree);

// The two extensions are read alike. Null: `object` has neither.
const nlohmann::json* findMeshopt(const nlohmann::json& object);

// `object[key]` as a whole number from 0 to `limit`, if it is there; 12.0 becomes 12.
Result<void> checkWholeNumber(nlohmann::json& object, const std::string& where, const char* key, uint64_t limit);

inline constexpr uint64_t kMaxGltfSize = 1ull << 48;

}  // namespace skinbench
