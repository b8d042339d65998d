#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/scene/pose.h"
#include "common/scene/scene.h"
#include "common/scene/skin_cpu.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

Scene make(const std::string& name, uint32_t vertices, uint32_t seed = 1) {
    auto scene = makeBuiltin(name, vertices, seed);
    REQUIRE(scene);
    return std::move(*scene);
}

struct Hash {
    uint64_t value = 0xCBF29CE484222325u;  // FNV-1a

    void bytes(const void* data, size_t size) {
        for (size_t i = 0; i < size; ++i) value = (value ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001B3u;
    }
    template <class T>
    void add(const std::vector<T>& values) {
        bytes(values.data(), values.size() * sizeof(T));
    }
};

uint64_t hashScene(const Scene& scene) {
    Hash hash;
    hash.add(scene.mesh.positions);
    hash.add(scene.mesh.normals);
    hash.add(scene.mesh.uvs);
    hash.add(scene.mesh.influences);
    hash.add(scene.mesh.indices);
    for (const Node& node : scene.skeleton.nodes) {
        hash.bytes(node.name.data(), node.name.size());
        hash.bytes(&node.parent, sizeof(node.parent));
        hash.bytes(&node.translation, sizeof(node.translation));
    }
    for (const Joint& joint : scene.skeleton.joints) hash.bytes(&joint.inverseBind, sizeof(joint.inverseBind));
    for (const Clip& clip : scene.clips)
        for (const Channel& channel : clip.channels) {
            hash.bytes(&channel.node, sizeof(channel.node));
            hash.add(channel.times);
            hash.add(channel.values);
        }
    return hash.value;
}

// By position: hard edges and uv seams split vertices, never the surface.
std::vector<uint32_t> weldedIndices(const Mesh& mesh) {
    std::map<std::array<float, 3>, uint32_t> ids;
    std::vector<uint32_t> result;
    for (const uint32_t index : mesh.indices) {
        const glm::vec3& p = mesh.positions[index];
        result.push_back(ids.try_emplace({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, uint32_t(ids.size())).first->second);
    }
    return result;
}

// Edges that are not shared by exactly two triangles with opposite directions.
size_t openEdges(const Mesh& mesh) {
    const std::vector<uint32_t> indices = weldedIndices(mesh);
    std::vector<uint64_t> edges, reversed;
    for (size_t i = 0; i < indices.size(); ++i) {
        const uint64_t a = indices[i], b = indices[i % 3 == 2 ? i - 2 : i + 1];
        edges.push_back(a << 32 | b);
        reversed.push_back(b << 32 | a);
    }
    std::sort(edges.begin(), edges.end());
    std::sort(reversed.begin(), reversed.end());
    std::vector<uint64_t> lonely;
    std::set_symmetric_difference(edges.begin(), edges.end(), reversed.begin(), reversed.end(),
                                  std::back_inserter(lonely));
    size_t repeated = 0;
    for (size_t i = 1; i < edges.size(); ++i) repeated += edges[i] == edges[i - 1];
    return lonely.size() + repeated;
}

size_t pieces(const Mesh& mesh) {
    const std::vector<uint32_t> indices = weldedIndices(mesh);
    std::vector<uint32_t> parent(*std::max_element(indices.begin(), indices.end()) + 1);
    for (uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto root = [&](uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (size_t i = 0; i < indices.size(); i += 3)
        for (size_t k = 1; k < 3; ++k) parent[root(indices[i])] = root(indices[i + k]);
    size_t count = 0;
    for (uint32_t i = 0; i < parent.size(); ++i) count += root(i) == i;
    return count;
}

double signedVolume(const Mesh& mesh) {
    double sum = 0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
            c(mesh.positions[mesh.indices[i + 2]]);
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

double smallestAngle(const Mesh& mesh, size_t triangle) {
    double least = 180;
    for (size_t k = 0; k < 3; ++k) {
        const auto at = [&](size_t j) { return glm::dvec3(mesh.positions[mesh.indices[triangle * 3 + (k + j) % 3]]); };
        const glm::dvec3 a = glm::normalize(at(1) - at(0)), b = glm::normalize(at(2) - at(0));
        least = std::min(least, glm::degrees(std::acos(glm::clamp(glm::dot(a, b), -1.0, 1.0))));
    }
    return least;
}

// The share of triangles with an angle below `degrees`.
double sharperThan(const Mesh& mesh, double degrees) {
    const size_t triangles = mesh.indices.size() / 3;
    size_t sharp = 0;
    for (size_t t = 0; t < triangles; ++t) sharp += !(smallestAngle(mesh, t) >= degrees);
    return double(sharp) / double(triangles);
}

// The share of triangles whose winding and vertex normals disagree.
double turnedNormals(const Mesh& mesh) {
    size_t turned = 0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                        c = mesh.positions[mesh.indices[i + 2]];
        glm::vec3 sum(0);
        for (size_t k = 0; k < 3; ++k) sum += mesh.normals[mesh.indices[i + k]];
        turned += glm::dot(glm::cross(b - a, c - a), sum) <= 0;
    }
    return double(turned) / double(mesh.indices.size() / 3);
}

struct WeightFacts {
    double mean = 0;
    int most = 0;
    size_t tuples = 0;
    std::set<uint16_t> joints;
    double worstSum = 0;
};

WeightFacts weightFacts(const Mesh& mesh) {
    WeightFacts facts;
    std::set<std::vector<uint16_t>> tuples;
    for (const Influences& in : mesh.influences) {
        std::vector<uint16_t> tuple;
        double sum = 0;
        for (size_t i = 0; i < kMaxInfluences; ++i) {
            sum += double(in.weights[i]);
            if (in.weights[i] > 0) tuple.push_back(in.joints[i]);
            if (i > 0) REQUIRE(in.weights[i] <= in.weights[i - 1]);
        }
        facts.mean += double(tuple.size());
        facts.most = std::max(facts.most, int(tuple.size()));
        facts.worstSum = std::max(facts.worstSum, std::abs(sum - 1));
        facts.joints.insert(tuple.begin(), tuple.end());
        tuples.insert(tuple);
    }
    facts.mean /= double(mesh.influences.size());
    facts.tuples = tuples.size();
    return facts;
}

void checkShape(const std::string& name, uint32_t vertices) {
    const Scene scene = make(name, vertices);
    REQUIRE(checkScene(scene));
    CHECK(std::abs(double(scene.mesh.positions.size()) / vertices - 1) <= 0.05);
    CHECK(openEdges(scene.mesh) == 0);
    CHECK(signedVolume(scene.mesh) > 0.01);
    CHECK(turnedNormals(scene.mesh) < (vertices < 10000 ? 0.01 : 0.001));
    if (name != "robot") CHECK(pieces(scene.mesh) == 1);
    if (vertices >= 20'000) {
        CHECK(sharperThan(scene.mesh, 20) < (name == "robot" ? 0.08 : 0.015));
        CHECK(sharperThan(scene.mesh, 10) < (name == "robot" ? 0.01 : 0.001));
    }
    for (const glm::vec3& n : scene.mesh.normals) REQUIRE(std::abs(glm::length(n) - 1) < 1e-5f);
    for (const glm::vec2& uv : scene.mesh.uvs) REQUIRE((std::min(uv.x, uv.y) >= 0 && std::max(uv.x, uv.y) <= 1));
}

}  // namespace

TEST_CASE("a built-in character is closed, turned outwards, well shaped and has about the asked number of vertices") {
    for (const BuiltinScene& builtin : builtinScenes())
        for (const uint32_t vertices : {2'000u, 20'000u, 60'000u}) {
            INFO(builtin.name << " " << vertices);
            checkShape(builtin.name, vertices);
        }
}

TEST_CASE("a built-in character of a million vertices keeps its promises") {
    const Scene scene = make("biped", 1'000'000);
    CHECK(std::abs(double(scene.mesh.positions.size()) / 1e6 - 1) <= 0.05);
    CHECK(openEdges(scene.mesh) == 0);
    CHECK(std::abs(weightFacts(scene.mesh).mean - 1.9) <= 0.15);
}

TEST_CASE("influences of the built-in characters resemble published characters") {
    // Kimmersdorfer, table 4.1
    struct Wanted {
        const char* name;
        double mean, tolerance;
        int most;
        size_t leastJoints, mostJoints, leastTuples;
    };
    for (const Wanted& wanted :
         {Wanted{"biped", 1.9, 0.15, 4, 40, 60, 150}, Wanted{"robot", 1, 0, 1, 33, 33, 33},
          Wanted{"creature", 2.2, 0.15, 4, 100, 140, 300}, Wanted{"blended", 4, 0, 4, 40, 60, 300}})
        for (const uint32_t seed : {1u, 2u, 3u}) {
            INFO(wanted.name << " seed " << seed);
            const Scene scene = make(wanted.name, 8'000, seed);
            const WeightFacts facts = weightFacts(scene.mesh);
            CHECK(std::abs(facts.mean - wanted.mean) <= wanted.tolerance);
            CHECK(facts.most == wanted.most);
            CHECK(facts.worstSum < 1e-6);
            CHECK(facts.tuples >= wanted.leastTuples);
            CHECK(scene.skeleton.joints.size() >= wanted.leastJoints);
            CHECK(scene.skeleton.joints.size() <= wanted.mostJoints);
            // Nearly every joint moves something; a root may move nothing by itself.
            CHECK(facts.joints.size() + 1 >= scene.skeleton.joints.size());
        }
}

TEST_CASE("the biped stands on the floor, as tall as a person") {
    const Scene scene = make("biped", 10'000);
    const Bounds bounds = posedBounds(scene.mesh, poseScene(scene, nullptr, 0));
    CHECK(std::abs(bounds.min.y) < 0.005f);
    CHECK(std::abs(bounds.max.y - 1.8f) < 0.1f);
    CHECK(std::abs(bounds.min.x + bounds.max.x) < 0.02f);
}

TEST_CASE("the rest pose of a built-in character is its bind pose") {
    for (const BuiltinScene& builtin : builtinScenes()) {
        INFO(builtin.name);
        const Scene scene = make(builtin.name, 5'000);
        const SkinnedReference skinned = skinReference(scene.mesh, poseScene(scene, nullptr, 0));
        double worst = 0;
        for (size_t i = 0; i < scene.mesh.positions.size(); ++i)
            worst = std::max(worst, glm::length(skinned.positions[i] - glm::dvec3(scene.mesh.positions[i])));
        CHECK(worst < 2e-6);
    }
}

TEST_CASE("every clip of a built-in character moves it, loops and keeps it together") {
    for (const BuiltinScene& builtin : builtinScenes()) {
        const Scene scene = make(builtin.name, 5'000);
        REQUIRE(scene.clips.size() >= 2);
        CHECK(scene.clips[0].name == "walk");
        const float size = posedBounds(scene.mesh, poseScene(scene, nullptr, 0)).diagonal();
        for (const Clip& clip : scene.clips) {
            INFO(builtin.name << " " << clip.name);
            const auto at = [&](float part) {
                const LocalPose pose = sampleClip(scene.skeleton, &clip, part * clip.duration);
                const Palette palette = makePalette(scene.skeleton, toModelSpace(pose));
                return skinReference(scene.mesh, palette).positions;
            };
            const auto start = at(0), middle = at(0.4f), end = at(1);
            double moved = 0, gap = 0;
            for (size_t i = 0; i < start.size(); ++i) {
                moved = std::max(moved, glm::length(middle[i] - start[i]));
                gap = std::max(gap, glm::length(end[i] - start[i]));
            }
            CHECK(moved > 0.01 * double(size));
            CHECK(moved < 0.6 * double(size));
            CHECK(gap < 1e-5);
        }
    }
}

TEST_CASE("between them the built-in clips use every interpolation and every path") {
    std::set<Interpolation> interpolations;
    std::set<ChannelPath> paths;
    for (const BuiltinScene& builtin : builtinScenes())
        for (const Clip& clip : make(builtin.name, 2'000).clips)
            for (const Channel& channel : clip.channels) {
                interpolations.insert(channel.interpolation);
                paths.insert(channel.path);
            }
    CHECK(interpolations.size() == 3);
    CHECK(paths.size() == 3);
}

TEST_CASE("the same arguments give the same bytes on every machine") {
    struct Pinned {
        const char* name;
        uint32_t vertices;
        uint64_t hash;
    };
    for (const Pinned& pinned :
         {Pinned{"biped", 2'000, 0x26CA0BAA2EA6490E}, Pinned{"biped", 20'000, 0xFFB9B1DAA9F7862D},
          Pinned{"robot", 2'000, 0x4B462CA8DF2B96C3}, Pinned{"robot", 20'000, 0x0D4A307DD4C1CB09},
          Pinned{"creature", 2'000, 0xEA4036C435D7BB4A}, Pinned{"creature", 20'000, 0x4334FEB1E91967BD},
          Pinned{"blended", 2'000, 0x3EDD52F8DE6CA0A2}}) {
        INFO(pinned.name << " " << pinned.vertices);
        CHECK(hashScene(make(pinned.name, pinned.vertices)) == pinned.hash);
    }
}

TEST_CASE("another seed gives another character") {
    for (const BuiltinScene& builtin : builtinScenes()) {
        const Scene first = make(builtin.name, 3'000, 1), second = make(builtin.name, 3'000, 2);
        INFO(builtin.name);
        CHECK(first.mesh.positions != second.mesh.positions);
        CHECK(first.clips[0].channels[1].values != second.clips[0].channels[1].values);
        CHECK(first.skeleton.nodes.size() == second.skeleton.nodes.size());
    }
}

TEST_CASE("wrong names and counts are refused with what is allowed") {
    const auto unknown = makeBuiltin("dragon", 10'000);
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().fault == Fault::input);
    CHECK_THAT(unknown.error().text,
               ContainsSubstring("dragon") && ContainsSubstring("biped, robot, creature, blended"));
    for (const uint32_t vertices : {0u, kMinBuiltinVertices - 1, kMaxBuiltinVertices + 1, 0xFFFFFFFFu}) {
        const auto wrong = makeBuiltin("robot", vertices);
        REQUIRE_FALSE(wrong);
        CHECK(wrong.error().fault == Fault::input);
        CHECK_THAT(wrong.error().text,
                   ContainsSubstring(std::to_string(vertices)) && ContainsSubstring("2000 to 2000000"));
    }
}
