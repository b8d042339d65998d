#include "common/scene/gltf/gltf_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <format>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "common/core/utf8.h"

namespace skinbench {
namespace {

using nlohmann::json;

constexpr int kMaxJsonDepth = 100;
constexpr size_t kMaxFaults = 1000;
constexpr uint64_t kMaxIndex = std::numeric_limits<int32_t>::max();

// Later stages recurse over the tree; this bounds them.
bool depthIsBounded(std::string_view text) {
    int depth = 0;
    bool inString = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (inString) {
            if (c == '\\') ++i;
            if (c == '"') inString = false;
            continue;
        }
        if (c == '"') inString = true;
        if (c == '{' || c == '[') ++depth;
        if (c == '}' || c == ']') --depth;
        if (depth > kMaxJsonDepth) return false;
    }
    return true;
}

Result<void> wholeNumber(json& value, const std::string& where, uint64_t limit) {
    if (value.is_number_float()) {
        const double number = value.get<double>();
        if (number >= 0 && number <= 9e15 && number == std::floor(number)) value = static_cast<uint64_t>(number);
    }
    const bool negative = value.is_number_integer() && !value.is_number_unsigned() && value.get<int64_t>() < 0;
    if (!value.is_number_integer() || negative || value.get<uint64_t>() > limit)
        return inputError(std::format("{} must be a whole number from 0 to {}", where, limit));
    return {};
}

Result<void> wholeNumbers(json& object, const std::string& where, std::initializer_list<const char*> keys,
                          uint64_t limit = kMaxIndex) {
    for (const char* key : keys)
        if (auto ok = checkWholeNumber(object, where, key, limit); !ok) return ok;
    return {};
}

Result<void> wholeNumberArray(json& object, const std::string& where, const char* key) {
    const auto it = object.find(key);
    if (it == object.end()) return {};
    if (!it->is_array()) return inputError(where + ": " + key + " must be an array");
    for (json& value : *it)
        if (auto ok = wholeNumber(value, where + ": " + key, kMaxIndex); !ok) return ok;
    return {};
}

Result<void> numberArray(const json& object, const std::string& where, const char* key, size_t count) {
    const auto it = object.find(key);
    if (it == object.end()) return {};
    const bool good = it->is_array() && it->size() == count &&
                      std::ranges::all_of(*it, [](const json& value) { return value.is_number(); });
    if (!good) return inputError(std::format("{}: {} must hold {} numbers", where, key, count));
    return {};
}

// Counts and takes away.
void takeExtensions(json& object, FoundExtensions& found) {
    const auto all = object.find("extensions");
    if (all == object.end()) return;
    if (all->is_object())
        for (const auto& [name, value] : all->items()) ++found.counts[name];
    object.erase(all);
}

template <class Check>
Result<void> forEachObject(json& parent, const std::string& where, const char* key, const char* singular, Check check) {
    const auto it = parent.find(key);
    if (it == parent.end()) return {};
    const std::string prefix = where.empty() ? "" : where + ": ";
    if (!it->is_array()) return inputError(prefix + key + " must be an array");
    for (size_t i = 0; i < it->size(); ++i) {
        const std::string place = std::format("{}{} {}", prefix, singular, i);
        json& object = (*it)[i];
        if (!object.is_object()) return inputError(place + " must be an object");
        object.erase("extras");
        if (const auto name = object.find("name"); name != object.end() && !name->is_string()) object.erase(name);
        if (auto ok = check(object, place); !ok) return ok;
    }
    return {};
}

// As above, but a broken object becomes `empty` and is remembered.
template <class Check>
Result<void> forEachPart(json& tree, const char* key, const char* singular, const json& empty, GltfFaults& faults,
                         Check check) {
    const auto it = tree.find(key);
    if (it == tree.end()) return {};
    if (!it->is_array()) return inputError(std::string(key) + " must be an array");
    for (size_t i = 0; i < it->size(); ++i) {
        const std::string place = std::format("{} {}", singular, i);
        json& object = (*it)[i];
        Result<void> good;
        if (!object.is_object()) {
            good = inputError(place + " must be an object");
        } else {
            object.erase("extras");
            if (const auto name = object.find("name"); name != object.end() && !name->is_string()) object.erase(name);
            good = check(object, i, place);
        }
        if (good) continue;
        // Each becomes an empty one, which takes more memory than "0," takes of the file.
        if (faults.size() == kMaxFaults)
            return inputError(std::format("more than {} of its {} are broken; the first: {}", kMaxFaults, key,
                                          faults.begin()->second));
        faults[i] = good.error().text;
        object = empty;
    }
    return {};
}

Result<void> takeCompression(json& view, size_t index, const std::string& where, GltfTree& out) {
    const json* found = findMeshopt(view);
    if (!found) return {};
    const std::string name =
        view["extensions"].contains("KHR_meshopt_compression") ? "KHR_meshopt_compression" : "EXT_meshopt_compression";
    const std::string place = where + ": " + name;
    if (!found->is_object()) return inputError(place + " must be an object");
    json packed = *found;
    if (auto ok = wholeNumbers(packed, place, {"buffer", "byteOffset", "byteLength", "count", "byteStride"}); !ok)
        return ok;
    if (!packed.contains("buffer")) return inputError(place + " names no buffer");
    const auto number = [&](const char* key) { return packed.contains(key) ? packed[key].get<uint64_t>() : 0; };
    const auto word = [&](const char* key) {
        return packed.contains(key) && packed[key].is_string() ? packed[key].get<std::string>() : std::string();
    };
    CompressedView compressed;
    compressed.extension = name;
    compressed.buffer = number("buffer");
    compressed.offset = number("byteOffset");
    compressed.length = number("byteLength");
    compressed.count = number("count");
    compressed.stride = number("byteStride");
    compressed.mode = word("mode");
    compressed.filter = word("filter");
    out.packed[index] = std::move(compressed);
    return {};
}

Result<void> checkBufferView(json& view, size_t index, const std::string& where, GltfTree& out) {
    if (!view.contains("buffer") || !view.contains("byteLength"))
        return inputError(where + " needs a buffer and a byteLength");
    if (auto ok = wholeNumbers(view, where, {"buffer"}); !ok) return ok;
    if (auto ok = wholeNumbers(view, where, {"byteOffset", "byteLength"}, kMaxGltfSize); !ok) return ok;
    if (auto ok = wholeNumbers(view, where, {"byteStride"}); !ok) return ok;
    view.erase("target");
    if (auto ok = takeCompression(view, index, where, out); !ok) return ok;
    takeExtensions(view, out.extensions);
    const auto stride = view.find("byteStride");
    if (stride == view.end()) return {};
    const uint64_t bytes = stride->get<uint64_t>();
    // The specification forbids 0; other readers take it as tightly packed, as OpenGL does.
    if (bytes == 0) {
        out.notes.add(GltfNote::zeroStrides);
        view.erase(stride);
    }
    if (bytes != 0 && (bytes < 4 || bytes > 252 || bytes % 4 != 0))
        return inputError(std::format("{}: byteStride {} must be a multiple of 4 from 4 to 252", where, bytes));
    return {};
}

Result<void> checkSparse(json& sparse, const std::string& where) {
    for (const char* key : {"indices", "values"})
        if (!sparse.is_object() || !sparse.contains(key) || !sparse[key].is_object() ||
            !sparse[key].contains("bufferView"))
            return inputError(std::format("{}: sparse has no {} with a bufferView", where, key));
    if (!sparse.contains("count") || !sparse["indices"].contains("componentType"))
        return inputError(where + ": sparse has no count or no componentType");
    if (auto ok = wholeNumbers(sparse, where + ": sparse", {"count"}); !ok) return ok;
    for (const char* key : {"indices", "values"}) {
        if (auto ok = wholeNumbers(sparse[key], where + ": sparse", {"bufferView", "componentType"}); !ok) return ok;
        if (auto ok = wholeNumbers(sparse[key], where + ": sparse", {"byteOffset"}, kMaxGltfSize); !ok) return ok;
    }
    return {};
}

// Takes the list away. Empty: it is missing, or holds anything but a few numbers.
std::vector<float> takeBound(json& accessor, const char* key) {
    const auto it = accessor.find(key);
    if (it == accessor.end()) return {};
    std::vector<float> bound;
    if (it->is_array() && it->size() <= 16 && std::ranges::all_of(*it, [](const json& v) { return v.is_number(); }))
        for (const json& value : *it) bound.push_back(value.get<float>());
    accessor.erase(it);
    return bound;
}

Result<void> checkAccessor(json& accessor, size_t index, const std::string& where, GltfTree& out) {
    for (const char* key : {"componentType", "count", "type"})
        if (!accessor.contains(key)) return inputError(where + " has no " + key);
    if (GltfBounds bounds{takeBound(accessor, "min"), takeBound(accessor, "max")}; !bounds.min.empty())
        out.bounds[index] = std::move(bounds);
    takeExtensions(accessor, out.extensions);
    if (auto ok = wholeNumbers(accessor, where, {"bufferView", "componentType"}); !ok) return ok;
    if (auto ok = wholeNumbers(accessor, where, {"byteOffset", "count"}, kMaxGltfSize); !ok) return ok;
    constexpr std::array<int, 6> kComponents = {kGltfI8, kGltfU8, kGltfI16, kGltfU16, kGltfU32, kGltfF32};
    if (const int type = accessor["componentType"]; std::ranges::find(kComponents, type) == kComponents.end())
        return inputError(std::format("{}: has the unknown component type {}", where, type));
    constexpr std::array<std::string_view, 7> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    const json& type = accessor["type"];
    if (!type.is_string() || std::ranges::find(kTypes, type.get_ref<const std::string&>()) == kTypes.end())
        return inputError(where + ": has an unknown type, which is none of SCALAR, VEC2 to VEC4, MAT2 to MAT4");
    if (const auto flag = accessor.find("normalized"); flag != accessor.end() && !flag->is_boolean())
        return inputError(where + ": normalized must be true or false");
    const auto sparse = accessor.find("sparse");
    return sparse == accessor.end() ? Result<void>{} : checkSparse(*sparse, where);
}

// Positions that only Draco's bytes hold.
bool needsDraco(const json& primitive, const json& accessors) {
    const auto extensions = primitive.find("extensions");
    if (extensions == primitive.end() || !extensions->is_object() ||
        !extensions->contains("KHR_draco_mesh_compression"))
        return false;
    const auto position = primitive["attributes"].find("POSITION");
    return position != primitive["attributes"].end() && position->get<uint64_t>() < accessors.size() &&
           !accessors[position->get<uint64_t>()].contains("bufferView");
}

Result<void> checkPrimitive(json& primitive, const std::string& place, const json& accessors, GltfTree& out) {
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) return inputError(place + " has no attributes");
    for (auto& [name, accessor] : attributes->items())
        if (auto ok = wholeNumber(accessor, place + ": " + shortText(name, 40), kMaxIndex); !ok) return ok;
    const uint64_t last = std::max<size_t>(accessors.size(), 1) - 1;
    if (auto ok = wholeNumbers(primitive, place, {"indices"}, last); !ok) return ok;
    if (const auto targets = primitive.find("targets"); targets != primitive.end()) {
        out.notes.add(GltfNote::morphs);
        primitive.erase(targets);
    }
    if (needsDraco(primitive, accessors))
        return inputError(place + ": KHR_draco_mesh_compression is not supported; export the file without it");
    takeExtensions(primitive, out.extensions);
    primitive.erase("material");
    return wholeNumbers(primitive, place, {"mode"});
}

Result<void> checkMesh(json& mesh, const std::string& where, const json& accessors, GltfTree& out) {
    mesh.erase("weights");
    takeExtensions(mesh, out.extensions);
    if (!mesh.contains("primitives")) return inputError(where + " has no primitives");
    return forEachObject(mesh, where, "primitives", "primitive", [&](json& primitive, const std::string& place) {
        return checkPrimitive(primitive, place, accessors, out);
    });
}

bool isHidden(const json& node) {
    const auto all = node.find("extensions");
    if (all == node.end() || !all->is_object()) return false;
    const auto it = all->find("KHR_node_visibility");
    return it != all->end() && it->is_object() && it->value("visible", json(true)) == false;
}

// What is against the specification, but can be read.
void noteNode(const json& node, GltfNotes& notes) {
    const bool parts = node.contains("translation") || node.contains("rotation") || node.contains("scale");
    if (node.contains("matrix") && parts) notes.add(GltfNote::matrixAndParts);
    if (const auto it = node.find("rotation"); it != node.end()) {
        double sum = 0;
        for (const json& value : *it) sum += value.get<double>() * value.get<double>();
        if (std::abs(std::sqrt(sum) - 1) > 0.005) notes.add(GltfNote::longRotations);
    }
    if (const auto it = node.find("matrix"); it != node.end()) {
        std::array<double, 16> m{};
        for (size_t i = 0; i < 16; ++i) m[i] = (*it)[i].get<double>();
        const auto product = [&](int a, int b) {
            return m[a * 4] * m[b * 4] + m[a * 4 + 1] * m[b * 4 + 1] + m[a * 4 + 2] * m[b * 4 + 2];
        };
        bool sheared = m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1;
        for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}})
            sheared |= std::abs(product(a, b)) > 1e-3 * std::sqrt(product(a, a) * product(b, b));
        if (sheared) notes.add(GltfNote::shearedMatrices);
    }
}

Result<void> checkNode(json& node, const std::string& where, size_t index, GltfTree& out) {
    if (isHidden(node)) out.hidden.insert(index);
    takeExtensions(node, out.extensions);
    node.erase("weights");
    node.erase("camera");
    if (auto ok = wholeNumbers(node, where, {"mesh", "skin"}); !ok) return ok;
    if (auto ok = numberArray(node, where, "translation", 3); !ok) return ok;
    if (auto ok = numberArray(node, where, "rotation", 4); !ok) return ok;
    if (auto ok = numberArray(node, where, "scale", 3); !ok) return ok;
    if (auto ok = numberArray(node, where, "matrix", 16); !ok) return ok;
    noteNode(node, out.notes);
    return wholeNumberArray(node, where, "children");
}

Result<void> checkAnimation(json& animation, const std::string& where, FoundExtensions& found) {
    takeExtensions(animation, found);
    for (const char* key : {"channels", "samplers"})
        if (!animation.contains(key)) return inputError(where + " has no " + key);
    auto ok = forEachObject(animation, where, "channels", "channel",
                            [&](json& channel, const std::string& place) -> Result<void> {
                                const auto target = channel.find("target");
                                if (target == channel.end() || !target->is_object() || !channel.contains("sampler"))
                                    return inputError(place + " needs a sampler and a target");
                                const auto path = target->find("path");
                                if (path == target->end() || !path->is_string())
                                    return inputError(place + " has no target path");
                                takeExtensions(channel, found);
                                takeExtensions(*target, found);
                                target->erase("extras");
                                if (auto good = wholeNumbers(channel, place, {"sampler"}); !good) return good;
                                return wholeNumbers(*target, place, {"node"});
                            });
    if (!ok) return ok;
    return forEachObject(animation, where, "samplers", "sampler",
                         [&](json& sampler, const std::string& place) -> Result<void> {
                             takeExtensions(sampler, found);
                             if (!sampler.contains("input") || !sampler.contains("output"))
                                 return inputError(place + " needs an input and an output");
                             const auto how = sampler.find("interpolation");
                             if (how != sampler.end() && !how->is_string())
                                 return inputError(place + ": interpolation must be a name");
                             return wholeNumbers(sampler, place, {"input", "output"});
                         });
}

Result<void> checkSkin(json& skin, const std::string& where, GltfTree& out) {
    takeExtensions(skin, out.extensions);
    if (const auto it = skin.find("skeleton"); it != skin.end() && !wholeNumber(*it, where, kMaxIndex)) {
        out.notes.add(GltfNote::wrongSkeletons);
        skin.erase(it);
    }
    if (!skin.contains("joints")) return inputError(where + ": has no joints");
    if (auto ok = wholeNumbers(skin, where, {"inverseBindMatrices"}); !ok) return ok;
    return wholeNumberArray(skin, where, "joints");
}

Result<void> checkObjects(json& tree, GltfTree& out) {
    const json noView = {{"buffer", 0}, {"byteLength", 1}}, noMesh = {{"primitives", json::array()}},
               noSkin = {{"joints", json::array()}},
               noAccessor = {{"componentType", kGltfU8}, {"count", 1}, {"type", "SCALAR"}},
               noAnimation = {{"channels", json::array()}, {"samplers", json::array()}};
    auto ok = forEachPart(tree, "bufferViews", "bufferView", noView, out.views,
                          [&](json& view, size_t i, const std::string& p) { return checkBufferView(view, i, p, out); });
    if (!ok) return ok;
    ok =
        forEachPart(tree, "accessors", "accessor", noAccessor, out.accessors,
                    [&](json& accessor, size_t i, const std::string& p) { return checkAccessor(accessor, i, p, out); });
    if (!ok) return ok;
    const json accessors = tree.value("accessors", json::array());
    ok = forEachPart(tree, "meshes", "mesh", noMesh, out.meshes,
                     [&](json& mesh, size_t, const std::string& p) { return checkMesh(mesh, p, accessors, out); });
    if (!ok) return ok;
    ok = forEachPart(tree, "skins", "skin", noSkin, out.skins,
                     [&](json& skin, size_t, const std::string& p) { return checkSkin(skin, p, out); });
    if (!ok) return ok;
    ok = forEachPart(
        tree, "animations", "animation", noAnimation, out.animations,
        [&](json& animation, size_t, const std::string& p) { return checkAnimation(animation, p, out.extensions); });
    if (!ok) return ok;
    size_t node = 0;
    ok = forEachObject(tree, "", "nodes", "node",
                       [&](json& one, const std::string& p) { return checkNode(one, p, node++, out); });
    if (!ok) return ok;
    ok = forEachObject(tree, "", "scenes", "scene", [&](json& scene, const std::string& where) {
        takeExtensions(scene, out.extensions);
        return wholeNumberArray(scene, where, "nodes");
    });
    if (!ok) return ok;
    return wholeNumbers(tree, "glTF", {"scene"});
}

Result<void> checkVersion(const json& tree) {
    const auto asset = tree.find("asset");
    const auto version = asset != tree.end() && asset->is_object() ? asset->find("version") : asset;
    if (asset == tree.end() || !asset->is_object() || version == asset->end() || !version->is_string())
        return inputError("has no asset version, so it is not glTF 2.0");
    const std::string text = version->get<std::string>();
    if (!text.starts_with("2.") && text != "2")
        return inputError("is glTF " + shortText(text, 20) + "; only glTF 2.0 can be read, convert the file first");
    if (const auto least = asset->find("minVersion"); least != asset->end() && *least != "2.0" && *least != "2")
        return inputError("needs a reader of glTF " +
                          (least->is_string() ? shortText(least->get<std::string>(), 20) : "of an unknown version") +
                          " (asset.minVersion); only glTF 2.0 can be read");
    return {};
}

Result<void> checkRequiredExtensions(const json& tree) {
    const auto required = tree.find("extensionsRequired");
    if (required == tree.end()) return {};
    if (!required->is_array()) return inputError("extensionsRequired must be an array");
    for (const json& entry : *required) {
        if (!entry.is_string()) return inputError("extensionsRequired must hold names");
        if (auto ok = checkRequired(entry.get_ref<const std::string&>()); !ok) return ok;
    }
    return {};
}

void noteDeclared(const json& tree, GltfTree& out) {
    std::set<std::string> declared;
    for (const char* key : {"extensionsUsed", "extensionsRequired"})
        if (const auto list = tree.find(key); list != tree.end() && list->is_array())
            for (const json& entry : *list)
                if (entry.is_string()) declared.insert(entry.get<std::string>());
    out.quantization = declared.contains("KHR_mesh_quantization");
    for (const auto& [name, count] : out.extensions.counts)
        if (!declared.contains(name)) out.notes.add(GltfNote::undeclaredExtensions);
}

}  // namespace

Result<json> parseGltfJson(std::span<const uint8_t> bytes) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    while (!text.empty() && text.back() == '\0') text.remove_suffix(1);
    const size_t first = text.find_first_not_of(" \t\r\n");
    if (first == text.npos || text[first] != '{')
        return inputError("is neither a glTF text (.gltf) nor a glTF binary (.glb)");
    if (const size_t bad = firstBadUtf8(text); bad != text.npos)
        return inputError(
            std::format("its JSON is not UTF-8: byte {} of it, {:#04x}, starts no character; save it as "
                        "UTF-8",
                        bad, static_cast<uint8_t>(text[bad])));
    if (!depthIsBounded(text)) return inputError(std::format("nests its JSON deeper than {} levels", kMaxJsonDepth));
    try {
        return json::parse(text);
    } catch (const json::parse_error& error) {
        return inputError(std::format("its JSON is broken near byte {}", error.byte));
    } catch (const json::exception&) {
        return inputError("its JSON holds a number that is out of range");
    }
}

Result<void> checkWholeNumber(json& object, const std::string& where, const char* key, uint64_t limit) {
    const auto it = object.find(key);
    return it == object.end() ? Result<void>{} : wholeNumber(*it, where + ": " + key, limit);
}

const json* findMeshopt(const json& object) {
    const auto all = object.find("extensions");
    if (all == object.end() || !all->is_object()) return nullptr;
    for (const char* name : {"KHR_meshopt_compression", "EXT_meshopt_compression"})
        if (const auto it = all->find(name); it != all->end()) return &*it;
    return nullptr;
}

Result<GltfTree> checkGltfTree(json& tree) {
    GltfTree out;
    SKINBENCH_TRY(checkVersion(tree));
    // An extension that cannot be read explains every fault that follows from it.
    SKINBENCH_TRY(checkRequiredExtensions(tree));
    takeExtensions(tree, out.extensions);
    SKINBENCH_TRY(checkObjects(tree, out));
    noteDeclared(tree, out);
    json kept = {{"asset", {{"version", "2.0"}}}};
    for (const char* key : {"bufferViews", "accessors", "meshes", "nodes", "scenes", "scene", "animations", "skins"})
        if (auto it = tree.find(key); it != tree.end()) kept[key] = std::move(*it);
    out.json = kept.dump();
    return out;
}

}  // namespace skinbench
