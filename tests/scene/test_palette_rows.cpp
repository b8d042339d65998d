#include "common/scene/palette_rows.h"

#include <cmath>
#include <cstring>
#include <random>

#include <catch2/catch_test_macros.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/cases.h"

using namespace skinbench;

namespace {

constexpr double kQuarter = 1.5707963267948966;

struct RandomRows {
    std::mt19937 engine{5};
    float operator()() { return static_cast<float>(engine()) / 4294967296.0f * 2 - 1; }
};

PaletteEntry turnedAboutZ(double angle) {
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    return {{glm::vec4{c, -s, 0, 0}, glm::vec4{s, c, 0, 0}, glm::vec4{0, 0, 1, 0}}};
}

PaletteEntry randomAffine(RandomRows& random, bool singular) {
    PaletteEntry entry;
    for (glm::vec4& row : entry.rows) row = {random(), random(), random(), random()};
    if (singular) entry.rows[2] = entry.rows[0] * 2.0f;
    return entry;
}

glm::dvec3 moved(const PaletteEntry& entry, const glm::dvec3& p) {
    const glm::dvec4 q(p, 1);
    return {glm::dot(glm::dvec4(entry.rows[0]), q), glm::dot(glm::dvec4(entry.rows[1]), q),
            glm::dot(glm::dvec4(entry.rows[2]), q)};
}

Skeleton skeletonOf(size_t joints) {
    Skeleton skeleton;
    skeleton.nodes.resize(1);
    skeleton.joints.resize(joints);
    return skeleton;
}

Mesh oneVertex(const glm::vec3& position, const Influences& influences) {
    Mesh mesh;
    mesh.positions = {position};
    mesh.normals = {{0, 1, 0}};
    mesh.uvs = {{0, 0}};
    mesh.influences = {influences};
    return mesh;
}

constexpr PaletteForm kDual{Method::dqs}, kStretched{Method::dqs, RowFormat::f32, true};

}  // namespace

TEST_CASE("a joint alone moves a vertex by dual quaternions as by its matrix, whatever the matrix") {
    RandomRows random;
    for (int i = 0; i < 300; ++i) {
        PaletteEntry entry = randomAffine(random, i % 10 == 0);
        if (i == 1) entry.rows = {};                                                    // scaled to nothing
        if (i == 2) entry.rows = {glm::vec4{-1, 0, 0, 1}, {0, 1, 0, 2}, {0, 0, 1, 3}};  // a mirror
        if (i == 3) entry.rows = {glm::vec4{0, 0, 0, 1}, {0, 0, 0, 2}, {0, 0, 5, 3}};   // one direction is left
        if (i == 4) entry = turnedAboutZ(2 * kQuarter);                                 // a quaternion with w = 0
        const glm::vec3 place(random(), random(), random()), p(random(), random(), random());
        Skeleton skeleton = skeletonOf(1);
        skeleton.joints[0].inverseBind[3] = glm::vec4(-place, 1);
        const Palette palette{entry};
        const auto rows = paletteRows(skeleton, palette, kStretched);
        REQUIRE(rows);
        REQUIRE(rows->size() == 5);
        const SkinnedReference skinned = skinReference(oneVertex(p, {{0, kNoJoint}, {1, 0}}), *rows, kStretched);
        INFO(i);
        CHECK(glm::distance(skinned.positions[0], moved(entry, p)) < 1e-5);
        const glm::dvec3 normal = moved(entry, {0, 1, 0}) - moved(entry, {0, 0, 0});
        if (glm::length(normal) > 1e-3) CHECK(glm::distance(skinned.normals[0], glm::normalize(normal)) < 1e-3);
        CHECK(!skinned.undecided[0]);
        const SplitJoint split = splitJoint(entry, place);
        CHECK(std::abs(glm::length(split.real) - 1) < 1e-12);
        const glm::dvec3 kept(glm::dot(split.stretch[0], glm::dvec4(place, 1)),
                              glm::dot(split.stretch[1], glm::dvec4(place, 1)),
                              glm::dot(split.stretch[2], glm::dvec4(place, 1)));
        CHECK(glm::distance(kept, glm::dvec3(place)) < 1e-6);
    }
}

TEST_CASE("half of a quarter turn is an eighth of a turn, where linear blending shrinks") {
    const Palette palette{turnedAboutZ(0), turnedAboutZ(kQuarter)};
    const auto rows = paletteRows(skeletonOf(2), palette, kDual);
    REQUIRE(rows);
    const Mesh mesh = oneVertex({2, 0, 0}, {{0, 1, kNoJoint}, {0.5f, 0.5f, 0}});
    const SkinnedReference dual = skinReference(mesh, *rows, kDual);
    CHECK(glm::distance(dual.positions[0], glm::dvec3(std::sqrt(2.0), std::sqrt(2.0), 0)) < 1e-6);
    CHECK(glm::distance(dual.normals[0], glm::dvec3(-std::sqrt(0.5), std::sqrt(0.5), 0)) < 1e-6);
    CHECK(glm::length(skinReference(mesh, palette).positions[0]) < 1.5);
}

TEST_CASE("the sign of a joint's quaternion means nothing, and a right angle is undecided") {
    const Palette palette{turnedAboutZ(0.3), turnedAboutZ(1.1), turnedAboutZ(0.3 + 2 * kQuarter)};
    std::vector<glm::vec4> rows = *paletteRows(skeletonOf(3), palette, kDual);
    const Mesh mesh = oneVertex({2, 1, 3}, {{1, 0, kNoJoint}, {0.7f, 0.3f, 0}});
    const glm::dvec3 before = skinReference(mesh, rows, kDual).positions[0];
    for (size_t row : {0, 1}) rows[row] = -rows[row];
    CHECK(skinReference(mesh, rows, kDual).positions[0] == before);
    const Mesh half = oneVertex({2, 1, 3}, {{0, 2, kNoJoint}, {0.7f, 0.3f, 0}});
    CHECK(skinReference(half, rows, kDual).undecided[0]);
    SkinnedVertex far{{9, 9, 9}, 0, {0, 1, 0}, 0};
    const SkinError error = compareSkinned(skinReference(half, rows, kDual), {&far, 1}, 1);
    CHECK(error.undecided == 1);
    CHECK(error.position == 0);
}

TEST_CASE("weights that are equal but for rounding and disagree about signs are undecided") {
    // Thirds of a turn: each is on the near side of one neighbour and on the far side of the other.
    const Palette palette{turnedAboutZ(0), turnedAboutZ(4 * kQuarter / 3 * 1.2), turnedAboutZ(-4 * kQuarter / 3 * 1.2)};
    const auto rows = paletteRows(skeletonOf(3), palette, kDual);
    const float third = 1.0f / 3;
    for (const float rounding : {0.0f, 0.002f})
        CHECK(skinReference(oneVertex({1, 0, 0}, {{0, 1, 2, kNoJoint}, {third - rounding, third, third + rounding, 0}}),
                            *rows, kDual)
                  .undecided[0]);
    CHECK(
        !skinReference(oneVertex({1, 0, 0}, {{0, 1, 2, kNoJoint}, {0.4f, 0.3f, 0.3f, 0}}), *rows, kDual).undecided[0]);
}

TEST_CASE("rows of half floats have these bytes, and refuse what they cannot hold") {
    Palette palette{turnedAboutZ(0)};
    palette[0].rows[0].w = 1.0f / 3;
    palette[0].rows[1].w = 3e-5f;  // a GPU may take it for zero
    const PaletteForm form{Method::lbs, RowFormat::f16};
    const auto rows = paletteRows(skeletonOf(1), palette, form);
    REQUIRE(rows);
    CHECK((*rows)[0].w == 0.333251953125f);
    CHECK((*rows)[1].w == 0);
    std::vector<std::byte> bytes;
    appendRows(bytes, *rows, form.format);
    const uint16_t wanted[] = {0x3C00, 0, 0, 0x3555, 0, 0x3C00, 0, 0, 0, 0, 0x3C00, 0};
    REQUIRE(bytes.size() == sizeof(wanted));
    CHECK(bytes.size() == form.bytesOfJoint());
    CHECK(std::memcmp(bytes.data(), wanted, sizeof(wanted)) == 0);
    palette[0].rows[2].w = 70000;
    const auto refused = paletteRows(skeletonOf(1), palette, form);
    REQUIRE(!refused);
    CHECK(refused.error().text.starts_with("joint 0 moves by 7e+04"));
}

TEST_CASE("a clip stretches where it scales, and not where bind matrices undo a scale that holds still") {
    Scene scene = tinyScene();
    CHECK(!stretches(scene, &scene.clips[0]));
    CHECK(paletteRows(scene.skeleton, poseScene(scene, &scene.clips[0], 0.7f), kDual));
    Scene small = scene;
    small.skeleton.nodes[0].scale = glm::vec3(0.01f);
    for (Joint& joint : small.skeleton.joints)
        joint.inverseBind = glm::scale(glm::mat4(1), glm::vec3(100)) * joint.inverseBind;
    CHECK(!stretches(small, &small.clips[0]));
    Scene pulsing = scene;
    pulsing.clips[0].channels.push_back({1,
                                         ChannelPath::scale,
                                         Interpolation::linear,
                                         {0, 0.01f, 0.02f},
                                         {glm::vec4(1, 1, 1, 0), glm::vec4(1, 2, 1, 0), glm::vec4(1, 1, 1, 0)}});
    CHECK(stretches(pulsing, &pulsing.clips[0]));
    CHECK(!paletteRows(pulsing.skeleton, poseScene(pulsing, &pulsing.clips[0], 0.01f), kDual));
    CHECK(paletteRows(pulsing.skeleton, poseScene(pulsing, &pulsing.clips[0], 0.01f), kStretched));
}
