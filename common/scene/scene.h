// A scene is one flat character: every mesh instance of the file is expanded into one vertex and one index array, and
// every skin into one list of joints, because that is what one copy uploads and draws. Static meshes that hang on an
// animated node follow it as vertices with a single influence.
//
// Units are those of the file (glTF: metres, y up, counter-clockwise front faces). Times are seconds.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "common/core/result.h"

namespace skinbench {

inline constexpr int kMaxInfluences = 8;
inline constexpr uint16_t kNoJoint = 0xFFFF;    // "irrelevant": fills the places behind the last influence
inline constexpr uint32_t kMaxJoints = 0xFFFF;  // joint ids are 16 bits and one value is taken by kNoJoint

// After cleanWeights: sorted by descending weight (equal weights: smaller joint first), weights sum to 1, places of
// weight 0 hold kNoJoint. Straight from a loader: any order, any sum, kNoJoint never used.
struct Influences {
    std::array<uint16_t, kMaxInfluences> joints{};
    std::array<float, kMaxInfluences> weights{};
    bool operator==(const Influences&) const = default;
};

// Structure of arrays; all four vertex arrays have the same length. Three indices a triangle.
struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // unit length
    std::vector<glm::vec2> uvs;
    std::vector<Influences> influences;
    std::vector<uint32_t> indices;
};

// What one primitive of one mesh instance became in the flat arrays. Preparation keeps the index ranges.
struct Part {
    std::string name;
    uint32_t firstIndex = 0;
    uint32_t indexCount = 0;
    bool rigid = false;  // a static mesh on a node: one influence of weight 1
};

// Parents stand before their children; parent is -1 for a root. `matrix`, where given, replaces the three others
// (glTF forbids animating such a node).
struct Node {
    std::string name;
    int32_t parent = -1;
    glm::vec3 translation{0};
    glm::quat rotation{1, 0, 0, 0};
    glm::vec3 scale{1};
    std::optional<glm::mat4> matrix;
};

// One entry of the palette: modelSpace(node) * inverseBind. Joints of all skins stand in one list.
struct Joint {
    uint32_t node = 0;
    glm::mat4 inverseBind{1};
};

struct Skeleton {
    std::vector<Node> nodes;
    std::vector<Joint> joints;
};

enum class ChannelPath { translation, rotation, scale };
enum class Interpolation { step, linear, cubicSpline };

// Values are xyz0 for translation and scale, xyzw for rotation. cubicSpline stores three values a key (in-tangent,
// value, out-tangent), the others one. Key times ascend.
struct Channel {
    uint32_t node = 0;
    ChannelPath path = ChannelPath::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;
    std::vector<glm::vec4> values;
};

struct Clip {
    std::string name;
    float duration = 0;  // largest key time
    std::vector<Channel> channels;
};

struct Scene {
    std::string name;
    Mesh mesh;
    std::vector<Part> parts;
    Skeleton skeleton;
    std::vector<Clip> clips;
    std::vector<std::string> warnings;  // one sentence each: what was ignored, repaired or dropped
};

// The scene's row as in Kimmersdorfer, table 4.1. A tuple is the joint list of a vertex in order of descending weight.
struct SceneStats {
    uint32_t vertices = 0;
    uint32_t triangles = 0;
    uint32_t joints = 0;
    uint32_t uniqueTuples = 0;
    double meanInfluences = 0;
    uint32_t maxInfluences = 0;
};

// What weight clean-up took away because a vertex had more influences than were kept, as sums of normalised weight.
struct DroppedWeight {
    float max = 0;
    double mean = 0;  // over all vertices
};

enum class Geometry {
    welded,    // equal vertices merged (Torabi 3.2); the default
    stored,    // as the file stores them
    unwelded,  // one vertex per triangle corner, as Kimmersdorfer's scenes were
};
const char* geometryName(Geometry geometry);

struct PrepareOptions {
    int influences = 4;  // kept per vertex: 4 or 8
    Geometry geometry = Geometry::welded;
    bool cacheOrder = true;  // reorder triangles and vertices for the vertex cache (Torabi 5.1.1)
};

// Accepts "PATH.gltf", "PATH.glb", "builtin:NAME" and "builtin:NAME:VERTICES". The result is as stored; prepareScene
// makes it ready to draw.
Result<Scene> loadScene(const std::string& name);
Result<Scene> loadGltf(const std::string& path);

// Fails with the first fault found: arrays of unequal length, no triangle, an index or joint out of range, a value
// that is not finite, a parent behind its child, key times that do not ascend, positions beyond 1e18 or all within
// 1e-20 of each other but not equal. Every loader's result passes it.
Result<void> checkScene(const Scene& scene);

// Fails where every part is rigid: a benchmark of skinning would time something else.
Result<void> checkSkinned(const Scene& scene);

// As checkScene does for each channel of a clip; `nodes`: how many the skeleton has.
Result<void> checkChannel(const Channel& channel, size_t nodes);

// docs/codecs.md 2 with K = `keep`. Works in double precision and rounds once at the end.
DroppedWeight cleanWeights(Mesh& mesh, int keep);

// Clean-up, then welding or splitting, then cache order; what was dropped is added to `warnings`. The same input
// gives the same bytes on every machine.
Result<Scene> prepareScene(Scene scene, const PrepareOptions& options);

SceneStats sceneStats(const Scene& scene);

// Writes a binary glTF 2.0 file that loadGltf reads back to an equal scene, but for what glTF forbids: joints get a
// common root, weights that do not sum to 1 are cleaned. Refuses names that do not end in .glb.
Result<void> saveGlb(const Scene& scene, const std::string& path);

// --- built-in characters (scene_builtin.cpp) -------------------------------------------------------------------

struct BuiltinScene {
    const char* name;
    const char* what;
    uint32_t defaultVertices;
};

// biped (organic, about 1.9 influences a vertex), robot (rigid, 1.0), creature (many joints, 2.2), blended (the biped with
// 4).
const std::vector<BuiltinScene>& builtinScenes();

inline constexpr uint32_t kMinBuiltinVertices = 2'000;
inline constexpr uint32_t kMaxBuiltinVertices = 2'000'000;

// A closed, skinned and animated surface with about `vertices` vertices (within 5 %). The same arguments give the
// same bytes on every machine: no libm function whose last bit differs between systems takes part.
Result<Scene> makeBuiltin(const std::string& name, uint32_t vertices, uint32_t seed = 1);

}  // namespace skinbench
