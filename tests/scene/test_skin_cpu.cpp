#include <limits>
#include <random>

#include <catch2/catch_test_macros.hpp>

#include "common/scene/skin_cpu.h"

using namespace skinbench;

namespace {

Palette randomPalette(size_t joints, uint32_t seed) {
    std::mt19937 random(seed);
    const auto next = [&] { return static_cast<float>(random()) / 4294967296.0f * 2 - 1; };
    Palette palette(joints);
    for (PaletteEntry& entry : palette) {
        const glm::quat q = glm::normalize(glm::quat(next(), next(), next(), next()));
        const glm::mat3 m = glm::mat3_cast(q);
        for (int row = 0; row < 3; ++row) entry.rows[row] = {m[0][row], m[1][row], m[2][row], next()};
    }
    return palette;
}

Mesh scatteredMesh(size_t vertices, size_t joints, uint32_t seed) {
    std::mt19937 random(seed);
    const auto next = [&] { return static_cast<float>(random()) / 4294967296.0f * 2 - 1; };
    Mesh mesh;
    for (size_t v = 0; v < vertices; ++v) {
        mesh.positions.push_back({next(), next(), next()});
        mesh.normals.push_back(glm::normalize(glm::vec3(next(), next(), 1.5f)));
        mesh.uvs.push_back({next(), next()});
        Influences influences;
        for (int k = 0; k < 3; ++k) {
            influences.joints[k] = static_cast<uint16_t>(random() % joints);
            influences.weights[k] = next() + 1;
        }
        mesh.influences.push_back(influences);
    }
    mesh.indices = {0, 1, 2};
    cleanWeights(mesh, 4);
    return mesh;
}

}  // namespace

TEST_CASE("two joints by hand") {
    Palette palette(2);
    palette[0].rows[0].w = 4;  // moves by 4 in x
    palette[1].rows = {glm::vec4{0, -1, 0, 0}, glm::vec4{1, 0, 0, 0},
                       glm::vec4{0, 0, 1, 0}};  // turns by 90 degrees around z
    Mesh mesh;
    mesh.positions = {{1, 2, 3}, {1, 0, 0}};
    mesh.normals = {{1, 0, 0}, {1, 0, 0}};
    mesh.uvs = {{0, 0}, {0, 0}};
    mesh.influences = {{{0, kNoJoint}, {1, 0}}, {{0, 1, kNoJoint}, {0.75f, 0.25f, 0}}};
    const auto skinned = skinReference(mesh, palette);
    CHECK(skinned.positions[0] == glm::dvec3(5, 2, 3));
    CHECK(skinned.normals[0] == glm::dvec3(1, 0, 0));
    CHECK(skinned.positions[1] == glm::dvec3(0.75 * 5, 0.25, 0));
    CHECK(glm::length(skinned.normals[1] - glm::normalize(glm::dvec3(3, 1, 0))) < 1e-15);
}

TEST_CASE("skinOnCpu agrees with the reference for any number of threads") {
    const size_t vertices = 1013, copies = 3;
    std::vector<Mesh> meshes;
    std::vector<Palette> palettes;
    for (size_t c = 0; c < copies; ++c) {
        meshes.push_back(scatteredMesh(vertices, 20, 7));
        palettes.push_back(randomPalette(20, 100 + static_cast<uint32_t>(c)));
    }
    std::vector<SkinnedVertex> first;
    for (const unsigned threads : {0u, 1u, 2u, 3u, 7u, 64u}) {
        std::vector<SkinnedVertex> out(vertices * copies);
        skinOnCpu({meshes, palettes, out}, threads);
        for (size_t c = 0; c < copies; ++c) {
            const auto reference = skinReference(meshes[c], palettes[c]);
            const SkinError error = compareSkinned(reference, std::span(out).subspan(c * vertices, vertices), 1);
            CHECK(error.position < 2e-6);
            CHECK(error.normal < 2e-5);
            CHECK(error.position > 0);
            CHECK(out[c * vertices + 5].u == meshes[c].uvs[5].x);
            CHECK(out[c * vertices + 5].v == meshes[c].uvs[5].y);
        }
        if (first.empty()) first = out;
        CHECK(std::memcmp(first.data(), out.data(), out.size() * sizeof(SkinnedVertex)) == 0);
    }
}

TEST_CASE("skinOnCpu accepts fewer vertices than threads, and nothing") {
    const std::vector<Mesh> meshes = {scatteredMesh(3, 2, 1)};
    const std::vector<Palette> palettes = {randomPalette(2, 1)};
    std::vector<SkinnedVertex> out(3);
    skinOnCpu({meshes, palettes, out}, 16);
    CHECK(compareSkinned(skinReference(meshes[0], palettes[0]), out, 1).position < 1e-6);
    skinOnCpu({}, 4);
}

TEST_CASE("a normal without a direction is not compared, its position is") {
    Palette palette(3);
    palette[0].rows[0] = glm::vec4(0);  // flat in x
    palette[2].rows[0].x = palette[2].rows[1].y = -1;
    Mesh mesh;
    mesh.positions.assign(3, {1, 2, 3});
    mesh.normals = {{1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
    mesh.uvs.assign(3, {0, 0});
    mesh.influences.assign(3, {{0, kNoJoint}, {1, 0}});
    mesh.influences[2] = {{1, 2, kNoJoint}, {0.5f, 0.5f, 0}};  // half a turn against none
    const SkinnedReference reference = skinReference(mesh, palette);
    CHECK(reference.normals == std::vector<glm::dvec3>{{0, 0, 0}, {0, 1, 0}, {0, 0, 0}});
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    std::vector<SkinnedVertex> measured(3);
    for (size_t v = 0; v < 3; ++v) measured[v].position = reference.positions[v];
    measured[0].normal = measured[2].normal = {kNaN, kNaN, kNaN};
    measured[1].normal = {0, 1, 0};
    CHECK(compareSkinned(reference, measured, 1).normal == 0);
    CHECK(compareSkinned(reference, measured, 1).position == 0);
    measured[0].position.y += 1;
    CHECK(compareSkinned(reference, measured, 1).position == 1);
}

TEST_CASE("compareSkinned measures position over diagonal and normals as angles") {
    SkinnedReference reference;
    reference.positions = {{0, 0, 0}, {1, 0, 0}};
    reference.normals = {{0, 0, 1}, {0, 0, 1}};
    std::vector<SkinnedVertex> measured = {{{0, 0, 0}, 0, {0, 0, 1}, 0}, {{1, 0.5f, 0}, 0, {0, 2, 2}, 0}};
    const SkinError error = compareSkinned(reference, measured, 4);
    CHECK(error.position == 0.125);
    CHECK(std::abs(error.normal - std::acos(-1) / 4) < 1e-12);
    const double infinity = std::numeric_limits<double>::infinity();
    // No scale makes an error small by being none.
    CHECK(compareSkinned(reference, measured, 0).position == infinity);
    CHECK(compareSkinned(reference, measured, infinity).position == infinity);
    measured[1].position.y = 0;
    CHECK(compareSkinned(reference, measured, 0).position == 0);
    measured[0].position.y = std::numeric_limits<float>::quiet_NaN();
    CHECK(compareSkinned(reference, measured, 4).position == infinity);
    measured[1].normal = {0, 0, 0};
    CHECK(compareSkinned(reference, measured, 4).normal == infinity);
}
