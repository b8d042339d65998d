// Every buffer of every codec on the shared models, in bytes, against a recount from docs/codecs.md 7 and 8.
#include <filesystem>
#include <set>

#include <catch2/catch_test_macros.hpp>

#include "common/codecs/codec.h"
#include "tests/cases.h"
#include "tests/codec_test.h"
#include "tests/codecs/codec_recount.h"

using namespace skinbench;
using namespace skinbench::test;

namespace {

constexpr uintmax_t kLargeFile = 8'000'000;  // bytes; larger models are counted welded only

uint64_t sizeOf(const Bytes& bytes) { return bytes ? bytes->size() : 0; }

uint64_t padded(uint64_t bytes) { return (bytes + 3) / 4 * 4; }

// docs/codecs.md 3.2: the distinct joint lists that are no proper prefix of another one.
size_t countTuples(const Mesh& mesh) {
    using List = std::vector<uint16_t>;
    std::set<List> lists;
    for (const Influences& influences : mesh.influences) {
        List list;
        for (size_t i = 0; i < 4 && influences.joints[i] != kNoJoint; ++i) list.push_back(influences.joints[i]);
        lists.insert(list);
    }
    std::set<List> prefixes;
    for (List list : lists)
        for (list.pop_back(); !list.empty(); list.pop_back()) prefixes.insert(list);
    return static_cast<size_t>(
        std::ranges::count_if(lists, [&](const List& list) { return !prefixes.contains(list); }));
}

struct Sizes {
    uint64_t vertex = 0, extra = 0, tuple = 0;
    uint64_t vertices = 0;
};

void checkSizes(const char* name, const Mesh& mesh, const MeshletMesh& cut, const Sizes& wanted) {
    INFO("codec " << name);
    const auto encoded = findCodec(name)->encode({mesh, &cut, 4});
    REQUIRE(encoded);
    CHECK(encoded->vertexCount == wanted.vertices);
    CHECK(sizeOf(encoded->vertices) == wanted.vertex);
    CHECK(sizeOf(encoded->meshletExtra) == wanted.extra);
    CHECK(sizeOf(encoded->tuples) == wanted.tuple);
    uint64_t ids = 0, indexWords = 0;
    for (const Meshlet& meshlet : cut.meshlets) {
        ids += meshlet.vertexCount;
        indexWords += (meshlet.triangleCount + 3) / 4 * 3;
    }
    const PackedMeshlets packed = findMeshletLayout("redirect")->pack(encoded->meshlets ? *encoded->meshlets : cut, {});
    CHECK(packed.descriptors.size() == 2 * cut.meshlets.size());
    CHECK(packed.data.size() == ids + indexWords);
}

// The quantised attributes at `firstBytes` are those that `pc` has for the meshlet's first vertex.
void checkFirstBytes(const char* name, const Mesh& mesh, const MeshletMesh& cut) {
    INFO("codec " << name);
    const auto encoded = findCodec(name)->encode({mesh, &cut, 4}), pc = findCodec("pc")->encode({mesh, nullptr, 4});
    REQUIRE(encoded);
    REQUIRE(pc);
    REQUIRE(encoded->firstBytes.size() == cut.meshlets.size());
    REQUIRE(encoded->blendBytes.size() == cut.meshlets.size());
    for (size_t m = 0; m < cut.meshlets.size(); ++m) {
        REQUIRE(encoded->firstBytes[m] + kBaseVertexBytes + encoded->blendBytes[m] <= encoded->vertices->size());
        const std::byte* found = encoded->vertices->data() + encoded->firstBytes[m];
        const std::byte* wanted = pc->vertices->data() + size_t{18} * cut.vertices[cut.meshlets[m].firstVertex];
        REQUIRE(std::equal(found, found + kBaseVertexBytes, wanted));
    }
}

void checkCodecs(const Mesh& mesh) {
    const MeshletMesh cut = builders()[0].build(mesh, MeshletLimits{});
    const uint64_t count = mesh.positions.size();
    const uint64_t table = 8 * countTuples(mesh);
    checkSizes("uc", mesh, cut, {64 * count, 0, 0, count});
    checkSizes("uc16", mesh, cut, {padded(30 * count), 0, 0, count});
    checkSizes("oss", mesh, cut, {padded(18 * count), 0, table, count});
    checkSizes("pc", mesh, cut, {padded(18 * count), 0, table, count});

    const uint64_t extra = 8 * cut.meshlets.size();
    const Codes plain = codesOf(mesh, DifferenceCodec::pdc8);
    CHECK(8 * plain.tuples == table);
    Codes merged = codesOf(mesh, DifferenceCodec::dpdc16);
    if (merged.tuples > 8192) merged = codesOf(mesh, DifferenceCodec::dpdc16Mixed);
    struct Row {
        const char* name;
        uint32_t granularity;
        const Codes& codes;
    };
    for (const Row& row : {Row{"pdc8", 8, plain}, {"pdc16", 16, plain}, {"pdc32", 32, plain}, {"dpdc16", 16, merged}}) {
        const Recount counted = recount(cut, row.codes.ofVertex, row.granularity, row.granularity == 32);
        checkSizes(row.name, mesh, cut, {padded(counted.vertexBytes), extra, 8 * row.codes.tuples, counted.vertices});
        checkFirstBytes(row.name, mesh, cut);
    }
}

}  // namespace

TEST_CASE("bytes of every buffer on the shared models are those of a recount") {
    if (modelFiles().empty()) SKIP("no model folder: set SKINBENCH_MODELS to run this test");
    size_t loaded = 0;
    for (const std::string& file : modelFiles()) {
        const auto stored = loadScene(file);
        if (!stored) continue;  // which files must load is tested in test_scene_gltf.cpp
        ++loaded;
        for (Geometry geometry : {Geometry::welded, Geometry::unwelded}) {
            if (geometry == Geometry::unwelded && std::filesystem::file_size(file) > kLargeFile) continue;
            INFO(file << (geometry == Geometry::welded ? " welded" : " unwelded"));
            const auto scene = prepareScene(*stored, {4, geometry});
            REQUIRE(scene);
            checkCodecs(scene->mesh);
        }
    }
    CHECK(loaded > 30);
}

TEST_CASE("bytes of every buffer where meshlets split vertices") {
    for (uint32_t joints : {1u, 6u, 300u}) checkCodecs(randomMesh(joints + 90, 6000, joints));
}
