// What is read although the specification forbids it, or left out although it allows it: one warning each.
#include <algorithm>
#include <fstream>
#include <functional>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/scene/gltf/gltf_extensions.h"
#include "common/scene/pose.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using fixture::Gltf;
using fixture::json;

namespace {

struct Warned {
    const char* warning;
    std::function<void(Gltf&)> change;
};

void extend(Gltf& g, json& object, const char* name, const json& value = json::object()) {
    object["extensions"][name] = value;
    g.tree["extensionsUsed"].push_back(name);
}

const std::vector<Warned> kCases = {
    {"1 node has a rotation that is not of unit length",
     [](Gltf& g) {
         g.tree["nodes"][1]["rotation"] = {0, 0, 0, 2};
     }},
    {"1 animation channel has the same target as another",
     [](Gltf& g) { g.tree["animations"][0]["channels"].push_back(g.tree["animations"][0]["channels"][0]); }},
    {"1 key time is not larger than the one before it", [](Gltf& g) { g.poke<float>(7, 0, 1); }},
    {"1 key time is negative", [](Gltf& g) { g.poke<float>(7, 0, -1); }},
    {"1 inverse bind matrix has a last row other than 0 0 0 1", [](Gltf& g) { g.poke<float>(6, 15, 2); }},
    {"1 accessor has a format that glTF does not allow",
     [](Gltf& g) {
         g.primitive()["attributes"]["POSITION"] = g.add<int8_t>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 5120, "VEC3");
     }},
    {"1 accessor has a format that glTF does not allow",
     [](Gltf& g) {
         g.primitive()["attributes"]["WEIGHTS_0"] =
             g.add<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, 5121, "VEC4");
     }},
    {"1 vertex names a joint twice",
     [](Gltf& g) {
         g.poke<float>(4, 0, 0.5f);
         g.poke<float>(4, 1, 0.5f);
     }},
    {"4 normals are not of unit length",
     [](Gltf& g) {
         for (int v = 0; v < 4; ++v) g.poke<float>(1, v * 3 + 2, 3);
     }},
    {"1 node has both a matrix and its parts",
     [](Gltf& g) {
         g.tree["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
         g.tree["nodes"][1]["scale"] = {1, 1, 1};
     }},
    {"1 node has a matrix that is no translation, rotation and scale",
     [](Gltf& g) { g.tree["nodes"][1]["matrix"] = {1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
    {"1 skin names a node twice",
     [](Gltf& g) {
         g.tree["skins"][0]["joints"] = {1, 1};
     }},
    {"1 skin has joints without a common root",
     [](Gltf& g) {
         g.tree["nodes"][1].erase("children");
         g.tree["scenes"][0]["nodes"].push_back(2);
     }},
    {"1 skin names a skeleton that is not above all its joints", [](Gltf& g) { g.tree["skins"][0]["skeleton"] = 2; }},
    {"1 skin names a skeleton that is not above all its joints", [](Gltf& g) { g.tree["skins"][0]["skeleton"] = 99; }},
    {"1 skin names a skeleton that is not above all its joints",
     [](Gltf& g) { g.tree["skins"][0]["skeleton"] = "hips"; }},
    {"1 accessor of positions or key times lacks min and max",
     [](Gltf& g) {
         g.tree["accessors"][0]["min"] = {0, 0, 0};
         g.tree["accessors"][0]["max"] = {1, 1, 0.5};
     }},
    {"1 accessor of positions or key times lacks min and max", [](Gltf& g) { g.tree["accessors"][0]["min"] = "none"; }},
    {"1 accessor of positions or key times lacks min and max",
     [](Gltf& g) {
         g.tree["accessors"][7]["min"] = {0.25};
         g.tree["accessors"][7]["max"] = {1};
     }},
    {"1 key has a rotation that is not of unit length", [](Gltf& g) { g.poke<float>(8, 3, 2); }},
    {"1 extension is used but not listed in extensionsUsed",
     [](Gltf& g) { g.tree["nodes"][1]["extensions"]["MSFT_lod"] = json::object(); }},
    {"1 primitive has a skin but no JOINTS_0 and WEIGHTS_0",
     [](Gltf& g) {
         json other = g.primitive();
         other["attributes"].erase("JOINTS_0");
         other["attributes"].erase("WEIGHTS_0");
         g.tree["meshes"][0]["primitives"].push_back(other);
     }},
    {"EXT_mesh_gpu_instancing is ignored in 1 place: each of its nodes is drawn once",
     [](Gltf& g) { extend(g, g.tree["nodes"][0], "EXT_mesh_gpu_instancing"); }},
    {"VRMC_springBone is ignored in 1 place", [](Gltf& g) { extend(g, g.tree, "VRMC_springBone"); }},
    {"KHR_animation_pointer is ignored in 1 place: its channels move nothing",
     [](Gltf& g) {
         g.tree["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"path", "pointer"}}}});
         extend(g, g.tree["animations"][0]["channels"][1]["target"], "KHR_animation_pointer");
     }},
    {"extensions that are not known are ignored: FOO_bar", [](Gltf& g) { extend(g, g.tree["nodes"][1], "FOO_bar"); }},
    {"morph targets are ignored",
     [](Gltf& g) {
         g.primitive()["targets"] = {{{"POSITION", 0}}};
     }},
    {"its animations move no node; the rest pose is drawn",
     [](Gltf& g) { g.tree["animations"][0]["channels"] = json::array(); }},
    {"none of its triangles has an area at rest",
     [](Gltf& g) {
         g.primitive()["indices"] = g.add<uint16_t>({0, 0, 1, 2, 1, 2}, 5123, "SCALAR");
     }},
    {"animation 1: channel 0: sampler 7 does not exist; the clip was left out",
     [](Gltf& g) {
         g.tree["animations"].push_back(g.tree["animations"][0]);
         g.tree["animations"][1]["channels"][0]["sampler"] = 7;
     }},
    {"animation 1 must be an object; it and 1 more clip were left out",
     [](Gltf& g) {
         g.tree["animations"].push_back(5);
         g.tree["animations"].push_back({{"channels", 3}, {"samplers", 4}});
     }},
};

}  // namespace

TEST_CASE("each deviation is one warning, and the file loads") {
    for (const Warned& one : kCases) {
        INFO(one.warning);
        Gltf g = fixture::small();
        one.change(g);
        const auto scene = g.load();
        INFO((scene ? std::string() : scene.error().text));
        REQUIRE(scene);
        REQUIRE(scene->warnings.size() == 1);
        CHECK_THAT(scene->warnings[0], ContainsSubstring(one.warning));
    }
}

TEST_CASE("a clip without a name is called by its number") {
    Gltf g = fixture::small();
    g.tree["animations"][0]["name"] = "walk";
    g.tree["animations"].push_back(g.tree["animations"][0]);
    g.tree["animations"][1].erase("name");
    const auto scene = g.load();
    REQUIRE(scene);
    REQUIRE(scene->clips.size() == 2);
    CHECK(scene->clips[0].name == "walk");
    CHECK(scene->clips[1].name == "animation 1");
}

TEST_CASE("a skeleton may be any node above all joints") {
    for (const int skeleton : {1, 3}) {
        Gltf g = fixture::small();
        g.tree["nodes"].push_back({{"children", {1}}});
        g.tree["scenes"][0]["nodes"] = {0, 3};
        g.tree["skins"][0]["skeleton"] = skeleton;
        const auto scene = g.load();
        REQUIRE(scene);
        CHECK(scene->warnings.empty());
    }
}

TEST_CASE("bounds may be wider than the vertices that triangles use") {
    Gltf g = fixture::small();
    g.primitive()["indices"] = g.add<uint16_t>({0, 1, 2}, 5123, "SCALAR");
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->warnings.empty());
}

TEST_CASE("a part that nothing uses may be broken") {
    Gltf g = fixture::small();
    g.tree["skins"].push_back(json::object());
    g.tree["skins"].push_back({{"joints", {99}}});
    g.tree["meshes"].push_back("none");
    g.tree["meshes"].push_back({{"primitives", {{{"attributes", 3}}}}});
    g.tree["bufferViews"].push_back({{"buffer", 9}, {"byteLength", 4}});
    g.tree["bufferViews"].push_back({{"byteLength", -4}});
    g.tree["accessors"].push_back({{"type", "VEC9"}, {"componentType", 1}, {"count", 1}});
    g.tree["images"] = {{{"bufferView", 999}}, 7};
    const auto scene = g.load();
    INFO((scene ? std::string() : scene.error().text));
    REQUIRE(scene);
    REQUIRE(scene->warnings.size() == 1);
    CHECK(scene->warnings[0] ==
          "5 parts of the file that nothing uses are broken; the first: bufferView 10 needs a buffer and a byteLength");
}

TEST_CASE("what names a broken part says what is wrong with it") {
    Gltf skin = fixture::small();
    skin.tree["skins"][0] = {{"joints", 5}};
    CHECK_THAT(skin.load().error().text, ContainsSubstring("skin 0: joints must be an array"));
    Gltf mesh = fixture::small();
    mesh.tree["meshes"][0] = 5;
    CHECK_THAT(mesh.load().error().text, ContainsSubstring("mesh 0 must be an object"));
}

TEST_CASE("a byteStride of 0 means tightly packed") {
    Gltf g = fixture::small();
    for (json& view : g.tree["bufferViews"]) view["byteStride"] = 0;
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->warnings == std::vector<std::string>{"9 bufferViews have a byteStride of 0; taken as tightly packed"});
    CHECK(scene->mesh.positions == fixture::small().load()->mesh.positions);
}

TEST_CASE("nodes that KHR_node_visibility hides are left out with all below them") {
    Gltf g = fixture::small();
    g.tree["nodes"].push_back({{"children", {4}}});
    g.tree["nodes"].push_back({{"mesh", 0}, {"skin", 0}});
    g.tree["scenes"][0]["nodes"].push_back(3);
    REQUIRE(g.load()->parts.size() == 2);
    extend(g, g.tree["nodes"][3], "KHR_node_visibility", {{"visible", false}});
    g.tree["extensionsRequired"] = {"KHR_node_visibility"};
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->parts.size() == 1);
    CHECK(scene->warnings == std::vector<std::string>{"1 node with a mesh is hidden by KHR_node_visibility; left out"});
    g.tree["nodes"][3]["extensions"]["KHR_node_visibility"]["visible"] = true;
    CHECK(g.load()->parts.size() == 2);
    extend(g, g.tree["nodes"][0], "KHR_node_visibility", {{"visible", false}});
    g.tree["nodes"][3]["extensions"]["KHR_node_visibility"]["visible"] = false;
    CHECK_THAT(g.load().error().text, ContainsSubstring("every skinned mesh is hidden by KHR_node_visibility"));
}

TEST_CASE("a skin alone skins nothing") {
    Gltf g = fixture::small();
    REQUIRE(checkSkinned(*g.load()));
    g.primitive()["attributes"].erase("JOINTS_0");
    g.primitive()["attributes"].erase("WEIGHTS_0");
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->parts[0].rigid);
    CHECK_THAT(checkSkinned(*scene).error().text, ContainsSubstring("small: no vertex is skinned"));
}

TEST_CASE("the sign of the mesh node's determinant says which side is the front, for skinned meshes too") {
    Gltf g = fixture::small();
    // A mirrored armature: its joints and its mesh are all below the mirror.
    g.tree["nodes"].push_back({{"scale", {-1, 1, 1}}, {"children", {0, 1}}});
    g.tree["scenes"][0]["nodes"] = {3};
    const auto both = g.load();
    REQUIRE(both);
    CHECK(both->warnings.empty());
    CHECK(both->mesh.indices == std::vector<uint32_t>{0, 2, 1, 0, 3, 2});
    // The mesh beside the armature: the node decides, the joints disagree.
    g.tree["nodes"][3]["children"] = {1};
    g.tree["scenes"][0]["nodes"] = {0, 3};
    const auto apart = g.load();
    REQUIRE(apart);
    CHECK(apart->mesh.indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    REQUIRE(apart->warnings.size() == 1);
    CHECK_THAT(apart->warnings[0], ContainsSubstring("2 of 2 joints mirror the mesh where its node does not"));
}

TEST_CASE("buffers that are marked as fallback are not loaded") {
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        Gltf g = fixture::small();
        // Version 0: one element, four bytes without a delta, then the tail with the element itself.
        std::vector<uint8_t> packed = {0xA0, 0, 0, 0, 0};
        packed.resize(packed.size() + 28);
        packed.insert(packed.end(), {0, 0, 0, 0});
        const int times = g.add<uint8_t>(packed, 5121, "SCALAR");
        const auto view = g.tree["accessors"][times]["bufferView"].get<size_t>();
        g.tree["bufferViews"].push_back(
            {{"buffer", 1}, {"byteLength", 4}, {"extensions", {{name, g.tree["bufferViews"][view]}}}});
        json& compressed = g.tree["bufferViews"].back()["extensions"][name];
        compressed.update({{"count", 1}, {"byteStride", 4}, {"mode", "ATTRIBUTES"}});
        g.tree["accessors"].push_back({{"bufferView", g.tree["bufferViews"].size() - 1},
                                       {"componentType", 5126},
                                       {"count", 1},
                                       {"type", "SCALAR"}});
        const size_t input = g.tree["accessors"].size() - 1;
        const int value = g.add<float>({0, 0, 0, 1}, 5126, "VEC4");
        g.tree["animations"][0]["samplers"].push_back({{"input", input}, {"output", value}});
        g.tree["animations"][0]["channels"].push_back(
            {{"sampler", 1}, {"target", {{"node", 1}, {"path", "rotation"}}}});
        g.tree["extensionsUsed"] = {name};
        g.tree["buffers"] = {
            {{"byteLength", g.bin.size()}, {"uri", "data:;base64," + fixture::base64(g.bin)}},
            {{"byteLength", 4}, {"uri", "missing.bin"}, {"extensions", {{name, {{"fallback", true}}}}}}};
        const auto scene = g.load();
        INFO((scene ? std::string() : scene.error().text));
        REQUIRE(scene);
        CHECK(scene->warnings.empty());
        CHECK(scene->clips[0].channels[1].times == std::vector<float>{0});
    }
}

TEST_CASE("the table of extensions is found by name and by prefix, and docs/scenes.md has every row") {
    REQUIRE(findGltfExtension("KHR_materials_unlit"));
    CHECK(findGltfExtension("KHR_materials_unlit")->role == ExtensionRole::harmless);
    CHECK(findGltfExtension("KHR_node_visibility")->role == ExtensionRole::supported);
    CHECK_FALSE(findGltfExtension("KHR_node_visibilit"));
    CHECK_FALSE(checkRequired("EXT_mesh_gpu_instancing"));
    CHECK(checkRequired("KHR_meshopt_compression"));
    std::ifstream file(SKINBENCH_SOURCE_DIR "/docs/scenes.md");
    const std::string docs{std::istreambuf_iterator<char>(file), {}};
    for (const GltfExtension& row : gltfExtensions()) {
        INFO(row.name);
        CHECK_THAT(docs, ContainsSubstring("`" + std::string(row.name) + "`"));
        CHECK_THAT(docs, ContainsSubstring(row.effect));
    }
}
