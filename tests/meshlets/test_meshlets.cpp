// Builders, the check of what they build, the packed words and the statistics.
#include <algorithm>
#include <map>
#include <numeric>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/meshlets/meshlets.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinRel;

namespace {

const std::vector<MeshletLimits> kLimits = {{64, 124}, {64, 126}, {32, 60}, {128, 252}, {255, 512}, {3, 4}, {4, 5}};

// A mesh of which only the indices matter.
Mesh indexed(uint32_t vertices, std::vector<uint32_t> indices) {
    Mesh mesh;
    for (uint32_t v = 0; v < vertices; ++v) {
        mesh.positions.emplace_back(static_cast<float>(v % 3), static_cast<float>(v / 3), 0);
        mesh.influences.push_back({});
    }
    mesh.indices = std::move(indices);
    return mesh;
}

void requireGoodCuts(const Mesh& mesh) {
    for (const Builder& builder : builders())
        for (const MeshletLimits& limits : kLimits) {
            INFO(builder.name << " " << limits.vertices << "/" << limits.triangles);
            const MeshletMesh cut = builder.build(mesh, limits);
            CHECK(cut.limits == limits);
            const auto right = checkMeshlets(mesh, cut);
            if (!right) FAIL(right.error().text);
            CHECK(cut.triangles.size() == mesh.indices.size() / 3);
            for (const Meshlet& meshlet : cut.meshlets) CHECK(meshlet.triangleCount > 0);
        }
}

// The triangles with their winding as the shader would read them, straight from the words that the header draws.
std::vector<std::array<uint32_t, 3>> decode(const PackedMeshlets& packed, const MeshletMesh& cut,
                                            const MeshletPacking& packing) {
    const bool wide = packing.orderedRecords || !packing.extraStart.empty();
    const size_t header = wide ? 3 : 1;
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t m = 0; m < cut.meshlets.size(); ++m) {
        const size_t descriptor = m * (wide ? 4 : 2), block = m * packed.fixedWords;
        const bool fixed = packed.fixedWords > 0;
        auto head = [&](size_t word) {
            return fixed ? packed.data.at(block + word) : packed.descriptors.at(descriptor + 1 + word);
        };
        const uint32_t vertices = head(0) & 0x1FFF, count = head(0) >> 16 & 0x7FFF;
        CHECK((head(0) >> 31 == 1) == (m < packing.commonMeshlets));
        if (!packing.extraStart.empty()) CHECK(head(2) == packing.extraStart[m]);
        const size_t ids = fixed ? block + header : packed.descriptors.at(descriptor);
        const size_t indices = ids + (packing.orderedRecords ? 0 : fixed ? cut.limits.vertices : vertices);
        for (uint32_t t = 0; t < count; ++t) {
            std::array<uint32_t, 3> corners;
            for (uint32_t c = 0; c < 3; ++c) {
                const uint32_t byte = t * 3 + c;
                const uint32_t local = packed.data.at(indices + byte / 4) >> byte % 4 * 8 & 0xFF;
                REQUIRE(local < vertices);
                corners[c] = packing.orderedRecords ? head(1) + local : packed.data.at(ids + local);
            }
            triangles.push_back(corners);
        }
    }
    return triangles;
}

std::vector<std::array<uint32_t, 3>> trianglesOf(const MeshletMesh& cut) {
    std::vector<std::array<uint32_t, 3>> triangles;
    for (const Meshlet& meshlet : cut.meshlets)
        for (uint32_t t = 0; t < meshlet.triangleCount; ++t) {
            const auto& local = cut.triangles[meshlet.firstTriangle + t];
            triangles.push_back({cut.vertices[meshlet.firstVertex + local[0]],
                                 cut.vertices[meshlet.firstVertex + local[1]],
                                 cut.vertices[meshlet.firstVertex + local[2]]});
        }
    return triangles;
}

}  // namespace

TEST_CASE("builders are found by name") {
    for (const Builder& builder : builders()) CHECK(findBuilder(builder.name) == &builder);
    CHECK(findBuilder("magic") == nullptr);
    for (const MeshletLayout& layout : meshletLayouts()) CHECK(findMeshletLayout(layout.name) == &layout);
    CHECK(findMeshletLayout("fixed-or-not") == nullptr);
}

TEST_CASE("builders keep every limit on a small scene and on every built-in one") {
    requireGoodCuts(tinyScene().mesh);
    for (const BuiltinScene& row : builtinScenes()) {
        INFO(row.name);
        auto stored = makeBuiltin(row.name, 3000);
        REQUIRE(stored);
        for (Geometry geometry : {Geometry::welded, Geometry::unwelded}) {
            auto scene = prepareScene(*stored, {.geometry = geometry});
            REQUIRE(scene);
            requireGoodCuts(scene->mesh);
        }
    }
}

TEST_CASE("builders keep the limits on models of the shared folder") {
    size_t used = 0;
    for (const std::string& file : modelFiles()) {
        auto stored = loadScene(file);
        if (!stored || stored->mesh.indices.size() > 300'000) continue;
        INFO(file);
        auto scene = prepareScene(std::move(*stored), {});
        REQUIRE(scene);
        for (const Builder& builder : builders()) CHECK(checkMeshlets(scene->mesh, builder.build(scene->mesh, {})));
        if (++used == 6) break;
    }
    if (used == 0) SKIP("no model folder");
}

TEST_CASE("scan closes a meshlet when the next triangle does not fit") {
    // Five vertices: 0 1 2, 2 1 3 fill the four places; 0 4 1 opens the next; a degenerate triangle adds one vertex.
    const Mesh mesh = indexed(6, {0, 1, 2, 2, 1, 3, 0, 4, 1, 5, 5, 4, 4, 4, 4});
    const MeshletMesh cut = findBuilder("scan")->build(mesh, {4, 8});
    REQUIRE(cut.meshlets.size() == 2);
    CHECK(cut.meshlets[0].vertexCount == 4);
    CHECK(cut.meshlets[0].triangleCount == 2);
    CHECK(cut.meshlets[1].firstVertex == 4);
    CHECK(cut.meshlets[1].firstTriangle == 2);
    CHECK(cut.meshlets[1].vertexCount == 4);
    CHECK(cut.meshlets[1].triangleCount == 3);
    CHECK(cut.vertices == std::vector<uint32_t>{0, 1, 2, 3, 0, 4, 1, 5});
    CHECK(cut.triangles == std::vector<std::array<uint8_t, 3>>{{0, 1, 2}, {2, 1, 3}, {0, 1, 2}, {3, 3, 1}, {1, 1, 1}});
    CHECK(checkMeshlets(mesh, cut));
}

TEST_CASE("scan closes a meshlet at the triangle limit") {
    const Mesh mesh = indexed(3, {0, 1, 2, 1, 2, 0, 0, 2, 1, 2, 0, 1, 0, 1, 2});
    const MeshletMesh cut = findBuilder("scan")->build(mesh, {64, 2});
    REQUIRE(cut.meshlets.size() == 3);
    CHECK(cut.meshlets[0].triangleCount == 2);
    CHECK(cut.meshlets[1].triangleCount == 2);
    CHECK(cut.meshlets[2].triangleCount == 1);
    CHECK(cut.vertices == std::vector<uint32_t>{0, 1, 2, 0, 2, 1, 0, 1, 2});
    CHECK(checkMeshlets(mesh, cut));
}

TEST_CASE("an empty index buffer has no meshlet") {
    const MeshletMesh cut = findBuilder("scan")->build(indexed(3, {}), {});
    CHECK(cut.meshlets.empty());
    CHECK(checkMeshlets(indexed(3, {}), cut));
    CHECK(meshletStats(indexed(3, {}), cut).meshlets == 0);
}

TEST_CASE("the check refuses each kind of damage") {
    const Mesh mesh = tinyScene().mesh;
    const MeshletMesh good = findBuilder("scan")->build(mesh, {32, 60});
    REQUIRE(good.meshlets.size() > 2);
    REQUIRE(checkMeshlets(mesh, good));
    auto refused = [&](const char* why, auto damage) {
        MeshletMesh bad = good;
        damage(bad);
        const auto checked = checkMeshlets(mesh, bad);
        INFO(why);
        REQUIRE(!checked);
        CHECK_THAT(checked.error().text, ContainsSubstring(why));
    };
    refused("exceed the limits", [](MeshletMesh& m) { m.limits.vertices = m.meshlets[0].vertexCount - 1; });
    refused("exceed the limits", [](MeshletMesh& m) { m.limits.triangles = m.meshlets[0].triangleCount - 1; });
    refused("past the end", [](MeshletMesh& m) { m.vertices.pop_back(); });
    refused("past the end", [](MeshletMesh& m) { m.triangles.pop_back(); });
    refused("past the end", [](MeshletMesh& m) { m.meshlets[1].firstVertex = UINT32_MAX; });
    refused("past the end", [](MeshletMesh& m) { m.meshlets[1].firstTriangle = UINT32_MAX; });
    refused("meshlet 0: names a vertex that does not exist", [](MeshletMesh& m) { m.vertices[0] = 1'000'000; });
    refused("a local index is not below", [](MeshletMesh& m) { m.triangles[0][1] = 32; });
    refused("exactly once", [](MeshletMesh& m) { std::swap(m.triangles[0][0], m.triangles[0][1]); });
    refused("exactly once", [](MeshletMesh& m) { m.triangles[1] = m.triangles[0]; });
    refused("exactly once", [](MeshletMesh& m) { m.meshlets.pop_back(); });
    refused("exactly once", [](MeshletMesh& m) { m.meshlets.push_back(m.meshlets[0]); });
    refused("exactly once", [](MeshletMesh& m) { --m.meshlets[0].triangleCount; });
    refused("exactly once", [](MeshletMesh& m) { std::swap(m.vertices[0], m.vertices[1]); });
}

TEST_CASE("the check allows a triangle to start at another corner, but not its mirror image") {
    const Mesh mesh = indexed(4, {0, 1, 2, 1, 3, 2});
    MeshletMesh cut{{}, {{0, 0, 4, 2}}, {0, 1, 2, 3}, {{2, 0, 1}, {3, 2, 1}}};
    CHECK(checkMeshlets(mesh, cut));
    cut.triangles[0] = {1, 0, 2};
    CHECK(!checkMeshlets(mesh, cut));
    // A degenerate triangle has no winding but keeps its corners.
    const Mesh degenerate = indexed(3, {0, 0, 1, 2, 1, 2});
    CHECK(checkMeshlets(degenerate, {{}, {{0, 0, 3, 2}}, {0, 1, 2}, {{0, 1, 0}, {1, 2, 2}}}));
    CHECK(!checkMeshlets(degenerate, {{}, {{0, 0, 3, 2}}, {0, 1, 2}, {{0, 1, 1}, {1, 2, 2}}}));
}

TEST_CASE("redirect packs the words that its layout describes") {
    // Two meshlets: 4 vertices with 5 triangles (15 bytes, 2 groups of four), 3 vertices with 1 triangle.
    const MeshletMesh cut{{},
                          {{0, 0, 4, 5}, {4, 5, 3, 1}},
                          {10, 11, 12, 70'000, 7, 8, 9},
                          {{0, 1, 2}, {2, 1, 3}, {3, 0, 1}, {1, 2, 3}, {3, 2, 0}, {2, 0, 1}}};
    const PackedMeshlets packed = findMeshletLayout("redirect")->pack(cut, {});
    CHECK(packed.descriptors == std::vector<uint32_t>{0, 5u << 16 | 4, 10, 1u << 16 | 3});
    CHECK(packed.fixedWords == 0);
    CHECK(packed.data == std::vector<uint32_t>{10, 11, 12, 70'000,                  // vertices
                                               0x02020100, 0x00030301, 0x03020101,  // triangles 0 to 3
                                               0x00000203, 0, 0,                    // triangle 4, filled up
                                               7, 8, 9, 0x00010002, 0, 0});
}

TEST_CASE("redirect packs what a case adds") {
    const MeshletMesh cut{{}, {{0, 0, 3, 1}, {3, 1, 3, 1}}, {5, 6, 7, 20, 21, 22}, {{0, 1, 2}, {2, 1, 0}}};
    const PackedMeshlets ordered =
        findMeshletLayout("redirect")->pack(cut, {.orderedRecords = true, .commonMeshlets = 1, .extraStart = {40, 50}});
    CHECK(ordered.descriptors == std::vector<uint32_t>{0, 1u << 31 | 1u << 16 | 3, 5, 40, 3, 1u << 16 | 3, 20, 50});
    CHECK(ordered.data == std::vector<uint32_t>{0x00020100, 0, 0, 0x00000102, 0, 0});
    const PackedMeshlets sized = findMeshletLayout("redirect")->pack(cut, {.blendBytes = {4, 1}});
    CHECK(sized.descriptors == std::vector<uint32_t>{0, 1u << 16 | 4u << 13 | 3, 6, 1u << 16 | 1u << 13 | 3});
}

TEST_CASE("fixed takes 640 bytes a meshlet for 64 vertices and 126 triangles") {
    const MeshletMesh cut{{64, 126}, {{0, 0, 3, 1}, {3, 1, 3, 1}}, {5, 6, 7, 7, 6, 8}, {{0, 1, 2}, {2, 1, 0}}};
    const PackedMeshlets packed = findMeshletLayout("fixed")->pack(cut, {});
    CHECK(packed.descriptors.empty());
    CHECK(packed.fixedWords * 4 == 640);
    CHECK(packed.data.size() == 2 * 160 + 2);
    CHECK(packed.data[160] == (1u << 16 | 3));
    CHECK(packed.data[161] == 7);
    CHECK(packed.data[160 + 65] == 0x00000102);
}

TEST_CASE("packed meshlets decode to the triangles that were packed") {
    const Scene tiny = tinyScene();
    const auto robot = makeBuiltin("robot", 2000);
    REQUIRE(robot);
    for (const Mesh* mesh : {&tiny.mesh, &robot->mesh})
        for (const Builder& builder : builders())
            for (const MeshletLimits& limits : kLimits)
                for (const MeshletLayout& layout : meshletLayouts())
                    for (bool ordered : {false, true})
                        for (bool extra : {false, true}) {
                            MeshletMesh cut = builder.build(*mesh, limits);
                            if (ordered) std::iota(cut.vertices.begin(), cut.vertices.end(), 7u);
                            MeshletPacking packing{.orderedRecords = ordered, .commonMeshlets = 1};
                            for (uint32_t m = 0; extra && m < cut.meshlets.size(); ++m)
                                packing.extraStart.push_back(m * 7);
                            const PackedMeshlets packed = layout.pack(cut, packing);
                            INFO(builder.name << " " << layout.name << " " << limits.vertices << "/"
                                              << limits.triangles);
                            CHECK(decode(packed, cut, packing) == trianglesOf(cut));
                            // The shader reads whole groups of four triangles.
                            const size_t last = cut.meshlets.back().triangleCount;
                            const size_t tail = packed.fixedWords ? packed.fixedWords : 0;
                            CHECK(packed.data.size() >= tail * cut.meshlets.size() + (last + 3) / 4 * (tail ? 0 : 3));
                        }
}

TEST_CASE("statistics of a cut made by hand") {
    Mesh mesh = indexed(6, {0, 1, 2, 2, 1, 3, 3, 4, 5});
    auto joints = [](uint16_t a, uint16_t b) {
        Influences influences;
        influences.joints.fill(kNoJoint);
        influences.joints[0] = a;
        influences.joints[1] = b;
        influences.weights = {0.5f, 0.5f};
        return influences;
    };
    // Weights do not make a tuple, and neither do vertices outside the meshlet.
    mesh.influences = {joints(1, 2), joints(1, 2), joints(2, 1), joints(1, 2), joints(5, 6), joints(7, 8)};
    mesh.influences[1].weights = {0.75f, 0.25f};
    const MeshletMesh cut{
        {8, 4}, {{0, 0, 4, 2}, {4, 2, 3, 1}}, {0, 1, 2, 3, 3, 4, 5}, {{0, 1, 2}, {2, 1, 3}, {0, 1, 2}}};
    REQUIRE(checkMeshlets(mesh, cut));
    const MeshletStats stats = meshletStats(mesh, cut);
    CHECK(stats.meshlets == 2);
    CHECK(stats.meanVertices == 3.5);
    CHECK(stats.meanTriangles == 1.5);
    CHECK(stats.vertexFill == 3.5 / 8);
    CHECK(stats.triangleFill == 1.5 / 4);
    CHECK_THAT(stats.vertexReuse, WithinRel(7.0 / 6, 1e-14));
    CHECK(stats.meanUniqueTuples == 2.5);
}

TEST_CASE("meshopt repeats fewer vertices than scan on a scene in random order") {
    auto scene = makeBuiltin("biped", 5000);
    REQUIRE(scene);
    auto& indices = scene->mesh.indices;
    uint32_t state = 1;
    for (size_t t = indices.size() / 3; t > 1; --t) {
        state = state * 1664525 + 1013904223;
        for (size_t c = 0; c < 3; ++c) std::swap(indices[(t - 1) * 3 + c], indices[state % t * 3 + c]);
    }
    const MeshletMesh scan = findBuilder("scan")->build(scene->mesh, {});
    const MeshletMesh meshopt = findBuilder("meshopt")->build(scene->mesh, {});
    REQUIRE(checkMeshlets(scene->mesh, scan));
    REQUIRE(checkMeshlets(scene->mesh, meshopt));
    CHECK(meshletStats(scene->mesh, meshopt).vertexReuse < 1.5);
    CHECK(meshletStats(scene->mesh, scan).vertexReuse > 3);
}
