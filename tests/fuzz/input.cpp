#include "tests/fuzz/input.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace skinbench::fuzz {
namespace {

// What a scene is made of.
struct Kinds {
    bool rawFloats, fewPositions, strip, manyInfluences;
    int exponent;  // of positions that are no raw floats
};

glm::vec3 takePosition(Input& in, const Kinds& kinds) {
    if (kinds.rawFloats) return {in.take<float>(), in.take<float>(), in.take<float>()};
    glm::vec3 p;
    for (int a = 0; a < 3; ++a)
        p[a] = std::ldexp(static_cast<float>(kinds.fewPositions ? in.below(3) : in.take<int16_t>()), kinds.exponent);
    return p;
}

glm::vec3 takeNormal(Input& in) {
    const glm::dvec3 n(in.take<int8_t>(), in.take<int8_t>(), in.take<int8_t>());
    return n == glm::dvec3(0) ? glm::vec3(0, 0, 1) : glm::vec3(n / glm::length(n));
}

glm::vec2 takeUv(Input& in, const Kinds& kinds) {
    if (kinds.rawFloats) return {in.take<float>(), in.take<float>()};
    return glm::vec2(in.take<uint8_t>(), in.take<uint8_t>()) / 255.0f;
}

Influences takeInfluences(Input& in, const Kinds& kinds, uint32_t joints, uint32_t centre) {
    Influences out;
    const uint32_t count = 1 + in.below(kinds.manyInfluences ? kMaxInfluences : 4);
    for (uint32_t k = 0; k < count; ++k) {
        out.joints[k] = static_cast<uint16_t>((centre + in.below(std::min(joints, 9u))) % joints);
        out.weights[k] = kinds.rawFloats ? std::abs(in.take<float>()) : in.take<uint8_t>() / 255.0f;
    }
    return out;
}

}  // namespace

std::optional<Scene> takeScene(Input& in) {
    const Kinds kinds{in.below(8) == 0, in.below(8) == 0, in.flip(), in.flip(), static_cast<int>(in.below(80)) - 50};
    const uint32_t joints = 1 + in.below(in.below(8) == 0 ? 3000 : 40), spread = 1 + in.below(joints);
    const uint32_t vertices = 3 + in.below(1 + in.below(1 + in.below(598)));
    const uint32_t triangles = 1 + in.below(2 * vertices);
    Scene scene;
    scene.name = "fuzz";
    for (uint32_t j = 0; j < joints; ++j) {
        scene.skeleton.nodes.push_back({.parent = static_cast<int32_t>(j) - 1});
        scene.skeleton.joints.push_back({j});
    }
    for (uint32_t v = 0; v < vertices; ++v) {
        scene.mesh.positions.push_back(takePosition(in, kinds));
        scene.mesh.normals.push_back(takeNormal(in));
        scene.mesh.uvs.push_back(takeUv(in, kinds));
        scene.mesh.influences.push_back(takeInfluences(in, kinds, joints, v * spread / vertices));
    }
    for (uint32_t i = 0; i < triangles * 3; ++i)
        scene.mesh.indices.push_back(kinds.strip ? (i / 3 + i % 3) % vertices : in.below(vertices));
    scene.parts.push_back({"part", 0, triangles * 3, false});
    if (!checkScene(scene)) return std::nullopt;
    return scene;
}

std::string fileOf(std::span<const uint8_t> bytes) {
    static const int file = memfd_create("input", MFD_CLOEXEC);
    SKINBENCH_ASSERT(file >= 0 && ftruncate(file, 0) == 0);
    SKINBENCH_ASSERT(pwrite(file, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
    SKINBENCH_ASSERT(lseek(file, 0, SEEK_SET) == 0);
    return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace skinbench::fuzz
