#include "common/codecs/attributes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/core/parallel.h"

namespace skinbench {
namespace {

constexpr int kUvBits = 16;
constexpr int kEuclideanBits = 10;
constexpr int kNormalBits = 16;
constexpr uint32_t kMask10 = 0x3FF;
constexpr uint32_t kMask21 = 0x1FFFFF;

template <int N>
using Vec = glm::vec<N, float>;

template <int N, class Grid>
Grid makeGrid(std::span<const Vec<N>> values) {
    constexpr float kMax = std::numeric_limits<float>::max();
    Grid grid;
    if (values.empty()) return grid;
    Vec<N> low(kMax);
    Vec<N> high(-kMax);
    const auto parts = parallelParts(values.size(), [&](size_t begin, size_t end) {
        std::pair part(Vec<N>{kMax}, Vec<N>{-kMax});
        for (const Vec<N>& v : values.subspan(begin, end - begin)) {
            part.first = glm::min(part.first, v);
            part.second = glm::max(part.second, v);
        }
        return part;
    });
    for (const auto& [begin, part] : parts) {
        low = glm::min(low, part.first);
        high = glm::max(high, part.second);
    }
    for (int a = 0; a < N; ++a) {
        if (low[a] > high[a]) continue;  // only NaN on this axis
        grid.min[a] = low[a];
        grid.extent[a] = std::min(high[a] - low[a], kMax);
    }
    return grid;
}

// Truncation is floor for what is not negative; NaN gives 0.
template <class Real>
uint32_t truncateTo(Real x, uint32_t most) {
    if (!(x > 0)) return 0;
    return x >= static_cast<Real>(most) ? most : static_cast<uint32_t>(x);
}

uint32_t quantizeNearest(double unit, uint32_t steps) { return truncateTo(unit * steps + 0.5, steps); }

// Single precision on purpose: the 21-bit column of table 2.1 depends on it.
uint32_t quantizeFloor(float unit, uint32_t steps) { return truncateTo(unit * static_cast<float>(steps), steps); }

uint32_t quantizeUnit(double unit, uint32_t steps, Rounding rounding) {
    return truncateTo(unit * steps + (rounding == Rounding::nearest ? 0.5 : 0.0), steps);
}

double unitNearest(float value, float min, float extent) {
    return extent > 0 ? (static_cast<double>(value) - min) / extent : 0.0;
}

float unitFloor(float value, float min, float extent) { return extent > 0 ? (value - min) / extent : 0.0f; }

uint32_t quantizeAxis(float value, float min, float extent, uint32_t steps, Rounding rounding) {
    return rounding == Rounding::nearest ? quantizeNearest(unitNearest(value, min, extent), steps)
                                         : quantizeFloor(unitFloor(value, min, extent), steps);
}

float dequantizeAxis(uint32_t q, float min, float extent, uint32_t steps) {
    return static_cast<float>(q) / static_cast<float>(steps) * extent + min;
}

double signNotZero(double x) { return x < 0 ? -1.0 : 1.0; }
float signNotZero(float x) { return x < 0 ? -1.0f : 1.0f; }

glm::dvec3 unitNormal(glm::vec3 normal) {
    const glm::dvec3 n(normal);
    const double length = glm::length(n);
    return length > 0 && std::isfinite(length) ? n / length : glm::dvec3(0, 0, 1);
}

uint32_t encodeEuclidean(glm::dvec3 n, Rounding rounding) {
    constexpr uint32_t s = quantizerSteps(kEuclideanBits);
    return packPosition10({quantizeUnit(n.x * 0.5 + 0.5, s, rounding), quantizeUnit(n.y * 0.5 + 0.5, s, rounding),
                           quantizeUnit(n.z * 0.5 + 0.5, s, rounding)});
}

uint32_t encodeSpherical(glm::dvec3 n, Rounding rounding) {
    constexpr uint32_t s = quantizerSteps(kNormalBits);
    const double u = (std::atan2(n.y, n.x) + std::numbers::pi) / (2 * std::numbers::pi);
    const double v = std::acos(std::clamp(n.z, -1.0, 1.0)) / std::numbers::pi;
    return quantizeUnit(u, s, rounding) | quantizeUnit(v, s, rounding) << 16;
}

uint32_t encodeOctahedral(glm::dvec3 n, Rounding rounding) {
    constexpr uint32_t s = quantizerSteps(kNormalBits);
    const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    double fx = n.x / sum;
    double fy = n.y / sum;
    if (n.z < 0) {
        const double x = fx;
        fx = (1 - std::abs(fy)) * signNotZero(x);
        fy = (1 - std::abs(x)) * signNotZero(fy);
    }
    return quantizeUnit(fx * 0.5 + 0.5, s, rounding) | quantizeUnit(fy * 0.5 + 0.5, s, rounding) << 16;
}

glm::vec3 decodeSpherical(uint32_t word) {
    constexpr float s = quantizerSteps(kNormalBits);
    constexpr float pi = std::numbers::pi_v<float>;
    const float theta = static_cast<float>(word & 0xFFFF) / s * (2 * pi) - pi;
    const float phi = static_cast<float>(word >> 16) / s * pi;
    return {std::sin(phi) * std::cos(theta), std::sin(phi) * std::sin(theta), std::cos(phi)};
}

glm::vec3 decodeOctahedral(uint32_t word) {
    constexpr float s = quantizerSteps(kNormalBits);
    const float fx = static_cast<float>(word & 0xFFFF) / s * 2 - 1;
    const float fy = static_cast<float>(word >> 16) / s * 2 - 1;
    const float z = 1 - std::abs(fx) - std::abs(fy);
    const float t = std::max(-z, 0.0f);
    return glm::normalize(glm::vec3(fx - signNotZero(fx) * t, fy - signNotZero(fy) * t, z));
}

template <class Distance>
ErrorFigure measure(size_t count, const Distance& distance) {
    ErrorFigure figure;
    double sum = 0;
    for (size_t i = 0; i < count; ++i) {
        const double d = distance(i);
        sum += d;
        figure.max = std::max(figure.max, d);
    }
    if (count > 0) figure.mean = sum / static_cast<double>(count);
    return figure;
}

// Floor is measured in single precision like the thesis, nearest against the exact normalised value.
double axisError(float value, float min, float extent, uint32_t steps, Rounding rounding) {
    const uint32_t q = quantizeAxis(value, min, extent, steps, rounding);
    const float decoded = static_cast<float>(q) / static_cast<float>(steps);
    return rounding == Rounding::nearest ? decoded - unitNearest(value, min, extent)
                                         : decoded - unitFloor(value, min, extent);
}

}  // namespace

PositionGrid positionGrid(std::span<const glm::vec3> positions) { return makeGrid<3, PositionGrid>(positions); }
UvGrid uvGrid(std::span<const glm::vec2> uvs) { return makeGrid<2, UvGrid>(uvs); }

glm::uvec3 quantizePosition(glm::vec3 position, const PositionGrid& grid, int bits, Rounding rounding) {
    SKINBENCH_ASSERT(bits >= 1 && bits <= 24);
    glm::uvec3 q;
    for (int a = 0; a < 3; ++a) {
        q[a] = quantizeAxis(position[a], grid.min[a], grid.extent[a], quantizerSteps(bits), rounding);
    }
    return q;
}

glm::vec3 dequantizePosition(glm::uvec3 q, const PositionGrid& grid, int bits) {
    SKINBENCH_ASSERT(bits >= 1 && bits <= 24);
    glm::vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = dequantizeAxis(q[a], grid.min[a], grid.extent[a], quantizerSteps(bits));
    return p;
}

glm::uvec2 quantizeUv(glm::vec2 uv, const UvGrid& grid, Rounding rounding) {
    constexpr uint32_t s = quantizerSteps(kUvBits);
    return {quantizeAxis(uv.x, grid.min.x, grid.extent.x, s, rounding),
            quantizeAxis(uv.y, grid.min.y, grid.extent.y, s, rounding)};
}

glm::vec2 dequantizeUv(glm::uvec2 q, const UvGrid& grid) {
    constexpr uint32_t s = quantizerSteps(kUvBits);
    return {dequantizeAxis(q.x, grid.min.x, grid.extent.x, s), dequantizeAxis(q.y, grid.min.y, grid.extent.y, s)};
}

uint32_t packPosition10(glm::uvec3 q) { return (q.x & kMask10) | (q.y & kMask10) << 10 | (q.z & kMask10) << 20; }

glm::uvec3 unpackPosition10(uint32_t word) { return {word & kMask10, word >> 10 & kMask10, word >> 20 & kMask10}; }

std::array<uint32_t, 2> packPosition21(glm::uvec3 q) {
    return {q.x << 11 | (q.y & kMask21) >> 10, q.y << 22 | (q.z & kMask21)};
}

glm::uvec3 unpackPosition21(std::array<uint32_t, 2> words) {
    return {words[0] >> 11, (words[0] & 0x7FF) << 10 | words[1] >> 22, words[1] & kMask21};
}

uint32_t encodeNormal(glm::vec3 normal, NormalFormat format, Rounding rounding) {
    const glm::dvec3 n = unitNormal(normal);
    switch (format) {
        case NormalFormat::euclidean:
            return encodeEuclidean(n, rounding);
        case NormalFormat::spherical:
            return encodeSpherical(n, rounding);
        case NormalFormat::octahedral:
            break;
    }
    return encodeOctahedral(n, rounding);
}

glm::vec3 decodeEuclideanRaw(uint32_t word) {
    constexpr float s = quantizerSteps(kEuclideanBits);
    return glm::vec3(unpackPosition10(word)) / s * 2.0f - 1.0f;
}

glm::vec3 decodeNormal(uint32_t word, NormalFormat format) {
    switch (format) {
        case NormalFormat::euclidean:
            return glm::normalize(decodeEuclideanRaw(word));  // S is odd: never zero
        case NormalFormat::spherical:
            return decodeSpherical(word);
        case NormalFormat::octahedral:
            break;
    }
    return decodeOctahedral(word);
}

ErrorFigure positionError(const Mesh& mesh, int bits, Rounding rounding) {
    SKINBENCH_ASSERT(bits >= 1 && bits <= 24);
    const PositionGrid grid = positionGrid(mesh.positions);
    return measure(mesh.positions.size(), [&](size_t i) {
        glm::dvec3 d;
        for (int a = 0; a < 3; ++a) {
            d[a] = axisError(mesh.positions[i][a], grid.min[a], grid.extent[a], quantizerSteps(bits), rounding);
        }
        return glm::length(d);
    });
}

ErrorFigure uvError(const Mesh& mesh, Rounding rounding) {
    constexpr uint32_t s = quantizerSteps(kUvBits);
    const UvGrid grid = uvGrid(mesh.uvs);
    return measure(mesh.uvs.size(), [&](size_t i) {
        const glm::vec2 uv = mesh.uvs[i];
        return glm::length(glm::dvec2(axisError(uv.x, grid.min.x, grid.extent.x, s, rounding),
                                      axisError(uv.y, grid.min.y, grid.extent.y, s, rounding)));
    });
}

ErrorFigure normalError(const Mesh& mesh, NormalFormat format, Rounding rounding) {
    return measure(mesh.normals.size(), [&](size_t i) {
        const uint32_t word = encodeNormal(mesh.normals[i], format, rounding);
        return glm::distance(unitNormal(mesh.normals[i]), glm::dvec3(decodeNormal(word, format)));
    });
}

ErrorFigure euclideanRawError(const Mesh& mesh, Rounding rounding) {
    return measure(mesh.normals.size(), [&](size_t i) {
        const uint32_t word = encodeNormal(mesh.normals[i], NormalFormat::euclidean, rounding);
        return glm::distance(unitNormal(mesh.normals[i]), glm::dvec3(decodeEuclideanRaw(word)));
    });
}

}  // namespace skinbench
