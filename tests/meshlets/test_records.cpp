// Vertices as cases store them: every rewriting must lead back to the scene's vertices and say the same.
#include <bit>
#include <cstring>

#include <catch2/catch_test_macros.hpp>

#include "common/meshlets/records.h"
#include "tests/cases.h"

using namespace skinbench;

namespace {

Mesh cleanBar(int influences) {
    Mesh mesh = tinyScene().mesh;
    cleanWeights(mesh, influences);
    return mesh;
}

void checkSurface(const Mesh& mesh, const Records& records) {
    REQUIRE(records.mesh.positions.size() == records.sources.size());
    for (size_t r = 0; r < records.sources.size(); ++r) {
        const uint32_t source = records.sources[r];
        REQUIRE(source < mesh.positions.size());
        CHECK(records.mesh.positions[r] == mesh.positions[source]);
        CHECK(records.mesh.normals[r] == mesh.normals[source]);
        CHECK(records.mesh.uvs[r] == mesh.uvs[source]);
    }
}

std::vector<uint32_t> sourceIndices(const Records& records) {
    std::vector<uint32_t> indices;
    for (uint32_t record : records.mesh.indices) indices.push_back(records.sources.at(record));
    return indices;
}

}  // namespace

TEST_CASE("ordered records stand meshlet after meshlet") {
    const Mesh mesh = cleanBar(4);
    const MeshletMesh cut = findBuilder("meshopt")->build(mesh, {16, 16});
    const Records records = orderedRecords(mesh, cut);
    checkSurface(mesh, records);
    CHECK(records.sources == cut.vertices);
    CHECK(records.sources.size() > mesh.positions.size());
    CHECK(sourceIndices(records) == triangleList(cut));
    CHECK(triangleList(records.meshlets) == records.mesh.indices);
    for (size_t i = 0; i < records.meshlets.vertices.size(); ++i) CHECK(records.meshlets.vertices[i] == i);
    for (size_t r = 0; r < records.sources.size(); ++r)
        CHECK(records.mesh.influences[r] == mesh.influences[records.sources[r]]);
}

TEST_CASE("ordered records of common meshlets keep the common ones first") {
    const auto creature = makeBuiltin("creature", 4000);
    REQUIRE(creature);
    const Scene scene = *prepareScene(*creature, {});
    const CommonInfluenceCut cut = buildCommonInfluences(scene.mesh, {findBuilder("meshopt"), {}, 4});
    REQUIRE(checkCommonInfluences(scene.mesh, cut));
    REQUIRE(cut.commonMeshlets > 0);
    REQUIRE(cut.commonMeshlets < cut.meshlets.meshlets.size());
    const Records plain = commonRecords(cut), records = orderedRecords(plain);
    checkSurface(scene.mesh, records);
    CHECK(sourceIndices(records) == sourceIndices(plain));
    CHECK(records.commonMeshlets == cut.commonMeshlets);
    uint32_t common = 0;
    for (uint32_t m = 0; m < cut.commonMeshlets; ++m) common += cut.meshlets.meshlets[m].vertexCount;
    CHECK(records.commonRecords == common);
    for (uint32_t m = 0; m < cut.commonMeshlets; ++m) {
        const Meshlet& meshlet = records.meshlets.meshlets[m];
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i)
            CHECK(records.mesh.influences[meshlet.firstVertex + i].joints == records.joints[m]);
    }
}

TEST_CASE("partitioned records name slots that hold the vertex' joints") {
    const Mesh mesh = cleanBar(4);
    PaletteHardware hardware = *findPaletteHardware("generic");
    hardware.slots = 8;
    const auto plan =
        partitionMesh(mesh, hardware, *findPartitionSolver("cheapest-insertion"), *findGroupOrder("given"));
    REQUIRE(plan);
    REQUIRE(plan->commands.size() > 1);
    const Records records = partitionedRecords(mesh, *plan);
    checkSurface(mesh, records);
    for (size_t c = 0; c < plan->commands.size(); ++c) {
        const std::vector<uint16_t> slots = slotsAfter(*plan, c);
        const PartitionCommand& command = plan->commands[c];
        for (uint32_t t = 0; t < command.triangleCount; ++t)
            for (uint32_t corner = 0; corner < 3; ++corner) {
                const uint32_t record = records.mesh.indices[(command.firstTriangle + t) * 3 + corner];
                const uint32_t vertex = records.sources[record];
                CHECK(vertex == mesh.indices[plan->triangles[command.firstTriangle + t] * 3 + corner]);
                const Influences &own = records.mesh.influences[record], &source = mesh.influences[vertex];
                CHECK(own.weights == source.weights);
                for (int i = 0; i < 4; ++i)
                    CHECK((own.joints[i] == kNoJoint ? kNoJoint : slots.at(own.joints[i])) == source.joints[i]);
            }
    }
}

TEST_CASE("joint lists of meshlets lead local numbers back to joints") {
    for (int influences : {4, 8}) {
        const Mesh mesh = cleanBar(influences);
        const MeshletMesh cut = findBuilder("meshopt")->build(mesh, {32, 40});
        const auto packed = packMeshletJoints(mesh, cut, influences);
        REQUIRE(packed);
        REQUIRE(packed->start.size() == cut.meshlets.size());
        uint32_t most = 0;
        for (size_t m = 0; m < cut.meshlets.size(); ++m) {
            const uint32_t* words = &packed->words[packed->start[m]];
            const uint32_t joints = words[0];
            most = std::max(most, joints);
            for (uint32_t j = 1; j < joints; ++j) CHECK(words[j] < words[j + 1]);
            const Meshlet& meshlet = cut.meshlets[m];
            for (uint32_t v = 0; v < meshlet.vertexCount; ++v)
                for (int i = 0; i < influences; ++i) {
                    const uint16_t joint = mesh.influences[cut.vertices[meshlet.firstVertex + v]].joints[i];
                    const uint32_t word = words[1 + joints + v * influences / 4 + i / 4];
                    const uint32_t local = word >> i % 4 * 8 & 0xFF;
                    REQUIRE(local < joints);
                    if (joint != kNoJoint) CHECK(words[1 + local] == joint);
                }
        }
        CHECK(packed->most == most);
    }
}

TEST_CASE("a meshlet of more joints than a byte counts is refused") {
    Mesh mesh;
    for (uint16_t v = 0; v < 66; ++v) {
        mesh.positions.emplace_back(v, v % 2, 0);
        mesh.normals.emplace_back(0, 0, 1);
        mesh.uvs.emplace_back(0, 0);
        Influences influences;
        influences.joints.fill(kNoJoint);
        for (uint16_t i = 0; i < 4; ++i) influences.joints[i] = v * 4 + i, influences.weights[i] = 0.25f;
        mesh.influences.push_back(influences);
        if (v >= 2) mesh.indices.insert(mesh.indices.end(), {uint32_t(v - 2), uint32_t(v - 1), uint32_t(v)});
    }
    const auto packed = packMeshletJoints(mesh, findBuilder("scan")->build(mesh, {128, 124}), 4);
    REQUIRE(!packed);
    CHECK(packed.error().text == "a meshlet has 264 joints, and one-byte joint numbers reach 256");
}

TEST_CASE("slim and whole records, word by word") {
    Mesh mesh;
    mesh.positions = {{1, 2, 3}, {4, 5, 6}};
    mesh.normals = {{0, 0, 1}, {0, 1, 0}};
    mesh.uvs = {{0.25f, 0.5f}, {0.75f, 1}};
    Influences influences;
    influences.joints.fill(kNoJoint);
    influences.joints[0] = 7;
    influences.joints[1] = 300;
    influences.weights = {0.75f, 0.25f};
    mesh.influences = {influences, influences};
    auto words = [](const EncodedMesh& encoded) {
        std::vector<uint32_t> out(encoded.vertices->size() / 4);
        std::memcpy(out.data(), encoded.vertices->data(), encoded.vertices->size());
        return out;
    };
    auto f = [](float value) { return std::bit_cast<uint32_t>(value); };
    std::vector<uint32_t> wanted = {
        f(1),     f(2),     f(3), 0, 0,    f(1), f(0.25f), f(0.5f), f(0.75f), f(0.25f), 0, 0,  // slim
        f(4),     f(5),     f(6), 0, f(1), 0,    f(0.75f), f(1),    7,        300,      0, 0,  // whole
        f(0.75f), f(0.25f), 0,    0};
    const EncodedMesh slim = *encodeSlim({mesh, nullptr, 4, 1, false});
    CHECK(words(slim) == wanted);
    CHECK(slim.vertexCount == 2);
    CHECK(encodeSlim({mesh, nullptr, 4, 2, false})->vertices->size() == 2 * 48);
    CHECK(encodeSlim({mesh, nullptr, 4, 2, true})->vertices->size() == 2 * 64);
    CHECK(encodeSlim({mesh, nullptr, 8, 2, false})->vertices->size() == 2 * 64);
    CHECK(encodeSlim({mesh, nullptr, 8, 0, false})->vertices->size() == 2 * 96);
}

TEST_CASE("joint lists are packed with zeros behind the last joint, and never empty") {
    JointList list;
    list.fill(kNoJoint);
    list[0] = 5;
    list[1] = 9;
    CHECK(packJointLists({list, list}, 4) == std::vector<uint32_t>{5, 9, 0, 0, 5, 9, 0, 0});
    CHECK(packJointLists({list}, 8) == std::vector<uint32_t>{5, 9, 0, 0, 0, 0, 0, 0});
    CHECK(packJointLists({}, 4) == std::vector<uint32_t>{0});
}
