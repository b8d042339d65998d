// Optimal Simplex Sampling: the three smaller of four sorted blend weights as the number of a grid point
// (docs/codecs.md 6; Kuth, Meyer, "Vertex-Blend Attribute Compression", HPG 2021).
//
// The grid point (i, j, k) stands for w4 = k s, w3 = (j + k) s, w2 = (i + j + k) s, w1 = 1 - w2 - w3 - w4. Points are
// numbered with k outermost, then j, then i.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "common/core/result.h"

namespace skinbench {

struct SimplexCode {
    int bits = 0;
    uint64_t n = 0;      // the grid has n points along w2 where w3 = w4 = 0
    uint64_t count = 0;  // T(n) <= 2^bits: codes are 0..count-1
    double step = 0;     // s = 0.5 / (n - 1)
    bool operator==(const SimplexCode&) const = default;
};

struct SimplexPoint {
    uint64_t i = 0;
    uint64_t j = 0;
    uint64_t k = 0;
    bool operator==(const SimplexPoint&) const = default;
};

inline constexpr int kMaxSimplexBits = 48;
inline constexpr int kMaxSimplexBits32 = 26;  // up to here 32-bit integers and single precision decode every code

// The finest grid for `bits`, 1 to 48 (from there on double precision no longer resolves a step).
Result<SimplexCode> makeSimplexCode(int bits);

// 16 bits, as in the thesis: n = 104, 65231 codes.
const SimplexCode& simplexCode16();

// `weights` descending, sum 1. In double precision; weights out of range (NaN, negative) land on the nearest bound.
uint64_t encodeSimplex(const SimplexCode& code, glm::vec4 weights);

// Fails for count and above.
Result<SimplexPoint> decodeSimplexPoint(const SimplexCode& code, uint64_t value);

// The same with 32-bit integers and a single-precision estimate, step by step what a shader does. At most 26 bits and
// `value` below count, or the result means nothing.
SimplexPoint decodeSimplexPoint32(const SimplexCode& code, uint32_t value);

// The inverse of decodeSimplexPoint; 2 i + 3 j + 4 k <= 2 (n - 1) must hold.
uint64_t encodeSimplexPoint(const SimplexCode& code, SimplexPoint point);

// Descending, sum 1.
glm::vec4 simplexWeights(const SimplexCode& code, SimplexPoint point);
Result<glm::vec4> decodeSimplex(const SimplexCode& code, uint64_t value);

}  // namespace skinbench
