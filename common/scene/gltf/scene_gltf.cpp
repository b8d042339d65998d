#include <algorithm>
#include <cmath>
#include <filesystem>
#include <format>
#include <map>
#include <new>
#include <set>

#include <tiny_gltf.h>

#include "common/core/text.h"
#include "common/core/utf8.h"
#include "common/scene/gltf/gltf_clips.h"
#include "common/scene/gltf/gltf_data.h"
#include "common/scene/gltf/gltf_file.h"
#include "common/scene/gltf/gltf_mesh.h"
#include "common/scene/gltf/gltf_nodes.h"
#include "common/scene/pose.h"
#include "common/scene/scene.h"

namespace skinbench {
namespace {

constexpr uint64_t kMaxVertices = 1u << 25;
constexpr uint64_t kMaxIndices = 3u << 25;

std::unexpected<Error> failed(const std::string& place, const Error& error) {
    return std::unexpected(Error{error.fault, place + ": " + error.text});
}

// --- tinygltf's model in our terms ------------------------------------------------------------------------------

Result<tinygltf::Model> parseModel(const std::string& json) {
    tinygltf::Model model;
    tinygltf::TinyGLTF loader;
    loader.RemoveImageLoader();
    std::string error, warning;
    const bool good =
        loader.LoadASCIIFromString(&model, &error, &warning, json.data(), static_cast<unsigned>(json.size()), "");
    if (good && error.empty()) return model;
    std::ranges::replace(error, '\n', ' ');
    while (!error.empty() && (error.back() == ' ' || error.back() == '.')) error.pop_back();
    return inputError(error.empty() ? "is no valid glTF 2.0; Khronos' glTF validator names the place"
                                    : "tinygltf says: " + shortText(error, 200));
}

Result<std::span<const uint8_t>> bytesOf(const GltfFile& file, uint64_t buffer, uint64_t offset, uint64_t length) {
    if (buffer >= file.buffers.size()) return inputError(std::format("buffer {} does not exist", buffer));
    if (!file.buffers[buffer].fault.empty()) return inputError(file.buffers[buffer].fault);
    const auto bytes = file.buffers[buffer].bytes;
    if (offset > bytes.size() || length > bytes.size() - offset)
        return inputError(std::format("{} at {} {} past the {} of buffer {}", counted(length, "byte"), offset,
                                      length == 1 ? "goes" : "go", counted(bytes.size(), "byte"), buffer));
    return bytes.subspan(offset, length);
}

GltfView makeView(const tinygltf::BufferView& view, size_t index, const GltfFile& file) {
    GltfView out;
    const std::string where = std::format("bufferView {}: ", index);
    if (const auto fault = file.tree.views.find(index); fault != file.tree.views.end()) {
        out.fault = fault->second;
        return out;
    }
    if (const auto packed = file.tree.packed.find(index); packed != file.tree.packed.end()) {
        out.packed = packed->second;
        const auto bytes = bytesOf(file, out.packed->buffer, out.packed->offset, out.packed->length);
        if (bytes)
            out.packed->bytes = *bytes;
        else
            out.fault = where + out.packed->extension + ": " + bytes.error().text;
        return out;
    }
    const auto bytes = bytesOf(file, view.buffer, view.byteOffset, view.byteLength);
    if (bytes)
        out.bytes = *bytes;
    else
        out.fault = where + bytes.error().text;
    out.stride = view.byteStride;
    return out;
}

GltfData makeData(const tinygltf::Model& model, const GltfFile& file) {
    GltfData data;
    data.budget.left += file.size * kGltfBudgetFactor;
    data.quantization = file.tree.quantization;
    for (size_t i = 0; i < model.bufferViews.size(); ++i) data.views.push_back(makeView(model.bufferViews[i], i, file));
    for (size_t i = 0; i < model.accessors.size(); ++i) {
        const tinygltf::Accessor& source = model.accessors[i];
        GltfAccessor accessor;
        accessor.view = source.bufferView;
        accessor.offset = source.byteOffset;
        accessor.count = source.count;
        accessor.component = source.componentType;
        accessor.components = tinygltf::GetNumComponentsInType(source.type);
        accessor.normalized = source.normalized;
        if (const auto& sparse = source.sparse; sparse.isSparse)
            accessor.sparse =
                GltfSparse{static_cast<uint64_t>(sparse.count), sparse.indices.bufferView, sparse.indices.byteOffset,
                           sparse.indices.componentType,        sparse.values.bufferView,  sparse.values.byteOffset};
        if (const auto bounds = file.tree.bounds.find(i); bounds != file.tree.bounds.end())
            accessor.bounds = bounds->second;
        if (const auto fault = file.tree.accessors.find(i); fault != file.tree.accessors.end())
            accessor.fault = fault->second;
        data.accessors.push_back(std::move(accessor));
    }
    return data;
}

// --- skins and instances ----------------------------------------------------------------------------------------

// One mesh on one node.
struct Instance {
    int node = 0;  // the file's index
    int mesh = 0;
    int skin = -1;
};

struct Importer {
    const tinygltf::Model& model;
    const GltfTree& tree;
    const NodeOrder& order;
    GltfData& data;
    Scene& scene;
    GltfNotes& notes;
    std::map<int, GltfMesh> meshes;       // decoded on first use
    std::map<int, uint32_t> skinJoints;   // skin -> its first joint
    std::map<int, uint16_t> rigidJoints;  // node -> its joint
    std::vector<bool> mirrored;           // by our node index, in the rest pose
    Subtrees subtrees;
};

// glTF 2.0, section 3.7.3.2. `root`: the node that the skin calls its skeleton, or -1.
void noteSkin(const Importer& in, uint32_t first, int root) {
    const Skeleton& skeleton = in.scene.skeleton;
    GltfNotes& notes = in.notes;
    std::set<uint32_t> nodes;
    bool apart = false, repeated = false;
    const uint32_t ours = contains(in.model.nodes, root) ? in.order.place[root] : 0;
    bool above = root < 0 || contains(in.model.nodes, root);
    for (size_t j = first; j < skeleton.joints.size(); ++j) {
        const Joint& joint = skeleton.joints[j];
        repeated |= !nodes.insert(joint.node).second;
        apart |= in.subtrees.roots[joint.node] != in.subtrees.roots[skeleton.joints[first].node];
        above &= root < 0 || in.subtrees.holds(ours, joint.node);
        const glm::mat4& m = joint.inverseBind;
        const glm::vec4 lastRow(m[0][3], m[1][3], m[2][3], m[3][3]);
        if (glm::any(glm::greaterThan(glm::abs(lastRow - glm::vec4(0, 0, 0, 1)), glm::vec4(1e-5f))))
            notes.add(GltfNote::brokenBindRows);
    }
    if (apart) notes.add(GltfNote::skinsWithoutRoot);
    if (repeated) notes.add(GltfNote::repeatedSkinJoints);
    // Joints without a common root have none that could be named.
    if (!above && !apart) notes.add(GltfNote::wrongSkeletons);
}

Result<uint32_t> addSkin(Importer& in, int index) {
    const tinygltf::Skin& skin = in.model.skins[index];
    Skeleton& skeleton = in.scene.skeleton;
    if (const auto fault = in.tree.skins.find(index); fault != in.tree.skins.end()) return inputError(fault->second);
    const std::string where = std::format("skin {}: ", index);
    if (skin.joints.empty()) return inputError(where + "has no joint");
    if (skeleton.joints.size() + skin.joints.size() > kMaxJoints)
        return inputError(where + std::format("the scene has more than the limit of {} joints", kMaxJoints));
    std::vector<float> matrices;
    if (skin.inverseBindMatrices >= 0) {
        auto read = readFloats(in.data, skin.inverseBindMatrices, 16, false, skin.joints.size());
        if (!read) return inputError(where + "inverseBindMatrices: " + read.error().text);
        matrices = std::move(*read);
        if (in.data.accessors[skin.inverseBindMatrices].component != kGltfF32) in.notes.add(GltfNote::forbiddenFormats);
        if (matrices.size() < skin.joints.size() * 16)
            return inputError(
                where + std::format("has {} but {}", counted(skin.joints.size(), "joint"),
                                    counted(matrices.size() / 16, "inverse bind matrix", "inverse bind matrices")));
    }
    const auto first = static_cast<uint32_t>(skeleton.joints.size());
    for (size_t j = 0; j < skin.joints.size(); ++j) {
        if (!contains(in.model.nodes, skin.joints[j]))
            return inputError(where + std::format("joint {}: node {} does not exist", j, skin.joints[j]));
        Joint joint{in.order.place[skin.joints[j]], glm::mat4(1)};
        if (!matrices.empty())
            for (int i = 0; i < 16; ++i) joint.inverseBind[i / 4][i % 4] = matrices[j * 16 + i];
        skeleton.joints.push_back(joint);
    }
    noteSkin(in, first, skin.skeleton);
    return first;
}

Result<std::vector<Instance>> findInstances(const tinygltf::Model& model, const NodeOrder& order,
                                            const std::set<size_t>& hidden, Scene& scene, GltfNotes& notes) {
    const auto inScene = shownNodes(model, order);
    SKINBENCH_TRY(inScene);
    const std::vector<bool> left = hiddenNodes(order, hidden);
    std::vector<Instance> shown, all;
    bool skinShown = false, skinVisible = false, anySkin = false;
    for (size_t i = 0; i < model.nodes.size(); ++i) {
        const tinygltf::Node& node = model.nodes[i];
        if (node.mesh < 0) continue;
        if (!contains(model.meshes, node.mesh))
            return inputError(std::format("node {}: mesh {} does not exist", i, node.mesh));
        if (node.skin >= 0 && !contains(model.skins, node.skin))
            return inputError(std::format("node {}: skin {} does not exist", i, node.skin));
        anySkin |= node.skin >= 0;
        if (left[i]) {
            notes.add(GltfNote::hiddenNodes);
            continue;
        }
        all.push_back({static_cast<int>(i), node.mesh, node.skin});
        skinVisible |= node.skin >= 0;
        if (!(*inScene)[i]) continue;
        shown.push_back(all.back());
        skinShown |= node.skin >= 0;
    }
    if (!anySkin) return inputError("has no skin: nothing to animate; give a file with a skinned mesh");
    if (!skinVisible) return inputError("every skinned mesh is hidden by KHR_node_visibility: nothing to animate");
    if (!skinShown)
        scene.warnings.push_back("the default scene shows no skinned mesh; all nodes of the file were taken");
    return skinShown ? shown : all;
}

Result<const GltfMesh*> decodeMesh(Importer& in, int index) {
    if (const auto known = in.meshes.find(index); known != in.meshes.end()) return &known->second;
    if (const auto fault = in.tree.meshes.find(index); fault != in.tree.meshes.end()) return inputError(fault->second);
    std::vector<GltfPrimitive> primitives;
    for (const tinygltf::Primitive& source : in.model.meshes[index].primitives)
        primitives.push_back({{source.attributes.begin(), source.attributes.end()},
                              source.indices,
                              source.mode < 0 ? TINYGLTF_MODE_TRIANGLES : source.mode});
    auto mesh = at(std::format("mesh {}", index), readMesh(in.data, primitives, in.notes));
    SKINBENCH_TRY(mesh);
    return &in.meshes.emplace(index, std::move(*mesh)).first->second;
}

Result<uint16_t> rigidJoint(Importer& in, int node) {
    const auto [it, isNew] = in.rigidJoints.try_emplace(node, static_cast<uint16_t>(in.scene.skeleton.joints.size()));
    if (!isNew) return it->second;
    if (in.scene.skeleton.joints.size() >= kMaxJoints)
        return inputError(std::format("the scene has more than the limit of {} joints", kMaxJoints));
    in.scene.skeleton.joints.push_back({in.order.place[node], glm::mat4(1)});
    return it->second;
}

Result<void> appendVertices(Importer& in, const GltfVertices& vertices, const Instance& instance, bool skinned) {
    Mesh& mesh = in.scene.mesh;
    const Mesh& source = vertices.mesh;
    if (mesh.positions.size() + source.positions.size() > kMaxVertices)
        return inputError(std::format("the scene has more than {} vertices", kMaxVertices));
    constexpr uint64_t kBytes = 2 * sizeof(glm::vec3) + sizeof(glm::vec2) + sizeof(Influences);
    if (auto ok = spend(in.data.budget, source.positions.size(), kBytes); !ok) return ok;
    mesh.positions.insert(mesh.positions.end(), source.positions.begin(), source.positions.end());
    mesh.normals.insert(mesh.normals.end(), source.normals.begin(), source.normals.end());
    mesh.uvs.insert(mesh.uvs.end(), source.uvs.begin(), source.uvs.end());
    if (!skinned) {
        const auto joint = rigidJoint(in, instance.node);
        SKINBENCH_TRY(joint);
        Influences influences{{}, {1}};
        influences.joints.fill(*joint);
        mesh.influences.resize(mesh.positions.size(), influences);
        return {};
    }
    const uint32_t first = in.skinJoints.at(instance.skin);
    const size_t joints = in.model.skins[instance.skin].joints.size();
    for (size_t v = 0; v < source.influences.size(); ++v) {
        Influences influences = source.influences[v];
        for (int k = 0; k < kMaxInfluences; ++k) {
            if (influences.joints[k] >= joints && influences.weights[k] > 0)
                return inputError(std::format("vertex {} names joint {}, but skin {} has {}", vertices.fileVertex[v],
                                              influences.joints[k], instance.skin, counted(joints, "joint")));
            const uint32_t local = influences.joints[k] < joints ? influences.joints[k] : 0;
            influences.joints[k] = static_cast<uint16_t>(first + local);
        }
        mesh.influences.push_back(influences);
    }
    return {};
}

std::string partName(const Importer& in, const Instance& instance, size_t primitive) {
    const tinygltf::Mesh& mesh = in.model.meshes[instance.mesh];
    std::string name = !mesh.name.empty() ? mesh.name : in.model.nodes[instance.node].name;
    if (name.empty()) name = std::format("mesh {}", instance.mesh);
    return mesh.primitives.size() > 1 ? std::format("{}.{}", name, primitive) : name;
}

Result<void> addInstance(Importer& in, const Instance& instance) {
    const std::string place = std::format("mesh {}", instance.mesh);
    const auto decoded = decodeMesh(in, instance.mesh);
    SKINBENCH_TRY(decoded);
    const GltfMesh& mesh = **decoded;
    if (auto ok = at(place, spend(in.data.budget, mesh.parts.size(), sizeof(Part))); !ok) return ok;
    std::vector<size_t> firstVertex;
    for (const GltfVertices& vertices : mesh.vertices) {
        firstVertex.push_back(in.scene.mesh.positions.size());
        const bool skinned = instance.skin >= 0 && vertices.skinned;
        if (auto ok = at(place, appendVertices(in, vertices, instance, skinned)); !ok) return ok;
    }
    for (size_t p = 0; p < mesh.parts.size(); ++p) {
        const GltfMesh::Part& part = mesh.parts[p];
        if (part.indices.empty()) continue;
        const bool skinned = instance.skin >= 0 && mesh.vertices[part.vertices].skinned;
        if (instance.skin >= 0 && !skinned) in.notes.add(GltfNote::unskinned);
        std::vector<uint32_t>& indices = in.scene.mesh.indices;
        if (indices.size() + part.indices.size() > kMaxIndices)
            return inputError(std::format("the scene has more than {} triangles", kMaxIndices / 3));
        if (auto ok = at(place, spend(in.data.budget, part.indices.size(), sizeof(uint32_t))); !ok) return ok;
        const auto begin = static_cast<uint32_t>(indices.size());
        for (const uint32_t index : part.indices)
            indices.push_back(static_cast<uint32_t>(firstVertex[part.vertices] + index));
        // glTF 2.0, section 3.7.2.1: the node's transform says which side is the front, for skinned meshes too.
        if (in.mirrored[in.order.place[instance.node]])
            for (size_t i = begin; i < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
        in.scene.parts.push_back(
            {partName(in, instance, p), begin, static_cast<uint32_t>(part.indices.size()), !skinned});
    }
    return {};
}

// Joints that mirror what the mesh's node does not, or the other way round, show the inside.
void warnOfMirroredJoints(const Importer& in, const std::vector<Instance>& instances) {
    const std::vector<glm::dmat4> global = toModelSpace({in.scene.skeleton.nodes});
    std::set<int> seen;
    size_t other = 0, all = 0;
    for (const Instance& instance : instances) {
        if (instance.skin < 0 || !seen.insert(instance.skin).second) continue;
        const size_t first = in.skinJoints.at(instance.skin), count = in.model.skins[instance.skin].joints.size();
        all += count;
        for (size_t j = first; j < first + count; ++j) {
            const Joint& joint = in.scene.skeleton.joints[j];
            const double sign = glm::determinant(glm::dmat3(global[joint.node])) *
                                glm::determinant(glm::dmat3(glm::mat3(joint.inverseBind)));
            if (sign != 0 && (sign < 0) != in.mirrored[in.order.place[instance.node]]) ++other;
        }
    }
    if (other > 0)
        in.scene.warnings.push_back(std::format(
            "{} of {} {} the mesh where its node does not, or the other way round; the node decides which side is the "
            "front, so parts may be drawn inside out",
            other, counted(all, "joint"), other == 1 ? "mirrors" : "mirror"));
}

// Once the scene is built: what used a broken part was an error.
void warnOfBrokenParts(const GltfTree& tree, std::vector<std::string>& warnings) {
    size_t count = 0;
    std::string first;
    for (const GltfFaults* faults : {&tree.views, &tree.accessors, &tree.meshes, &tree.skins}) {
        if (count == 0 && !faults->empty()) first = faults->begin()->second;
        count += faults->size();
    }
    if (count == 1) warnings.push_back("a part of the file that nothing uses is broken: " + first);
    if (count > 1)
        warnings.push_back(
            std::format("{} parts of the file that nothing uses are broken; the first: {}", count, first));
}

// Such a mesh is skinned, but nothing of it is drawn.
void warnOfNoArea(Scene& scene) {
    const Mesh& mesh = scene.mesh;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto corner = [&](size_t number) { return mesh.positions[mesh.indices[i + number]]; };
        if (corner(0) != corner(1) && corner(1) != corner(2) && corner(2) != corner(0)) return;
    }
    scene.warnings.emplace_back("none of its triangles has an area at rest");
}

Result<Scene> buildScene(const tinygltf::Model& model, const GltfFile& file) {
    GltfData data = makeData(model, file);
    const auto order = orderNodes(model);
    SKINBENCH_TRY(order);
    Scene scene;
    for (const int node : order->sorted) {
        const int parent = order->parents[node];
        scene.skeleton.nodes.push_back(
            makeNode(model.nodes[node], parent < 0 ? -1 : static_cast<int>(order->place[parent])));
    }
    GltfNotes notes = file.tree.notes;
    const auto instances = findInstances(model, *order, file.tree.hidden, scene, notes);
    SKINBENCH_TRY(instances);
    SKINBENCH_TRY(addClips(model, file.tree.animations, data, *order, scene, notes));
    Importer in{model,
                file.tree,
                *order,
                data,
                scene,
                notes,
                {},
                {},
                {},
                mirroredNodes(scene.skeleton),
                subtreesOf(scene.skeleton)};
    // All skins come first, so that the joint numbers of a file do not depend on its static meshes.
    for (const Instance& instance : *instances) {
        if (instance.skin < 0 || in.skinJoints.contains(instance.skin)) continue;
        const auto first = addSkin(in, instance.skin);
        SKINBENCH_TRY(first);
        in.skinJoints[instance.skin] = *first;
    }
    for (const Instance& instance : *instances) SKINBENCH_TRY(addInstance(in, instance));
    if (scene.mesh.indices.empty()) return inputError("has no triangle to draw");
    for (std::string& text : describe(notes)) scene.warnings.push_back(std::move(text));
    for (std::string& text : describe(file.tree.extensions)) scene.warnings.push_back(std::move(text));
    warnOfBrokenParts(file.tree, scene.warnings);
    warnOfMirroredJoints(in, *instances);
    warnOfNoArea(scene);
    SKINBENCH_TRY(checkScene(scene));
    return scene;
}

Result<Scene> loadUnnamed(const std::string& path) {
    const auto file = readGltfFile(path);
    SKINBENCH_TRY(file);
    const auto model = parseModel(file->tree.json);
    SKINBENCH_TRY(model);
    return buildScene(*model, *file);
}

}  // namespace

Result<Scene> loadGltf(const std::string& path) {
    const std::filesystem::path source(path);
    // Names end up in JSON, which holds UTF-8 only.
    const std::string name = toUtf8(path);
    try {
        auto scene = loadUnnamed(path);
        if (!scene) return failed(name, scene.error());
        scene->name = toUtf8(source.stem().string());
        return scene;
    } catch (const std::bad_alloc&) {
        return inputError(name + ": does not fit into memory");
    } catch (const std::exception& error) {
        return inputError(name + ": cannot be read: " + error.what());
    }
}

}  // namespace skinbench
