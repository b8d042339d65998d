#include <algorithm>
#include <array>

#include "common/scene/builtin/characters.h"
#include "common/scene/scene.h"

namespace skinbench {

namespace {

using MakeCharacter = Scene (*)(uint32_t vertices, uint32_t seed);

constexpr std::array<MakeCharacter, 4> kMakers = {builtin::makeBiped, builtin::makeRobot, builtin::makeCreature,
                                                  builtin::makeBlended};

// One planar projection for the whole character, seen from the front, or from above where it is flatter than wide.
// Without a seam no vertex has to be split.
std::vector<glm::vec2> planarUvs(const std::vector<glm::vec3>& positions) {
    glm::vec3 low(1e9f), high(-1e9f);
    for (const glm::vec3& p : positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const glm::vec3 size = high - low;
    const int down = size.y >= size.z ? 1 : 2;
    const float scale = 1 / std::max(size.x, size[down]);
    std::vector<glm::vec2> uvs;
    uvs.reserve(positions.size());
    for (const glm::vec3& p : positions) {
        const float along = down == 1 ? high.y - p.y : p.z - low.z;
        uvs.emplace_back(std::clamp((p.x - low.x) * scale, 0.0f, 1.0f), std::clamp(along * scale, 0.0f, 1.0f));
    }
    return uvs;
}

}  // namespace

const std::vector<BuiltinScene>& builtinScenes() {
    static const std::vector<BuiltinScene> scenes = {
        {"biped", "an organic humanoid, about 1.9 influences a vertex", 60'000},
        {"robot", "a humanoid of rigid parts, one influence a vertex", 20'000},
        {"creature", "an octopus of 128 joints, about 2.2 influences a vertex", 40'000},
        {"blended", "the biped with four influences for every vertex", 60'000},
    };
    return scenes;
}

Result<Scene> makeBuiltin(const std::string& name, uint32_t vertices, uint32_t seed) {
    const auto& scenes = builtinScenes();
    const auto found =
        std::find_if(scenes.begin(), scenes.end(), [&](const BuiltinScene& s) { return s.name == name; });
    if (found == scenes.end()) {
        std::string names;
        for (const BuiltinScene& s : scenes) names += (names.empty() ? "" : ", ") + std::string(s.name);
        return inputError("builtin:" + name + ": no such built-in scene; there are " + names);
    }
    if (vertices < kMinBuiltinVertices || vertices > kMaxBuiltinVertices)
        return inputError("builtin:" + name + ": cannot have " + std::to_string(vertices) + " vertices; ask for " +
                          std::to_string(kMinBuiltinVertices) + " to " + std::to_string(kMaxBuiltinVertices));
    Scene scene = kMakers[size_t(found - scenes.begin())](vertices, seed);
    scene.name = name;
    scene.mesh.uvs = planarUvs(scene.mesh.positions);
    Part part;
    part.name = name;
    part.indexCount = uint32_t(scene.mesh.indices.size());
    scene.parts.push_back(part);
    return scene;
}

}  // namespace skinbench
