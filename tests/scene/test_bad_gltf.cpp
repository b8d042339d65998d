// Broken and hostile files: each must give one clear input error, and none may crash, hang or read out of bounds.
#include <functional>
#include <limits>
#include <random>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using fixture::Gltf;
using fixture::json;

namespace {

void checkMessage(const Error& error, const std::string& file) {
    CHECK(error.fault == Fault::input);
    CHECK(error.text.contains(file + ": "));
    CHECK(error.text.find('\n') == std::string::npos);
    CHECK(error.text.size() < 400);
    CHECK_FALSE(error.text.ends_with('.'));
}

struct BadFile {
    const char* expected;  // part of the message
    std::function<void(Gltf&)> damage;
};

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

const std::vector<BadFile> kStructure = {
    {"has no asset version", [](Gltf& g) { g.tree.erase("asset"); }},
    {"is glTF 1.0", [](Gltf& g) { g.tree["asset"]["version"] = "1.0"; }},
    {"needs the extension FOO_bar", [](Gltf& g) { g.tree["extensionsRequired"] = {"FOO_bar"}; }},
    {"needs the extension KHR_draco_mesh_compression",
     [](Gltf& g) { g.tree["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }},
    {"extensionsRequired must be an array", [](Gltf& g) { g.tree["extensionsRequired"] = 5; }},
    {"nodes must be an array",
     [](Gltf& g) {
         g.tree["nodes"] = {{"a", 1}};
     }},
    {"node 1 must be an object", [](Gltf& g) { g.tree["nodes"][1] = 5; }},
    {"node 0: mesh 4 does not exist", [](Gltf& g) { g.tree["nodes"][0]["mesh"] = 4; }},
    {"node 0: skin 4 does not exist", [](Gltf& g) { g.tree["nodes"][0]["skin"] = 4; }},
    {"node 0: mesh must be a whole number", [](Gltf& g) { g.tree["nodes"][0]["mesh"] = -1; }},
    {"node 0: mesh must be a whole number", [](Gltf& g) { g.tree["nodes"][0]["mesh"] = "zero"; }},
    {"node 0: mesh must be a whole number", [](Gltf& g) { g.tree["nodes"][0]["mesh"] = 4294967296; }},
    {"node 1: child 9 does not exist", [](Gltf& g) { g.tree["nodes"][1]["children"] = {9}; }},
    {"has two parents", [](Gltf& g) { g.tree["nodes"][0]["children"] = {2}; }},
    {"has two parents",
     [](Gltf& g) {
         g.tree["nodes"][1]["children"] = {2, 2};
     }},
    {"nodes form a cycle", [](Gltf& g) { g.tree["nodes"][2]["children"] = {1}; }},
    {"nodes form a cycle", [](Gltf& g) { g.tree["nodes"][0]["children"] = {0}; }},
    {"node 1: translation must hold 3 numbers",
     [](Gltf& g) {
         g.tree["nodes"][1]["translation"] = {1, 2};
     }},
    {"node 1: rotation must hold 4 numbers",
     [](Gltf& g) {
         g.tree["nodes"][1]["rotation"] = {1, 2, 3, "x"};
     }},
    {"node 1: its transform is not finite",
     [](Gltf& g) {
         g.tree["nodes"][1]["translation"] = {1e300, 0, 0};
     }},
    {"node 1: matrix must hold 16 numbers", [](Gltf& g) { g.tree["nodes"][1]["matrix"] = {1}; }},
    {"scene 3 does not exist", [](Gltf& g) { g.tree["scene"] = 3; }},
    {"scene 0: node 9 does not exist", [](Gltf& g) { g.tree["scenes"][0]["nodes"] = {9}; }},
    {"has no skin: nothing to animate", [](Gltf& g) { g.tree["nodes"][0].erase("skin"); }},
    {"has no skin: nothing to animate",
     [](Gltf& g) {
         g.tree.erase("nodes");
         g.tree.erase("scenes");
         g.tree.erase("skins");
         g.tree.erase("animations");
     }},
    {"has no triangle", [](Gltf& g) { g.tree["meshes"][0]["primitives"] = json::array(); }},
    {"mesh 0 has no primitives", [](Gltf& g) { g.tree["meshes"][0].erase("primitives"); }},
    {"skin 0: has no joints", [](Gltf& g) { g.tree["skins"][0] = json::object(); }},
    {"needs a reader of glTF 2.1 (asset.minVersion)", [](Gltf& g) { g.tree["asset"]["minVersion"] = "2.1"; }},
    {"its positions reach 1e+20; scale the file", [](Gltf& g) { g.poke<float>(0, 3, 1e20f); }},
    {"it is 1e-25 large; scale the file",
     [](Gltf& g) {
         g.tree["accessors"][0].erase("bufferView");
         const int values = g.add<float>({1e-25f, 0, 0}, 5126, "VEC3");
         const int indices = g.add<uint16_t>({2}, 5123, "SCALAR");
         g.tree["accessors"][0]["sparse"] = {{"count", 1},
                                             {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                             {"values", {{"bufferView", values}}}};
     }},
    {"has no triangle", [](Gltf& g) { g.primitive()["mode"] = 1; }},
    {"skin 0: has no joint", [](Gltf& g) { g.tree["skins"][0]["joints"] = json::array(); }},
    {"skin 0: joint 1: node 9 does not exist", [](Gltf& g) { g.tree["skins"][0]["joints"][1] = 9; }},
    {"skin 0: joints must be a whole number", [](Gltf& g) { g.tree["skins"][0]["joints"][1] = -2; }},
    {"skin 0: has 3 joints but 2 inverse bind matrices", [](Gltf& g) { g.tree["skins"][0]["joints"].push_back(0); }},
    {"skin 0: inverseBindMatrices: accessor 99 does not exist",
     [](Gltf& g) { g.tree["skins"][0]["inverseBindMatrices"] = 99; }},
    {"skin 0: inverseBindMatrices: accessor 0: has 3 components",
     [](Gltf& g) { g.tree["skins"][0]["inverseBindMatrices"] = 0; }},
    {"more than the limit of 65535 joints",
     [](Gltf& g) {
         g.tree["skins"][0] = {{"joints", std::vector<int>(65536, 1)}};
     }},
    {"buffers must be an array", [](Gltf& g) { g.tree["buffers"] = "none"; }},
    {"buffer 0: has no byteLength", [](Gltf& g) { g.tree["buffers"] = {json::object()}; }},
    {"buffer 0: has no uri",
     [](Gltf& g) {
         g.tree["buffers"] = {{{"byteLength", 4}}};
     }},
    {"buffer 0: missing.bin: there is no such file",
     [](Gltf& g) {
         g.tree["buffers"] = {{{"byteLength", 4}, {"uri", "missing.bin"}}};
     }},
    {"buffer 0: its uri \"https://x/y\" is no path",
     [](Gltf& g) {
         g.tree["buffers"] = {{{"byteLength", 4}, {"uri", "https://x/y"}}};
     }},
    {"is a folder",
     [](Gltf& g) {
         g.tree["buffers"] = {{{"byteLength", 4}, {"uri", "."}}};
     }},
    {"its data URI is not base64",
     [](Gltf& g) {
         g.tree["buffers"] = {{{"byteLength", 3}, {"uri", "data:application/octet-stream;base64,A*=="}}};
     }},
    {"its data URI is not base64",
     [](Gltf& g) {
         g.tree["buffers"] = {{{"byteLength", 3}, {"uri", "data:text/plain,abc"}}};
     }},
    {"buffer 0: byteLength is 99, but there are only 3 bytes",
     [](Gltf& g) {
         g.tree["buffers"] = {{{"byteLength", 99}, {"uri", "data:;base64,QUJD"}}};
     }},
};

const std::vector<BadFile> kData = {
    {"bufferView 0: buffer 7 does not exist", [](Gltf& g) { g.tree["bufferViews"][0]["buffer"] = 7; }},
    {"bufferView 0 needs a buffer", [](Gltf& g) { g.tree["bufferViews"][0].erase("buffer"); }},
    {"bufferView 0: 1000000 bytes at 0 go past", [](Gltf& g) { g.tree["bufferViews"][0]["byteLength"] = 1000000; }},
    {"go past", [](Gltf& g) { g.tree["bufferViews"][0]["byteOffset"] = 281474976710656; }},
    {"bufferView 0: byteOffset must be",
     [](Gltf& g) { g.tree["bufferViews"][0]["byteOffset"] = 18446744073709551615u; }},
    {"bufferView 0: byteOffset must be", [](Gltf& g) { g.tree["bufferViews"][0]["byteOffset"] = -4; }},
    {"bufferView 0: byteStride 6 must be a multiple of 4", [](Gltf& g) { g.tree["bufferViews"][0]["byteStride"] = 6; }},
    {"byteStride 4 is smaller than an element of 12", [](Gltf& g) { g.tree["bufferViews"][0]["byteStride"] = 4; }},
    {"mesh 0: POSITION: accessor 0: 4 elements at byte 4 go past",
     [](Gltf& g) { g.tree["accessors"][0]["byteOffset"] = 4; }},
    {"mesh 0: POSITION: accessor 0: 281474976710656 elements",
     [](Gltf& g) { g.tree["accessors"][0]["count"] = 281474976710656; }},
    {"accessor 0: count must be", [](Gltf& g) { g.tree["accessors"][0]["count"] = 1e30; }},
    {"accessor 0: count must be", [](Gltf& g) { g.tree["accessors"][0]["count"] = 4.5; }},
    {"accessor 0: bufferView 55 does not exist", [](Gltf& g) { g.tree["accessors"][0]["bufferView"] = 55; }},
    {"mesh 0: asks for more memory than a file of its size may",
     [](Gltf& g) {
         g.tree["accessors"][0]["count"] = 4294967296;
         g.tree["accessors"][0].erase("bufferView");
         g.primitive().erase("indices");
     }},
    {"accessor 0: has the unknown component type 5124",
     [](Gltf& g) { g.tree["accessors"][0]["componentType"] = 5124; }},
    {"accessor 0: has the unknown component type 77", [](Gltf& g) { g.tree["accessors"][0]["componentType"] = 77; }},
    {"accessor 0: has 2 components", [](Gltf& g) { g.tree["accessors"][0]["type"] = "VEC2"; }},
    {"type", [](Gltf& g) { g.tree["accessors"][0]["type"] = "VEC9"; }},
    {"accessor 0 has no count", [](Gltf& g) { g.tree["accessors"][0].erase("count"); }},
    {"NORMAL has 3 elements, POSITION has 4", [](Gltf& g) { g.tree["accessors"][1]["count"] = 3; }},
    {"JOINTS_0 has 3 elements, POSITION has 4", [](Gltf& g) { g.tree["accessors"][3]["count"] = 3; }},
    {"mesh 0: JOINTS_0 has no WEIGHTS_0", [](Gltf& g) { g.primitive()["attributes"].erase("WEIGHTS_0"); }},
    {"mesh 0: WEIGHTS_0 has no JOINTS_0", [](Gltf& g) { g.primitive()["attributes"].erase("JOINTS_0"); }},
    {"mesh 0: WEIGHTS_1 has no JOINTS_1", [](Gltf& g) { g.primitive()["attributes"]["WEIGHTS_1"] = 4; }},
    {"mesh 0: JOINTS_0: accessor 4: component type 5126 cannot hold indices",
     [](Gltf& g) { g.primitive()["attributes"]["JOINTS_0"] = 4; }},
    {"mesh 0: has no POSITION", [](Gltf& g) { g.primitive()["attributes"].erase("POSITION"); }},
    {"mesh 0: POSITION: accessor 42 does not exist", [](Gltf& g) { g.primitive()["attributes"]["POSITION"] = 42; }},
    {"primitive 0: POSITION must be a whole number", [](Gltf& g) { g.primitive()["attributes"]["POSITION"] = -3; }},
    {"primitive 0 has no attributes", [](Gltf& g) { g.primitive().erase("attributes"); }},
    {"mesh 0: primitive 0: indices must be a whole number from 0 to 8", [](Gltf& g) { g.primitive()["indices"] = 42; }},
    {"primitive 0: indices must be a whole number", [](Gltf& g) { g.primitive()["indices"] = -7; }},
    {"cannot hold indices", [](Gltf& g) { g.primitive()["indices"] = 2; }},
    {"mesh 0: index 3 names vertex 4 of 4", [](Gltf& g) { g.poke<uint16_t>(5, 3, 4); }},
    {"mesh 0: 5 indices, which is no multiple of 3", [](Gltf& g) { g.tree["accessors"][5]["count"] = 5; }},
    {"mesh 0: has the unknown mode 9", [](Gltf& g) { g.primitive()["mode"] = 9; }},
    {"mesh 0: POSITION: vertex 1 is not finite", [](Gltf& g) { g.poke<float>(0, 4, kNan); }},
    {"mesh 0: POSITION: vertex 0 is not finite", [](Gltf& g) { g.poke<float>(0, 0, kInfinity); }},
    {"joint 1: its inverse bind matrix is not finite", [](Gltf& g) { g.poke<float>(6, 20, kNan); }},
    {"vertex 2 names joint 9, but skin 0 has 2 joints", [](Gltf& g) { g.poke<uint8_t>(3, 8, 9); }},
    {"is not between 1 and 4",
     [](Gltf& g) {
         g.tree["accessors"][0]["sparse"] = {
             {"count", 5}, {"indices", {{"bufferView", 5}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
     }},
    {"sparse index 256 is not below 4",
     [](Gltf& g) {
         const int indices = g.add<uint16_t>({256}, 5123, "SCALAR");
         g.tree["accessors"][0]["sparse"] = {{"count", 1},
                                             {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                             {"values", {{"bufferView", 0}}}};
     }},
    {"sparse has no values",
     [](Gltf& g) {
         g.tree["accessors"][0]["sparse"] = {{"count", 1}, {"indices", {{"bufferView", 5}, {"componentType", 5123}}}};
     }},
    {"sparse: count must be",
     [](Gltf& g) {
         g.tree["accessors"][0]["sparse"] = {
             {"count", -1}, {"indices", {{"bufferView", 5}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
     }},
};

json meshopt(uint64_t count, uint64_t stride, const char* mode, const char* filter = "NONE") {
    return {{"EXT_meshopt_compression",
             {{"buffer", 0},
              {"byteOffset", 0},
              {"byteLength", 48},
              {"count", count},
              {"byteStride", stride},
              {"mode", mode},
              {"filter", filter}}}};
}

const std::vector<BadFile> kAnimations = {
    {"animation 0: channel 0: sampler 4 does not exist",
     [](Gltf& g) { g.tree["animations"][0]["channels"][0]["sampler"] = 4; }},
    {"animation 0: channel 0: node 9 does not exist",
     [](Gltf& g) { g.tree["animations"][0]["channels"][0]["target"]["node"] = 9; }},
    {"animation 0: channel 0 has no target path",
     [](Gltf& g) { g.tree["animations"][0]["channels"][0]["target"].erase("path"); }},
    {"channel 0 needs a sampler and a target", [](Gltf& g) { g.tree["animations"][0]["channels"][0].erase("target"); }},
    {"sampler 0 needs an input and an output", [](Gltf& g) { g.tree["animations"][0]["samplers"][0].erase("input"); }},
    {"channel 0: input: accessor 88 does not exist",
     [](Gltf& g) { g.tree["animations"][0]["samplers"][0]["input"] = 88; }},
    {"channel 0: output: accessor 7: has 1 component an element",
     [](Gltf& g) { g.tree["animations"][0]["samplers"][0]["output"] = 7; }},
    {"interpolation \"MAGIC\" is not known",
     [](Gltf& g) { g.tree["animations"][0]["samplers"][0]["interpolation"] = "MAGIC"; }},
    {"has 2 values for 2 keys",
     [](Gltf& g) { g.tree["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }},
    {"animation 0: channel 0: has 2 values for 1 key", [](Gltf& g) { g.tree["accessors"][7]["count"] = 1; }},
    {"channel 0: has no key", [](Gltf& g) { g.tree["accessors"][7]["count"] = 0; }},
    {"the key times do not ascend at key 1", [](Gltf& g) { g.poke<float>(7, 0, 2); }},
    {"the time of key 1 is not finite", [](Gltf& g) { g.poke<float>(7, 1, kNan); }},
    {"a value is not finite", [](Gltf& g) { g.poke<float>(8, 5, kInfinity); }},
    {"EXT_meshopt_compression: has the unknown mode \"FUN\"",
     [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(4, 12, "FUN"); }},
    {"bufferView 0: EXT_meshopt_compression: its compressed bytes are broken",
     [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(4, 12, "ATTRIBUTES"); }},
    {"its compressed bytes are broken",
     [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(6, 2, "TRIANGLES"); }},
    {"its compressed bytes are broken",
     [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(6, 4, "INDICES"); }},
    {"byteStride 10 must be a multiple of 4",
     [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(4, 10, "ATTRIBUTES"); }},
    {"byteStride 0 must be", [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(4, 0, "ATTRIBUTES"); }},
    {"7 indices, which is no multiple of 3",
     [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(7, 2, "TRIANGLES"); }},
    {"EXT_meshopt_compression: asks for more memory",
     [](Gltf& g) { g.tree["bufferViews"][0]["extensions"] = meshopt(1 << 30, 256, "ATTRIBUTES"); }},
    {"EXT_meshopt_compression: buffer must be a whole number",
     [](Gltf& g) {
         g.tree["bufferViews"][0]["extensions"] = meshopt(4, 12, "ATTRIBUTES");
         g.tree["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["buffer"] = -1;
     }},
    {"go past",
     [](Gltf& g) {
         g.tree["bufferViews"][0]["extensions"] = meshopt(4, 12, "ATTRIBUTES");
         g.tree["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteOffset"] = 1 << 30;
     }},
    {"KHR_draco_mesh_compression is not supported",
     [](Gltf& g) {
         g.primitive()["extensions"] = {
             {"KHR_draco_mesh_compression", {{"bufferView", 0}, {"attributes", json::object()}}}};
         g.tree["accessors"][0].erase("bufferView");
     }},
};

void checkCases(const std::vector<BadFile>& cases) {
    for (const BadFile& bad : cases) {
        Gltf g = fixture::small();
        bad.damage(g);
        INFO(bad.expected);
        const auto scene = g.load("bad.gltf");
        REQUIRE_FALSE(scene);
        checkMessage(scene.error(), "bad.gltf");
        CHECK_THAT(scene.error().text, ContainsSubstring(bad.expected));
    }
}

std::string loadError(const std::string& name, const std::vector<uint8_t>& bytes) {
    const auto scene = loadGltf(fixture::writeFile(name, bytes));
    if (scene) return "";
    checkMessage(scene.error(), name);
    return scene.error().text;
}

std::vector<uint8_t> bytesOf(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

TEST_CASE("broken structure") { checkCases(kStructure); }
TEST_CASE("broken data") { checkCases(kData); }
TEST_CASE("broken animations and compression") { checkCases(kAnimations); }

TEST_CASE("what is no glTF at all") {
    CHECK_THAT(loadError("empty.glb", {}), ContainsSubstring("is empty"));
    CHECK_THAT(loadError("noise.glb", {0xFF, 0xD8, 0xFF, 0xE0, 0, 1, 2, 3}), ContainsSubstring("is neither"));
    CHECK_THAT(loadError("text.gltf", bytesOf("hello")), ContainsSubstring("is neither"));
    CHECK_THAT(loadError("array.gltf", bytesOf("[1,2]")), ContainsSubstring("is neither"));
    CHECK_THAT(loadError("cut.gltf", bytesOf("{\"asset\": {")), ContainsSubstring("its JSON is broken near byte"));
    CHECK_THAT(loadError("huge.gltf", bytesOf("{\"asset\": 1e999}")), ContainsSubstring("out of range"));
    std::string deep = "{\"asset\": ";
    deep.append(3'000'000, '[');
    CHECK_THAT(loadError("deep.gltf", bytesOf(deep)), ContainsSubstring("deeper"));
    CHECK_THAT(loadError("empty.gltf", bytesOf("{}")), ContainsSubstring("has no asset version"));

    const auto missing = loadGltf("./no/nothing.glb");
    REQUIRE_FALSE(missing);
    CHECK(missing.error().text == "./no/nothing.glb: there is no such file");
    const auto folder = loadGltf(fixture::temporaryFolder().string());
    REQUIRE_FALSE(folder);
    CHECK_THAT(folder.error().text, ContainsSubstring("is a folder"));
    CHECK_FALSE(loadGltf(""));
    CHECK_FALSE(loadGltf("/dev/zero"));
}

TEST_CASE("deep node chains are walked without recursion") {
    Gltf g = fixture::small();
    constexpr int kDepth = 200'000;
    json& nodes = g.tree["nodes"];
    nodes[2]["children"] = {3};
    for (int i = 3; i < kDepth; ++i) nodes.push_back(i + 1 < kDepth ? json{{"children", {i + 1}}} : json::object());
    const auto scene = g.load("deep.gltf");
    REQUIRE(scene);
    CHECK(scene->skeleton.nodes.size() == kDepth);
}

TEST_CASE("a GLB cut off at any length is refused") {
    const std::vector<uint8_t> whole = fixture::small().asGlb();
    REQUIRE(loadError("cut.glb", whole).empty());
    for (size_t length = 0; length < whole.size(); ++length) {
        INFO(length);
        REQUIRE_FALSE(
            loadError("cut.glb", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}).empty());
    }
}

TEST_CASE("a GLB whose header agrees with the cut is refused or loads") {
    const std::vector<uint8_t> whole = fixture::small().asGlb();
    size_t refused = 0;
    for (size_t length = 12; length < whole.size(); ++length) {
        std::vector<uint8_t> bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        for (int i = 0; i < 4; ++i) bytes[8 + i] = static_cast<uint8_t>(length >> (8 * i));
        refused += !loadError("cut.glb", bytes).empty();
    }
    CHECK(refused == whole.size() - 12);
}

TEST_CASE("random damage gives a scene or an error, never a crash") {
    std::mt19937 random(20240607);
    const std::vector<uint8_t> whole = fixture::small().asGlb();
    size_t good = 0, refused = 0;
    for (int round = 0; round < 2000; ++round) {
        std::vector<uint8_t> bytes = whole;
        const int flips = 1 + static_cast<int>(random() % 4);
        for (int i = 0; i < flips; ++i) bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << random() % 8);
        auto scene = loadGltf(fixture::writeFile("flip.glb", bytes));
        if (!scene) {
            ++refused;
            REQUIRE(scene.error().fault == Fault::input);
            REQUIRE(scene.error().text.contains("flip.glb: "));
            continue;
        }
        ++good;
        REQUIRE(checkScene(*scene));
        REQUIRE(prepareScene(std::move(*scene), {}));
    }
    CHECK(good > 0);
    CHECK(refused > 0);
}

TEST_CASE("random numbers in the JSON give a scene or an error, never a crash") {
    std::mt19937 random(77);
    const Gltf whole = fixture::small();
    const std::string text = whole.asText();
    const size_t limit = text.find("data:");
    const std::vector<std::string> numbers = {
        "-1",    "0",    "3",    "7",     "255", "65536", "2147483648", "4294967295", "18446744073709551615",
        "1e308", "-0.5", "null", "\"x\"", "[]",  "{}"};
    size_t good = 0;
    for (int round = 0; round < 2000; ++round) {
        std::string damaged = text;
        // The data URI is left alone: its digits are bytes, which the test above flips.
        size_t at = random() % text.size();
        while (at < text.size() && !std::isdigit(static_cast<unsigned char>(text[at]))) ++at;
        const size_t uriEnd = text.find('"', limit);
        if (at >= text.size() || (at >= limit && at < uriEnd)) continue;
        size_t end = at;
        while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
        damaged.replace(at, end - at, numbers[random() % numbers.size()]);
        auto scene = loadGltf(fixture::writeText("numbers.gltf", damaged));
        if (!scene) {
            REQUIRE(scene.error().text.contains("numbers.gltf: "));
            continue;
        }
        ++good;
        REQUIRE(prepareScene(std::move(*scene), {}));
    }
    CHECK(good > 0);
}
