#include "common/scene/gltf/gltf_file.h"

#include <filesystem>
#include <format>
#include <map>

#include <nlohmann/json.hpp>

#include "common/core/text.h"
#include "common/core/utf8.h"
#include "common/scene/gltf/gltf_uri.h"

namespace skinbench {
namespace {

using nlohmann::json;

constexpr uint32_t kGlbMagic = 0x46546C67;
constexpr uint32_t kChunkJson = 0x4E4F534A;
constexpr uint32_t kChunkBin = 0x004E4942;

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

// The files of a glTF that were read already.
using LoadedFiles = std::map<std::filesystem::path, std::span<const uint8_t>>;

Result<std::span<const uint8_t>> loadUri(GltfFile& file, const std::string& uri, const std::filesystem::path& folder,
                                         LoadedFiles& loaded) {
    if (isDataUri(uri)) {
        auto bytes = decodeDataUri(uri);
        SKINBENCH_TRY(bytes);
        return file.storage.emplace_back(std::move(*bytes));
    }
    const auto path = resolveUri(uri, folder);
    SKINBENCH_TRY(path);
    if (const auto known = loaded.find(*path); known != loaded.end()) return known->second;
    auto bytes = readGltfBytes(*path);
    if (!bytes)
        return std::unexpected(
            Error{bytes.error().fault, shortText(path->filename().string(), 200) + ": " + bytes.error().text});
    file.size += bytes->size();
    return loaded[*path] = file.storage.emplace_back(std::move(*bytes));
}

Result<std::span<const uint8_t>> loadBuffer(GltfFile& file, json& buffer, size_t index, const Chunks& chunks,
                                            const std::filesystem::path& folder, LoadedFiles& loaded) {
    if (!buffer.is_object() || !buffer.contains("byteLength")) return inputError("has no byteLength");
    SKINBENCH_TRY(checkWholeNumber(buffer, "it", "byteLength", kMaxGltfSize));
    // The bytes that such a buffer would hold are those that its views decompress.
    if (const json* meshopt = findMeshopt(buffer);
        meshopt && meshopt->is_object() && meshopt->value("fallback", json(false)) == true)
        return inputError("is marked as fallback, but an uncompressed bufferView uses it");
    const uint64_t length = buffer["byteLength"].get<uint64_t>();
    const auto uri = buffer.find("uri");
    std::span<const uint8_t> bytes;
    if (uri != buffer.end()) {
        if (!uri->is_string()) return inputError("uri must be a string");
        const auto read = loadUri(file, uri->get_ref<const std::string&>(), folder, loaded);
        SKINBENCH_TRY(read);
        bytes = *read;
    } else if (index == 0 && chunks.hasBin) {
        bytes = chunks.bin;
    } else {
        return inputError("has no uri, and the file has no binary chunk for it");
    }
    if (bytes.size() < length)
        return inputError(std::format("byteLength is {}, but there {} only {}", length,
                                      bytes.size() == 1 ? "is" : "are", counted(bytes.size(), "byte")));
    return bytes.first(length);
}

}  // namespace

Result<GltfFile> readGltfFile(const std::string& path) {
    auto bytes = readGltfBytes(path);
    SKINBENCH_TRY(bytes);
    if (bytes->empty()) return inputError("is empty");

    GltfFile file;
    file.size = bytes->size();
    file.storage.push_back(std::move(*bytes));
    const std::span<const uint8_t> all = file.storage.back();
    Chunks chunks{all, {}, false};
    if (all.size() >= 4 && readWord(all, 0) == kGlbMagic) {
        auto split = splitGlb(all);
        SKINBENCH_TRY(split);
        chunks = *split;
    }
    auto json = parseGltfJson(chunks.json);
    SKINBENCH_TRY(json);
    auto tree = checkGltfTree(*json);
    SKINBENCH_TRY(tree);
    file.tree = std::move(*tree);

    const auto buffers = json->find("buffers");
    if (buffers == json->end()) return file;
    if (!buffers->is_array()) return inputError("buffers must be an array");
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    LoadedFiles loaded;
    if (std::error_code error; !chunks.hasBin) loaded[std::filesystem::weakly_canonical(path, error)] = all;
    for (size_t i = 0; i < buffers->size(); ++i) {
        const auto read = loadBuffer(file, (*buffers)[i], i, chunks, folder, loaded);
        file.buffers.push_back(read ? GltfBuffer{*read, {}}
                                    : GltfBuffer{{}, std::format("buffer {}: {}", i, read.error().text)});
    }
    return file;
}

}  // namespace skinbench
