// Binary glTF 2.0: a JSON chunk that describes the arrays and a BIN chunk that holds them, both padded to 4 bytes.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "common/core/file.h"
#include "common/scene/scene.h"

namespace skinbench {

namespace {

using Json = nlohmann::ordered_json;

enum ComponentType { kUint8 = 5121, kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };
enum BufferTarget { kNoTarget = 0, kVertices = 34962, kIndices = 34963 };

struct Glb {
    Json json;
    std::vector<uint8_t> bytes;

    // Appends a buffer view with one accessor and returns the accessor.
    template <class T>
    size_t add(std::span<const T> values, ComponentType component, const char* type, size_t count,
               BufferTarget target = kNoTarget) {
        const size_t offset = bytes.size(), size = values.size_bytes();
        bytes.resize((offset + size + 3) / 4 * 4, 0);
        if (size) std::memcpy(bytes.data() + offset, values.data(), size);
        Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
        if (target != kNoTarget) view["target"] = int(target);
        json["bufferViews"].push_back(view);
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                     {"componentType", int(component)},
                                     {"count", count},
                                     {"type", type}});
        return json["accessors"].size() - 1;
    }
};

template <class V>
Json toJson(const V& v) {
    Json array = Json::array();
    for (int i = 0; i < V::length(); ++i) array.push_back(v[i]);
    return array;
}

Json nodeJson(const Node& node) {
    Json json = {{"name", node.name}};
    if (node.matrix) {
        Json& matrix = json["matrix"] = Json::array();
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r) matrix.push_back((*node.matrix)[c][r]);
        return json;
    }
    // Stored rotations may be of any length; glTF asks for one.
    const double length = glm::length(glm::dquat(node.rotation));
    const bool unit = std::abs(length - 1) < 1e-6 || !(length > 0);
    const glm::quat q = unit ? node.rotation : glm::quat(glm::dquat(node.rotation) / length);
    if (node.translation != glm::vec3(0)) json["translation"] = toJson(node.translation);
    if (q != glm::quat(1, 0, 0, 0)) json["rotation"] = {q.x, q.y, q.z, q.w};
    if (node.scale != glm::vec3(1)) json["scale"] = toJson(node.scale);
    return json;
}

void addChild(Json& nodes, size_t parent, size_t child) { nodes[parent]["children"].push_back(child); }

bool shareRoot(const Skeleton& skeleton) {
    std::vector<size_t> rootOf(skeleton.nodes.size());
    for (size_t i = 0; i < rootOf.size(); ++i)
        rootOf[i] = skeleton.nodes[i].parent < 0 ? i : rootOf[size_t(skeleton.nodes[i].parent)];
    return std::ranges::all_of(
        skeleton.joints, [&](const Joint& joint) { return rootOf[joint.node] == rootOf[skeleton.joints[0].node]; });
}

// Returns the roots. The joints of a skin need a common one. A skin may name a node once only: a joint that shares its
// node gets a child of its own.
std::vector<size_t> addNodesAndSkin(const Skeleton& skeleton, Glb& glb) {
    Json nodes = Json::array();
    std::vector<size_t> roots;
    for (size_t i = 0; i < skeleton.nodes.size(); ++i) {
        nodes.push_back(nodeJson(skeleton.nodes[i]));
        if (skeleton.nodes[i].parent < 0)
            roots.push_back(i);
        else
            addChild(nodes, size_t(skeleton.nodes[i].parent), i);
    }
    if (!skeleton.joints.empty()) {
        Json joints = Json::array();
        std::vector<glm::mat4> inverseBinds;
        std::set<size_t> taken;
        for (const Joint& joint : skeleton.joints) {
            size_t node = joint.node;
            if (!taken.insert(node).second) {
                nodes.push_back({{"name", skeleton.nodes[joint.node].name + " again"}});
                node = nodes.size() - 1;
                addChild(nodes, joint.node, node);
            }
            joints.push_back(node);
            inverseBinds.push_back(joint.inverseBind);
            for (int column = 0; column < 4; ++column) inverseBinds.back()[column][3] = column == 3;
        }
        const size_t accessor = glb.add<glm::mat4>(inverseBinds, kFloat, "MAT4", inverseBinds.size());
        glb.json["skins"] = Json::array({{{"inverseBindMatrices", accessor}, {"joints", joints}}});
    }
    if (!shareRoot(skeleton)) {
        nodes.push_back({{"name", "root"}, {"children", roots}});
        roots = {nodes.size() - 1};
    }
    glb.json["nodes"] = std::move(nodes);
    return roots;
}

// glTF wants weights that sum to 1 and each joint once. Vertices that obey stay as they are.
Mesh withCleanWeights(const Mesh& mesh) {
    Mesh out = mesh;
    for (size_t v = 0; v < mesh.influences.size(); ++v) {
        const Influences& in = mesh.influences[v];
        double sum = 0;
        bool repeated = false;
        for (int i = 0; i < kMaxInfluences; ++i) {
            sum += in.weights[i];
            for (int k = 0; k < i; ++k)
                repeated |= in.joints[k] == in.joints[i] && in.weights[k] > 0 && in.weights[i] > 0;
        }
        if (!repeated && std::abs(sum - 1) < 1e-6) continue;
        Mesh one;
        one.influences = {in};
        cleanWeights(one, kMaxInfluences);
        out.influences[v] = one.influences[0];
    }
    return out;
}

// Four of a vertex' eight places.
template <class T>
size_t addJoints(const Mesh& mesh, size_t first, ComponentType component, Glb& glb) {
    std::vector<T> joints;
    joints.reserve(mesh.influences.size() * 4);
    for (const Influences& in : mesh.influences)
        for (size_t i = first; i < first + 4; ++i) joints.push_back(in.weights[i] == 0 ? T(0) : T(in.joints[i]));
    return glb.add<T>(joints, component, "VEC4", mesh.influences.size(), kVertices);
}

size_t addWeights(const Mesh& mesh, size_t first, Glb& glb) {
    std::vector<float> weights;
    weights.reserve(mesh.influences.size() * 4);
    for (const Influences& in : mesh.influences)
        weights.insert(weights.end(), in.weights.begin() + long(first), in.weights.begin() + long(first) + 4);
    return glb.add<float>(weights, kFloat, "VEC4", mesh.influences.size(), kVertices);
}

Json addAttributes(const Scene& scene, Glb& glb) {
    const Mesh mesh = withCleanWeights(scene.mesh);
    const size_t count = mesh.positions.size();
    Json attributes;
    attributes["POSITION"] = glb.add<glm::vec3>(mesh.positions, kFloat, "VEC3", count, kVertices);
    glm::vec3 low = mesh.positions.front(), high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    glb.json["accessors"].back()["min"] = toJson(low);
    glb.json["accessors"].back()["max"] = toJson(high);
    attributes["NORMAL"] = glb.add<glm::vec3>(mesh.normals, kFloat, "VEC3", count, kVertices);
    attributes["TEXCOORD_0"] = glb.add<glm::vec2>(mesh.uvs, kFloat, "VEC2", count, kVertices);
    if (scene.skeleton.joints.empty()) return attributes;
    const bool eight = std::any_of(mesh.influences.begin(), mesh.influences.end(), [](const Influences& in) {
        return std::any_of(in.weights.begin() + 4, in.weights.end(), [](float w) { return w != 0; });
    });
    for (size_t set = 0; set < (eight ? 2 : 1); ++set) {
        const std::string suffix = "_" + std::to_string(set);
        attributes["JOINTS" + suffix] = scene.skeleton.joints.size() <= 256
                                            ? addJoints<uint8_t>(mesh, set * 4, kUint8, glb)
                                            : addJoints<uint16_t>(mesh, set * 4, kUint16, glb);
        attributes["WEIGHTS" + suffix] = addWeights(mesh, set * 4, glb);
    }
    return attributes;
}

size_t addIndices(const Mesh& mesh, const Part& part, Glb& glb) {
    const std::span<const uint32_t> all(mesh.indices);
    const std::span<const uint32_t> range = all.subspan(part.firstIndex, part.indexCount);
    // 65535 would restart the primitive.
    if (mesh.positions.size() > 65535) return glb.add<uint32_t>(range, kUint32, "SCALAR", range.size(), kIndices);
    const std::vector<uint16_t> narrow(range.begin(), range.end());
    return glb.add<uint16_t>(narrow, kUint16, "SCALAR", narrow.size(), kIndices);
}

void addMesh(const Scene& scene, Glb& glb) {
    const Json attributes = addAttributes(scene, glb);
    std::vector<Part> parts = scene.parts;
    if (parts.empty()) parts.push_back({scene.name, 0, uint32_t(scene.mesh.indices.size()), false});
    Json primitives = Json::array();
    for (const Part& part : parts) {
        if (part.indexCount == 0) continue;
        primitives.push_back({{"attributes", attributes}, {"indices", addIndices(scene.mesh, part, glb)}, {"mode", 4}});
    }
    glb.json["meshes"] = Json::array({{{"name", scene.name}, {"primitives", primitives}}});
}

size_t addOutput(const Channel& channel, Glb& glb) {
    if (channel.path == ChannelPath::rotation)
        return glb.add<glm::vec4>(channel.values, kFloat, "VEC4", channel.values.size());
    const std::vector<glm::vec3> values(channel.values.begin(), channel.values.end());
    return glb.add<glm::vec3>(values, kFloat, "VEC3", values.size());
}

void addClips(const std::vector<Clip>& clips, Glb& glb) {
    static constexpr const char* kPaths[] = {"translation", "rotation", "scale"};
    static constexpr const char* kInterpolations[] = {"STEP", "LINEAR", "CUBICSPLINE"};
    std::map<std::vector<float>, size_t> inputs;
    for (const Clip& clip : clips) {
        Json channels = Json::array(), samplers = Json::array();
        // Of two channels with one target the last holds.
        std::map<std::pair<uint32_t, ChannelPath>, const Channel*> last;
        for (const Channel& channel : clip.channels) last[{channel.node, channel.path}] = &channel;
        for (const Channel& channel : clip.channels) {
            if (last[{channel.node, channel.path}] != &channel) continue;
            const auto [input, isNew] = inputs.try_emplace(channel.times, 0);
            if (isNew) {
                input->second = glb.add<float>(channel.times, kFloat, "SCALAR", channel.times.size());
                glb.json["accessors"].back()["min"] = {channel.times.front()};
                glb.json["accessors"].back()["max"] = {channel.times.back()};
            }
            channels.push_back({{"sampler", samplers.size()},
                                {"target", {{"node", channel.node}, {"path", kPaths[size_t(channel.path)]}}}});
            samplers.push_back({{"input", input->second},
                                {"interpolation", kInterpolations[size_t(channel.interpolation)]},
                                {"output", addOutput(channel, glb)}});
        }
        if (channels.empty()) continue;
        glb.json["animations"].push_back({{"name", clip.name}, {"channels", channels}, {"samplers", samplers}});
    }
}

Glb makeGlb(const Scene& scene) {
    Glb glb;
    glb.json["asset"] = {{"version", "2.0"}, {"generator", "skinbench"}};
    glb.json["scene"] = 0;
    std::vector<size_t> roots = addNodesAndSkin(scene.skeleton, glb);
    addMesh(scene, glb);
    Json meshNode = {{"name", scene.name}, {"mesh", 0}};
    if (!scene.skeleton.joints.empty()) meshNode["skin"] = 0;
    glb.json["nodes"].push_back(meshNode);
    roots.push_back(glb.json["nodes"].size() - 1);
    glb.json["scenes"] = Json::array({{{"nodes", roots}}});
    addClips(scene.clips, glb);
    glb.json["buffers"] = Json::array({{{"byteLength", glb.bytes.size()}}});
    return glb;
}

bool isGlb(const std::string& path) {
    std::string suffix = std::filesystem::path(path).extension().string();
    std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return suffix == ".glb";
}

void putWord(std::string& out, uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) out.push_back(char(word >> shift & 0xFF));
}

}  // namespace

Result<void> saveGlb(const Scene& scene, const std::string& path) {
    if (!isGlb(path)) return inputError(path + ": scenes are written as binary glTF; give a name that ends in .glb");
    if (auto good = checkScene(scene); !good) return inputError(path + ": cannot save: " + good.error().text);
    const Glb glb = makeGlb(scene);
    // Names may hold bytes that are not UTF-8; they must not throw.
    std::string json = glb.json.dump(-1, ' ', false, Json::error_handler_t::replace);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const uint64_t length = 12 + 8 + uint64_t(json.size()) + 8 + glb.bytes.size();
    if (length > 0xFFFFFFFFu)
        return inputError(path + ": larger than the 4 GiB that a .glb can hold; ask for fewer vertices");

    std::string file = "glTF";
    file.reserve(size_t(length));
    putWord(file, 2);
    putWord(file, uint32_t(length));
    putWord(file, uint32_t(json.size()));
    file += "JSON" + json;
    putWord(file, uint32_t(glb.bytes.size()));
    file.append("BIN\0", 4);
    file.append(glb.bytes.begin(), glb.bytes.end());
    return writeWholeFile(path, file);
}

}  // namespace skinbench
