// Small files that ask for much: each is refused in one line before the memory is taken, and valid ones load fast.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/scene/gltf/gltf_data.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using fixture::Gltf;
using fixture::json;

namespace {

void isTooMuch(const Gltf& g) {
    const auto scene = g.load("bomb.gltf");
    REQUIRE_FALSE(scene);
    CHECK(scene.error().fault == Fault::input);
    CHECK_THAT(scene.error().text, ContainsSubstring("asks for more memory than a file of its size may"));
}

// All vertex attributes are `vertices` elements of zeros that cost the file nothing.
Gltf withoutData(uint64_t vertices) {
    Gltf g = fixture::small();
    for (const int accessor : {0, 1, 2, 3, 4}) {
        g.tree["accessors"][accessor]["count"] = vertices;
        g.tree["accessors"][accessor].erase("bufferView");
    }
    return g;
}

void drawAgain(Gltf& g, int times) {
    for (int i = 0; i < times; ++i) {
        g.tree["scenes"][0]["nodes"].push_back(g.tree["nodes"].size());
        g.tree["nodes"].push_back({{"mesh", 0}, {"skin", 0}});
    }
}

}  // namespace

TEST_CASE("the budget is spent before anything is made") {
    GltfBudget budget{100};
    CHECK(spend(budget, 10, 8));
    CHECK(budget.left == 20);
    CHECK_FALSE(spend(budget, 3, 8));
    CHECK_FALSE(spend(budget, UINT64_MAX, 8));
    CHECK(budget.left == 20);
    CHECK(spend(budget, 0, 8));
}

TEST_CASE("vertices without data that triangles use cost as much as others") {
    Gltf g = withoutData(3 << 20);
    g.primitive().erase("indices");
    isTooMuch(g);
}

TEST_CASE("instances cannot multiply without end") {
    Gltf g = withoutData(3 << 13);
    g.primitive().erase("indices");
    drawAgain(g, 200);
    isTooMuch(g);
}

TEST_CASE("indices that many primitives share cannot multiply without end") {
    Gltf g = fixture::small();
    g.primitive()["indices"] = g.tree["accessors"].size();
    g.tree["accessors"].push_back({{"componentType", 5125}, {"count", 3 << 18}, {"type", "SCALAR"}});
    for (int i = 0; i < 20; ++i) g.tree["meshes"][0]["primitives"].push_back(g.primitive());
    isTooMuch(g);
}

TEST_CASE("key times without data are refused") {
    Gltf g = fixture::small();
    for (const int accessor : {7, 8}) {
        g.tree["accessors"][accessor].erase("bufferView");
        g.tree["accessors"][accessor]["count"] = 1 << 24;
    }
    isTooMuch(g);
}

TEST_CASE("bytes that a compressed view claims to hold are refused") {
    Gltf g = fixture::small();
    g.tree["bufferViews"][0]["extensions"]["KHR_meshopt_compression"] = {
        {"buffer", 0}, {"byteLength", 48}, {"count", 1 << 22}, {"byteStride", 256}, {"mode", "ATTRIBUTES"}};
    isTooMuch(g);
}

TEST_CASE("vertices that no triangle uses are not made") {
    const auto scene = withoutData(uint64_t{1} << 40).load();
    REQUIRE(scene);
    CHECK(scene->mesh.positions.size() == 4);

    Gltf gap = fixture::small();
    gap.primitive()["indices"] = gap.add<uint16_t>({1, 2, 3}, 5123, "SCALAR");
    const auto three = gap.load();
    REQUIRE(three);
    CHECK(three->mesh.positions == std::vector<glm::vec3>{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(three->mesh.indices == std::vector<uint32_t>{0, 1, 2});
    CHECK(three->mesh.influences[1].joints[0] == 1);
}

TEST_CASE("a broken vertex that no triangle uses does not matter; its number is that of the file") {
    Gltf g = fixture::small();
    g.primitive()["indices"] = g.add<uint16_t>({1, 2, 3}, 5123, "SCALAR");
    g.poke<float>(0, 0, std::numeric_limits<float>::infinity());
    CHECK(g.load());
    g.poke<float>(0, 9, std::numeric_limits<float>::infinity());
    const auto scene = g.load();
    REQUIRE_FALSE(scene);
    CHECK_THAT(scene.error().text, ContainsSubstring("vertex 3 is not finite"));
}

TEST_CASE("many skins read only the matrices of their joints") {
    Gltf g = fixture::small();
    g.tree["accessors"][6]["count"] = 1 << 22;
    g.tree["accessors"][6].erase("bufferView");
    for (int i = 0; i < 400; ++i) {
        g.tree["skins"].push_back(g.tree["skins"][0]);
        drawAgain(g, 1);
        g.tree["nodes"].back()["skin"] = i + 1;
    }
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->skeleton.joints.size() == 802);
}

TEST_CASE("primitives with an attribute set each are matched without a search among all") {
    Gltf g = fixture::small();
    for (int i = 0; i < 4000; ++i) {
        json other = g.primitive();
        other["attributes"]["_X" + std::to_string(i)] = 0;
        g.tree["meshes"][0]["primitives"].push_back(other);
    }
    const auto scene = g.load();
    REQUIRE(scene);
    CHECK(scene->mesh.positions.size() == 4 * 4001);
}

TEST_CASE("a file with very many broken parts is refused") {
    Gltf g = fixture::small();
    for (int i = 0; i < 1001; ++i) g.tree["accessors"].push_back(0);
    const auto scene = g.load();
    REQUIRE_FALSE(scene);
    CHECK_THAT(scene.error().text,
               ContainsSubstring("more than 1000 of its accessors are broken; the first: accessor 9 "
                                 "must be an object"));
    g.tree["accessors"].erase(9);
    CHECK(g.load());
}

TEST_CASE("a buffer that is named many times is loaded once") {
    const Gltf g = fixture::small();
    fixture::writeFile("once.bin", g.bin);
    Gltf many = g;
    many.tree["buffers"] = json::array();
    for (int i = 0; i < 300; ++i)
        many.tree["buffers"].push_back({{"byteLength", g.bin.size()}, {"uri", i % 2 ? "once.bin" : "./once.bin"}});
    CHECK(many.load("many.gltf"));
}
