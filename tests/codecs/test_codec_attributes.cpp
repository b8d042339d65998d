#include <cmath>
#include <limits>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include "common/codecs/attributes.h"
#include "tests/codec_test.h"

using namespace skinbench;
using namespace skinbench::test;
using Catch::Approx;

namespace {

const PositionGrid kUnit{glm::vec3(0), glm::vec3(1)};
constexpr int kPositionBits[] = {8, 10, 16, 21};

// Evenly spread in the unit cube, whose corners fix the grid.
Mesh uniformCube(uint32_t count) {
    Random random(11);
    Mesh mesh;
    mesh.positions = {glm::vec3(0), glm::vec3(1)};
    for (uint32_t i = 0; i < count; ++i) mesh.positions.emplace_back(random.unit(), random.unit(), random.unit());
    return mesh;
}

Mesh uniformSphere(uint32_t count) {
    Random random(12);
    Mesh mesh;
    for (uint32_t i = 0; i < count; ++i) mesh.normals.push_back(randomDirection(random));
    return mesh;
}

}  // namespace

TEST_CASE("position errors are those of table 2.1") {
    const Mesh mesh = uniformCube(1'000'000);
    struct Row {
        int bits;
        double floorMean, nearestMean;
    };
    for (const Row row :
         {Row{8, 3.767e-3, 1.883e-3}, {10, 9.390e-4, 4.695e-4}, {16, 1.466e-5, 7.33e-6}, {21, 4.27e-7, 2.31e-7}}) {
        CAPTURE(row.bits);
        const double s = quantizerSteps(row.bits);
        const ErrorFigure floor = positionError(mesh, row.bits, Rounding::floor);
        const ErrorFigure nearest = positionError(mesh, row.bits);
        CHECK(floor.mean == Approx(row.floorMean).epsilon(0.01));
        CHECK(nearest.mean == Approx(row.nearestMean).epsilon(0.01));
        CHECK(floor.max <= std::sqrt(3.0) / s * 1.15);
        CHECK(floor.max > std::sqrt(3.0) / s * 0.85);
        CHECK(nearest.max <= std::sqrt(3.0) / (2 * s) * 1.15);
        CHECK(nearest.max > std::sqrt(3.0) / (2 * s) * 0.9);
    }
}

TEST_CASE("normal errors are those of table 2.2") {
    const Mesh mesh = uniformSphere(1'000'000);
    const auto check = [](ErrorFigure figure, double mean, double max) {
        CHECK(figure.mean == Approx(mean).epsilon(0.01));
        CHECK(figure.max <= max * 1.01);
        CHECK(figure.max > max * 0.9);
    };
    check(euclideanRawError(mesh), 9.39e-4, 1.69e-3);
    check(euclideanRawError(mesh, Rounding::floor), 1.88e-3, 3.37e-3);
    check(normalError(mesh, NormalFormat::euclidean), 7.38e-4, 1.68e-3);
    check(normalError(mesh, NormalFormat::euclidean, Rounding::floor), 1.48e-3, 3.36e-3);
    check(normalError(mesh, NormalFormat::spherical), 2.41e-5, 5.35e-5);
    check(normalError(mesh, NormalFormat::spherical, Rounding::floor), 4.82e-5, 1.07e-4);
    check(normalError(mesh, NormalFormat::octahedral), 2.28e-5, 6.45e-5);
    check(normalError(mesh, NormalFormat::octahedral, Rounding::floor), 4.56e-5, 1.29e-4);
}

TEST_CASE("decoding and encoding a position again changes nothing") {
    for (const int bits : kPositionBits) {
        CAPTURE(bits);
        uint32_t changed = 0;
        for (uint32_t q = 0; q <= quantizerSteps(bits); ++q) {
            const glm::vec3 p = dequantizePosition(glm::uvec3(q), kUnit, bits);
            changed += quantizePosition(p, kUnit, bits, Rounding::floor) != glm::uvec3(q);
            changed += quantizePosition(p, kUnit, bits, Rounding::nearest) != glm::uvec3(q);
        }
        CHECK(changed == 0);
    }
}

TEST_CASE("a position is off by half a step at most, at every offset and scale") {
    Random random(5);
    for (const float offset : {0.0f, -1000.0f, 1e-3f}) {
        for (const float extent : {1e-6f, 1.0f, 12345.0f}) {
            const PositionGrid grid{glm::vec3(offset), glm::vec3(extent)};
            for (int i = 0; i < 2000; ++i) {
                const glm::vec3 p = glm::vec3(offset) + extent * static_cast<float>(random.unit());
                const glm::vec3 q = dequantizePosition(quantizePosition(p, grid, 16), grid, 16);
                const float step = extent / 65535 / 2 + 4 * std::abs(offset) * std::numeric_limits<float>::epsilon();
                CHECK(std::abs(q.x - p.x) <= step + extent * 2e-7f);
            }
        }
    }
}

TEST_CASE("corners of the grid are exact and what lies outside is clamped") {
    const Mesh mesh = randomMesh(1, 300, 5);
    const PositionGrid grid = positionGrid(mesh.positions);
    CHECK(quantizePosition(grid.min, grid, 16) == glm::uvec3(0));
    CHECK(quantizePosition(grid.min + grid.extent, grid, 16) == glm::uvec3(65535));
    CHECK(quantizePosition(grid.min - 1.0f, grid, 21) == glm::uvec3(0));
    CHECK(quantizePosition(grid.min + grid.extent * 9.0f, grid, 21, Rounding::floor) == glm::uvec3(0x1FFFFF));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    for (const Rounding rounding : {Rounding::nearest, Rounding::floor}) {
        CHECK(quantizePosition({nan, infinite, -infinite}, kUnit, 16, rounding) == glm::uvec3(0, 65535, 0));
    }
}

TEST_CASE("grids of degenerate input") {
    CHECK(positionGrid({}).min == glm::vec3(0));
    CHECK(positionGrid({}).extent == glm::vec3(0));
    const std::vector<glm::vec3> negative{{-5, -6, -7}, {-3, -6, -1}};  // bounds start at -FLT_MAX, not at FLT_MIN
    CHECK(positionGrid(negative).min == glm::vec3(-5, -6, -7));
    CHECK(positionGrid(negative).extent == glm::vec3(2, 0, 6));
    const glm::vec3 flat =
        dequantizePosition(quantizePosition({-4, -6, -2}, positionGrid(negative), 16), positionGrid(negative), 16);
    CHECK(flat.y == -6);
    const float huge = std::numeric_limits<float>::max();
    const std::vector<glm::vec3> wide{glm::vec3(-huge), glm::vec3(huge)};
    for (const glm::vec3& p : wide) {
        const glm::vec3 q = dequantizePosition(quantizePosition(p, positionGrid(wide), 16), positionGrid(wide), 16);
        CHECK(std::isfinite(q.x));
    }
}

TEST_CASE("texture coordinates outside 0..1 keep their range") {
    const Mesh mesh = randomMesh(2, 2000, 5);
    const UvGrid grid = uvGrid(mesh.uvs);
    CHECK(grid.min.x < -0.4f);
    for (const glm::vec2 uv : mesh.uvs) {
        const glm::vec2 back = dequantizeUv(quantizeUv(uv, grid), grid);
        CHECK(std::abs(back.x - uv.x) <= grid.extent.x / 65535 * 0.51f);
        CHECK(std::abs(back.y - uv.y) <= grid.extent.y / 65535 * 0.51f);
    }
    CHECK(uvError(mesh).max <= std::sqrt(2.0) / 65535 * 0.51);
    CHECK(uvError(mesh).mean * 1.8 < uvError(mesh, Rounding::floor).mean);
    CHECK(quantizeUv({0.5f, 7}, UvGrid{}) == glm::uvec2(0));
}

TEST_CASE("packed positions have the specified bits") {
    CHECK(packPosition10({1, 2, 3}) == (1u | 2u << 10 | 3u << 20));
    CHECK(packPosition21({0x1FFFFF, 0, 0}) == std::array{0xFFFFF800u, 0u});
    CHECK(packPosition21({0, 0x1FFFFF, 0}) == std::array{0x7FFu, 0xFFC00000u});
    CHECK(packPosition21({0, 0, 0x1FFFFF}) == std::array{0u, 0x1FFFFFu});
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
        const glm::uvec3 q(random.below(1 << 21), random.below(1 << 21), random.below(1 << 21));
        CHECK(unpackPosition21(packPosition21(q)) == q);
        CHECK(unpackPosition10(packPosition10(q >> 11u)) == q >> 11u);
    }
}

TEST_CASE("octahedral axes and folds") {
    const auto encode = [](glm::vec3 n) { return encodeNormal(n, NormalFormat::octahedral); };
    const auto decode = [](uint32_t w) { return decodeNormal(w, NormalFormat::octahedral); };
    CHECK(encode({0, 0, -1}) == 0xFFFFFFFF);
    CHECK(decode(0xFFFFFFFF) == glm::vec3(0, 0, -1));
    CHECK(encode({1, 0, 0}) == (0xFFFFu | 0x8000u << 16));
    CHECK(encode({0, 0, 1}) == 0x80008000);
    CHECK(glm::distance(decode(0x80008000), glm::vec3(0, 0, 1)) == Approx(2.2e-5).epsilon(0.03));
    for (const glm::vec3 n : {glm::vec3(1, 0, 0),
                              {-1, 0, 0},
                              {0, 1, 0},
                              {0, -1, 0},
                              {0, 0, 1},
                              {0, 0, -1},
                              {1, 0, -1e-3f},
                              {-1e-8f, 0, -1},
                              {0, -0.0f, -1},
                              {1, 1, -1},
                              {-1, -1, -1}}) {
        CAPTURE(n.x, n.y, n.z);
        CHECK(glm::distance(decode(encode(n)), glm::normalize(n)) < 6.6e-5f);
    }
}

TEST_CASE("vectors without a direction become +z; length does not matter") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    for (const NormalFormat format : {NormalFormat::euclidean, NormalFormat::spherical, NormalFormat::octahedral}) {
        const uint32_t up = encodeNormal({0, 0, 1}, format);
        CHECK(encodeNormal({0, 0, 0}, format) == up);
        CHECK(encodeNormal({nan, 1, 0}, format) == up);
        CHECK(encodeNormal({infinite, 0, 0}, format) == up);
        CHECK(encodeNormal({3e-30f, 4e-30f, 0}, format) == encodeNormal({3, 4, 0}, format));
        CHECK(encodeNormal({3e30f, 4e30f, 0}, format) == encodeNormal({3, 4, 0}, format));
    }
}

TEST_CASE("any word decodes to a unit normal") {
    Random random(4);
    for (int i = 0; i < 100'000; ++i) {
        const uint32_t word = i < 4 ? 0xFFFFFFFFu * (i & 1) ^ 0xFFFFu * (i >> 1) : static_cast<uint32_t>(random.next());
        for (const NormalFormat format : {NormalFormat::euclidean, NormalFormat::spherical, NormalFormat::octahedral}) {
            const float length = glm::length(decodeNormal(word, format));
            if (!(std::abs(length - 1) < 1e-5f)) FAIL_CHECK("word " << word << " has length " << length);
        }
    }
}

TEST_CASE("error figures of degenerate meshes are zero where nothing can be lost") {
    for (const auto& [name, mesh] : degenerateMeshes()) {
        CAPTURE(name);
        const ErrorFigure p = positionError(mesh, 16);
        CHECK(p.mean <= p.max);
        CHECK(p.max <= std::sqrt(3.0) / 65535 * 0.51);
        if (name == "one point") CHECK(p.max == 0);
        if (name == "constant uv") CHECK(uvError(mesh).max == 0);
    }
    CHECK(positionError(Mesh{}, 16).mean == 0);
    CHECK(normalError(Mesh{}, NormalFormat::octahedral).mean == 0);
}
