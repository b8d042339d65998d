#include <format>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/scene/pose.h"
#include "common/scene/skin_cpu.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

std::string model(const std::string& name) {
    if (!std::filesystem::exists(fixture::modelFolder()))
        SKIP("no models in " << fixture::modelFolder() << "; set SKINBENCH_MODELS");
    return fixture::modelFolder() + "/" + name;
}

Scene loadModel(const std::string& name) {
    auto scene = loadScene(model(name));
    INFO(name << ": " << (scene ? "" : scene.error().text));
    REQUIRE(scene);
    return std::move(*scene);
}

bool hasWarning(const Scene& scene, const std::string& text) {
    return std::ranges::any_of(scene.warnings, [&](const std::string& w) { return w.find(text) != w.npos; });
}

// Posed positions by triangle corner, so that files that index differently can be compared.
std::vector<glm::dvec3> corners(const Scene& scene, float seconds) {
    const Clip* clip = scene.clips.empty() ? nullptr : &scene.clips[0];
    Mesh mesh = scene.mesh;
    cleanWeights(mesh, kMaxInfluences);
    const auto model = toModelSpace(sampleClip(scene.skeleton, clip, seconds));  // without poseScene's wrapping
    const auto skinned = skinReference(mesh, makePalette(scene.skeleton, model));
    std::vector<glm::dvec3> out;
    for (const uint32_t index : mesh.indices) out.push_back(skinned.positions[index]);
    return out;
}

// Largest distance between two poses, over the size of the first.
double distance(const Scene& a, const Scene& b, float seconds) {
    const auto p = corners(a, seconds), q = corners(b, seconds);
    REQUIRE(p.size() == q.size());
    double worst = 0;
    for (size_t i = 0; i < p.size(); ++i) worst = std::max(worst, glm::length(p[i] - q[i]));
    return worst / posedBounds(a.mesh, poseScene(a, nullptr, 0)).diagonal();
}

struct Row {
    const char* name;
    uint32_t vertices, triangles, joints, tuples, maxInfluences;
    size_t clips;
};

// Of models without static meshes. recursive_skeletons draws its 40 vertices 84 times.
constexpr Row kRows[] = {
    {"arnaud.glb", 3934, 6670, 54, 343, 5, 3},
    {"cesium_man.glb", 3273, 4672, 19, 146, 4, 1},
    {"desk_fan.glb", 15601, 21080, 12, 4, 4, 4},
    {"dragon.glb", 2905, 3498, 100, 502, 4, 5},
    {"fox.glb", 1728, 576, 24, 49, 4, 3},
    {"human_dense.glb", 222584, 435648, 53, 560, 4, 1},
    {"human_female.glb", 24037, 14244, 66, 372, 4, 1},
    {"human_full_rig.glb", 56842, 108912, 163, 4737, 8, 3},
    {"human_game_rig.glb", 14813, 27228, 53, 414, 4, 3},
    {"mannequiny.glb", 12597, 13832, 45, 170, 4, 10},
    {"mechs_scene.glb", 23070, 22404, 150, 185, 3, 3},
    {"recursive_skeletons.glb", 3360, 6384, 840, 840, 1, 1},
    {"rigged_figure.glb", 370, 256, 19, 73, 4, 1},
    {"rigged_simple.glb", 160, 188, 2, 3, 2, 1},
    {"robot.glb", 7218, 3238, 43, 108, 4, 14},
    {"edge/cesium_man_2017_weights_not_normalised.glb", 3273, 4672, 19, 146, 4, 1},
    {"edge/human_face_morphs.glb", 14813, 27228, 53, 412, 4, 3},
    {"edge/one_skin_316_joints.glb", 50012, 40146, 316, 1059, 4, 3},
    {"edge/quad_twelve_influences.glb", 4, 2, 10, 4, 8, 0},
    {"edge/rigged_figure_cubicspline.glb", 370, 256, 19, 73, 4, 1},
    {"edge/rigged_figure_joints_u8_weights_u8.glb", 370, 256, 19, 74, 4, 1},
    {"edge/rigged_figure_no_indices.glb", 768, 256, 19, 73, 4, 1},
    {"edge/rigged_figure_sparse.glb", 370, 256, 19, 73, 4, 1},
    {"edge/rigged_figure_two_files/rigged_figure.gltf", 370, 256, 19, 73, 4, 1},
    {"edge/simple_skin.gltf", 10, 8, 2, 4, 2, 1},
    {"edge/spider_float.glb", 5461, 2712, 39, 125, 4, 5},
    {"edge/spider_meshopt.glb", 5461, 2712, 39, 125, 4, 5},
    {"edge/spider_quantized.glb", 5461, 2712, 39, 125, 4, 5},
    {"edge/asset_generator/Animation_Skin_06.gltf", 12, 12, 4, 4, 1, 1},
    {"edge/asset_generator/Animation_Skin_07.gltf", 10, 8, 5, 5, 1, 0},
    {"edge/asset_generator/Animation_Skin_09.gltf", 13, 10, 4, 4, 1, 0},
};

}  // namespace

TEST_CASE("models have the published counts") {
    for (const Row& row : kRows) {
        INFO(row.name);
        const Scene scene = loadModel(row.name);
        const SceneStats stats = sceneStats(scene);
        CHECK(stats.vertices == row.vertices);
        CHECK(stats.triangles == row.triangles);
        CHECK(stats.joints == row.joints);
        CHECK(stats.uniqueTuples == row.tuples);
        CHECK(stats.maxInfluences == row.maxInfluences);
        CHECK(scene.clips.size() == row.clips);
    }
}

TEST_CASE("every model loads, prepares and poses, or says why not") {
    size_t good = 0, refused = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(model(""))) {
        const auto extension = entry.path().extension();
        if (extension != ".glb" && extension != ".gltf") continue;
        INFO(entry.path());
        auto scene = loadScene(entry.path().string());
        if (!scene) {
            CHECK(scene.error().fault == Fault::input);
            CHECK(scene.error().text.starts_with(entry.path().string() + ": "));
            ++refused;
            continue;
        }
        ++good;
        CHECK(checkScene(*scene));
        const uint32_t triangles = sceneStats(*scene).triangles;
        const auto prepared = prepareScene(std::move(*scene), {});
        REQUIRE(prepared);
        CHECK(checkScene(*prepared));
        CHECK(prepared->mesh.indices.size() == triangles * size_t{3});
        for (const Clip& clip : prepared->clips) {
            const Bounds bounds = posedBounds(prepared->mesh, poseScene(*prepared, &clip, clip.duration * 0.4f));
            CHECK(std::isfinite(bounds.diagonal()));
            CHECK(bounds.diagonal() > 0);
        }
    }
    CHECK(good >= 45);
    CHECK(refused == 2);
}

TEST_CASE("one figure stored in many ways is one figure") {
    const Scene figure = loadModel("rigged_figure.glb");
    for (const char* name :
         {"interleaved.glb", "sparse.glb", "no_indices.glb", "data_uri.gltf", "two_files/rigged_figure.gltf"}) {
        INFO(name);
        const Scene other = loadModel(std::string("edge/rigged_figure_") + name);
        for (const float t : {0.0f, 0.37f, 0.9f}) CHECK(distance(figure, other, t) == 0);
    }
    CHECK(distance(figure, loadModel("edge/rigged_figure_joints_u8_weights_u8.glb"), 0.37f) < 2e-4);
    CHECK(distance(figure, loadModel("edge/rigged_figure_joints_u16_weights_u16.glb"), 0.37f) < 1e-6);
}

TEST_CASE("spline and step keys agree with linear ones at key times") {
    const Scene figure = loadModel("rigged_figure.glb");
    const Scene spline = loadModel("edge/rigged_figure_cubicspline.glb");
    const Scene step = loadModel("edge/rigged_figure_step.glb");
    const std::vector<float>& times = figure.clips[0].channels[0].times;
    for (const float t : times) {
        CHECK(distance(figure, spline, t) < 1e-6);
        CHECK(distance(figure, step, t) < 1e-6);
    }
    REQUIRE(times == std::vector<float>{0, 1.25f});
    const float between = 0.5f;
    CHECK(corners(step, between) == corners(step, 0));
    CHECK(corners(step, between) != corners(step, 1.25f));
    CHECK(distance(figure, spline, between) > 1e-5);
}

TEST_CASE("quantised and compressed spiders equal the plain one") {
    const Scene plain = loadModel("edge/spider_float.glb");
    for (const float t : {0.0f, 0.3f}) {
        CHECK(distance(plain, loadModel("edge/spider_quantized.glb"), t) < 1e-6);
        CHECK(distance(plain, loadModel("edge/spider_meshopt.glb"), t) < 1e-5);  // its filters round to 16 bits
    }
}

TEST_CASE("asset generator scenes") {
    auto of = [](const std::string& name) { return loadModel(std::format("edge/asset_generator/{}.gltf", name)); };
    const Scene plain = of("Animation_Skin_00");
    SECTION("transforms of the skinned node have no effect") {
        CHECK(distance(plain, of("Animation_Skin_02"), 0) == 0);
    }
    SECTION("joints outside the scene work") { CHECK(distance(plain, of("Animation_Skin_03"), 0) == 0); }
    SECTION("missing inverse bind matrices are identities") {
        for (const Joint& joint : of("Animation_Skin_04").skeleton.joints) CHECK(joint.inverseBind == glm::mat4(1));
    }
    SECTION("joint and weight types make no difference") {
        const Scene first = of("Animation_SkinType_00");
        for (const char* n : {"1", "2", "3"})
            CHECK(distance(first, of(std::format("Animation_SkinType_0{}", n)), 0) == 0);
    }
    SECTION("a static mesh follows its joint") {
        for (const char* n : {"5", "8"}) {
            const Scene scene = of(std::format("Animation_Skin_0{}", n));
            const auto part = std::ranges::find(scene.parts, true, &Part::rigid);
            REQUIRE(part != scene.parts.end());
            const auto begin = corners(scene, 0), later = corners(scene, scene.clips[0].duration * 0.5f);
            double moved = 0;  // not all vertices do: one lies on the joint's axis
            for (uint32_t i = part->firstIndex; i < part->firstIndex + part->indexCount; ++i)
                moved = std::max(moved, glm::length(begin[i] - later[i]));
            CHECK(moved > 0.01);
        }
    }
}

TEST_CASE("what was repaired or ignored is said") {
    CHECK(hasWarning(loadModel("edge/cesium_man_2017_weights_not_normalised.glb"),
                     "210 vertices have weights that do not sum to 1; normalised"));
    CHECK(hasWarning(loadModel("edge/crab_six_vertices_without_weights.glb"), "6 vertices have no weight at all"));
    CHECK(hasWarning(loadModel("edge/human_face_morphs.glb"), "morph targets are ignored"));
    CHECK(hasWarning(loadModel("edge/quad_twelve_influences.glb"), "more than 8 influences"));
    CHECK(loadModel("rigged_figure.glb").warnings.empty());
}

TEST_CASE("files that cannot be read are refused by name") {
    const auto draco = loadScene(model("edge/rigged_figure_draco/RiggedFigure.gltf"));
    REQUIRE_FALSE(draco);
    CHECK_THAT(draco.error().text, ContainsSubstring("KHR_draco_mesh_compression"));
    const auto old = loadScene(model("edge/rigged_simple_gltf1.glb"));
    REQUIRE_FALSE(old);
    CHECK_THAT(old.error().text, ContainsSubstring("glTF 1.0"));
}

TEST_CASE("the small fixture loads as text and as GLB") {
    const auto text = fixture::small().load();
    REQUIRE(text);
    CHECK(text->name == "small");
    CHECK(text->warnings.empty());
    const auto glb = loadScene(fixture::writeFile("small.glb", fixture::small().asGlb()));
    REQUIRE(glb);
    CHECK(glb->mesh.positions == text->mesh.positions);
    CHECK(glb->mesh.indices == text->mesh.indices);
    // The upper edge turns by 90 degrees around joint 1 at (0, 1, 0): x becomes y.
    const auto skinned = skinReference(text->mesh, poseScene(*text, &text->clips[0], 0.999999f));
    CHECK(glm::length(skinned.positions[2] - glm::dvec3(0, 2, 0)) < 1e-4);
    CHECK(skinned.positions[1] == glm::dvec3(1, 0, 0));
}

TEST_CASE("strips, fans and lists give the same triangles") {
    auto strip = fixture::small();
    strip.primitive()["indices"] = strip.add<uint8_t>({0, 1, 3, 2}, 5121, "SCALAR");
    strip.primitive()["mode"] = 5;
    CHECK(strip.load().value().mesh.indices == std::vector<uint32_t>{0, 1, 3, 1, 2, 3});
    auto fan = fixture::small();
    fan.primitive()["indices"] = fan.add<uint32_t>({0, 1, 2, 3}, 5125, "SCALAR");
    fan.primitive()["mode"] = 6;
    CHECK(fan.load().value().mesh.indices == std::vector<uint32_t>{1, 2, 0, 2, 3, 0});
    auto points = fixture::small();
    points.tree["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
    const auto scene = points.load();
    REQUIRE(scene);
    CHECK(hasWarning(*scene, "1 primitive of points or lines is ignored"));
    CHECK(scene->parts.size() == 1);
}

TEST_CASE("missing attributes are made up") {
    auto bare = fixture::small();
    bare.primitive()["attributes"].erase("NORMAL");
    bare.primitive()["attributes"].erase("TEXCOORD_0");
    bare.poke<float>(0, 2 * 3 + 2, 1.0f);  // lifts vertex 2
    const auto scene = bare.load();
    REQUIRE(scene);
    CHECK(scene->mesh.uvs == std::vector<glm::vec2>(4, glm::vec2(0)));
    // Triangle (0,1,2) has normal (0,-1,1), triangle (0,2,3) has (-1,0,1); they share vertices 0 and 2.
    CHECK(glm::length(scene->mesh.normals[1] - glm::normalize(glm::vec3(0, -1, 1))) < 1e-6f);
    CHECK(glm::length(scene->mesh.normals[0] - glm::normalize(glm::vec3(-1, -1, 2))) < 1e-6f);
}

TEST_CASE("static meshes on mirrored nodes keep their front faces") {
    auto g = fixture::small();
    g.tree["meshes"].push_back(
        {{"name", "flag"}, {"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 5}}}}});
    g.tree["nodes"].push_back({{"mesh", 1}, {"scale", {-1, 1, 1}}});
    g.tree["nodes"][1]["children"].push_back(3);
    const auto scene = g.load();
    REQUIRE(scene);
    REQUIRE(scene->parts.size() == 2);
    CHECK(scene->parts[1].rigid);
    CHECK(scene->parts[1].name == "flag");
    CHECK(std::vector<uint32_t>(scene->mesh.indices.begin() + 6, scene->mesh.indices.end()) ==
          std::vector<uint32_t>{4, 6, 5, 4, 7, 6});
    REQUIRE(scene->skeleton.joints.size() == 3);
    CHECK(scene->skeleton.nodes[scene->skeleton.joints[2].node].scale.x == -1);
    CHECK(scene->mesh.influences[4].joints[0] == 2);
    CHECK(scene->mesh.influences[4].weights[0] == 1);
}

TEST_CASE("two nodes may draw one mesh, and children may stand before parents") {
    auto g = fixture::small();
    g.tree["nodes"].push_back({{"mesh", 0}, {"skin", 0}});
    g.tree["scenes"][0]["nodes"].push_back(3);
    const auto twice = g.load();
    REQUIRE(twice);
    CHECK(twice->mesh.positions.size() == 8);
    CHECK(twice->parts.size() == 2);
    CHECK(twice->skeleton.joints.size() == 2);

    auto reversed = fixture::small();
    reversed.tree["nodes"] = {{{"mesh", 0}, {"skin", 0}},
                              {{"name", "child"}, {"translation", {0, 1, 0}}},
                              {{"name", "root"}, {"children", {1}}}};
    reversed.tree["skins"][0]["joints"] = {2, 1};
    reversed.tree["animations"][0]["channels"][0]["target"]["node"] = 1;
    reversed.tree["scenes"][0]["nodes"] = {0, 2};
    const auto sorted = reversed.load();
    REQUIRE(sorted);
    CHECK(distance(*fixture::small().load(), *sorted, 0.5f) == 0);
}

TEST_CASE("primitives with the same attributes share their vertices") {
    auto g = fixture::small();
    fixture::json second = g.primitive();
    g.primitive()["indices"] = g.add<uint16_t>({0, 1, 2}, 5123, "SCALAR");
    second["indices"] = g.add<uint16_t>({0, 2, 3}, 5123, "SCALAR");
    g.tree["meshes"][0]["primitives"].push_back(second);
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->mesh.positions.size() == 4);
    CHECK(scene->mesh.indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    CHECK(scene->parts.size() == 2);
}

TEST_CASE("weights of all kinds") {
    SECTION("normalised bytes, also when the flag is missing") {
        auto g = fixture::small();
        g.primitive()["attributes"]["WEIGHTS_0"] =
            g.add<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 51, 204, 0, 0, 255, 0, 0, 0}, 5121, "VEC4");
        const auto scene = g.load();
        REQUIRE(scene);
        CHECK(scene->mesh.influences[2].weights[0] == 0.2f);
        CHECK(scene->mesh.influences[2].weights[1] == 0.8f);
    }
    SECTION("bad ones are cleaned and counted") {
        auto g = fixture::small();
        g.poke<float>(4, 1, -0.5f);
        g.poke<float>(4, 5, std::numeric_limits<float>::quiet_NaN());
        g.poke<float>(4, 8, 0.0f);
        g.poke<float>(4, 12, 0.5f);
        const auto scene = g.load();
        REQUIRE(scene);
        CHECK(scene->warnings == std::vector<std::string>{"2 weights are negative or not finite; set to 0",
                                                          "1 vertex has weights that do not sum to 1; normalised",
                                                          "1 vertex has no weight at all; bound to its first joint"});
    }
    SECTION("a joint out of range is an error only where it has weight") {
        auto g = fixture::small();
        g.poke<uint8_t>(3, 1, 77);
        CHECK(g.load());
        g.poke<float>(4, 1, 0.5f);
        const auto scene = g.load();
        REQUIRE_FALSE(scene);
        CHECK_THAT(scene.error().text, ContainsSubstring("small.gltf: mesh 0: vertex 0 names joint 77"));
    }
}

TEST_CASE("animation details") {
    SECTION("rotations may be normalised integers") {
        auto g = fixture::small();
        g.tree["animations"][0]["samplers"][0]["output"] =
            g.add<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}, 5122, "VEC4", true);
        const auto scene = g.load();
        REQUIRE(scene);
        CHECK(scene->clips[0].channels[0].values[1].z == 23170 / 32767.0f);
        CHECK(distance(*fixture::small().load(), *scene, 0.5f) < 1e-4);
    }
    SECTION("weights and unknown targets are ignored with a word") {
        auto g = fixture::small();
        g.tree["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}});
        g.tree["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"path", "rotation"}}}});
        const auto scene = g.load();
        REQUIRE(scene);
        CHECK(scene->clips[0].channels.size() == 1);
        CHECK(hasWarning(*scene, "morph targets are ignored"));
    }
    SECTION("a matrix on an animated node is split") {
        auto g = fixture::small();
        g.tree["nodes"][2] = {{"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1}}};
        const auto scene = g.load();
        REQUIRE(scene);
        const Node& node = scene->skeleton.nodes[2];
        CHECK_FALSE(node.matrix);
        CHECK(node.translation == glm::vec3(5, 6, 7));
        CHECK(glm::length(node.scale - glm::vec3(2)) < 1e-6f);
        CHECK(std::abs(node.rotation.z - std::sqrt(0.5f)) < 1e-6f);
        CHECK(hasWarning(*scene, "split"));
    }
}

TEST_CASE("images are never looked at") {
    auto g = fixture::small();
    g.tree["images"] = {{{"uri", "missing.png"}}, {{"bufferView", 999}, {"mimeType", "image/png"}}, 7};
    g.tree["textures"] = {{{"source", 0}}};
    g.tree["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->warnings.empty());
}

TEST_CASE("a mesh without skin beside a skinned one is a rigid part; alone it is an error") {
    auto g = fixture::small();
    g.tree["nodes"][0].erase("skin");
    const auto scene = g.load();
    REQUIRE_FALSE(scene);
    CHECK_THAT(scene.error().text, ContainsSubstring("has no skin: nothing to animate"));
}
