// The numbers of a glTF asset: buffer views and accessors, with every range checked before a byte is read.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.h"

namespace skinbench {

enum GltfComponent {
    kGltfI8 = 5120,
    kGltfU8 = 5121,
    kGltfI16 = 5122,
    kGltfU16 = 5123,
    kGltfU32 = 5125,
    kGltfF32 = 5126
};

struct GltfView {
    std::span<const uint8_t> bytes;
    uint64_t stride = 0;  // 0: tightly packed
};

struct GltfSparse {
    uint64_t count = 0;
    int indexView = -1;
    uint64_t indexOffset = 0;
    int indexComponent = 0;
    int valueView = -1;
    uint64_t valueOffset = 0;
};

struct GltfAccessor {
    int view = -1;  // -1: zeros
    uint64_t offset = 0;
    uint64_t count = 0;
    int component = 0;
    int components = 0;  // 1 for SCALAR … 16 for MAT4
    bool normalized = false;
    std::optional<GltfSparse> sparse;
};

struct GltfData {
    std::vector<GltfView> views;
    std::vector<GltfAccessor> accessors;
    std::vector<std::vector<uint8_t>> storage;  // of decompressed views
};

// `components` values an element, one element after the other. Integers are divided by their range where the
// accessor says so, or always with `alwaysNormalized`.
Result<std::vector<float>> readFloats(const GltfData& data, int accessor, int components,
                                      bool alwaysNormalized = false);

// Accepts the unsigned types only, with at most `maxComponentBytes` bytes each.
Result<std::vector<uint32_t>> readUnsigned(const GltfData& data, int accessor, int components, int maxComponentBytes);

// A bufferView under EXT_meshopt_compression.
struct CompressedView {
    std::span<const uint8_t> bytes;
    uint64_t count = 0;
    uint64_t stride = 0;
    std::string mode;    // ATTRIBUTES, TRIANGLES, INDICES
    std::string filter;  // NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL
};
Result<std::vector<uint8_t>> decompressView(const CompressedView& view);

}  // namespace skinbench
