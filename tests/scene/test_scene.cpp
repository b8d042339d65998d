#include <cstring>
#include <limits>
#include <map>
#include <random>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/scene/pose.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

Mesh oneVertex(std::initializer_list<uint16_t> joints, std::initializer_list<float> weights) {
    Mesh mesh;
    mesh.influences.resize(1);
    std::ranges::copy(joints, mesh.influences[0].joints.begin());
    std::ranges::copy(weights, mesh.influences[0].weights.begin());
    return mesh;
}

Influences expected(std::initializer_list<uint16_t> joints, std::initializer_list<float> weights) {
    Mesh mesh = oneVertex({}, {});
    mesh.influences[0].joints.fill(kNoJoint);
    std::ranges::copy(joints, mesh.influences[0].joints.begin());
    std::ranges::copy(weights, mesh.influences[0].weights.begin());
    return mesh.influences[0];
}

Scene small() { return fixture::small().load().value(); }

// A corner with all its attributes, as a value to count.
using Corner = std::array<float, 8 + 2 * kMaxInfluences>;

Corner cornerOf(const Mesh& mesh, uint32_t v) {
    Corner c{};
    for (int i = 0; i < 3; ++i) c[i] = mesh.positions[v][i], c[3 + i] = mesh.normals[v][i];
    c[6] = mesh.uvs[v].x, c[7] = mesh.uvs[v].y;
    for (int i = 0; i < kMaxInfluences; ++i)
        c[8 + i] = mesh.influences[v].joints[i], c[8 + kMaxInfluences + i] = mesh.influences[v].weights[i];
    return c;
}

// The triangles of one part, each rotated to begin with its smallest corner, with how often they occur.
std::map<std::array<Corner, 3>, int> trianglesOf(const Scene& scene, size_t part) {
    std::map<std::array<Corner, 3>, int> triangles;
    const Part& range = scene.parts[part];
    for (uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) {
        std::array<Corner, 3> t;
        for (int k = 0; k < 3; ++k) t[k] = cornerOf(scene.mesh, scene.mesh.indices[i + k]);
        std::ranges::rotate(t, std::ranges::min_element(t));
        ++triangles[t];
    }
    return triangles;
}

// A bumpy grid whose vertices are stored once per triangle corner, in two parts, with one vertex nobody uses.
Scene grid(int size) {
    Scene scene = small();
    scene.mesh = {};
    const auto vertex = [&](int x, int y) {
        scene.mesh.positions.push_back({x, y, (x * 7 + y * 3) % 5});
        scene.mesh.normals.push_back({0, 0, 2});
        scene.mesh.uvs.push_back({x, x == 0 && y % 2 ? -0.0f : 0.0f});
        scene.mesh.influences.push_back({{1, 0}, {float(x), float(size - x)}});
        scene.mesh.indices.push_back(static_cast<uint32_t>(scene.mesh.positions.size() - 1));
    };
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1);
            vertex(x, y), vertex(x + 1, y + 1), vertex(x, y + 1);
        }
    vertex(0, 0);
    scene.mesh.indices.pop_back();
    const auto half = static_cast<uint32_t>(size / 2 * size * 6);
    const auto all = static_cast<uint32_t>(scene.mesh.indices.size());
    scene.parts = {{"lower", 0, half}, {"upper", half, all - half}};
    return scene;
}

}  // namespace

TEST_CASE("weight clean-up, rule by rule") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto clean = [](Mesh mesh, int keep = 4) {
        cleanWeights(mesh, keep);
        return mesh.influences[0];
    };
    CHECK(clean(oneVertex({7, 8, 9}, {nan, -3, 0.5f})) == expected({9}, {1}));
    CHECK(clean(oneVertex({7, 8}, {0.5f, 0.9e-7f})) == expected({7}, {1}));
    CHECK(clean(oneVertex({7, 8, 7}, {0.25f, 0.5f, 0.25f})) == expected({7, 8}, {0.5f, 0.5f}));
    CHECK(clean(oneVertex({3, 2, 1}, {0.25f, 0.5f, 0.25f})) == expected({2, 1, 3}, {0.5f, 0.25f, 0.25f}));
    CHECK(clean(oneVertex({5, 6}, {0, 0})) == expected({5}, {1}));
    CHECK(clean(oneVertex({5, 6}, {1, 3})) == expected({6, 5}, {0.75f, 0.25f}));
    CHECK(clean(oneVertex({kNoJoint, kNoJoint}, {0, 0})) == expected({0}, {1}));
    CHECK(clean(oneVertex({4, 3, 2, 1, 0}, {1, 1, 1, 1, 4}), 1) == expected({0}, {1}));
}

TEST_CASE("clean-up reports the weight it dropped") {
    Mesh mesh = oneVertex({0, 1, 2, 3, 4}, {4, 2, 1, 0.5f, 0.5f});
    mesh.influences.push_back(mesh.influences[0]);
    mesh.influences[1].weights = {1};
    const DroppedWeight dropped = cleanWeights(mesh, 4);
    CHECK(dropped.max == 0.0625f);
    CHECK(dropped.mean == 0.03125);
    CHECK(mesh.influences[0].joints == std::array<uint16_t, 8>{0, 1, 2, 3, kNoJoint, kNoJoint, kNoJoint, kNoJoint});
    CHECK(mesh.influences[0].weights[0] == static_cast<float>(4 / 7.5));
}

TEST_CASE("clean weights are sorted and sum to 1") {
    std::mt19937 random(5);
    Mesh mesh;
    mesh.influences.resize(5000);
    for (Influences& influences : mesh.influences)
        for (int k = 0; k < kMaxInfluences; ++k) {
            influences.joints[k] = static_cast<uint16_t>(random() % 6);
            influences.weights[k] = random() % 3 == 0 ? 0.0f : static_cast<float>(random() % 1000) / 100;
        }
    cleanWeights(mesh, 4);
    for (const Influences& influences : mesh.influences) {
        double sum = 0;
        for (int k = 0; k < kMaxInfluences; ++k) {
            sum += influences.weights[k];
            CHECK((influences.joints[k] == kNoJoint) == (influences.weights[k] == 0));
            if (k > 0) CHECK(influences.weights[k] <= influences.weights[k - 1]);
            if (k >= 4) CHECK(influences.weights[k] == 0);
        }
        CHECK(std::abs(sum - 1) < 3e-7);
    }
}

TEST_CASE("statistics count tuples with unused places marked") {
    Scene scene = small();
    scene.mesh.influences = {{{1, 0}, {1, 0}}, {{1, 0}, {0.6f, 0.4f}}, {{0, 1}, {0.4f, 0.6f}}, {{0, 1}, {0.6f, 0.4f}}};
    const SceneStats stats = sceneStats(scene);
    CHECK(stats.vertices == 4);
    CHECK(stats.triangles == 2);
    CHECK(stats.joints == 2);
    CHECK(stats.uniqueTuples == 3);
    CHECK(stats.meanInfluences == 7 / 4.0);
    CHECK(stats.maxInfluences == 2);
}

TEST_CASE("checkScene finds each fault") {
    const float infinity = std::numeric_limits<float>::infinity();
    const auto fault = [](auto damage) {
        Scene scene = small();
        REQUIRE(checkScene(scene));
        damage(scene);
        const auto result = checkScene(scene);
        return result ? std::string() : result.error().text;
    };
    CHECK_THAT(fault([](Scene& s) { s.mesh.uvs.pop_back(); }), ContainsSubstring("differ in length"));
    CHECK_THAT(fault([](Scene& s) { s.mesh.indices.clear(); }), ContainsSubstring("no triangle"));
    CHECK_THAT(fault([](Scene& s) { s.mesh.indices.pop_back(); }), ContainsSubstring("no multiple of 3"));
    CHECK_THAT(fault([](Scene& s) { s.mesh.indices[4] = 4; }), ContainsSubstring("triangle 1 names vertex 4 of 4"));
    CHECK_THAT(fault([&](Scene& s) { s.mesh.positions[1].y = infinity; }), ContainsSubstring("vertex 1: the position"));
    CHECK_THAT(fault([&](Scene& s) { s.mesh.normals[1].y = infinity; }), ContainsSubstring("vertex 1: the normal"));
    CHECK_THAT(fault([&](Scene& s) { s.mesh.uvs[1].y = infinity; }), ContainsSubstring("vertex 1: the uv"));
    CHECK_THAT(fault([&](Scene& s) { s.mesh.influences[1].weights[7] = infinity; }), ContainsSubstring("a weight"));
    CHECK_THAT(fault([](Scene& s) { s.mesh.influences[3].joints[0] = 2; }),
               ContainsSubstring("vertex 3 names joint 2 of 2"));
    CHECK_THAT(fault([](Scene& s) { s.mesh.influences[3].joints[0] = kNoJoint; }),
               ContainsSubstring("names joint 65535"));
    CHECK(fault([](Scene& s) { s.mesh.influences[3].joints[7] = kNoJoint; }).empty());
    CHECK_THAT(fault([](Scene& s) { s.skeleton.nodes[1].parent = 2; }), ContainsSubstring("does not stand before"));
    CHECK_THAT(fault([&](Scene& s) { s.skeleton.nodes[1].scale.x = infinity; }),
               ContainsSubstring("node 1: its transform"));
    CHECK_THAT(fault([](Scene& s) { s.skeleton.joints[1].node = 3; }), ContainsSubstring("joint 1 names node 3 of 3"));
    CHECK_THAT(fault([&](Scene& s) { s.skeleton.joints[1].inverseBind[2][2] = infinity; }),
               ContainsSubstring("joint 1"));
    CHECK_THAT(fault([](Scene& s) { s.skeleton.joints.resize(kMaxJoints + 1); }), ContainsSubstring("limit of 65535"));
    CHECK_THAT(fault([](Scene& s) { s.parts[0].indexCount = 9; }), ContainsSubstring("index range"));
    CHECK_THAT(fault([](Scene& s) { s.clips[0].channels[0].times = {1, 0}; }), ContainsSubstring("do not ascend"));
    CHECK_THAT(fault([](Scene& s) { s.clips[0].channels[0].values.pop_back(); }),
               ContainsSubstring("1 value for 2 keys"));
    CHECK_THAT(fault([](Scene& s) { s.clips[0].channels[0].node = 3; }), ContainsSubstring("names node 3 of 3"));
    CHECK_THAT(fault([&](Scene& s) { s.clips[0].channels[0].values[0].x = infinity; }),
               ContainsSubstring("clip bend: channel 0"));
}

TEST_CASE("welding merges equal vertices and keeps every triangle") {
    const int size = 12;
    const Scene source = grid(size);
    const auto stored = prepareScene(source, {4, Geometry::stored, false});
    REQUIRE(stored);
    CHECK(stored->mesh.positions.size() == source.mesh.positions.size());
    CHECK(stored->mesh.indices == source.mesh.indices);
    CHECK(stored->mesh.normals[0] == glm::vec3(0, 0, 1));
    for (const Geometry geometry : {Geometry::welded, Geometry::stored, Geometry::unwelded})
        for (const bool order : {false, true}) {
            const auto scene = prepareScene(source, {4, geometry, order});
            REQUIRE(scene);
            CHECK(checkScene(*scene));
            for (size_t part = 0; part < 2; ++part) CHECK(trianglesOf(*scene, part) == trianglesOf(*stored, part));
            const size_t expectedVertices = geometry == Geometry::welded     ? (size + 1) * (size + 1)
                                            : geometry == Geometry::unwelded ? source.mesh.indices.size()
                                                                             : source.mesh.positions.size();
            CHECK(scene->mesh.positions.size() == expectedVertices);
        }
}

TEST_CASE("cache order reorders triangles and vertices") {
    const auto plain = prepareScene(grid(40), {4, Geometry::welded, false});
    const auto ordered = prepareScene(grid(40), {4, Geometry::welded, true});
    CHECK(plain->mesh.indices != ordered->mesh.indices);
    // After the fetch remap a new vertex is always the next one.
    uint32_t next = 0;
    for (const uint32_t index : ordered->mesh.indices) {
        REQUIRE(index <= next);
        next += index == next;
    }
    const auto again = prepareScene(grid(40), {4, Geometry::welded, true});
    CHECK(again->mesh.indices == ordered->mesh.indices);
    CHECK(std::memcmp(again->mesh.positions.data(), ordered->mesh.positions.data(),
                      ordered->mesh.positions.size() * sizeof(glm::vec3)) == 0);
}

TEST_CASE("preparation repairs normals, reports dropped weight and refuses bad input") {
    Scene scene = small();
    scene.mesh.normals[0] = glm::vec3(0);
    scene.mesh.normals[1].x = std::numeric_limits<float>::quiet_NaN();
    scene.mesh.influences[0] = {{0, 1, 0, 1, 0, 1}, {0.5f, 0.5f}};
    const auto repaired = prepareScene(scene, {});
    REQUIRE(repaired);
    CHECK_THAT(repaired->warnings.at(0), ContainsSubstring("2 normals"));
    const auto one = prepareScene(scene, {1, Geometry::welded, true});
    REQUIRE(one);
    CHECK_THAT(one->warnings.at(1), ContainsSubstring("up to 0.5 of its weight"));
    CHECK_FALSE(prepareScene(scene, {0, Geometry::welded, true}));
    CHECK_FALSE(prepareScene(scene, {9, Geometry::welded, true}));
    scene.mesh.indices[0] = 77;
    CHECK_FALSE(prepareScene(scene, {}));
}

TEST_CASE("built-in names are checked") {
    const auto fault = [](const std::string& name) {
        const auto scene = loadScene(name);
        REQUIRE_FALSE(scene);
        CHECK(scene.error().fault == Fault::input);
        return scene.error().text;
    };
    CHECK_THAT(fault("builtin:unicorn"), ContainsSubstring("no built-in scene \"unicorn\"; choose one of"));
    const std::string first = std::string("builtin:") + builtinScenes().at(0).name;
    for (const char* number : {":", ":x", ":12x", ":-5", ":1", ":99999999999", ": 5000", ":5000:1"})
        CHECK_THAT(fault(first + number), ContainsSubstring("is not a number of vertices"));
    const auto scene = loadScene(first + ":3000");
    REQUIRE(scene);
    CHECK(checkScene(*scene));
}
