#include "common/scene/gltf/gltf_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <format>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <string_view>

#include <nlohmann/json.hpp>

namespace skinbench {
namespace {

using nlohmann::json;

constexpr uint64_t kMaxFileBytes = 0xFFFFFFFFu;  // a GLB counts its bytes in 32 bits
constexpr int kMaxJsonDepth = 100;
constexpr uint32_t kGlbMagic = 0x46546C67;
constexpr uint32_t kChunkJson = 0x4E4F534A;
constexpr uint32_t kChunkBin = 0x004E4942;
constexpr uint64_t kMaxIndex = std::numeric_limits<int32_t>::max();
constexpr uint64_t kMaxSize = 1ull << 48;

Result<std::vector<uint8_t>> readFile(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) return inputError("there is no such file");
    if (std::filesystem::is_directory(status)) return inputError("is a folder, not a glTF file");
    if (!std::filesystem::is_regular_file(status)) return inputError("is not a regular file");
    const uint64_t size = std::filesystem::file_size(path, error);
    if (error) return inputError("cannot be read: " + error.message());
    if (size > kMaxFileBytes) return inputError(std::format("has {} bytes; 4 GiB is the limit of glTF binaries", size));
    std::ifstream stream(path, std::ios::binary);
    std::vector<uint8_t> bytes(size);
    if (!stream) return inputError("cannot be opened; check its permissions");
    if (size > 0 && !stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
        return inputError("cannot be read to its end");
    return bytes;
}

uint32_t readWord(std::span<const uint8_t> bytes, size_t offset) {
    return bytes[offset] | bytes[offset + 1] << 8 | bytes[offset + 2] << 16 | uint32_t{bytes[offset + 3]} << 24;
}

struct Chunks {
    std::span<const uint8_t> json;
    std::span<const uint8_t> bin;
    bool hasBin = false;
};

Result<Chunks> splitGlb(std::span<const uint8_t> bytes) {
    if (bytes.size() < 12) return inputError("the GLB is cut off inside its header");
    const uint32_t version = readWord(bytes, 4);
    if (version == 1) return inputError("is glTF 1.0; only glTF 2.0 can be read, convert the file first");
    if (version != 2)
        return inputError(std::format("has GLB container version {}; only version 2 can be read", version));
    const uint32_t length = readWord(bytes, 8);
    if (length > bytes.size())
        return inputError(
            std::format("the GLB is cut off: its header says {} bytes, the file has {}", length, bytes.size()));
    Chunks chunks;
    size_t offset = 12;
    for (int index = 0; offset + 8 <= length; ++index) {
        const uint64_t chunkLength = readWord(bytes, offset);
        const uint32_t type = readWord(bytes, offset + 4);
        if (chunkLength > length - offset - 8)
            return inputError(
                std::format("GLB chunk {} of {} bytes goes past the end of the file", index, chunkLength));
        const auto chunk = bytes.subspan(offset + 8, chunkLength);
        if ((index == 0) != (type == kChunkJson)) return inputError("the first chunk of the GLB must be its one JSON");
        if (index == 0) chunks.json = chunk;
        if (index == 1 && type == kChunkBin) {
            chunks.bin = chunk;
            chunks.hasBin = true;
        }
        offset += 8 + chunkLength;
    }
    if (chunks.json.empty()) return inputError("the GLB has no JSON chunk");
    return chunks;
}

// Later stages (tinygltf's conversion of extensions among them) recurse over the tree; this bounds them.
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

Result<json> parseJson(std::span<const uint8_t> bytes) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    while (!text.empty() && text.back() == '\0') text.remove_suffix(1);
    const size_t first = text.find_first_not_of(" \t\r\n");
    if (first == text.npos || text[first] != '{')
        return inputError("is neither a glTF text (.gltf) nor a glTF binary (.glb)");
    if (!depthIsBounded(text)) return inputError(std::format("nests its JSON deeper than {} levels", kMaxJsonDepth));
    try {
        return json::parse(text);
    } catch (const json::parse_error& error) {
        return inputError(std::format("its JSON is broken near byte {}", error.byte));
    } catch (const json::exception&) {
        return inputError("its JSON holds a number that is out of range");
    }
}

// --- checks of the tree -----------------------------------------------------------------------------------------

// Turns 12.0 into 12, which JSON does not tell apart, and refuses what is no whole number in [0, limit].
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
        if (auto it = object.find(key); it != object.end())
            if (auto ok = wholeNumber(*it, where + ": " + key, limit); !ok) return ok;
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

template <class Check>
Result<void> forEachObject(json& parent, const std::string& where, const char* key, const char* singular, Check check) {
    const auto it = parent.find(key);
    if (it == parent.end()) return {};
    const std::string prefix = where.empty() ? "" : where + ": ";
    if (!it->is_array()) return inputError(prefix + key + " must be an array");
    for (size_t i = 0; i < it->size(); ++i) {
        const std::string place = std::format("{}{} {}", prefix, singular, i);
        if (!(*it)[i].is_object()) return inputError(place + " must be an object");
        (*it)[i].erase("extras");
        if (auto ok = check((*it)[i], place); !ok) return ok;
    }
    return {};
}

Result<void> checkBufferView(json& view, const std::string& where) {
    if (!view.contains("buffer") || !view.contains("byteLength"))
        return inputError(where + " needs a buffer and a byteLength");
    if (auto ok = wholeNumbers(view, where, {"buffer", "target"}); !ok) return ok;
    if (auto ok = wholeNumbers(view, where, {"byteOffset", "byteLength"}, kMaxSize); !ok) return ok;
    if (auto ok = wholeNumbers(view, where, {"byteStride"}); !ok) return ok;
    // tinygltf keeps extension values as 32-bit integers.
    if (const auto all = view.find("extensions"); all != view.end() && all->is_object())
        if (const auto it = all->find("EXT_meshopt_compression"); it != all->end()) {
            if (!it->is_object()) return inputError(where + ": EXT_meshopt_compression must be an object");
            const auto keys = {"buffer", "byteOffset", "byteLength", "count", "byteStride"};
            if (auto ok = wholeNumbers(*it, where + ": EXT_meshopt_compression", keys); !ok) return ok;
        }
    if (const auto it = view.find("byteStride"); it != view.end()) {
        const uint64_t stride = it->get<uint64_t>();
        if (stride < 4 || stride > 252 || stride % 4 != 0)
            return inputError(std::format("{}: byteStride {} must be a multiple of 4 from 4 to 252", where, stride));
    }
    return {};
}

Result<void> checkAccessor(json& accessor, const std::string& where) {
    for (const char* key : {"componentType", "count", "type"})
        if (!accessor.contains(key)) return inputError(where + " has no " + key);
    accessor.erase("min");
    accessor.erase("max");
    accessor.erase("extensions");
    if (auto ok = wholeNumbers(accessor, where, {"bufferView", "componentType"}); !ok) return ok;
    if (auto ok = wholeNumbers(accessor, where, {"byteOffset", "count"}, kMaxSize); !ok) return ok;
    const auto sparse = accessor.find("sparse");
    if (sparse == accessor.end()) return {};
    for (const char* key : {"indices", "values"})
        if (!sparse->is_object() || !sparse->contains(key) || !(*sparse)[key].contains("bufferView"))
            return inputError(std::format("{}: sparse has no {} with a bufferView", where, key));
    json& indices = (*sparse)["indices"];
    if (!sparse->contains("count") || !indices.contains("componentType"))
        return inputError(where + ": sparse has no count or no componentType");
    if (auto ok = wholeNumbers(*sparse, where + ": sparse", {"count"}); !ok) return ok;
    for (const char* key : {"indices", "values"}) {
        if (auto ok = wholeNumbers((*sparse)[key], where + ": sparse", {"bufferView", "componentType"}); !ok) return ok;
        if (auto ok = wholeNumbers((*sparse)[key], where + ": sparse", {"byteOffset"}, kMaxSize); !ok) return ok;
    }
    return {};
}

Result<void> checkMesh(json& mesh, const std::string& where, size_t accessors) {
    mesh.erase("weights");
    mesh.erase("extensions");
    return forEachObject(mesh, where, "primitives", "primitive",
                         [=](json& primitive, const std::string& place) -> Result<void> {
                             const auto attributes = primitive.find("attributes");
                             if (attributes == primitive.end() || !attributes->is_object())
                                 return inputError(place + " has no attributes");
                             for (auto& [name, accessor] : attributes->items())
                                 if (auto ok = wholeNumber(accessor, place + ": " + name, kMaxIndex); !ok) return ok;
                             const uint64_t last = std::max<size_t>(accessors, 1) - 1;
                             if (auto ok = wholeNumbers(primitive, place, {"indices"}, last); !ok) return ok;
                             return wholeNumbers(primitive, place, {"mode", "material"});
                         });
}

Result<void> checkNode(json& node, const std::string& where) {
    node.erase("extensions");
    node.erase("weights");
    node.erase("camera");
    if (auto ok = wholeNumbers(node, where, {"mesh", "skin"}); !ok) return ok;
    if (auto ok = numberArray(node, where, "translation", 3); !ok) return ok;
    if (auto ok = numberArray(node, where, "rotation", 4); !ok) return ok;
    if (auto ok = numberArray(node, where, "scale", 3); !ok) return ok;
    if (auto ok = numberArray(node, where, "matrix", 16); !ok) return ok;
    return wholeNumberArray(node, where, "children");
}

Result<void> checkAnimation(json& animation, const std::string& where) {
    animation.erase("extensions");
    auto ok = forEachObject(animation, where, "channels", "channel",
                            [](json& channel, const std::string& place) -> Result<void> {
                                const auto target = channel.find("target");
                                if (target == channel.end() || !target->is_object() || !channel.contains("sampler"))
                                    return inputError(place + " needs a sampler and a target");
                                const auto path = target->find("path");
                                if (path == target->end() || !path->is_string())
                                    return inputError(place + " has no target path");
                                target->erase("extensions");
                                target->erase("extras");
                                if (auto good = wholeNumbers(channel, place, {"sampler"}); !good) return good;
                                return wholeNumbers(*target, place, {"node"});
                            });
    if (!ok) return ok;
    return forEachObject(animation, where, "samplers", "sampler",
                         [](json& sampler, const std::string& place) -> Result<void> {
                             if (!sampler.contains("input") || !sampler.contains("output"))
                                 return inputError(place + " needs an input and an output");
                             return wholeNumbers(sampler, place, {"input", "output"});
                         });
}

Result<void> checkTree(json& tree) {
    if (auto ok = forEachObject(tree, "", "bufferViews", "bufferView", checkBufferView); !ok) return ok;
    if (auto ok = forEachObject(tree, "", "accessors", "accessor", checkAccessor); !ok) return ok;
    const size_t accessors = tree.contains("accessors") ? tree["accessors"].size() : 0;
    const auto checkOneMesh = [&](json& mesh, const std::string& where) { return checkMesh(mesh, where, accessors); };
    if (auto ok = forEachObject(tree, "", "meshes", "mesh", checkOneMesh); !ok) return ok;
    if (auto ok = forEachObject(tree, "", "nodes", "node", checkNode); !ok) return ok;
    if (auto ok = forEachObject(tree, "", "animations", "animation", checkAnimation); !ok) return ok;
    auto ok = forEachObject(tree, "", "skins", "skin", [](json& skin, const std::string& where) -> Result<void> {
        skin.erase("extensions");
        if (auto good = wholeNumbers(skin, where, {"inverseBindMatrices"}); !good) return good;
        skin.erase("skeleton");
        return wholeNumberArray(skin, where, "joints");
    });
    if (!ok) return ok;
    ok = forEachObject(tree, "", "scenes", "scene", [](json& scene, const std::string& where) -> Result<void> {
        scene.erase("extensions");
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
        return inputError("is glTF " + text.substr(0, 20) + "; only glTF 2.0 can be read, convert the file first");
    return {};
}

// Materials, textures and lights are never read, so an extension that only changes those cannot matter.
Result<void> checkExtensions(const json& tree) {
    const auto required = tree.find("extensionsRequired");
    if (required == tree.end()) return {};
    if (!required->is_array()) return inputError("extensionsRequired must be an array");
    for (const json& entry : *required) {
        if (!entry.is_string()) return inputError("extensionsRequired must hold names");
        const std::string name = entry.get<std::string>();
        constexpr std::array<std::string_view, 5> kHarmless = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                               "MSFT_texture_", "KHR_lights_"};
        const bool known =
            name == "EXT_meshopt_compression" || name == "KHR_mesh_quantization" ||
            std::ranges::any_of(kHarmless, [&](std::string_view start) { return name.starts_with(start); });
        if (!known)
            return inputError("needs the extension " + name.substr(0, 80) +
                              ", which is not supported; export the file without it");
    }
    return {};
}

// --- buffers ----------------------------------------------------------------------------------------------------

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string decodeUri(std::string_view uri) {
    std::string path;
    for (size_t i = 0; i < uri.size(); ++i) {
        const bool escape =
            uri[i] == '%' && i + 2 < uri.size() && hexDigit(uri[i + 1]) >= 0 && hexDigit(uri[i + 2]) >= 0;
        path += escape ? static_cast<char>(hexDigit(uri[i + 1]) * 16 + hexDigit(uri[i + 2])) : uri[i];
        if (escape) i += 2;
    }
    return path;
}

Result<std::vector<uint8_t>> decodeBase64(std::string_view text) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<int8_t, 256> value;
    value.fill(-1);
    for (size_t i = 0; i < kDigits.size(); ++i) value[static_cast<uint8_t>(kDigits[i])] = static_cast<int8_t>(i);
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::vector<uint8_t> bytes;
    bytes.reserve(text.size() * 3 / 4);
    uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int digit = value[static_cast<uint8_t>(c)];
        if (digit < 0) return inputError("its data URI is not base64");
        bits = bits << 6 | static_cast<uint32_t>(digit);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes.push_back(static_cast<uint8_t>(bits >> count));
        }
    }
    return bytes;
}

Result<std::vector<uint8_t>> loadUri(const std::string& uri, const std::filesystem::path& folder) {
    if (uri.starts_with("data:")) {
        const size_t comma = uri.find(',');
        if (comma == uri.npos || !std::string_view(uri).substr(0, comma).ends_with(";base64"))
            return inputError("its data URI is not base64");
        return decodeBase64(std::string_view(uri).substr(comma + 1));
    }
    if (uri.find("://") != uri.npos) return inputError("its uri is no path of a local file");
    const std::string path = decodeUri(uri);
    if (path.find('\0') != path.npos) return inputError("its uri is no path of a local file");
    auto bytes = readFile(folder / std::filesystem::path(std::u8string(path.begin(), path.end())));
    if (!bytes) return std::unexpected(Error{bytes.error().fault, path.substr(0, 200) + ": " + bytes.error().text});
    return bytes;
}

Result<void> loadBuffer(GltfFile& file, json& buffer, size_t index, const Chunks& chunks,
                        const std::filesystem::path& folder) {
    const std::string where = std::format("buffer {}", index);
    if (!buffer.is_object() || !buffer.contains("byteLength")) return inputError(where + " has no byteLength");
    if (auto ok = wholeNumbers(buffer, where, {"byteLength"}, kMaxSize); !ok) return ok;
    const uint64_t length = buffer["byteLength"].get<uint64_t>();
    const auto uri = buffer.find("uri");
    std::span<const uint8_t> bytes;
    if (uri != buffer.end()) {
        if (!uri->is_string()) return inputError(where + ": uri must be a string");
        auto loaded = loadUri(uri->get_ref<const std::string&>(), folder);
        if (!loaded) return std::unexpected(Error{loaded.error().fault, where + ": " + loaded.error().text});
        file.storage.push_back(std::move(*loaded));
        bytes = file.storage.back();
    } else if (index == 0 && chunks.hasBin) {
        bytes = chunks.bin;
    } else if (buffer.contains("extensions") && buffer["extensions"].is_object() &&
               buffer["extensions"].contains("EXT_meshopt_compression")) {
        file.buffers.emplace_back();
        return {};
    } else {
        return inputError(where + " has no uri, and the file has no binary chunk for it");
    }
    if (bytes.size() < length)
        return inputError(
            std::format("{}: byteLength is {}, but there are only {} bytes", where, length, bytes.size()));
    file.buffers.push_back(bytes.first(length));
    return {};
}

}  // namespace

Result<GltfFile> readGltfFile(const std::string& path) {
    auto bytes = readFile(path);
    if (!bytes) return std::unexpected(bytes.error());
    if (bytes->empty()) return inputError("is empty");

    GltfFile file;
    file.storage.push_back(std::move(*bytes));
    const std::span<const uint8_t> all = file.storage.back();
    Chunks chunks{all, {}, false};
    if (all.size() >= 4 && readWord(all, 0) == kGlbMagic) {
        auto split = splitGlb(all);
        if (!split) return std::unexpected(split.error());
        chunks = *split;
    }
    auto tree = parseJson(chunks.json);
    if (!tree) return std::unexpected(tree.error());
    if (auto ok = checkVersion(*tree); !ok) return std::unexpected(ok.error());
    if (auto ok = checkExtensions(*tree); !ok) return std::unexpected(ok.error());
    if (auto ok = checkTree(*tree); !ok) return std::unexpected(ok.error());

    if (auto buffers = tree->find("buffers"); buffers != tree->end()) {
        if (!buffers->is_array()) return inputError("buffers must be an array");
        for (size_t i = 0; i < buffers->size(); ++i)
            if (auto ok = loadBuffer(file, (*buffers)[i], i, chunks, std::filesystem::path(path).parent_path()); !ok)
                return std::unexpected(ok.error());
    }
    json kept = {{"asset", {{"version", "2.0"}}}};
    for (const char* key : {"bufferViews", "accessors", "meshes", "nodes", "scenes", "scene", "animations", "skins"})
        if (auto it = tree->find(key); it != tree->end()) kept[key] = std::move(*it);
    file.json = kept.dump(-1, ' ', false, json::error_handler_t::replace);
    return file;
}

}  // namespace skinbench
