#include <algorithm>
#include <cmath>
#include <filesystem>
#include <format>
#include <map>
#include <new>

#include <tiny_gltf.h>

#include "common/scene/gltf/gltf_data.h"
#include "common/scene/gltf/gltf_file.h"
#include "common/scene/gltf/gltf_mesh.h"
#include "common/scene/scene.h"

namespace skinbench {
namespace {

constexpr uint64_t kMaxVertices = 1u << 25;  // instances multiply what a small file holds
constexpr uint64_t kMaxIndices = 3u << 25;
constexpr uint64_t kMaxKeys = 1u << 25;

template <class T>
Result<T> at(const std::string& place, Result<T> result) {
    if (!result) result.error().text = place + ": " + result.error().text;
    return result;
}

std::unexpected<Error> failed(const std::string& place, const Error& error) {
    return std::unexpected(Error{error.fault, place + ": " + error.text});
}

template <class T>
bool contains(const std::vector<T>& list, int index) {
    return index >= 0 && static_cast<size_t>(index) < list.size();
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
    return inputError("tinygltf says: " + error.substr(0, 200));
}

Result<CompressedView> compressedView(const tinygltf::Value& value, const GltfFile& file) {
    const auto number = [&](const char* key) -> uint64_t {
        const tinygltf::Value& entry = value.Get(key);
        const double number = entry.IsNumber() ? entry.GetNumberAsDouble() : 0;
        return number >= 0 && number < 1e15 ? static_cast<uint64_t>(number) : UINT64_MAX;
    };
    const auto word = [&](const char* key) {
        return value.Get(key).IsString() ? value.Get(key).Get<std::string>() : std::string();
    };
    const uint64_t buffer = number("buffer"), offset = number("byteOffset"), length = number("byteLength");
    if (!value.Has("buffer") || buffer >= file.buffers.size()) return inputError("names a buffer that does not exist");
    const auto bytes = file.buffers[buffer];
    if (offset > bytes.size() || length > bytes.size() - offset)
        return inputError(
            std::format("{} bytes at {} go past the {} bytes of buffer {}", length, offset, bytes.size(), buffer));
    return CompressedView{bytes.subspan(offset, length), number("count"), number("byteStride"), word("mode"),
                          word("filter")};
}

Result<GltfView> makeView(const tinygltf::BufferView& view, const GltfFile& file, GltfData& data) {
    if (const auto it = view.extensions.find("EXT_meshopt_compression"); it != view.extensions.end()) {
        const auto compressed = at("EXT_meshopt_compression", compressedView(it->second, file));
        if (!compressed) return std::unexpected(compressed.error());
        auto bytes = at("EXT_meshopt_compression", decompressView(*compressed));
        if (!bytes) return std::unexpected(bytes.error());
        data.storage.push_back(std::move(*bytes));
        return GltfView{data.storage.back(), compressed->mode == "ATTRIBUTES" ? compressed->stride : 0};
    }
    if (!contains(file.buffers, view.buffer)) return inputError(std::format("buffer {} does not exist", view.buffer));
    const auto bytes = file.buffers[view.buffer];
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        return inputError(std::format("{} bytes at {} go past the {} bytes of buffer {}", view.byteLength,
                                      view.byteOffset, bytes.size(), view.buffer));
    return GltfView{bytes.subspan(view.byteOffset, view.byteLength), view.byteStride};
}

Result<GltfData> makeData(const tinygltf::Model& model, const GltfFile& file) {
    GltfData data;
    for (size_t i = 0; i < model.bufferViews.size(); ++i) {
        const auto view = at(std::format("bufferView {}", i), makeView(model.bufferViews[i], file, data));
        if (!view) return std::unexpected(view.error());
        data.views.push_back(*view);
    }
    for (const tinygltf::Accessor& source : model.accessors) {
        GltfAccessor accessor{source.bufferView,
                              source.byteOffset,
                              source.count,
                              source.componentType,
                              tinygltf::GetNumComponentsInType(source.type),
                              source.normalized,
                              {}};
        if (const auto& sparse = source.sparse; sparse.isSparse)
            accessor.sparse =
                GltfSparse{static_cast<uint64_t>(sparse.count), sparse.indices.bufferView, sparse.indices.byteOffset,
                           sparse.indices.componentType,        sparse.values.bufferView,  sparse.values.byteOffset};
        data.accessors.push_back(accessor);
    }
    return data;
}

Result<GltfPrimitive> makePrimitive(const tinygltf::Primitive& source, const GltfData& data) {
    const auto position = source.attributes.find("POSITION");
    if (source.extensions.contains("KHR_draco_mesh_compression") && position != source.attributes.end() &&
        contains(data.accessors, position->second) && data.accessors[position->second].view < 0)
        return inputError("KHR_draco_mesh_compression is not supported; export the file without it");
    const int mode = source.mode < 0 ? TINYGLTF_MODE_TRIANGLES : source.mode;
    return GltfPrimitive{{source.attributes.begin(), source.attributes.end()}, source.indices, mode};
}

// --- nodes ------------------------------------------------------------------------------------------------------

struct NodeOrder {
    std::vector<int> parents;     // by the file's index
    std::vector<uint32_t> place;  // the file's index -> ours
    std::vector<int> sorted;      // ours -> the file's index
};

Result<NodeOrder> orderNodes(const tinygltf::Model& model) {
    const size_t count = model.nodes.size();
    NodeOrder order{std::vector<int>(count, -1), std::vector<uint32_t>(count), {}};
    bool inOrder = true;
    for (size_t i = 0; i < count; ++i)
        for (const int child : model.nodes[i].children) {
            if (!contains(model.nodes, child))
                return inputError(std::format("node {}: child {} does not exist", i, child));
            if (order.parents[child] >= 0)
                return inputError(std::format("node {} has two parents, {} and {}", child, order.parents[child], i));
            order.parents[child] = static_cast<int>(i);
            inOrder &= static_cast<size_t>(child) > i;
        }
    std::vector<int> open;
    for (size_t root = count; root-- > 0;)
        if (order.parents[root] < 0) open.push_back(static_cast<int>(root));
    while (!open.empty()) {
        const int node = open.back();
        open.pop_back();
        order.sorted.push_back(node);
        const auto& children = model.nodes[node].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    if (order.sorted.size() < count) return inputError("its nodes form a cycle");
    // A file whose order is fine keeps it.
    if (inOrder) std::ranges::sort(order.sorted);
    for (size_t i = 0; i < count; ++i) order.place[order.sorted[i]] = static_cast<uint32_t>(i);
    return order;
}

glm::vec3 toVec3(const std::vector<double>& v, float missing) {
    return v.size() == 3 ? glm::vec3(v[0], v[1], v[2]) : glm::vec3(missing);
}

Node makeNode(const tinygltf::Node& source, int parent) {
    Node node{source.name, parent, toVec3(source.translation, 0), {1, 0, 0, 0}, toVec3(source.scale, 1), {}};
    if (const auto& q = source.rotation; q.size() == 4)
        node.rotation = glm::quat(static_cast<float>(q[3]), static_cast<float>(q[0]), static_cast<float>(q[1]),
                                  static_cast<float>(q[2]));
    if (source.matrix.size() == 16) {
        glm::mat4 m;
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = static_cast<float>(source.matrix[i]);
        if (m != glm::mat4(1)) node.matrix = m;
    }
    return node;
}

// The nodes that the default scene shows, by the file's index.
Result<std::vector<bool>> visibleNodes(const tinygltf::Model& model, const NodeOrder& order) {
    const size_t count = model.nodes.size();
    if (model.scenes.empty()) return std::vector<bool>(count, true);
    const int index = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (!contains(model.scenes, index)) return inputError(std::format("the default scene {} does not exist", index));
    std::vector<bool> visible(count, false);
    for (const int root : model.scenes[index].nodes) {
        if (!contains(model.nodes, root))
            return inputError(std::format("scene {}: node {} does not exist", index, root));
        visible[root] = true;
    }
    for (const int node : order.sorted)
        if (order.parents[node] >= 0 && visible[order.parents[node]]) visible[node] = true;
    return visible;
}

// --- animations -------------------------------------------------------------------------------------------------

// glTF forbids animating a node that has a matrix; where a file does it anyway, the matrix becomes its three parts.
void splitMatrix(Node& node) {
    const glm::mat4 m = *node.matrix;
    node.matrix.reset();
    node.translation = glm::vec3(m[3]);
    glm::mat3 axes(m);
    for (int i = 0; i < 3; ++i) node.scale[i] = glm::length(axes[i]);
    if (glm::determinant(axes) < 0) node.scale.x = -node.scale.x;
    for (int i = 0; i < 3; ++i)
        if (node.scale[i] != 0) axes[i] /= node.scale[i];
    const glm::quat rotation = glm::quat_cast(axes);
    const bool good = std::isfinite(glm::dot(rotation, rotation)) && glm::dot(rotation, rotation) > 0;
    node.rotation = good ? glm::normalize(rotation) : glm::quat(1, 0, 0, 0);
}

Result<Channel> makeChannel(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& source,
                            const GltfData& data) {
    if (!contains(animation.samplers, source.sampler))
        return inputError(std::format("sampler {} does not exist", source.sampler));
    const tinygltf::AnimationSampler& sampler = animation.samplers[source.sampler];
    Channel channel;
    if (source.target_path == "rotation") channel.path = ChannelPath::rotation;
    if (source.target_path == "scale") channel.path = ChannelPath::scale;
    if (sampler.interpolation == "STEP")
        channel.interpolation = Interpolation::step;
    else if (sampler.interpolation == "CUBICSPLINE")
        channel.interpolation = Interpolation::cubicSpline;
    else if (sampler.interpolation != "LINEAR")
        return inputError("interpolation \"" + sampler.interpolation.substr(0, 40) + "\" is not known");

    const bool rotation = channel.path == ChannelPath::rotation;
    const int components = rotation ? 4 : 3;
    auto times = at("input", readFloats(data, sampler.input, 1));
    if (!times) return std::unexpected(times.error());
    const auto values = at("output", readFloats(data, sampler.output, components, rotation));
    if (!values) return std::unexpected(values.error());
    if (times->empty()) return inputError("has no key");
    channel.times = std::move(*times);
    channel.values.resize(values->size() / components, glm::vec4(0));
    for (size_t i = 0; i < values->size(); ++i) channel.values[i / components][i % components] = (*values)[i];
    return channel;
}

struct Ignored {
    bool morphs = false;
    bool targets = false;
    bool matrices = false;
};

Result<void> addClips(const tinygltf::Model& model, const GltfData& data, const NodeOrder& order, Scene& scene,
                      Ignored& ignored) {
    uint64_t keys = 0;
    for (size_t a = 0; a < model.animations.size(); ++a) {
        const tinygltf::Animation& animation = model.animations[a];
        Clip clip{animation.name, 0, {}};
        for (size_t c = 0; c < animation.channels.size(); ++c) {
            const tinygltf::AnimationChannel& source = animation.channels[c];
            const std::string place = std::format("animation {}: channel {}", a, c);
            const std::string& path = source.target_path;
            ignored.morphs |= path == "weights";
            const bool known = path == "translation" || path == "rotation" || path == "scale";
            ignored.targets |= !known && path != "weights";
            if (!known || source.target_node < 0) continue;
            if (!contains(model.nodes, source.target_node))
                return inputError(std::format("{}: node {} does not exist", place, source.target_node));
            auto channel = at(place, makeChannel(animation, source, data));
            if (!channel) return std::unexpected(channel.error());
            channel->node = order.place[source.target_node];
            keys += channel->values.size();
            if (keys > kMaxKeys) return inputError(std::format("its animations hold more than {} keys", kMaxKeys));
            if (Node& node = scene.skeleton.nodes[channel->node]; node.matrix) {
                splitMatrix(node);
                ignored.matrices = true;
            }
            for (const float time : channel->times) clip.duration = std::max(clip.duration, time);
            clip.channels.push_back(std::move(*channel));
        }
        if (!clip.channels.empty()) scene.clips.push_back(std::move(clip));
    }
    return {};
}

// --- skins and instances ----------------------------------------------------------------------------------------

Result<uint32_t> addSkin(const tinygltf::Model& model, int index, const GltfData& data, const NodeOrder& order,
                         Skeleton& skeleton) {
    const tinygltf::Skin& skin = model.skins[index];
    if (skin.joints.empty()) return inputError("has no joint");
    if (skeleton.joints.size() + skin.joints.size() > kMaxJoints)
        return inputError(std::format("the scene has more than the limit of {} joints", kMaxJoints));
    std::vector<float> matrices;
    if (skin.inverseBindMatrices >= 0) {
        auto read = at("inverseBindMatrices", readFloats(data, skin.inverseBindMatrices, 16));
        if (!read) return std::unexpected(read.error());
        matrices = std::move(*read);
        if (matrices.size() < skin.joints.size() * 16)
            return inputError(
                std::format("has {} joints but {} inverse bind matrices", skin.joints.size(), matrices.size() / 16));
    }
    const auto first = static_cast<uint32_t>(skeleton.joints.size());
    for (size_t j = 0; j < skin.joints.size(); ++j) {
        if (!contains(model.nodes, skin.joints[j]))
            return inputError(std::format("joint {}: node {} does not exist", j, skin.joints[j]));
        Joint joint{order.place[skin.joints[j]], glm::mat4(1)};
        if (!matrices.empty())
            for (int i = 0; i < 16; ++i) joint.inverseBind[i / 4][i % 4] = matrices[j * 16 + i];
        skeleton.joints.push_back(joint);
    }
    return first;
}

// One mesh on one node.
struct Instance {
    int node = 0;  // the file's index
    int mesh = 0;
    int skin = -1;
};

Result<std::vector<Instance>> findInstances(const tinygltf::Model& model, const NodeOrder& order,
                                            std::vector<std::string>& warnings) {
    auto visible = visibleNodes(model, order);
    if (!visible) return std::unexpected(visible.error());
    std::vector<Instance> shown, all;
    bool skinShown = false, anySkin = false;
    for (size_t i = 0; i < model.nodes.size(); ++i) {
        const tinygltf::Node& node = model.nodes[i];
        if (node.mesh < 0) continue;
        if (!contains(model.meshes, node.mesh))
            return inputError(std::format("node {}: mesh {} does not exist", i, node.mesh));
        if (node.skin >= 0 && !contains(model.skins, node.skin))
            return inputError(std::format("node {}: skin {} does not exist", i, node.skin));
        all.push_back({static_cast<int>(i), node.mesh, node.skin});
        anySkin |= node.skin >= 0;
        if (!(*visible)[i]) continue;
        shown.push_back(all.back());
        skinShown |= node.skin >= 0;
    }
    if (!anySkin) return inputError("has no skin: nothing to animate; give a file with a skinned mesh");
    if (!skinShown) warnings.push_back("the default scene shows no skinned mesh; all nodes of the file were taken");
    return skinShown ? shown : all;
}

struct Importer {
    const tinygltf::Model& model;
    const GltfData& data;
    const NodeOrder& order;
    Scene& scene;
    std::vector<std::vector<GltfMeshPart>> meshes;  // decoded on first use
    std::map<int, uint32_t> skinJoints;             // skin -> its first joint
    std::map<int, uint16_t> rigidJoints;            // node -> its joint
    std::vector<bool> mirrored;                     // by our node index, in the rest pose
    GltfRepairs repairs;
    Ignored ignored;
};

Result<const std::vector<GltfMeshPart>*> decodeMesh(Importer& in, int index) {
    std::vector<GltfMeshPart>& parts = in.meshes[index];
    const auto& primitives = in.model.meshes[index].primitives;
    for (size_t p = parts.size(); p < primitives.size(); ++p) {
        const std::string place =
            primitives.size() > 1 ? std::format("mesh {}: primitive {}", index, p) : std::format("mesh {}", index);
        auto primitive = at(place, makePrimitive(primitives[p], in.data));
        if (!primitive) return std::unexpected(primitive.error());
        in.ignored.morphs |= !primitives[p].targets.empty();
        const auto same = std::find_if(parts.begin(), parts.end(), [&](const GltfMeshPart& part) {
            return part.attributes == primitive->attributes && part.ownsVertices && !part.mesh.indices.empty();
        });
        const GltfMeshPart* shared = same == parts.end() ? nullptr : &*same;
        auto part = at(place, readPrimitive(in.data, *primitive, shared, in.repairs));
        if (!part) return std::unexpected(part.error());
        if (shared) part->sharedWith = same - parts.begin();
        parts.push_back(std::move(*part));
    }
    return &parts;
}

Result<uint16_t> rigidJoint(Importer& in, int node) {
    const auto [it, isNew] = in.rigidJoints.try_emplace(node, static_cast<uint16_t>(in.scene.skeleton.joints.size()));
    if (!isNew) return it->second;
    if (in.scene.skeleton.joints.size() >= kMaxJoints)
        return inputError(std::format("the scene has more than the limit of {} joints", kMaxJoints));
    in.scene.skeleton.joints.push_back({in.order.place[node], glm::mat4(1)});
    return it->second;
}

Result<void> appendVertices(Importer& in, const GltfMeshPart& part, const Instance& instance, bool skinned) {
    Mesh& mesh = in.scene.mesh;
    const Mesh& source = part.mesh;
    if (mesh.positions.size() + source.positions.size() > kMaxVertices)
        return inputError(std::format("the scene has more than {} vertices", kMaxVertices));
    mesh.positions.insert(mesh.positions.end(), source.positions.begin(), source.positions.end());
    mesh.normals.insert(mesh.normals.end(), source.normals.begin(), source.normals.end());
    mesh.uvs.insert(mesh.uvs.end(), source.uvs.begin(), source.uvs.end());
    if (!skinned) {
        const auto joint = rigidJoint(in, instance.node);
        if (!joint) return std::unexpected(joint.error());
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
                return inputError(std::format("vertex {} names joint {}, but skin {} has {} joints", v,
                                              influences.joints[k], instance.skin, joints));
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
    const auto parts = decodeMesh(in, instance.mesh);
    if (!parts) return std::unexpected(parts.error());
    std::vector<size_t> firstVertex((*parts)->size());
    for (size_t p = 0; p < (*parts)->size(); ++p) {
        const GltfMeshPart& part = (**parts)[p];
        const bool skinned = instance.skin >= 0 && part.skinned;
        firstVertex[p] = part.ownsVertices ? in.scene.mesh.positions.size() : firstVertex[part.sharedWith];
        if (part.mesh.indices.empty()) continue;
        if (part.ownsVertices)
            if (auto ok = at(place, appendVertices(in, part, instance, skinned)); !ok) return ok;
        std::vector<uint32_t>& indices = in.scene.mesh.indices;
        if (indices.size() + part.mesh.indices.size() > kMaxIndices)
            return inputError(std::format("the scene has more than {} triangles", kMaxIndices / 3));
        const auto begin = static_cast<uint32_t>(indices.size());
        for (const uint32_t index : part.mesh.indices) indices.push_back(static_cast<uint32_t>(firstVertex[p] + index));
        if (!skinned && in.mirrored[in.order.place[instance.node]])
            for (size_t i = begin; i < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
        in.scene.parts.push_back(
            {partName(in, instance, p), begin, static_cast<uint32_t>(part.mesh.indices.size()), !skinned});
    }
    return {};
}

std::vector<bool> mirroredNodes(const Skeleton& skeleton) {
    std::vector<bool> mirrored(skeleton.nodes.size());
    for (size_t i = 0; i < mirrored.size(); ++i) {
        const Node& node = skeleton.nodes[i];
        const float sign =
            node.matrix ? glm::determinant(glm::mat3(*node.matrix)) : node.scale.x * node.scale.y * node.scale.z;
        mirrored[i] = (sign < 0) != (node.parent >= 0 && mirrored[node.parent]);
    }
    return mirrored;
}

void addWarnings(const GltfRepairs& repairs, const Ignored& ignored, std::vector<std::string>& warnings) {
    for (std::string& text : describe(repairs)) warnings.push_back(std::move(text));
    if (ignored.morphs) warnings.push_back("morph targets are ignored");
    if (ignored.targets) warnings.push_back("animation channels with an unknown target are ignored");
    if (ignored.matrices)
        warnings.push_back("animated nodes with a matrix had it split into translation, rotation and scale");
}

Result<Scene> buildScene(const tinygltf::Model& model, const GltfFile& file) {
    const auto data = makeData(model, file);
    if (!data) return std::unexpected(data.error());
    const auto order = orderNodes(model);
    if (!order) return std::unexpected(order.error());
    Scene scene;
    for (const int node : order->sorted) {
        const int parent = order->parents[node];
        scene.skeleton.nodes.push_back(
            makeNode(model.nodes[node], parent < 0 ? -1 : static_cast<int>(order->place[parent])));
    }
    const auto instances = findInstances(model, *order, scene.warnings);
    if (!instances) return std::unexpected(instances.error());
    Importer in{model, *data, *order, scene, std::vector<std::vector<GltfMeshPart>>(model.meshes.size()),
                {},    {},    {},     {},    {}};
    if (auto ok = addClips(model, *data, *order, scene, in.ignored); !ok) return std::unexpected(ok.error());
    in.mirrored = mirroredNodes(scene.skeleton);
    // All skins come first, so that the joint numbers of a file do not depend on its static meshes.
    for (const Instance& instance : *instances) {
        if (instance.skin < 0 || in.skinJoints.contains(instance.skin)) continue;
        const auto first =
            at(std::format("skin {}", instance.skin), addSkin(model, instance.skin, *data, *order, scene.skeleton));
        if (!first) return std::unexpected(first.error());
        in.skinJoints[instance.skin] = *first;
    }
    for (const Instance& instance : *instances)
        if (auto ok = addInstance(in, instance); !ok) return std::unexpected(ok.error());
    if (scene.mesh.indices.empty()) return inputError("has no triangle to draw");
    addWarnings(in.repairs, in.ignored, scene.warnings);
    if (auto ok = checkScene(scene); !ok) return std::unexpected(ok.error());
    return scene;
}

Result<Scene> loadUnnamed(const std::string& path) {
    const auto file = readGltfFile(path);
    if (!file) return std::unexpected(file.error());
    const auto model = parseModel(file->json);
    if (!model) return std::unexpected(model.error());
    return buildScene(*model, *file);
}

}  // namespace

Result<Scene> loadGltf(const std::string& path) {
    const std::filesystem::path source(path);
    const std::string name = source.has_filename() ? source.filename().string() : path;
    try {
        auto scene = loadUnnamed(path);
        if (!scene) return failed(name, scene.error());
        scene->name = source.stem().string();
        return scene;
    } catch (const std::bad_alloc&) {
        return inputError(name + ": does not fit into memory");
    } catch (const std::exception& error) {
        return inputError(name + ": cannot be read: " + error.what());
    }
}

}  // namespace skinbench
