// The attribute codec of KHR_meshopt_compression (appendix A, mode 0, versions 0 and 1) and the filters of its appendix
// B. Debian's meshoptimizer reads version 0 only. Indices (modes 1 and 2) are the same in both extensions and are left
// to that library.
#pragma once

#include <cstdint>
#include <span>

#include "common/core/result.h"

namespace skinbench {

// `out` holds whole elements of `stride` bytes: 4 to 256, a multiple of 4. No byte beyond `source` is read; bytes that
// are left over or missing are an error.
Result<void> decodeMeshoptAttributes(std::span<const uint8_t> source, uint64_t stride, std::span<uint8_t> out);

// In place. `bytes` holds whole elements; the strides that each filter allows are the caller's to check.
void decodeMeshoptOctahedral(std::span<uint8_t> bytes, uint64_t stride);  // 4 or 8
void decodeMeshoptQuaternion(std::span<uint8_t> bytes);                   // 8
void decodeMeshoptExponential(std::span<uint8_t> bytes);                  // a multiple of 4
void decodeMeshoptColor(std::span<uint8_t> bytes, uint64_t stride);       // 4 or 8

}  // namespace skinbench
