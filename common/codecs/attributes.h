// Quantised positions, texture coordinates and normals (docs/codecs.md 1; Kimmersdorfer 2.1.1 to 2.1.3).
//
// Every integer q lies in 0..S with S = 2^bits - 1 and decodes to q / S. Divide: a multiplication with 1 / S differs in
// the last bit for 512 of the 65536 values of 16 bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "common/scene/scene.h"

namespace skinbench {

// nearest is what every codec stores. floor is what the thesis' program stores: twice the error, single precision; it
// reproduces table 2.1.
enum class Rounding { nearest, floor };

inline constexpr uint32_t quantizerSteps(int bits) { return (1u << bits) - 1; }  // S, for 1 to 24 bits

// --- positions and texture coordinates -------------------------------------------------------------------------

// value = q / S * extent + min, per axis. An axis without extent always has q = 0. Meshes that share a border share a
// grid, or the border cracks. No input: all zero. An extent beyond the range of float is cut to the largest float.
struct PositionGrid {
    glm::vec3 min{0};
    glm::vec3 extent{0};
};

struct UvGrid {
    glm::vec2 min{0};
    glm::vec2 extent{0};
};

PositionGrid positionGrid(std::span<const glm::vec3> positions);
UvGrid uvGrid(std::span<const glm::vec2> uvs);

// bits is 8, 10, 16 or 21 in the thesis; 1 to 24 work. Values outside the grid are clamped, NaN becomes 0.
glm::uvec3 quantizePosition(glm::vec3 position, const PositionGrid& grid, int bits,
                            Rounding rounding = Rounding::nearest);
glm::vec3 dequantizePosition(glm::uvec3 q, const PositionGrid& grid, int bits);

// 16 bits an axis.
glm::uvec2 quantizeUv(glm::vec2 uv, const UvGrid& grid, Rounding rounding = Rounding::nearest);
glm::vec2 dequantizeUv(glm::uvec2 q, const UvGrid& grid);

// 8 bits: three bytes x, y, z.  16 bits: three u16 x, y, z.
//
// 10 bits: [31:30] zero  [29:20] z  [19:10] y  [9:0] x
uint32_t packPosition10(glm::uvec3 q);
glm::uvec3 unpackPosition10(uint32_t word);

// 21 bits, word 0: [31:11] x  [10:0] upper 11 bits of y
//          word 1: [31:22] lower 10 bits of y  [21] zero  [20:0] z
std::array<uint32_t, 2> packPosition21(glm::uvec3 q);
glm::uvec3 unpackPosition21(std::array<uint32_t, 2> words);

// --- normals in 32 bits ----------------------------------------------------------------------------------------

// euclidean   [31:30] zero  [29:20] z  [19:10] y  [9:0] x
// spherical   [31:16] polar angle / pi            [15:0] (azimuth + pi) / 2 pi
// octahedral  [31:16] v                           [15:0] u; what every codec stores
enum class NormalFormat { euclidean, spherical, octahedral };

// The input is normalised first; zero, NaN and infinite vectors become (0, 0, 1).
uint32_t encodeNormal(glm::vec3 normal, NormalFormat format, Rounding rounding = Rounding::nearest);

// Any word decodes to a unit vector.
glm::vec3 decodeNormal(uint32_t word, NormalFormat format);

// Before renormalisation, as table 2.2 of the thesis measures the Euclidean format; each axis lies in -1..1.
glm::vec3 decodeEuclideanRaw(uint32_t word);

// --- error figures ---------------------------------------------------------------------------------------------

struct ErrorFigure {
    double mean = 0;
    double max = 0;
};

// Thesis equation 2.4 (table 2.1): distance between the normalised positions (the grid is the unit cube) before and
// after coding. No vertices: zero.
ErrorFigure positionError(const Mesh& mesh, int bits, Rounding rounding = Rounding::nearest);

// The same for texture coordinates at 16 bits, in the unit square.
ErrorFigure uvError(const Mesh& mesh, Rounding rounding = Rounding::nearest);

// Table 2.2: distance between the unit normals before and after coding.
ErrorFigure normalError(const Mesh& mesh, NormalFormat format, Rounding rounding = Rounding::nearest);
ErrorFigure euclideanRawError(const Mesh& mesh, Rounding rounding = Rounding::nearest);

}  // namespace skinbench
