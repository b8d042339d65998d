// Tangents against surfaces whose tangents are known, and against what every tangent must be.
#include <random>

#include <catch2/catch_test_macros.hpp>

#include <cmath>

#include "common/scene/tangents.h"
#include "tests/cases.h"

using namespace skinbench;

namespace {

// A square in the plane of `right` and `up`, u and v over it as given.
Mesh square(glm::vec3 right, glm::vec3 up, glm::vec2 uOfRightAndUp, glm::vec2 vOfRightAndUp) {
    Mesh mesh;
    for (glm::vec2 corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
        mesh.positions.push_back(right * corner.x + up * corner.y);
        mesh.normals.push_back(glm::normalize(glm::cross(right, up)));
        mesh.uvs.emplace_back(glm::dot(uOfRightAndUp, corner), glm::dot(vOfRightAndUp, corner));
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

void checkAll(const Mesh& mesh, glm::vec3 direction, float side) {
    for (const glm::vec4& tangent : vertexTangents(mesh)) {
        CHECK(glm::length(glm::vec3(tangent) - direction) < 1e-6f);
        CHECK(tangent.w == side);
    }
}

void checkPerpendicular(const Mesh& mesh) {
    const std::vector<glm::vec4> tangents = vertexTangents(mesh);
    REQUIRE(tangents.size() == mesh.positions.size());
    size_t wrong = 0;
    for (size_t v = 0; v < tangents.size(); ++v) {
        const glm::vec3 t(tangents[v]);
        const bool unit = std::abs(glm::length(t) - 1) < 1e-6f, across = std::abs(glm::dot(t, mesh.normals[v])) < 1e-6f;
        wrong += !unit || !across || std::abs(tangents[v].w) != 1;
    }
    CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("a tangent points where u grows, its side where v grows") {
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    checkAll(square(x, y, {1, 0}, {0, 1}), x, 1);
    checkAll(square(x, y, {-1, 0}, {0, 1}), -x, -1);
    checkAll(square(x, y, {1, 0}, {0, -1}), x, -1);
    checkAll(square(x, y, {0, 1}, {1, 0}), y, -1);
    checkAll(square(y, z, {0, 3}, {-0.5f, 0}), z, 1);
    // Sheared uvs: u grows along x - y, the direction of constant v.
    checkAll(square(x, y, {1, 0}, {1, 1}), glm::normalize(x - y), 1);
    // The normal may lean: what is left of the direction is perpendicular to it.
    Mesh leaning = square(x, y, {1, 0}, {0, 1});
    for (glm::vec3& normal : leaning.normals) normal = glm::normalize(glm::vec3(1, 0, 1));
    checkAll(leaning, glm::normalize(glm::vec3(1, 0, -1)), 1);
}

TEST_CASE("without an area in uv a tangent is any perpendicular") {
    for (const glm::vec3& right : {glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0.3f, -2, 0.7f)}) {
        Mesh mesh = square(right, glm::cross(right, glm::vec3(0.2f, 1, 0.5f)), {0, 0}, {0, 0});
        checkPerpendicular(mesh);
        for (const glm::vec4& tangent : vertexTangents(mesh)) CHECK(tangent.w == 1);
        mesh.indices.clear();
        checkPerpendicular(mesh);
    }
}

TEST_CASE("tangents of whole characters are unit vectors across the normal") {
    for (const BuiltinScene& builtin : builtinScenes())
        checkPerpendicular(loadScene(std::string("builtin:") + builtin.name + ":3000")->mesh);
    for (const std::string& file : modelFiles())
        if (auto scene = loadScene(file)) checkPerpendicular(scene->mesh);
}

TEST_CASE("a tangent in bytes is turned by no more than they allow, and keeps its side") {
    std::mt19937 random(4);
    const auto next = [&] { return static_cast<float>(random()) / 4294967296.0f * 2 - 1; };
    double most = 0;
    for (int i = 0; i < 20'000; ++i) {
        const glm::vec4 tangent(glm::normalize(glm::vec3(next(), next(), next())), i % 2 ? 1 : -1);
        const glm::vec4 read = unpackTangentBytes(packTangentBytes(tangent));
        const glm::dvec3 a(tangent), b(read);
        most = std::max(most, std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
        CHECK(read.w == tangent.w);
    }
    CHECK(most <= mostTurnOfBytes());
    CHECK(most > 0.8 * mostTurnOfBytes());
}

TEST_CASE("a tangent in a word keeps its direction within 2e-4 and its side") {
    std::mt19937 random(3);
    const auto next = [&] { return static_cast<float>(random()) / 4294967296.0f * 2 - 1; };
    for (int i = 0; i < 2000; ++i) {
        glm::vec4 tangent(glm::normalize(glm::vec3(next(), next(), next())), i % 2 ? 1 : -1);
        if (i < 6) tangent = glm::vec4(i % 3 == 0, i % 3 == 1, i % 3 == 2, 1) * (i < 3 ? 1.0f : -1.0f);
        const glm::vec4 read = unpackTangent(packTangent(tangent));
        CHECK(glm::distance(glm::vec3(tangent), glm::vec3(read)) < 2e-4f);
        CHECK(read.w == tangent.w);
    }
    CHECK(packTangent({0, 0, 1, -1}) == 1);
    CHECK(packTangent({0, 1, 0, 1}) == 0x7FFF0000);
}
