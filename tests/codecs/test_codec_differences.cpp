#include <cmath>
#include <set>

#include <catch2/catch_test_macros.hpp>

#include "common/codecs/differences.h"
#include "tests/codec_test.h"
#include "tests/codecs/codec_recount.h"

using namespace skinbench;
using namespace skinbench::test;

namespace {

constexpr DifferenceCodec kCodecs[] = {DifferenceCodec::pdc8, DifferenceCodec::pdc16, DifferenceCodec::pdc32,
                                       DifferenceCodec::dpdc16, DifferenceCodec::dpdc16Mixed};

// Every meshlet vertex against its source: joints exact, weights within the code's bound (or exact mean in pdc32).
void checkVertices(const Mesh& mesh, const MeshletMesh& meshlets, const DifferenceMesh& encoded) {
    const double bound = worstErrorSingle(differenceTraits(encoded.codec).code) + 1e-5;
    uint64_t wrong = 0;
    for (uint32_t m = 0; m < meshlets.meshlets.size(); ++m) {
        for (uint32_t l = 0; l < meshlets.meshlets[m].vertexCount; ++l) {
            const uint32_t v = meshlets.vertices[meshlets.meshlets[m].firstVertex + l];
            const auto got = decodeDifference(encoded, meshlets, m, l);
            REQUIRE(got.has_value());
            const Influences& source = mesh.influences[v];
            // A shared weight of pdc32 is the mean of weights that lie in the same cell: twice the bound.
            const double limit =
                encoded.codec == DifferenceCodec::pdc32 && encoded.differenceBytes[m] == 0 ? 2 * bound : bound;
            for (int i = 0; i < kMaxInfluences; ++i) {
                wrong += std::abs(double{got->influences.weights[i]} - source.weights[i]) > limit;
                if (got->influences.weights[i] != 0 && source.joints[i] != kNoJoint) {
                    wrong += got->influences.joints[i] != source.joints[i];
                }
                if (source.weights[i] == 0 && limit == bound) wrong += got->influences.weights[i] != 0;
            }
            const glm::uvec3 q = quantizePosition(mesh.positions[v], encoded.grids.position, 16);
            wrong += got->position != dequantizePosition(q, encoded.grids.position, 16);
            wrong += got->uv != dequantizeUv(quantizeUv(mesh.uvs[v], encoded.grids.uv), encoded.grids.uv);
            const uint32_t normal = encodeNormal(mesh.normals[v], NormalFormat::octahedral);
            wrong += got->normal != decodeNormal(normal, NormalFormat::octahedral);
        }
    }
    CHECK(wrong == 0);
}

// Byte offsets beside MeshletMesh::vertices.
std::vector<uint32_t> offsetsOf(const MeshletMesh& meshlets, const DifferenceMesh& encoded) {
    std::vector<uint32_t> offsets(meshlets.vertices.size());
    for (size_t m = 0; m < meshlets.meshlets.size(); ++m) {
        const Meshlet& meshlet = meshlets.meshlets[m];
        const uint32_t width = encoded.differenceBytes[m];
        for (uint32_t i = meshlet.firstVertex; i < meshlet.firstVertex + meshlet.vertexCount; ++i)
            offsets[i] = encoded.sections[width] + encoded.numbers[i] * (14 + width);
    }
    return offsets;
}

void checkSizes(const Mesh& mesh, const MeshletMesh& meshlets, const DifferenceMesh& encoded) {
    const Codes codes = codesOf(mesh, encoded.codec);
    const Recount expected =
        recount(meshlets, codes.ofVertex, granularityOf(encoded.codec), encoded.codec == DifferenceCodec::pdc32);
    CHECK(encoded.vertexBytes == expected.vertexBytes);
    CHECK(encoded.vertices.size() == (expected.vertexBytes + 3) / 4 * 4);
    CHECK(encoded.vertexCount == expected.vertices);
    CHECK(encoded.copies == expected.copies);
    CHECK(std::equal(expected.widths.begin(), expected.widths.end(), encoded.differenceBytes.begin(),
                     encoded.differenceBytes.end()));
    CHECK(encoded.meshletExtra.size() == meshlets.meshlets.size());
    CHECK(encoded.numbers.size() == meshlets.vertices.size());
    CHECK(encoded.sources.size() == encoded.vertexCount);
    CHECK(encoded.tuples.size() == 4 * codes.tuples);
    // First use order within a width: an offset that was not seen yet is the end of all vertices of the width before.
    const std::vector<uint32_t> offsets = offsetsOf(meshlets, encoded);
    std::set<uint32_t> seen;
    std::map<uint32_t, uint64_t> sizes;
    for (const uint32_t width : expected.storedWidths) sizes[width] += 14 + width;
    std::map<uint32_t, uint64_t> ends;
    uint64_t end = 0;
    for (const auto& [width, size] : sizes) end = (ends[width] = end) + size;
    uint64_t wrong = 0;
    for (size_t m = 0; m < meshlets.meshlets.size(); ++m) {
        const Meshlet& meshlet = meshlets.meshlets[m];
        for (uint32_t i = meshlet.firstVertex; i < meshlet.firstVertex + meshlet.vertexCount; ++i) {
            wrong += encoded.sources[encoded.numbers[i]] != meshlets.vertices[i];
            if (!seen.insert(offsets[i]).second) continue;
            wrong += offsets[i] != ends[encoded.differenceBytes[m]];
            ends[encoded.differenceBytes[m]] += 14 + encoded.differenceBytes[m];
        }
    }
    CHECK(wrong == 0);
}

void checkMesh(const Mesh& mesh, const MeshletMesh& meshlets) {
    for (const DifferenceCodec codec : kCodecs) {
        INFO("codec " << differenceTraits(codec).name);
        const auto encoded = encodeDifferences(mesh, meshlets, codec);
        REQUIRE(encoded.has_value());
        checkVertices(mesh, meshlets, *encoded);
        checkSizes(mesh, meshlets, *encoded);
    }
}

// Two meshlets over five vertices; vertex 2 is in both. Vertex 5 is in none.
struct Small {
    Mesh mesh;
    MeshletMesh meshlets;
};

Small smallMesh() {
    Small s;
    for (int v = 0; v < 6; ++v) {
        s.mesh.positions.emplace_back(v, v, v);
        s.mesh.normals.emplace_back(0, 0, -1);
        s.mesh.uvs.emplace_back(v, -v);
        s.mesh.influences.push_back(cleanInfluences({{static_cast<uint16_t>(v < 3 ? 1 : 2), 1.0}}));
    }
    s.mesh.influences[5] = cleanInfluences({{9, 1.0}});
    s.meshlets.limits = {4, 4};
    s.meshlets.meshlets = {{0, 0, 3, 1}, {3, 1, 3, 1}};
    s.meshlets.vertices = {1, 0, 2, 2, 3, 4};
    s.meshlets.triangles = {{0, 1, 2}, {0, 1, 2}};
    return s;
}

}  // namespace

TEST_CASE("widths are whole multiples, also where log2 in float is wrong") {
    struct Row {
        uint32_t largest, p8, p16, p32;
    };
    for (const Row row : {Row{0, 0, 0, 0},
                          {1, 1, 2, 4},
                          {255, 1, 2, 4},
                          {256, 2, 2, 4},
                          {65535, 2, 2, 4},
                          {65536, 3, 4, 4},
                          {(1u << 24) - 1, 3, 4, 4},
                          {1u << 24, 4, 4, 4},
                          {0xFFFFFFFF, 4, 4, 4}}) {
        CHECK(differenceBytes(row.largest, 8) == row.p8);
        CHECK(differenceBytes(row.largest, 16) == row.p16);
        CHECK(differenceBytes(row.largest, 32) == row.p32);
    }
}

TEST_CASE("pinned bytes of a small mesh") {
    const Small s = smallMesh();
    // Tuples: 0: 9, 1: 2, 2: 1. Rigid codes (q = 0 1 2, x = 1): payload 2 t + 1: t = 1: Q 0, rank 3 (120) -> 2 0 1;
    // t = 2: Q 0, rank 5 (210) -> 2 1 0.
    const uint32_t code2 = 2 * 3364 + 0 * 58 + 1;
    const uint32_t code1 = 2 * 3364 + 1 * 58 + 0;
    const auto base = [](int v) {
        const uint8_t lo = static_cast<uint8_t>(v * 13107), hi = static_cast<uint8_t>(v * 13107 >> 8);
        const int w = 5 - v;
        const uint8_t wl = static_cast<uint8_t>(w * 13107), wh = static_cast<uint8_t>(w * 13107 >> 8);
        return std::vector<uint8_t>{lo, hi, lo, hi, lo, hi, 0xFF, 0xFF, 0xFF, 0xFF, lo, hi, wl, wh};
    };
    const auto join = [&](std::initializer_list<std::pair<int, std::vector<uint8_t>>> vertices) {
        std::vector<uint8_t> bytes;
        for (const auto& [v, difference] : vertices) {
            const auto b = base(v);
            bytes.insert(bytes.end(), b.begin(), b.end());
            bytes.insert(bytes.end(), difference.begin(), difference.end());
        }
        bytes.resize((bytes.size() + 3) / 4 * 4);
        return bytes;
    };
    // pdc8: the first meshlet is constant, the second spans code1 - code2 = 57; vertex 2 is split.
    const auto pdc8 = *encodeDifferences(s.mesh, s.meshlets, DifferenceCodec::pdc8);
    CHECK(pdc8.vertices == join({{1, {}}, {0, {}}, {2, {}}, {2, {57}}, {3, {0}}, {4, {0}}}));
    CHECK(offsetsOf(s.meshlets, pdc8) == std::vector<uint32_t>{0, 14, 28, 42, 57, 72});
    CHECK(pdc8.numbers == std::vector<uint32_t>{0, 1, 2, 3, 4, 5});
    CHECK(pdc8.sources == std::vector<uint32_t>{1, 0, 2, 2, 3, 4});
    CHECK(pdc8.meshletExtra == std::vector<std::array<uint32_t, 2>>{{code1, 0}, {code2, 1}});
    CHECK(pdc8.differenceBytes == std::vector<uint8_t>{0, 1});
    CHECK(pdc8.vertexBytes == 87);
    CHECK(pdc8.vertexCount == 6);
    CHECK(pdc8.copies == 1);
    CHECK(pdc8.tuples == std::vector<uint16_t>{9, kNoJoint, kNoJoint, kNoJoint, 2, kNoJoint, kNoJoint, kNoJoint, 1,
                                               kNoJoint, kNoJoint, kNoJoint});

    const auto pdc16 = *encodeDifferences(s.mesh, s.meshlets, DifferenceCodec::pdc16);
    CHECK(pdc16.vertices == join({{1, {}}, {0, {}}, {2, {}}, {2, {57, 0}}, {3, {0, 0}}, {4, {0, 0}}}));

    // pdc32: tuple 2 and weights 1 0 0 0 in the meshlet; whole codes in the other.
    const auto pdc32 = *encodeDifferences(s.mesh, s.meshlets, DifferenceCodec::pdc32);
    const auto word = [](uint32_t c) {
        return std::vector<uint8_t>{static_cast<uint8_t>(c), static_cast<uint8_t>(c >> 8), 0, 0};
    };
    CHECK(pdc32.vertices == join({{1, {}}, {0, {}}, {2, {}}, {2, word(code1)}, {3, word(code2)}, {4, word(code2)}}));
    CHECK(pdc32.meshletExtra == std::vector<std::array<uint32_t, 2>>{{2, 0}, {0xFFFF, 0}});

    // dpdc16: 9 takes 2, then 1, now the emptiest, takes 9 2.
    const auto dpdc16 = *encodeDifferences(s.mesh, s.meshlets, DifferenceCodec::dpdc16);
    CHECK(dpdc16.tuples == std::vector<uint16_t>{1, 9, 2, kNoJoint});
    checkMesh(s.mesh, s.meshlets);
}

TEST_CASE("equal meshlets share their vertices") {
    Small s = smallMesh();
    for (Influences& list : s.mesh.influences) list = cleanInfluences({{4, 0.75}, {3, 0.25}});
    for (const DifferenceCodec codec : kCodecs) {
        const auto encoded = *encodeDifferences(s.mesh, s.meshlets, codec);
        CHECK(encoded.copies == 0);
        CHECK(encoded.vertexBytes == 5 * 14);
        CHECK(encoded.numbers[2] == encoded.numbers[3]);
    }
    // Different constants: pdc32 still shares, the others have different base codes but no vertex in both.
    s.meshlets.vertices[3] = 5;
    for (const int v : {3, 4, 5}) s.mesh.influences[v] = cleanInfluences({{8, 1.0}});
    for (const DifferenceCodec codec : kCodecs)
        CHECK(encodeDifferences(s.mesh, s.meshlets, codec)->vertexBytes == 6 * 14);
    checkMesh(s.mesh, s.meshlets);
}

TEST_CASE("pdc32 shares the mean of the distinct source weights") {
    Small s = smallMesh();
    const float w[] = {0.5f, 0.5005f, 0.5f, 0.5f, 0.5f};
    for (int v = 0; v < 5; ++v)
        s.mesh.influences[v] = cleanInfluences({{1, 1 - double{w[v]} * 0.5}, {2, double{w[v]} * 0.5}});
    const auto encoded = *encodeDifferences(s.mesh, s.meshlets, DifferenceCodec::pdc32);
    REQUIRE(encoded.differenceBytes == std::vector<uint8_t>{0, 0});
    const double mean = (0.25 + 0.25025) / 2;
    CHECK(encoded.meshletExtra[0][0] >> 16 == static_cast<uint32_t>(std::lround(2 * mean * 65535)));
    // The other meshlet has the same code and must meet it at vertex 2 without a crack.
    CHECK(encoded.meshletExtra[1] == encoded.meshletExtra[0]);
    CHECK(std::abs(decodeDifference(encoded, s.meshlets, 0, 0)->influences.weights[1] - mean) < 1e-5);
}

TEST_CASE("random meshes, several meshlet sizes") {
    for (const uint32_t joints : {1u, 3u, 40u, 900u}) {
        const Mesh mesh = randomMesh(joints + 70, 5000, joints);
        for (const MeshletLimits limits : {MeshletLimits{64, 124}, {3, 1}, {256, 256}})
            checkMesh(mesh, cutMeshlets(mesh, limits));
    }
}

TEST_CASE("a vertex shared by many meshlets") {
    Mesh mesh = randomMesh(80, 3000, 50);
    for (size_t t = 0; t < mesh.indices.size(); t += 3) mesh.indices[t] = 0;
    checkMesh(mesh, cutMeshlets(mesh, {8, 8}));
}

TEST_CASE("degenerate meshes and empty ones") {
    for (const auto& [name, mesh] : degenerateMeshes()) {
        CAPTURE(name);
        checkMesh(mesh, cutMeshlets(mesh));
    }
    MeshletMesh hollow;
    hollow.meshlets = {{0, 0, 0, 0}};
    for (const DifferenceCodec codec : kCodecs) {
        CHECK(encodeDifferences(Mesh{}, MeshletMesh{}, codec)->vertices.empty());
        const auto encoded = encodeDifferences(smallMesh().mesh, hollow, codec);
        REQUIRE(encoded.has_value());
        CHECK(encoded->vertexCount == 0);
        CHECK_FALSE(decodeDifference(*encoded, hollow, 0, 0).has_value());
    }
}

TEST_CASE("the result does not depend on the run") {
    const Mesh mesh = randomMesh(81, 60'000, 300);
    const MeshletMesh meshlets = cutMeshlets(mesh);
    for (const DifferenceCodec codec : kCodecs) {
        const auto a = *encodeDifferences(mesh, meshlets, codec);
        const auto b = *encodeDifferences(mesh, meshlets, codec);
        CHECK((a.vertices == b.vertices && a.numbers == b.numbers && a.meshletExtra == b.meshletExtra));
    }
}

TEST_CASE("tuple overflow names count and limit") {
    // `count` tuples that neither reuse nor merging can reduce: four joints each, ascending.
    const auto make = [](uint32_t count) {
        Mesh mesh;
        for (uint32_t v = 0; v < count; ++v) {
            mesh.positions.emplace_back(v, 0, 0);
            mesh.normals.emplace_back(0, 0, 1);
            mesh.uvs.emplace_back(0, 0);
            mesh.influences.push_back(cleanInfluences({{0, 0.4},
                                                       {1, 0.3},
                                                       {static_cast<uint16_t>(2 + v % 256), 0.2},
                                                       {static_cast<uint16_t>(300 + v / 256), 0.1}}));
        }
        return mesh;
    };
    for (const DifferenceCodec codec : kCodecs) {
        const DifferenceTraits& traits = differenceTraits(codec);
        CAPTURE(traits.name);
        MeshletMesh one;
        one.meshlets = {{0, 0, 3, 1}};
        one.vertices = {0, 1, 2};
        one.triangles = {{0, 1, 2}};
        CHECK(encodeDifferences(make(traits.maxTuples), one, codec).has_value());
        const auto over = encodeDifferences(make(traits.maxTuples + 1), one, codec);
        REQUIRE_FALSE(over.has_value());
        CHECK(over.error().text.find(std::to_string(traits.maxTuples)) != std::string::npos);
        CHECK(over.error().text.find(std::to_string(traits.maxTuples + 1)) != std::string::npos);
        CHECK(over.error().text.find(traits.name) != std::string::npos);
    }
}

TEST_CASE("meshlets that do not belong to the mesh are refused") {
    const Small s = smallMesh();
    for (const DifferenceCodec codec : kCodecs) {
        MeshletMesh bad = s.meshlets;
        bad.vertices[4] = 6;
        CHECK_FALSE(encodeDifferences(s.mesh, bad, codec).has_value());
        bad = s.meshlets;
        bad.meshlets[1].vertexCount = 4;
        CHECK_FALSE(encodeDifferences(s.mesh, bad, codec).has_value());
        bad.meshlets[1] = {0xFFFFFFFF, 0, 2, 1};
        CHECK_FALSE(encodeDifferences(s.mesh, bad, codec).has_value());
    }
}

TEST_CASE("hostile buffers are decoded or refused, never followed out of bounds") {
    Random random(82);
    const Mesh mesh = randomMesh(83, 400, 20);
    const MeshletMesh meshlets = cutMeshlets(mesh, {32, 40});
    for (const DifferenceCodec codec : kCodecs) {
        const DifferenceMesh good = *encodeDifferences(mesh, meshlets, codec);
        uint32_t decoded = 0, refused = 0;
        for (int r = 0; r < 400; ++r) {
            DifferenceMesh bad = good;
            const uint32_t kind = random.below(5);
            if (kind == 0)
                for (uint8_t& b : bad.vertices) b = static_cast<uint8_t>(random.next());
            if (kind == 1)
                for (uint32_t& n : bad.numbers) n = static_cast<uint32_t>(random.next()) >> random.below(32);
            if (kind == 2)
                for (auto& e : bad.meshletExtra)
                    e[random.below(2)] = static_cast<uint32_t>(random.next()) >> random.below(32);
            if (kind == 3)
                bad.vertices.resize(random.below(static_cast<uint32_t>(bad.vertices.size()))),
                    bad.vertices.shrink_to_fit();
            if (kind == 4)
                bad.tuples.resize(random.below(static_cast<uint32_t>(bad.tuples.size()))), bad.tuples.shrink_to_fit();
            for (uint32_t m = 0; m < meshlets.meshlets.size(); ++m) {
                for (uint32_t l = 0; l < meshlets.meshlets[m].vertexCount; ++l) {
                    decodeDifference(bad, meshlets, m, l) ? ++decoded : ++refused;
                }
            }
        }
        CHECK(decoded > 0);
        CHECK(refused > 0);
        CHECK_FALSE(decodeDifference(good, meshlets, static_cast<uint32_t>(meshlets.meshlets.size()), 0).has_value());
        CHECK_FALSE(decodeDifference(good, meshlets, 0, meshlets.meshlets[0].vertexCount).has_value());
        CHECK_FALSE(decodeDifference(good, meshlets, 0xFFFFFFFF, 0xFFFFFFFF).has_value());
        DifferenceMesh fewer = good;
        fewer.meshletExtra.pop_back();
        CHECK_FALSE(
            decodeDifference(fewer, meshlets, static_cast<uint32_t>(meshlets.meshlets.size() - 1), 0).has_value());
    }
}

TEST_CASE("real models: every vertex reads back and every buffer has the counted size") {
    const std::string folder = folderOf("SKINBENCH_MODELS", "/../shared/models");
    if (!std::filesystem::is_directory(folder)) SKIP("no folder " << folder << ": set SKINBENCH_MODELS");
    uint32_t models = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".glb" || entry.file_size() > 8'000'000) continue;
        auto loaded = loadGltf(entry.path().string());
        INFO("model " << entry.path().filename());
        REQUIRE(loaded.has_value());
        for (const Geometry geometry : {Geometry::welded, Geometry::unwelded}) {
            PrepareOptions options;
            options.geometry = geometry;
            const auto scene = prepareScene(*loaded, options);
            REQUIRE(scene.has_value());
            const MeshletMesh meshlets = builders()[0].build(scene->mesh, MeshletLimits{});
            checkMesh(scene->mesh, meshlets);
        }
        ++models;
    }
    CHECK(models > 0);
}
