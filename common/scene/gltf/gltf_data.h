// The numbers of a glTF asset: buffer views and accessors, with every range checked before a byte is read, and one
// budget for all that is decoded.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/core/result.h"
#include "common/scene/gltf/gltf_notes.h"

namespace skinbench {

enum GltfComponent {
    kGltfI8 = 5120,
    kGltfU8 = 5121,
    kGltfI16 = 5122,
    kGltfU16 = 5123,
    kGltfU32 = 5125,
    kGltfF32 = 5126
};

// Instances, shared accessors, accessors without data and compression all let a small file ask for much. What the file
// becomes in memory may be kGltfBudgetFactor times as large as its bytes (those of its buffers' files included), and
// kGltfBudgetFloor bytes on top.
inline constexpr uint64_t kGltfBudgetFactor = 64;
inline constexpr uint64_t kGltfBudgetFloor = 128ull << 20;

struct GltfBudget {
    uint64_t left = kGltfBudgetFloor;
};
// `count` things of `bytes` bytes each, before they are made.
Result<void> spend(GltfBudget& budget, uint64_t count, uint64_t bytes);

// A bufferView under EXT_meshopt_compression or KHR_meshopt_compression.
struct CompressedView {
    std::string extension;
    uint64_t buffer = 0, offset = 0, length = 0;
    std::span<const uint8_t> bytes;
    uint64_t count = 0;
    uint64_t stride = 0;
    std::string mode;    // ATTRIBUTES, TRIANGLES, INDICES
    std::string filter;  // NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL, COLOR
};
Result<std::vector<uint8_t>> decompressView(const CompressedView& view, GltfBudget& budget);

struct GltfView {
    std::span<const uint8_t> bytes;
    uint64_t stride = 0;                   // 0: tightly packed
    std::optional<CompressedView> packed;  // until it is first used
    std::string fault;                     // why it cannot be used
};

struct GltfSparse {
    uint64_t count = 0;
    int indexView = -1;
    uint64_t indexOffset = 0;
    int indexComponent = 0;
    int valueView = -1;
    uint64_t valueOffset = 0;
};

// What an accessor says of its own elements, a number each component; empty where it says nothing of that size.
struct GltfBounds {
    std::vector<float> min, max;
};

struct GltfAccessor {
    int view = -1;  // -1: zeros
    uint64_t offset = 0;
    uint64_t count = 0;
    int component = 0;
    int components = 0;  // 1 for SCALAR … 16 for MAT4
    bool normalized = false;
    std::optional<GltfSparse> sparse;
    GltfBounds bounds;
    std::string fault;
};

// Elements of equal size that are known to lie inside their view. Null: zeros.
struct GltfElements {
    const uint8_t* first = nullptr;
    uint64_t stride = 0;
};

// An accessor that is ready to be read element by element; the elements themselves are not copied.
struct GltfColumn {
    GltfElements elements;
    uint64_t count = 0;
    int component = 0;
    int components = 0;
    bool normalized = false;
    bool misaligned = false;
    GltfElements values;                                // of sparse elements
    std::vector<std::pair<uint32_t, uint32_t>> sparse;  // element -> its place in `values`, ascending
};

struct GltfData {
    std::vector<GltfView> views;
    std::vector<GltfAccessor> accessors;
    std::map<int, std::unique_ptr<GltfColumn>> columns;  // those that were opened
    std::vector<std::vector<uint8_t>> storage;           // of decompressed views
    GltfBudget budget;
    bool quantization = false;  // the file uses KHR_mesh_quantization
    std::set<int> wrongBounds;  // accessors that were noted
};

// Opened once and shared. Errors name the accessor.
Result<const GltfColumn*> openColumn(GltfData& data, int accessor, int components);

// Refuses all but the unsigned types with at most `maxComponentBytes` bytes each.
Result<const GltfColumn*> openIndexColumn(GltfData& data, int accessor, int components, int maxComponentBytes);

// `column.components` values. Integers are divided by their range where the accessor says so, or with `normalized`.
void readElement(const GltfColumn& column, uint64_t element, float* out, bool normalized = false);
void readElement(const GltfColumn& column, uint64_t element, uint32_t* out);

// Notes an accessor of floats whose bounds are missing or other than `found`. Where only a part of its elements was
// read, bounds may be wider. glTF 2.0, section 3.6.2.5.
void noteBounds(GltfData& data, int accessor, const GltfBounds& found, bool all, GltfNotes& notes);

// The first `count` elements, or all.
Result<std::vector<float>> readFloats(GltfData& data, int accessor, int components, bool normalized = false,
                                      uint64_t count = UINT64_MAX);

}  // namespace skinbench
