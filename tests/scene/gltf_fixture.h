// A small valid skinned glTF, made in memory, for tests to break or to vary; and the folder of real models.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

#include <nlohmann/json.hpp>

#include "common/scene/scene.h"

namespace fixture {

using nlohmann::json;

inline std::string modelFolder() {
    const char* given = std::getenv("SKINBENCH_MODELS");
    return given ? given : SKINBENCH_SOURCE_DIR "/../shared/models";
}

inline std::filesystem::path temporaryFolder() {
    static const struct Folder {
        std::filesystem::path path =
            std::filesystem::temp_directory_path() / ("skinbench_test_" + std::to_string(getpid()));
        Folder() { std::filesystem::create_directories(path); }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    } folder;
    return folder.path;
}

inline std::string writeFile(const std::string& name, const std::vector<uint8_t>& bytes) {
    const auto path = temporaryFolder() / name;
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return path.string();
}

inline std::string writeText(const std::string& name, const std::string& text) {
    return writeFile(name, std::vector<uint8_t>(text.begin(), text.end()));
}

inline std::string base64(const std::vector<uint8_t>& bytes) {
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0);
        for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

struct Gltf {
    json tree;
    std::vector<uint8_t> bin;

    // Returns the accessor's index.
    template <class T>
    int add(const std::vector<T>& values, int componentType, const std::string& type, bool normalized = false) {
        static const std::map<std::string, int> sizes = {
            {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
        while (bin.size() % 4 != 0) bin.push_back(0);
        const size_t offset = bin.size();
        const size_t bytes = values.size() * sizeof(T);
        bin.resize(offset + bytes);
        if (bytes > 0) std::memcpy(bin.data() + offset, values.data(), bytes);
        tree["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
        json accessor = {{"bufferView", tree["bufferViews"].size() - 1},
                         {"componentType", componentType},
                         {"count", values.size() / sizes.at(type)},
                         {"type", type}};
        if (normalized) accessor["normalized"] = true;
        tree["accessors"].push_back(accessor);
        return static_cast<int>(tree["accessors"].size()) - 1;
    }

    // Overwrites the values of an accessor that add() made.
    template <class T>
    void poke(int accessor, size_t index, T value) {
        const size_t offset = tree["bufferViews"][tree["accessors"][accessor]["bufferView"].get<int>()]["byteOffset"];
        std::memcpy(bin.data() + offset + index * sizeof(T), &value, sizeof(T));
    }

    json& primitive(int index = 0) { return tree["meshes"][0]["primitives"][index]; }
    int accessor(const std::string& attribute) { return primitive()["attributes"][attribute]; }

    // The tree with min and max of every packed accessor of floats that has none, as the specification asks.
    json withBounds() const {
        json copy = tree;
        const auto number = [](const json& object, const char* key, size_t missing) {
            const bool there = object.is_object() && object.contains(key) && object[key].is_number_integer();
            return there && object[key].get<int64_t>() >= 0 ? object[key].get<size_t>() : missing;
        };
        if (!copy.contains("accessors") || !copy.contains("bufferViews")) return copy;
        for (json& accessor : copy["accessors"]) {
            const size_t view = number(accessor, "bufferView", SIZE_MAX), count = number(accessor, "count", 0);
            if (view >= copy["bufferViews"].size() || number(accessor, "componentType", 0) != 5126) continue;
            if (accessor.contains("min") || accessor.contains("max") || count > bin.size()) continue;
            const json type = accessor.contains("type") ? accessor["type"] : json();
            const size_t width = type == "SCALAR" ? 1 : 3, step = width * sizeof(float);
            const size_t offset =
                number(copy["bufferViews"][view], "byteOffset", 0) + number(accessor, "byteOffset", 0);
            if ((width == 3 && type != "VEC3") || count == 0) continue;
            if (offset > bin.size() || offset + count * step > bin.size()) continue;
            std::vector<float> values(count * width);
            std::memcpy(values.data(), &bin[offset], count * step);
            for (size_t c = 0; c < width; ++c) {
                float low = values[c], high = low;
                for (size_t i = c; i < values.size(); i += width) {
                    low = std::min(low, values[i]);
                    high = std::max(high, values[i]);
                }
                accessor["min"].push_back(low);
                accessor["max"].push_back(high);
            }
        }
        return copy;
    }

    std::string asText() const {
        json copy = withBounds();
        if (!copy.contains("buffers"))
            copy["buffers"] = {
                {{"byteLength", bin.size()}, {"uri", "data:application/octet-stream;base64," + base64(bin)}}};
        return copy.dump();
    }

    std::vector<uint8_t> asGlb() const {
        json copy = withBounds();
        if (!copy.contains("buffers")) copy["buffers"] = {{{"byteLength", bin.size()}}};
        std::string text = copy.dump();
        while (text.size() % 4 != 0) text += ' ';
        std::vector<uint8_t> padded = bin;
        while (padded.size() % 4 != 0) padded.push_back(0);
        std::vector<uint8_t> out;
        const auto word = [&](uint32_t value) {
            for (int i = 0; i < 4; ++i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
        };
        word(0x46546C67);
        word(2);
        word(static_cast<uint32_t>(28 + text.size() + padded.size()));
        word(static_cast<uint32_t>(text.size()));
        word(0x4E4F534A);
        out.insert(out.end(), text.begin(), text.end());
        word(static_cast<uint32_t>(padded.size()));
        word(0x004E4942);
        out.insert(out.end(), padded.begin(), padded.end());
        return out;
    }

    skinbench::Result<skinbench::Scene> load(const std::string& name = "small.gltf") const {
        return skinbench::loadScene(writeText(name, asText()));
    }
};

// A unit quad of two triangles in the xy plane. Node 0 draws it with skin 0; nodes 1 and 2 are the joints, 2 below 1.
// The lower two vertices follow joint 0, the upper two joint 1. Accessors: 0 POSITION, 1 NORMAL, 2 TEXCOORD_0,
// 3 JOINTS_0, 4 WEIGHTS_0, 5 indices, 6 inverse bind matrices, 7 times, 8 rotations.
inline Gltf small() {
    Gltf g;
    g.tree = {{"asset", {{"version", "2.0"}}}, {"bufferViews", json::array()}, {"accessors", json::array()}};
    g.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 5126, "VEC3");
    g.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3");
    g.add<float>({0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2");
    g.add<uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5121, "VEC4");
    g.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5126, "VEC4");
    g.add<uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR");
    g.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                 5126, "MAT4");
    g.add<float>({0, 1}, 5126, "SCALAR");
    g.add<float>({0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f}, 5126, "VEC4");
    g.tree["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}, {"JOINTS_0", 3}, {"WEIGHTS_0", 4}}},
            {"indices", 5}}}}}};
    g.tree["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", 6}}};
    g.tree["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"children", {2}}}, {{"translation", {0, 1, 0}}}};
    g.tree["scenes"] = {{{"nodes", {0, 1}}}};
    g.tree["scene"] = 0;
    g.tree["animations"] = {{{"name", "bend"},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}},
                             {"samplers", {{{"input", 7}, {"output", 8}}}}}};
    return g;
}

}  // namespace fixture
