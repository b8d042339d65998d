#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <nlohmann/json.hpp>

#include "common/scene/scene.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

namespace {

struct SavedFolder {
    fs::path path;
    SavedFolder() {
        std::string name = (fs::temp_directory_path() / "skinbench_save_XXXXXX").string();
        REQUIRE(mkdtemp(name.data()));
        path = name;
    }
    SavedFolder(const SavedFolder&) = delete;
    ~SavedFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    std::string file(const std::string& name) const { return (path / name).string(); }
};

std::string readAll(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

uint32_t wordAt(const std::string& bytes, size_t offset) {
    uint32_t word = 0;
    for (size_t i = 0; i < 4; ++i) word |= uint32_t(uint8_t(bytes[offset + i])) << (8 * i);
    return word;
}

nlohmann::json jsonOf(const std::string& bytes) { return nlohmann::json::parse(bytes.substr(20, wordAt(bytes, 12))); }

Scene madeScene(const std::string& name, uint32_t vertices) {
    auto scene = makeBuiltin(name, vertices);
    REQUIRE(scene);
    return std::move(*scene);
}

Scene saveAndLoad(const Scene& scene, const std::string& path) {
    const auto saved = saveGlb(scene, path);
    REQUIRE(saved);
    auto loaded = loadGltf(path);
    INFO((loaded ? std::string() : loaded.error().text));
    REQUIRE(loaded);
    return std::move(*loaded);
}

// The file has one node more: the one that carries the mesh.
void checkEqual(const Scene& scene, const Scene& loaded) {
    CHECK(loaded.name == scene.name);
    CHECK(loaded.mesh.positions == scene.mesh.positions);
    CHECK(loaded.mesh.normals == scene.mesh.normals);
    CHECK(loaded.mesh.uvs == scene.mesh.uvs);
    CHECK(loaded.mesh.indices == scene.mesh.indices);
    CHECK(loaded.mesh.influences == scene.mesh.influences);
    REQUIRE(loaded.parts.size() == scene.parts.size());
    for (size_t i = 0; i < scene.parts.size(); ++i) {
        CHECK(loaded.parts[i].firstIndex == scene.parts[i].firstIndex);
        CHECK(loaded.parts[i].indexCount == scene.parts[i].indexCount);
    }
    REQUIRE(loaded.skeleton.nodes.size() == scene.skeleton.nodes.size() + 1);
    for (size_t i = 0; i < scene.skeleton.nodes.size(); ++i) {
        const Node &a = scene.skeleton.nodes[i], &b = loaded.skeleton.nodes[i];
        CHECK((a.name == b.name && a.parent == b.parent && a.translation == b.translation && a.rotation == b.rotation &&
               a.scale == b.scale && a.matrix == b.matrix));
    }
    REQUIRE(loaded.skeleton.joints.size() == scene.skeleton.joints.size());
    for (size_t i = 0; i < scene.skeleton.joints.size(); ++i) {
        CHECK(loaded.skeleton.joints[i].node == scene.skeleton.joints[i].node);
        CHECK(loaded.skeleton.joints[i].inverseBind == scene.skeleton.joints[i].inverseBind);
    }
    REQUIRE(loaded.clips.size() == scene.clips.size());
    for (size_t c = 0; c < scene.clips.size(); ++c) {
        const Clip &a = scene.clips[c], &b = loaded.clips[c];
        CHECK(a.name == b.name);
        CHECK(a.duration == b.duration);
        REQUIRE(a.channels.size() == b.channels.size());
        for (size_t i = 0; i < a.channels.size(); ++i) {
            const Channel &x = a.channels[i], &y = b.channels[i];
            CHECK((x.node == y.node && x.path == y.path && x.interpolation == y.interpolation && x.times == y.times &&
                   x.values == y.values));
        }
    }
    CHECK(loaded.warnings.empty());
}

// One joint a node, 300 of them: more than 8 bits can number. One triangle with eight influences a vertex.
Scene wideScene() {
    Scene scene;
    scene.name = "wide";
    for (int i = 0; i < 300; ++i) {
        Node node;
        node.name = "joint " + std::to_string(i);
        node.parent = i - 1;
        node.translation = {0.1f, 0, 0};
        scene.skeleton.nodes.push_back(node);
        scene.skeleton.joints.push_back({uint32_t(i), glm::mat4(1)});
    }
    scene.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.mesh.normals.assign(3, {0, 0, 1});
    scene.mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
    scene.mesh.indices = {0, 1, 2};
    for (uint16_t v = 0; v < 3; ++v) {
        Influences in;
        for (uint16_t i = 0; i < kMaxInfluences; ++i) {
            in.joints[i] = uint16_t(290 + i - v);
            in.weights[i] = 0.125f;
        }
        scene.mesh.influences.push_back(in);
    }
    scene.parts.push_back({"wide", 0, 3, false});
    return scene;
}

}  // namespace

TEST_CASE("a saved scene loads back equal") {
    const SavedFolder folder;
    for (const BuiltinScene& builtin : builtinScenes()) {
        INFO(builtin.name);
        const Scene scene = madeScene(builtin.name, 3'000);
        checkEqual(scene, saveAndLoad(scene, folder.file(std::string(builtin.name) + ".glb")));
    }
}

TEST_CASE("32-bit indices are kept") {
    const SavedFolder folder;
    const Scene scene = madeScene("robot", 90'000);
    checkEqual(scene, saveAndLoad(scene, folder.file("robot.glb")));
}

TEST_CASE("eight influences and 16-bit joints are kept") {
    const SavedFolder folder;
    const Scene scene = wideScene();
    checkEqual(scene, saveAndLoad(scene, folder.file("wide.glb")));
}

TEST_CASE("each part becomes a primitive of its own index range") {
    const SavedFolder folder;
    Scene scene = madeScene("biped", 2'000);
    const auto half = uint32_t(scene.mesh.indices.size() / 6 * 3);
    scene.parts = {{"front", 0, half, false}, {"rest", half, uint32_t(scene.mesh.indices.size()) - half, false}};
    checkEqual(scene, saveAndLoad(scene, folder.file("biped.glb")));
    CHECK(jsonOf(readAll(folder.file("biped.glb")))["meshes"][0]["primitives"].size() == 2);
}

TEST_CASE("an irrelevant joint is written as joint 0 with weight 0") {
    const SavedFolder folder;
    Scene scene = madeScene("biped", 2'000);
    const std::vector<Influences> asMade = scene.mesh.influences;
    cleanWeights(scene.mesh, 4);
    REQUIRE(scene.mesh.influences[0].joints[7] == kNoJoint);
    const Scene loaded = saveAndLoad(scene, folder.file("biped.glb"));
    for (size_t v = 0; v < asMade.size(); ++v)
        for (size_t i = 0; i < kMaxInfluences; ++i) {
            const bool used = scene.mesh.influences[v].weights[i] > 0;
            REQUIRE(loaded.mesh.influences[v].joints[i] == (used ? scene.mesh.influences[v].joints[i] : 0));
            REQUIRE(loaded.mesh.influences[v].weights[i] == scene.mesh.influences[v].weights[i]);
        }
}

TEST_CASE("a joint that shares its node with another gets a node of its own") {
    const SavedFolder folder;
    Scene scene = wideScene();
    scene.skeleton.joints[299].node = 5;
    const Scene loaded = saveAndLoad(scene, folder.file("twice.glb"));
    REQUIRE(loaded.skeleton.joints.size() == 300);
    const Node& own = loaded.skeleton.nodes[loaded.skeleton.joints[299].node];
    CHECK(own.parent == 5);
    CHECK(own.translation == glm::vec3(0));
    const auto joints = jsonOf(readAll(folder.file("twice.glb")))["skins"][0]["joints"];
    CHECK(std::set<int>(joints.begin(), joints.end()).size() == 300);
}

TEST_CASE("the container is laid out as glTF 2.0 asks") {
    const SavedFolder folder;
    for (const uint32_t vertices : {2'000u, 2'500u, 3'001u}) {
        const Scene scene = madeScene("creature", vertices);
        REQUIRE(saveGlb(scene, folder.file("c.glb")));
        const std::string bytes = readAll(folder.file("c.glb"));
        CHECK(bytes.substr(0, 4) == "glTF");
        CHECK(wordAt(bytes, 4) == 2);
        CHECK(wordAt(bytes, 8) == bytes.size());
        const uint32_t jsonSize = wordAt(bytes, 12);
        CHECK(jsonSize % 4 == 0);
        CHECK(bytes.substr(16, 4) == "JSON");
        CHECK(wordAt(bytes, 20 + jsonSize) % 4 == 0);
        CHECK(bytes.substr(24 + jsonSize, 4) == std::string("BIN\0", 4));
        CHECK(bytes.size() == 28 + jsonSize + wordAt(bytes, 20 + jsonSize));

        const nlohmann::json json = jsonOf(bytes);
        CHECK(json["asset"]["version"] == "2.0");
        CHECK(json["asset"]["generator"] == "skinbench");
        CHECK(json["buffers"][0]["byteLength"] == wordAt(bytes, 20 + jsonSize));
        size_t end = 0;
        for (const auto& view : json["bufferViews"]) {
            CHECK(view["byteOffset"].get<size_t>() % 4 == 0);
            CHECK(view["byteOffset"].get<size_t>() >= end);
            end = view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>();
        }
        CHECK(end <= json["buffers"][0]["byteLength"].get<size_t>());
        const auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
        const auto& position = json["accessors"][attributes["POSITION"].get<size_t>()];
        CHECK(position["min"].size() == 3);
        CHECK(position["max"].size() == 3);
        CHECK(json["accessors"][attributes["JOINTS_0"].get<size_t>()]["componentType"] == 5121);
        CHECK_FALSE(attributes.contains("JOINTS_1"));
        CHECK(json["skins"][0]["joints"].size() == scene.skeleton.joints.size());
    }
}

TEST_CASE("a file that cannot be written is an error and leaves nothing behind") {
    const SavedFolder folder;
    const Scene scene = madeScene("robot", 2'000);
    fs::create_directory(folder.path / "taken.glb");
    const auto saved = saveGlb(scene, folder.file("taken.glb"));
    REQUIRE_FALSE(saved);
    CHECK(saved.error().fault == Fault::input);
    CHECK_THAT(saved.error().text, ContainsSubstring("taken.glb"));
    CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
    if (fs::exists("/dev/full")) CHECK_FALSE(saveGlb(scene, "/dev/full/robot.glb"));
}

TEST_CASE("a broken scene is not saved") {
    const SavedFolder folder;
    Scene scene = madeScene("robot", 2'000);
    scene.mesh.indices[0] = 1u << 30;
    const auto saved = saveGlb(scene, folder.file("broken.glb"));
    REQUIRE_FALSE(saved);
    CHECK_THAT(saved.error().text, ContainsSubstring("broken.glb"));
    CHECK(fs::is_empty(folder.path));
}

TEST_CASE("joints without a common root get one") {
    const SavedFolder folder;
    Scene scene = wideScene();
    scene.skeleton.nodes[150].parent = -1;
    REQUIRE(saveGlb(scene, folder.file("roots.glb")));
    const auto json = jsonOf(readAll(folder.file("roots.glb")));
    REQUIRE(json["scenes"][0]["nodes"].size() == 2);  // the root and the mesh
    const size_t root = json["scenes"][0]["nodes"][0];
    CHECK(json["nodes"][root]["children"] == nlohmann::json({0, 150}));
    const auto loaded = loadGltf(folder.file("roots.glb"));
    REQUIRE(loaded);
    CHECK(loaded->warnings.empty());
    CHECK(loaded->skeleton.joints.size() == 300);
}

TEST_CASE("what glTF forbids is put right on the way out") {
    const SavedFolder folder;
    Scene scene = wideScene();
    scene.skeleton.nodes[1].rotation = {2, 0, 0, 0};
    scene.skeleton.joints[0].inverseBind[0][3] = 5;
    scene.mesh.influences[0].weights[0] = 3;
    scene.mesh.influences[1].joints[0] = scene.mesh.influences[1].joints[1];
    const Channel channel{0, ChannelPath::translation, Interpolation::linear, {0}, {{1, 0, 0, 0}}};
    scene.clips.push_back({"twice", 0, {channel, channel}});
    scene.clips[0].channels[1].values = {{2, 0, 0, 0}};
    const Scene loaded = saveAndLoad(scene, folder.file("clean.glb"));
    CHECK(loaded.warnings.empty());
    CHECK(loaded.skeleton.nodes[1].rotation == glm::quat(1, 0, 0, 0));
    CHECK(loaded.skeleton.joints[0].inverseBind == glm::mat4(1));
    CHECK(loaded.mesh.influences[2] == scene.mesh.influences[2]);
    REQUIRE(loaded.clips[0].channels.size() == 1);
    CHECK(loaded.clips[0].channels[0].values[0].x == 2);
}

TEST_CASE("a name that does not end in .glb is refused") {
    const SavedFolder folder;
    for (const char* name : {"x.gltf", "x", "x.glb.txt", "glb"}) {
        INFO(name);
        const auto saved = saveGlb(wideScene(), folder.file(name));
        REQUIRE_FALSE(saved);
        CHECK_THAT(saved.error().text, ContainsSubstring("give a name that ends in .glb"));
    }
    CHECK(saveGlb(wideScene(), folder.file("X.GLB")));
    CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
}
