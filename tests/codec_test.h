// Meshes for the codec tests: seeded random ones, degenerate ones, a plain meshlet cut.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "common/meshlets/meshlets.h"
#include "common/scene/scene.h"

namespace skinbench::test {

// splitmix64: unlike std::uniform_real_distribution the same numbers everywhere.
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t next() {
        uint64_t z = state_ += 0x9E3779B97F4A7C15u;
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
        z = (z ^ z >> 27) * 0x94D049BB133111EBu;
        return z ^ z >> 31;
    }
    uint32_t below(uint32_t count) { return static_cast<uint32_t>((next() >> 32) * count >> 32); }
    double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

private:
    uint64_t state_;
};

inline glm::vec3 randomDirection(Random& random) {
    const double z = random.unit() * 2 - 1;
    const double a = random.unit() * 6.283185307179586;
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
}

// docs/codecs.md 2 for weights that need no merging.
inline Influences cleanInfluences(std::vector<std::pair<uint16_t, double>> list) {
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
        return a.second != b.second ? a.second > b.second : a.first < b.first;
    });
    double sum = 0;
    for (const auto& [joint, weight] : list) sum += weight;
    Influences result;
    result.joints.fill(kNoJoint);
    for (size_t i = 0; i < list.size(); ++i) {
        result.weights[i] = static_cast<float>(list[i].second / sum);
        if (result.weights[i] > 0) result.joints[i] = list[i].first;
    }
    return result;
}

// 1 to `most` influences on neighbouring joints around `centre`, uniform on the simplex.
inline Influences randomInfluences(Random& random, uint32_t joints, uint32_t centre, uint32_t most) {
    const uint32_t count = 1 + random.below(std::min(most, joints));
    std::vector<std::pair<uint16_t, double>> list;
    while (list.size() < count) {
        const uint16_t joint = static_cast<uint16_t>((centre + random.below(most + 1)) % joints);
        const bool used = std::any_of(list.begin(), list.end(), [&](const auto& e) { return e.first == joint; });
        if (!used) list.emplace_back(joint, 1e-3 - std::log(1 - random.unit()));
    }
    return cleanInfluences(std::move(list));
}

// A strip of triangles along a random cloud; neighbouring vertices use neighbouring joints.
inline Mesh randomMesh(uint64_t seed, uint32_t vertices, uint32_t joints, uint32_t most = 4) {
    Random random(seed);
    Mesh mesh;
    for (uint32_t v = 0; v < vertices; ++v) {
        mesh.positions.emplace_back(random.unit() * 3 - 1, random.unit() * 0.5, random.unit() * 40 - 17);
        mesh.normals.push_back(randomDirection(random));
        mesh.uvs.emplace_back(random.unit() * 2 - 0.5, random.unit());
        const uint32_t centre = static_cast<uint32_t>(uint64_t{v} * joints / vertices);
        mesh.influences.push_back(randomInfluences(random, joints, centre, most));
    }
    for (uint32_t v = 0; v + 2 < vertices; ++v) {
        mesh.indices.insert(mesh.indices.end(), {v, v + 1 + v % 2, v + 2 - v % 2});
    }
    return mesh;
}

// Greedy in index order.
inline MeshletMesh cutMeshlets(const Mesh& mesh, MeshletLimits limits = {}) {
    MeshletMesh result{limits, {}, {}, {}};
    std::map<uint32_t, uint8_t> local;
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        uint32_t fresh = 0;
        for (int c = 0; c < 3; ++c) fresh += !local.contains(mesh.indices[t + c]);
        if (result.meshlets.empty() || local.size() + fresh > limits.vertices ||
            result.meshlets.back().triangleCount == limits.triangles) {
            local.clear();
            result.meshlets.push_back(
                {static_cast<uint32_t>(result.vertices.size()), static_cast<uint32_t>(result.triangles.size()), 0, 0});
        }
        std::array<uint8_t, 3> triangle;
        for (int c = 0; c < 3; ++c) {
            const auto [it, isNew] = local.try_emplace(mesh.indices[t + c], static_cast<uint8_t>(local.size()));
            if (isNew) result.vertices.push_back(mesh.indices[t + c]);
            result.meshlets.back().vertexCount += isNew;
            triangle[c] = it->second;
        }
        ++result.meshlets.back().triangleCount;
        result.triangles.push_back(triangle);
    }
    return result;
}

// Named corner cases; every mesh has at least three vertices.
inline std::vector<std::pair<std::string, Mesh>> degenerateMeshes() {
    std::vector<std::pair<std::string, Mesh>> meshes;
    const auto add = [&](const char* name, const std::function<void(Mesh&)>& change) {
        Mesh mesh = randomMesh(7, 500, 40);
        change(mesh);
        meshes.emplace_back(name, std::move(mesh));
    };
    add("flat", [](Mesh& m) {
        for (auto& p : m.positions) p.y = 0.25f;
    });
    add("one point", [](Mesh& m) {
        for (auto& p : m.positions) p = {1, 2, 3};
    });
    add("constant uv", [](Mesh& m) {
        for (auto& t : m.uvs) t = {0.5f, -3};
    });
    add("one joint", [](Mesh& m) {
        for (auto& i : m.influences) i = cleanInfluences({{0, 1.0}});
    });
    add("highest joint", [](Mesh& m) {
        for (auto& i : m.influences) i = cleanInfluences({{kNoJoint - 1, 1.0}});
    });
    add("one joint a vertex", [](Mesh& m) {
        for (size_t v = 0; v < m.influences.size(); ++v)
            m.influences[v] = cleanInfluences({{static_cast<uint16_t>(v), 1.0}});
    });
    add("all weights equal", [](Mesh& m) {
        for (auto& i : m.influences) i = cleanInfluences({{3, 0.25}, {1, 0.25}, {9, 0.25}, {4, 0.25}});
    });
    add("zero normals", [](Mesh& m) {
        for (auto& n : m.normals) n = {0, 0, 0};
    });
    add("three vertices", [](Mesh& m) { m = randomMesh(3, 3, 2); });
    return meshes;
}

// As many joints as a scene can have, a tuple each: all that a table of 16-bit tuple numbers holds, but one.
inline Mesh everyJointMesh() {
    Mesh mesh = randomMesh(8, kMaxJoints, 40);
    for (uint32_t v = 0; v < kMaxJoints; ++v) mesh.influences[v] = cleanInfluences({{static_cast<uint16_t>(v), 1.0}});
    return mesh;
}

inline std::string folderOf(const char* variable, const char* fallback) {
    const char* value = std::getenv(variable);
    if (value != nullptr) return value;
    std::string folder = SKINBENCH_SOURCE_DIR;
    folder += fallback;
    return folder;
}

}  // namespace skinbench::test
