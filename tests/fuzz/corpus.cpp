#include "tests/fuzz/corpus.h"

#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

#include "tests/codec_test.h"
#include "tests/scene/gltf_fixture.h"

namespace skinbench::fuzz {
namespace {

using nlohmann::json;
using Bytes = std::vector<uint8_t>;

Bytes bytesOf(const std::string& text) { return Bytes(text.begin(), text.end()); }

// Four vertices' positions, compressed, in place of the plain ones.
void compressPositions(fixture::Gltf& g) {
    constexpr size_t kStride = 12, kCount = 4;
    Bytes packed(meshopt_encodeVertexBufferBound(kCount, kStride));
    packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), g.bin.data(), kCount, kStride));
    const size_t offset = g.bin.size();
    g.bin.insert(g.bin.end(), packed.begin(), packed.end());
    g.tree["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", 0},      {"byteOffset", offset}, {"byteLength", packed.size()},
        {"byteStride", 12}, {"count", kCount},      {"mode", "ATTRIBUTES"}};
    g.tree["extensionsUsed"] = {"EXT_meshopt_compression"};
}

std::vector<Bytes> gltfFiles() {
    std::vector<Bytes> files = {fixture::small().asGlb(), bytesOf(fixture::small().asText())};
    const auto add = [&](auto change) {
        fixture::Gltf g = fixture::small();
        change(g);
        files.push_back(g.asGlb());
    };
    add(compressPositions);
    add([](fixture::Gltf& g) {
        g.tree["accessors"][0]["sparse"] = {
            {"count", 1}, {"indices", {{"bufferView", 5}, {"componentType", 5123}}}, {"values", {{"bufferView", 1}}}};
    });
    add([](fixture::Gltf& g) {
        g.primitive()["mode"] = 5;
        g.primitive().erase("indices");
        g.primitive()["attributes"].erase("NORMAL");
        g.tree["nodes"][0]["scale"] = {-1, 1, 1};
        g.tree["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1};
    });
    add([](fixture::Gltf& g) {
        const int weights =
            g.add<uint8_t>({255, 0, 0, 0, 128, 127, 0, 0, 255, 0, 0, 0, 1, 254, 0, 0}, 5121, "VEC4", true);
        const int positions = g.add<int16_t>({0, 0, 0, 9, 9, 0, 0, 0, 9, 9, 0, 0}, 5122, "VEC3");
        g.primitive()["attributes"]["WEIGHTS_0"] = weights;
        g.primitive()["attributes"]["JOINTS_1"] = 3;
        g.primitive()["attributes"]["WEIGHTS_1"] = weights;
        g.primitive()["attributes"]["POSITION"] = positions;
        g.tree["extensionsUsed"] = {"KHR_mesh_quantization", "KHR_node_visibility"};
        g.tree["nodes"][2]["extensions"]["KHR_node_visibility"] = {{"visible", false}};
    });
    add([](fixture::Gltf& g) {
        g.tree["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE";
        g.tree["animations"][0]["samplers"][0]["output"] =
            g.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1}, 5126, "VEC4");
        g.tree["meshes"].push_back(g.tree["meshes"][0]);
        g.tree["nodes"].push_back({{"mesh", 1}});
        g.tree["nodes"][2]["children"] = {3};
    });
    return files;
}

// Mode, filter, stride and count as meshopt.cpp reads them, then the bytes.
Bytes view(uint8_t mode, uint8_t filter, uint16_t stride, uint32_t count, const Bytes& packed) {
    Bytes out = {mode, filter, static_cast<uint8_t>(stride), static_cast<uint8_t>(stride >> 8)};
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<uint8_t>(count >> 8 * i));
    out.insert(out.end(), packed.begin(), packed.end());
    return out;
}

std::vector<Bytes> meshoptViews() {
    constexpr uint16_t kStride = 8;
    constexpr uint32_t kCount = 40;
    std::vector<Bytes> views;
    Bytes vertices(kStride * kCount);
    for (size_t i = 0; i < vertices.size(); ++i) vertices[i] = static_cast<uint8_t>(i * i / 7);
    Bytes packed(meshopt_encodeVertexBufferBound(kCount, kStride));
    packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), vertices.data(), kCount, kStride));
    for (uint8_t filter = 0; filter < 5; ++filter) views.push_back(view(0, filter, kStride, kCount, packed));
    // Version 1, every byte as it is, each channel in another mode: bytes, then rotated by 3.
    Bytes literal = {0xA1, 0xFF, 0xFF};
    literal.insert(literal.end(), vertices.begin(), vertices.end());
    literal.resize(literal.size() + 14);
    literal.insert(literal.end(), {1, 2, 3, 4, 5, 6, 7, 8, 0x00, 0x32});
    views.push_back(view(0, 0, kStride, kCount, literal));
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < kCount; ++i) indices.insert(indices.end(), {i, i + 1, i + 2});
    const size_t count = indices.size();
    Bytes triangles(meshopt_encodeIndexBufferBound(count, count));
    triangles.resize(meshopt_encodeIndexBuffer(triangles.data(), triangles.size(), indices.data(), count));
    Bytes sequence(meshopt_encodeIndexSequenceBound(count, count));
    sequence.resize(meshopt_encodeIndexSequence(sequence.data(), sequence.size(), indices.data(), count));
    for (const uint16_t stride : {2, 4}) {
        views.push_back(view(1, 0, stride, static_cast<uint32_t>(count), triangles));
        views.push_back(view(2, 0, stride, static_cast<uint32_t>(count), sequence));
    }
    return views;
}

json timedCase(const char* id, double milliseconds) {
    std::vector<double> samples;
    for (int i = 0; i < 8; ++i) samples.push_back(milliseconds + 0.01 * i);
    return {{"id", id},
            {"route", "vk"},
            {"variant", "vertex"},
            {"status", "ok"},
            {"reason", nullptr},
            {"raster", "full"},
            {"limit_ms", 0.5},
            {"gpu_ms",
             {{"median", milliseconds},
              {"min", milliseconds},
              {"cv", 0.01},
              {"samples", samples},
              {"round_sizes", {4, 4}},
              {"interval", {milliseconds, milliseconds + 0.1}}}},
            {"passes_ms", {{"skin", nullptr}, {"draw", milliseconds}}},
            {"memory_bytes", {{"total", 1024}}},
            {"accuracy", {{"max_position_error", 1e-7}}}};
}

// As an older version wrote it; loadResults adds the rest.
std::string resultFile(double milliseconds) {
    json skipped = timedCase("vk/none/uc", 1);
    skipped["status"] = "skipped";
    skipped["reason"] = "no device";
    for (const char* figures : {"gpu_ms", "passes_ms", "memory_bytes", "accuracy"}) skipped[figures] = nullptr;
    return json{{"schema", "skinbench-results/1"},
                {"tool", {{"version", "1"}, {"revision", "abc"}}},
                {"host", {{"os", "Linux"}, {"cpu", "CPU"}}},
                {"scene",
                 {{"name", "hero"},
                  {"vertices", 100},
                  {"triangles", 200},
                  {"joints", 30},
                  {"unique_tuples", 40},
                  {"mean_influences", 1.5},
                  {"max_influences", 4}}},
                {"settings", {{"copies", 7}, {"frames", 8}, {"width", 64}, {"height", 64}, {"pose", "animated"}}},
                {"devices", {{{"route_api", "vulkan"}, {"name", "Card"}, {"driver", "1"}, {"software", false}}}},
                {"cases", {timedCase("vk/vertex/uc", milliseconds), timedCase("vk/vertex/uc+pull", 2), skipped}}}
        .dump();
}

std::vector<Bytes> resultFiles() {
    return {bytesOf(resultFile(2)), bytesOf(resultFile(2) + '\x1e' + resultFile(3)), bytesOf("[[[[")};
}

std::vector<Bytes> caseLines() {
    return {bytesOf("vk/vertex/uc\nvk-nv/mesh/pc/meshopt/redirect+discard\nvk/none/uc+again"),
            bytesOf("vk-ext/mesh-ci/uc/scan/fixed+ordered-records"),
            bytesOf("route=vk,gl\nvariant=vertex,compute\ncodec=uc,pc24\ninfluences=4,8\nraster=full,discard"),
            bytesOf("variant=palette\npalette_slots=4,20"),
            bytesOf("route=vk-ext\nmeshlet_limits=64/124,3/1\ncull=compact")};
}

std::vector<Bytes> numbers() {
    std::vector<Bytes> out;
    for (uint64_t seed = 1; seed <= 24; ++seed) {
        test::Random random(seed);
        Bytes bytes(4 + 4 * seed);
        for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random.next());
        out.push_back(std::move(bytes));
    }
    return out;
}

}  // namespace

std::map<std::string, std::vector<Bytes>> makeCorpus() {
    return {{"gltf", gltfFiles()},    {"meshopt", meshoptViews()}, {"results", resultFiles()},
            {"case_id", caseLines()}, {"encode", numbers()},       {"decode", numbers()}};
}

}  // namespace skinbench::fuzz
