// Common influences: what is grouped, how records are shared, what the check refuses.
#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/meshlets/common_influences.h"
#include "tests/cases.h"
#include "tests/codec_test.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

using JointSet = std::set<uint16_t>;

JointSet jointsOf(const Influences& influences) {
    JointSet joints;
    for (size_t i = 0; i < influences.joints.size(); ++i)
        if (influences.weights[i] > 0) joints.insert(influences.joints[i]);
    return joints;
}

std::vector<std::array<uint32_t, 3>> trianglesOf(const Mesh& mesh) {
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t i = 0; i < mesh.indices.size(); i += 3)
        triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
    return triangles;
}

// Triangles that the definition of a key puts into the common part, with groups of `min` vertices or more.
uint32_t expectedTriangles(const Mesh& mesh, CiKey key, uint32_t min) {
    std::map<std::array<uint16_t, kMaxInfluences>, std::pair<uint32_t, std::set<uint32_t>>> groups;
    for (const auto& triangle : trianglesOf(mesh)) {
        std::array<std::array<uint16_t, kMaxInfluences>, 3> keys;
        for (size_t c = 0; c < 3; ++c) {
            keys[c] = mesh.influences[triangle[c]].joints;
            if (key == CiKey::set) std::ranges::sort(keys[c]);
        }
        if (keys[0] != keys[1] || keys[0] != keys[2]) continue;
        auto& [count, vertices] = groups[keys[0]];
        ++count;
        vertices.insert(triangle.begin(), triangle.end());
    }
    uint32_t sum = 0;
    for (const auto& [joints, group] : groups)
        if (group.second.size() >= min) sum += group.first;
    return sum;
}

uint32_t fittingTriangles(const Mesh& mesh, size_t most) {
    uint32_t sum = 0;
    for (const auto& triangle : trianglesOf(mesh)) {
        JointSet joints;
        for (uint32_t vertex : triangle) joints.merge(jointsOf(mesh.influences[vertex]));
        sum += joints.size() <= most;
    }
    return sum;
}

JointSet jointsOf(const Mesh& mesh, const MeshletMesh& cut, const Meshlet& meshlet) {
    JointSet joints;
    for (uint32_t i = 0; i < meshlet.vertexCount; ++i)
        joints.merge(jointsOf(mesh.influences[cut.vertices[meshlet.firstVertex + i]]));
    return joints;
}

// Every record once, used, and only where a meshlet of its list is.
void checkNothingTwice(const CommonInfluenceCut& cut) {
    std::set<std::pair<uint32_t, JointList>> common;
    std::set<uint32_t> rest;
    for (uint32_t r = 0; r < cut.sources.size(); ++r)
        CHECK((r < cut.commonRecords ? common.emplace(cut.sources[r], cut.mesh.influences[r].joints).second
                                     : rest.insert(cut.sources[r]).second));
    std::set<uint32_t> used(cut.meshlets.vertices.begin(), cut.meshlets.vertices.end());
    CHECK(used.size() == cut.sources.size());
}

std::vector<CommonInfluenceOptions> everyOption(int influences) {
    std::vector<CommonInfluenceOptions> all;
    for (const Builder& builder : builders())
        for (MeshletLimits limits : {MeshletLimits{64, 124}, MeshletLimits{12, 8}})
            for (uint32_t min : {0u, 48u}) {
                all.push_back({&builder, limits, influences, CiGrouping::meshlets, CiKey::fit, min});
                for (CiKey key : {CiKey::ordered, CiKey::set, CiKey::fit})
                    all.push_back({&builder, limits, influences, CiGrouping::triangles, key, min});
            }
    return all;
}

void checkEveryOption(const Mesh& mesh, int influences) {
    for (const CommonInfluenceOptions& options : everyOption(influences)) {
        INFO(options.builder->name << ' ' << options.limits.vertices << " grouping "
                                   << static_cast<int>(options.grouping) << " key " << static_cast<int>(options.key)
                                   << " min " << options.minVertices);
        const CommonInfluenceCut cut = buildCommonInfluences(mesh, options);
        const auto right = checkCommonInfluences(mesh, cut);
        INFO((right ? "" : right.error().text));
        REQUIRE(right);
        checkNothingTwice(cut);
        const MeshletMesh ofVertices = sourceMeshlets(cut);
        for (uint32_t m = 0; m < cut.commonMeshlets; ++m) {
            const JointSet joints = jointsOf(mesh, ofVertices, ofVertices.meshlets[m]);
            CHECK(joints.size() <= static_cast<size_t>(influences));
            const JointList& list = cut.joints[m];
            CHECK(std::ranges::all_of(joints, [&](uint16_t joint) { return std::ranges::count(list, joint) == 1; }));
            CHECK(std::count(list.begin() + influences, list.end(), kNoJoint) == kMaxInfluences - influences);
            if (options.grouping == CiGrouping::meshlets || options.key != CiKey::ordered)
                CHECK(std::ranges::is_sorted(list));
        }
        if (options.grouping == CiGrouping::triangles && options.key != CiKey::fit)
            CHECK(cut.commonTriangles == expectedTriangles(mesh, options.key, options.minVertices));
        if (options.grouping == CiGrouping::triangles && options.key == CiKey::fit && options.minVertices == 0)
            CHECK(cut.commonTriangles == fittingTriangles(mesh, static_cast<size_t>(influences)));
        if (options.grouping == CiGrouping::triangles) continue;
        const MeshletMesh plain = options.builder->build(mesh, options.limits);
        CHECK(cut.meshlets.meshlets.size() == plain.meshlets.size());
        CHECK(cut.commonMeshlets == std::ranges::count_if(plain.meshlets, [&](const Meshlet& meshlet) {
                  return meshlet.vertexCount >= options.minVertices &&
                         jointsOf(mesh, plain, meshlet).size() <= static_cast<size_t>(influences);
              }));
    }
}

// A strip of `joints.size()` quads along x; both vertices of column i use joints[i] with equal weights.
Mesh strip(const std::vector<std::vector<uint16_t>>& joints) {
    Mesh mesh;
    for (size_t column = 0; column < joints.size(); ++column)
        for (float y : {0.0f, 1.0f}) {
            mesh.positions.emplace_back(static_cast<float>(column), y, 0);
            mesh.normals.emplace_back(0, 0, 1);
            mesh.uvs.emplace_back(0, 0);
            std::vector<std::pair<uint16_t, double>> list;
            for (size_t i = 0; i < joints[column].size(); ++i)
                list.emplace_back(joints[column][i], static_cast<double>(joints[column].size() - i));
            mesh.influences.push_back(test::cleanInfluences(list));
        }
    for (uint32_t v = 0; v + 3 < mesh.positions.size(); v += 2)
        mesh.indices.insert(mesh.indices.end(), {v, v + 2, v + 1, v + 1, v + 2, v + 3});
    return mesh;
}

JointList listOf(std::vector<uint16_t> joints) {
    JointList list;
    list.fill(kNoJoint);
    std::ranges::copy(joints, list.begin());
    return list;
}

CommonInfluenceCut cutStrip(const Mesh& mesh, CiGrouping grouping, CiKey key = CiKey::fit, uint32_t min = 0) {
    const CommonInfluenceCut cut = buildCommonInfluences(mesh, {findBuilder("scan"), {4, 4}, 4, grouping, key, min});
    REQUIRE(checkCommonInfluences(mesh, cut));
    return cut;
}

}  // namespace

TEST_CASE("every grouping of small scenes keeps mesh, influences and limits") {
    const auto tiny = prepareScene(tinyScene(), {8});
    REQUIRE(tiny);
    checkEveryOption(tiny->mesh, 8);
    for (const char* name : {"biped", "robot", "creature"}) {
        auto scene = makeBuiltin(name, 2500);
        REQUIRE(scene);
        auto prepared = prepareScene(*scene, {});
        REQUIRE(prepared);
        INFO(name);
        checkEveryOption(prepared->mesh, 4);
    }
}

TEST_CASE("every grouping of degenerate meshes keeps mesh, influences and limits") {
    for (const auto& [name, mesh] : test::degenerateMeshes()) {
        INFO(name);
        checkEveryOption(mesh, 4);
    }
    Mesh degenerate = strip({{0}, {1}, {2}});
    degenerate.indices.insert(degenerate.indices.end(), {0, 0, 1, 2, 2, 2});
    checkEveryOption(degenerate, 4);
    // A vertex of very many lists, and vertices that no triangle uses.
    Mesh fan = test::randomMesh(11, 3000, 900);
    fan.indices.clear();
    for (uint32_t v = 1; v + 2 < 3000; v += 2) fan.indices.insert(fan.indices.end(), {0, v, v + 1});
    checkEveryOption(fan, 4);
}

TEST_CASE("every grouping of models keeps mesh, influences and limits") {
    if (modelFolder().empty()) SKIP("no models on this machine");
    for (const char* name : {"arnaud.glb", "fox.glb"})
        for (int influences : {4, 8}) {
            auto stored = loadScene(modelFolder() + "/" + name);
            REQUIRE(stored);
            auto scene = prepareScene(*stored, {influences});
            REQUIRE(scene);
            INFO(name << " " << influences);
            checkEveryOption(scene->mesh, influences);
        }
}

TEST_CASE("keys of a strip made by hand") {
    // The same set twice in another order, then two other sets.
    const Mesh mesh = strip({{1, 2}, {1, 2}, {2, 1}, {2, 1}, {3}, {3}, {3}, {4, 5, 6}, {7, 8}});
    const CommonInfluenceCut ordered = cutStrip(mesh, CiGrouping::triangles, CiKey::ordered);
    CHECK(ordered.commonTriangles == 2 + 2 + 4);
    CHECK(ordered.joints == std::vector{listOf({1, 2}), listOf({2, 1}), listOf({3}), listOf({3})});
    const CommonInfluenceCut set = cutStrip(mesh, CiGrouping::triangles, CiKey::set);
    CHECK(set.commonTriangles == 6 + 4);
    CHECK(set.joints.front() == listOf({1, 2}));
    CHECK(set.commonRecords == 8 + 6);
    // All but the last quad has at most four joints.
    CHECK(cutStrip(mesh, CiGrouping::triangles, CiKey::fit).commonTriangles == 14);
    CHECK(cutStrip(mesh, CiGrouping::triangles, CiKey::set, 7).commonTriangles == 6);
    CHECK(cutStrip(mesh, CiGrouping::triangles, CiKey::set, 9).commonTriangles == 0);
}

TEST_CASE("a record has its weights in the order of the list") {
    const Mesh mesh = strip({{7, 3}, {5}});
    const CommonInfluenceCut cut = cutStrip(mesh, CiGrouping::meshlets);
    REQUIRE(cut.commonMeshlets == 1);
    CHECK(cut.joints[0] == listOf({3, 5, 7}));
    for (uint32_t r = 0; r < cut.commonRecords; ++r) {
        const Influences& record = cut.mesh.influences[r];
        const std::array<float, 8> wanted =
            cut.sources[r] < 2 ? std::array<float, 8>{1 / 3.0f, 0, 2 / 3.0f} : std::array<float, 8>{0, 1, 0};
        CHECK(record.joints == cut.joints[0]);
        CHECK(record.weights == wanted);
    }
}

TEST_CASE("meshlets that share vertices share a list where it has room") {
    // One quad a meshlet. {0}, {0, 1}, {1}, {1, 2}, ... become lists of four joints, so that borders are stored once.
    const Mesh mesh = strip({{0}, {0}, {1}, {1}, {2}, {2}});
    const CommonInfluenceCut cut = cutStrip(mesh, CiGrouping::meshlets);
    CHECK(cut.commonMeshlets == 5);
    CHECK(cut.sources.size() == mesh.positions.size());
    CHECK(cut.joints == std::vector(5, listOf({0, 1, 2})));
    // Beyond the room there are two lists, and the border between them twice.
    const Mesh longer = strip({{0}, {1}, {2}, {3}, {4}, {5}});
    const CommonInfluenceCut two = cutStrip(longer, CiGrouping::meshlets);
    const std::set<JointList> lists(two.joints.begin(), two.joints.end());
    CHECK(lists.size() >= 2);
    CHECK(two.sources.size() == longer.positions.size() + 2 * (lists.size() - 1));
}

TEST_CASE("a given cut is marked instead of a new one") {
    const Mesh mesh = strip({{0}, {0}, {1, 2, 3}, {4, 5, 6}, {7}});
    const MeshletMesh plain = findBuilder("scan")->build(mesh, {4, 4});
    CommonInfluenceOptions options{findBuilder("meshopt"), {4, 4}, 4, CiGrouping::meshlets, CiKey::fit, 0};
    options.cut = &plain;
    const CommonInfluenceCut cut = buildCommonInfluences(mesh, options);
    REQUIRE(checkCommonInfluences(mesh, cut));
    const CommonInfluenceCut own = cutStrip(mesh, CiGrouping::meshlets);
    CHECK(cut.sources == own.sources);
    CHECK(cut.meshlets.triangles == own.meshlets.triangles);
    CHECK(cut.commonMeshlets == 3);
}

TEST_CASE("the check of common influences tells what is wrong") {
    const Mesh mesh = strip({{1, 2}, {1, 2}, {2, 1}, {3}, {4, 5, 6}, {7, 8, 9}, {10}});
    const CommonInfluenceCut good = cutStrip(mesh, CiGrouping::triangles);
    REQUIRE(good.commonMeshlets > 1);
    REQUIRE(good.commonMeshlets < good.meshlets.meshlets.size());
    const auto refused = [&](const char* part, const std::function<void(CommonInfluenceCut&)>& damage) {
        CommonInfluenceCut bad = good;
        damage(bad);
        const auto checked = checkCommonInfluences(mesh, bad);
        INFO(part);
        REQUIRE(!checked);
        CHECK_THAT(checked.error().text, ContainsSubstring(part));
    };
    using Cut = CommonInfluenceCut;
    refused("differ in length", [](Cut& c) { c.sources.pop_back(); });
    refused("differ in length", [](Cut& c) { c.joints.pop_back(); });
    refused("differ in length", [](Cut& c) { c.commonRecords = 1000; });
    refused("record 0: its vertex does not exist", [](Cut& c) { c.sources[0] = 1000; });
    refused("record 1: position", [](Cut& c) { c.mesh.positions[1].x += 0.5f; });
    refused("record 1: position", [](Cut& c) { c.mesh.normals[1].x += 0.5f; });
    refused("record 1: position", [](Cut& c) { c.mesh.uvs[1].x += 0.5f; });
    refused("record 2: its influences", [](Cut& c) { c.mesh.influences[2].weights[0] += 0.25f; });
    refused("record 2: its influences",
            [](Cut& c) { std::swap(c.mesh.influences[2].joints[0], c.mesh.influences[2].joints[1]); });
    refused("its influences", [](Cut& c) { c.mesh.influences.back().weights[0] = 0; });
    refused("names a record that does not exist", [](Cut& c) { c.meshlets.vertices[0] = 1000; });
    refused("other part", [](Cut& c) { ++c.commonRecords; });
    refused("another joint list", [](Cut& c) { std::swap(c.joints[0][0], c.joints[0][1]); });
    refused("are counted as common", [](Cut& c) { --c.commonTriangles; });
    refused("in order", [](Cut& c) { std::swap(c.mesh.indices[0], c.mesh.indices[1]); });
    refused("every triangle exactly once", [](Cut& c) { c.meshlets.triangles[1] = c.meshlets.triangles[0]; });
    refused("exceed the limits", [](Cut& c) { c.meshlets.limits.vertices = 3; });
}

TEST_CASE("cutting is the same again") {
    auto scene = makeBuiltin("creature", 4000);
    REQUIRE(scene);
    auto prepared = prepareScene(*scene, {});
    REQUIRE(prepared);
    for (const CommonInfluenceOptions& options : everyOption(4)) {
        const CommonInfluenceCut a = buildCommonInfluences(prepared->mesh, options);
        const CommonInfluenceCut b = buildCommonInfluences(prepared->mesh, options);
        CHECK(a.sources == b.sources);
        CHECK(a.joints == b.joints);
        CHECK(a.mesh.indices == b.mesh.indices);
    }
}

TEST_CASE("on models `fit` makes more meshlets common than Torabi's key, and stores fewer vertices") {
    if (modelFolder().empty()) SKIP("no models on this machine");
    for (const char* name : {"human_game_rig.glb", "arnaud.glb"}) {
        auto stored = loadScene(modelFolder() + "/" + name);
        REQUIRE(stored);
        auto scene = prepareScene(*stored, {});
        REQUIRE(scene);
        CommonInfluenceOptions options{findBuilder("meshopt")};
        options.grouping = CiGrouping::triangles;
        const CommonInfluenceCut fit = buildCommonInfluences(scene->mesh, options);
        options.key = CiKey::ordered;
        const CommonInfluenceCut ordered = buildCommonInfluences(scene->mesh, options);
        INFO(name);
        CHECK(fit.commonTriangles > ordered.commonTriangles);
        CHECK(fit.meshlets.meshlets.size() < ordered.meshlets.meshlets.size());
        CHECK(fit.sources.size() < ordered.sources.size());
    }
}
