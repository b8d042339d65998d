#include <limits>

#include <catch2/catch_test_macros.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include "common/scene/pose.h"

using namespace skinbench;

namespace {

Skeleton chain() {
    Skeleton skeleton;
    skeleton.nodes.resize(2);
    skeleton.nodes[0].translation = {1, 0, 0};
    skeleton.nodes[1].parent = 0;
    skeleton.nodes[1].translation = {0, 2, 0};
    skeleton.joints = {{0, glm::mat4(1)}, {1, glm::mat4(1)}};
    return skeleton;
}

Clip clipOf(Channel channel) {
    const float duration = channel.times.back();
    return {"clip", duration, {std::move(channel)}};
}

glm::vec3 translationAt(const Channel& channel, float seconds) {
    const Clip clip = clipOf(channel);
    return sampleClip(chain(), &clip, seconds).nodes[channel.node].translation;
}

glm::quat rotationAt(const Channel& channel, float seconds) {
    const Clip clip = clipOf(channel);
    return sampleClip(chain(), &clip, seconds).nodes[channel.node].rotation;
}

bool near(const glm::quat& a, const glm::quat& b) {
    return glm::length(glm::vec4(a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w)) < 1e-6f;
}

glm::quat aroundZ(float degrees) { return glm::angleAxis(glm::radians(degrees), glm::vec3(0, 0, 1)); }

glm::vec4 asVector(const glm::quat& q) { return {q.x, q.y, q.z, q.w}; }

}  // namespace

TEST_CASE("linear and step translation") {
    Channel channel{
        1, ChannelPath::translation, Interpolation::linear, {1, 2, 4}, {{0, 0, 0, 0}, {2, 4, 6, 0}, {4, 0, 0, 0}}};
    CHECK(translationAt(channel, 1.25f) == glm::vec3(0.5f, 1, 1.5f));
    CHECK(translationAt(channel, 2) == glm::vec3(2, 4, 6));
    CHECK(translationAt(channel, 3) == glm::vec3(3, 2, 3));
    channel.interpolation = Interpolation::step;
    CHECK(translationAt(channel, 1.99f) == glm::vec3(0));
    CHECK(translationAt(channel, 2) == glm::vec3(2, 4, 6));
    CHECK(translationAt(channel, 3.99f) == glm::vec3(2, 4, 6));
}

TEST_CASE("times outside the keys hold the nearest key") {
    const Channel channel{1, ChannelPath::translation, Interpolation::linear, {1, 2}, {{1, 0, 0, 0}, {2, 0, 0, 0}}};
    CHECK(translationAt(channel, 0).x == 1);
    CHECK(translationAt(channel, -5).x == 1);
    CHECK(translationAt(channel, 99).x == 2);
    CHECK(translationAt(channel, std::numeric_limits<float>::quiet_NaN()).x == 1);
    const Channel single{
        1, ChannelPath::translation, Interpolation::cubicSpline, {3}, {{9, 9, 9, 0}, {1, 2, 3, 0}, {9, 9, 9, 0}}};
    for (const float t : {0.0f, 3.0f, 7.0f}) CHECK(translationAt(single, t) == glm::vec3(1, 2, 3));
}

TEST_CASE("equal key times jump") {
    const Channel channel{1,
                          ChannelPath::translation,
                          Interpolation::linear,
                          {0, 1, 1, 2},
                          {{0, 0, 0, 0}, {1, 0, 0, 0}, {5, 0, 0, 0}, {6, 0, 0, 0}}};
    CHECK(translationAt(channel, 0.5f).x == 0.5f);
    CHECK(translationAt(channel, 1).x == 5);
    CHECK(translationAt(channel, 1.5f).x == 5.5f);
}

TEST_CASE("cubic spline follows glTF 2.0 appendix C.5") {
    // Two keys two seconds apart. At t = 1/2: h00 = h01 = 1/2, h10 = 1/8, h11 = -1/8; tangents are scaled by 2 s.
    const Channel channel{1,
                          ChannelPath::translation,
                          Interpolation::cubicSpline,
                          {0, 2},
                          {{99, 99, 99, 0}, {1, 0, 0, 0}, {4, 0, 8, 0}, {-4, 8, 0, 0}, {3, 0, 0, 0}, {99, 99, 99, 0}}};
    CHECK(translationAt(channel, 1) == glm::vec3(2 + 1 + 1, -2, 2));
    CHECK(translationAt(channel, 0) == glm::vec3(1, 0, 0));
    CHECK(translationAt(channel, 2) == glm::vec3(3, 0, 0));
    // Rotations are normalised: here the spline passes through (0, 0, 1, 1) / 2.
    const Channel turn{1,
                       ChannelPath::rotation,
                       Interpolation::cubicSpline,
                       {0, 1},
                       {{0, 0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 0}}};
    CHECK(near(rotationAt(turn, 0.5f), aroundZ(90)));
}

TEST_CASE("rotations are interpolated spherically on the short way") {
    Channel channel{
        1, ChannelPath::rotation, Interpolation::linear, {0, 1}, {asVector(aroundZ(0)), asVector(aroundZ(90))}};
    CHECK(near(rotationAt(channel, 1.0f / 3), aroundZ(30)));
    channel.values[1] = -channel.values[1];  // the same rotation, the long way
    CHECK(near(rotationAt(channel, 1.0f / 3), aroundZ(30)));
    channel.values = {asVector(aroundZ(20)), asVector(aroundZ(20))};
    CHECK(near(rotationAt(channel, 0.5f), aroundZ(20)));
    channel.values = {glm::vec4(0), glm::vec4(0)};
    CHECK(near(rotationAt(channel, 0.5f), glm::quat(1, 0, 0, 0)));
}

TEST_CASE("a null clip is the rest pose and unknown nodes keep theirs") {
    const auto pose = sampleClip(chain(), nullptr, 3);
    CHECK(pose.nodes[0].translation == glm::vec3(1, 0, 0));
    CHECK(pose.nodes[1].translation == glm::vec3(0, 2, 0));
}

TEST_CASE("model space and palette by hand") {
    Skeleton skeleton = chain();
    skeleton.nodes[0].rotation = aroundZ(90);
    skeleton.nodes[0].scale = {2, 2, 2};
    skeleton.joints[1].inverseBind = glm::translate(glm::mat4(1), glm::vec3(0, -2, 0));
    const auto model = toModelSpace(sampleClip(skeleton, nullptr, 0));
    // The tip stands 2 up; doubled and turned it is 4 to the left of the root at (1, 0, 0).
    CHECK(glm::length(glm::dvec3(model[1][3]) - glm::dvec3(-3, 0, 0)) < 1e-6);
    const Palette palette = makePalette(skeleton, model);
    // The bind position (0, 2, 0) of the tip lands there; (1, 2, 0) lands 2 above it.
    const glm::vec4 p(1, 2, 0, 1);
    const glm::vec3 q(glm::dot(palette[1].rows[0], p), glm::dot(palette[1].rows[1], p),
                      glm::dot(palette[1].rows[2], p));
    CHECK(glm::length(q - glm::vec3(-3, 2, 0)) < 1e-6f);
}

TEST_CASE("a node's matrix replaces its parts, and only its affine part counts") {
    Skeleton skeleton = chain();
    glm::mat4 m = glm::translate(glm::mat4(1), glm::vec3(7, 8, 9));
    m[0][3] = 5;
    skeleton.nodes[0].matrix = m;
    const auto model = toModelSpace(sampleClip(skeleton, nullptr, 0));
    CHECK(glm::dvec3(model[0][3]) == glm::dvec3(7, 8, 9));
    CHECK(model[0][0][3] == 0);
}

TEST_CASE("poseScene wraps around the duration") {
    Scene scene;
    scene.skeleton = chain();
    scene.mesh.positions = {{0, 0, 0}};
    scene.mesh.influences = {{{0}, {1}}};
    const Clip clip =
        clipOf({0, ChannelPath::translation, Interpolation::linear, {0, 2}, {{0, 0, 0, 0}, {2, 0, 0, 0}}});
    const auto x = [&](float t) { return poseScene(scene, &clip, t)[0].rows[0].w; };
    CHECK(x(0.5f) == 0.5f);
    CHECK(x(2.5f) == 0.5f);
    CHECK(x(-0.5f) == 1.5f);
    CHECK(x(2) == 2);  // the end, not the start of the next round
    CHECK(x(4.5f) == 0.5f);
    CHECK(std::isfinite(x(std::numeric_limits<float>::infinity())));
}

TEST_CASE("posed bounds") {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 2, 3}};
    mesh.influences = {{{0}, {1}}, {{0}, {1}}};
    Palette palette(1);
    palette[0].rows[0].w = 10;
    const Bounds bounds = posedBounds(mesh, palette);
    CHECK(bounds.min == glm::vec3(10, 0, 0));
    CHECK(bounds.max == glm::vec3(11, 2, 3));
    CHECK(posedBounds(Mesh{}, palette).diagonal() == 0);
}
