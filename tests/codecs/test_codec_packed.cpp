#include <cmath>
#include <numeric>

#include <catch2/catch_test_macros.hpp>

#include "common/codecs/packed.h"
#include "common/codecs/simplex.h"
#include "tests/codec_test.h"

using namespace skinbench;
using namespace skinbench::test;

namespace {

using Pack = Result<PackedVertices> (*)(const Mesh&);
using Read = Result<DecodedVertex> (*)(const PackedVertices&, uint32_t);

struct Format {
    const char* name;
    Pack pack;
    Read read;
    uint32_t stride;
    float weightError;  // of a single weight
};

Result<PackedVertices> packUc16Four(const Mesh& mesh) { return packUc16(mesh); }

const Format kFormats[] = {{"oss", packOss, readOss, 18, 7.26e-3f},
                           {"pc", packPc, readPc, 18, 4.546e-3f},
                           {"uc16", packUc16Four, readUc16, 30, 1.0f / 65535}};

Result<PackedVertices> packPc8(const Mesh& mesh) { return packPermutation(mesh, *configurePermutation(8, 65536, 64)); }
Result<DecodedVertex> readPc8(const PackedVertices& packed, uint32_t vertex) {
    return readPermutation(packed, *configurePermutation(8, 65536, 64), vertex);
}

// Joints of positive weight must be those of the source, weights must be close, attributes within half a step.
uint32_t countWrong(const Mesh& mesh, uint32_t v, const DecodedVertex& got, const VertexGrids& grids,
                    float weightError) {
    uint32_t wrong = 0;
    float sum = 0;
    for (int i = 0; i < kMaxInfluences; ++i) {
        const Influences& source = mesh.influences[v];
        sum += got.influences.weights[i];
        wrong += std::abs(got.influences.weights[i] - source.weights[i]) > weightError + 1e-6f;
        if (got.influences.weights[i] != 0) wrong += got.influences.joints[i] != source.joints[i];
        if (got.influences.weights[i] == 0) wrong += got.influences.joints[i] != kNoJoint;
        if (source.weights[i] == 0) wrong += got.influences.weights[i] != 0;
    }
    wrong += std::abs(sum - 1) > 1e-6f;
    for (int a = 0; a < 3; ++a) {
        const float step = grids.position.extent[a] / 65535;
        wrong +=
            std::abs(got.position[a] - mesh.positions[v][a]) > 0.51f * step + 4e-7f * std::abs(grids.position.min[a]);
    }
    for (int a = 0; a < 2; ++a) {
        wrong += std::abs(got.uv[a] - mesh.uvs[v][a]) > 0.51f * grids.uv.extent[a] / 65535 + 1e-7f;
    }
    const bool directed = glm::length(mesh.normals[v]) > 0;
    wrong += glm::distance(got.normal, directed ? mesh.normals[v] : glm::vec3(0, 0, 1)) > 6.6e-5f;
    return wrong;
}

void checkFormat(const Mesh& mesh, const Format& format) {
    INFO("format " << format.name);
    const auto packed = format.pack(mesh);
    REQUIRE(packed.has_value());
    CHECK(packed->vertexCount == mesh.positions.size());
    CHECK(packed->stride == format.stride);
    CHECK(packed->vertices.size() == (mesh.positions.size() * format.stride + 3) / 4 * 4);
    uint32_t wrong = 0;
    for (uint32_t v = 0; v < packed->vertexCount; ++v) {
        const auto vertex = format.read(*packed, v);
        REQUIRE(vertex.has_value());
        wrong += countWrong(mesh, v, *vertex, packed->grids, format.weightError);
    }
    CHECK(wrong == 0);
    for (size_t b = size_t{packed->vertexCount} * packed->stride; b < packed->vertices.size(); ++b)
        CHECK(packed->vertices[b] == 0);
}

Mesh pinnedMesh() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 2, 4}, {0.25f, 1, 3}};
    mesh.normals = {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}};
    mesh.uvs = {{0, 0}, {1, 1}, {0.5f, 0.25f}};
    mesh.influences = {cleanInfluences({{7, 1.0}}), cleanInfluences({{3, 0.5}, {2, 0.5}}),
                       cleanInfluences({{9, 0.52}, {8, 0.31}, {1, 0.13}, {0, 0.04}})};
    mesh.indices = {0, 1, 2};
    return mesh;
}

}  // namespace

TEST_CASE("pinned bytes") {
    const std::vector<std::vector<uint8_t>> base{
        {0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0},
        {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x00, 0x80, 0xFF, 0xFF, 0xFF, 0xFF},
        // 16383.75 -> 16384, 32767.5 -> 32768, 49151.25 -> 49151
        {0x00, 0x40, 0x00, 0x80, 0xFF, 0xBF, 0x00, 0x80, 0xFF, 0xFF, 0x00, 0x80, 0x00, 0x40}};
    const auto check = [&](const PackedVertices& packed, const std::vector<std::vector<uint8_t>>& blend) {
        std::vector<uint8_t> expected;
        for (int v = 0; v < 3; ++v) {
            expected.insert(expected.end(), base[v].begin(), base[v].end());
            expected.insert(expected.end(), blend[v].begin(), blend[v].end());
        }
        expected.resize((expected.size() + 3) / 4 * 4);
        CHECK(packed.vertices == expected);
    };
    // Tuples in descending order: 0: 9 8 1 0, 1: 7, 2: 2 3 (equal weights: smaller joint first).
    const auto oss = *packOss(pinnedMesh());
    CHECK(oss.tuples == std::vector<uint16_t>{9, 8, 1, 0, 7, kNoJoint, kNoJoint, kNoJoint, 2, 3, kNoJoint, kNoJoint});
    const uint32_t code = static_cast<uint32_t>(encodeSimplex(simplexCode16(), {0.52f, 0.31f, 0.13f, 0.04f}));
    check(oss, {{1, 0, 0, 0}, {2, 0, 103, 0}, {0, 0, static_cast<uint8_t>(code), static_cast<uint8_t>(code >> 8)}});

    // pc: (q, x) from docs/codecs.md 4.2 by hand.
    // vertex 0: tuple 1, c = 0 0 0, q = 0 1 2, x = 1 (O = 5: m = 5), payload 1*2+1 = 3 -> Q 0, rank 3 = 120
    // vertex 1: tuple 2, c = 0 0 1, q = 0 1 57, m = 115, x = 1, payload 5 -> rank 5 = 210
    // vertex 2: tuple 0, q = 9 25 46, m = 92, x = 0, payload 0 -> rank 0
    const uint32_t pc[] = {2u * 3364 + 0 * 58 + 1, 57u * 3364 + 1 * 58 + 0, 9u * 3364 + 25 * 58 + 46};
    std::vector<std::vector<uint8_t>> words;
    for (const uint32_t w : pc)
        words.push_back({static_cast<uint8_t>(w), static_cast<uint8_t>(w >> 8), static_cast<uint8_t>(w >> 16), 0});
    check(*packPc(pinnedMesh()), words);

    // 0.52 0.31 0.13 0.04 of 65535: 34078.2 20315.85 8519.55 2621.4 -> the two left over go to 20315 and 8519
    const auto le = [](std::initializer_list<uint16_t> fields) {
        std::vector<uint8_t> bytes;
        for (const uint16_t f : fields)
            bytes.insert(bytes.end(), {static_cast<uint8_t>(f), static_cast<uint8_t>(f >> 8)});
        return bytes;
    };
    check(*packUc16(pinnedMesh()), {le({7, 0, 0, 0, 65535, 0, 0, 0}), le({2, 3, 0, 0, 32768, 32767, 0, 0}),
                                    le({9, 8, 1, 0, 34078, 20316, 8520, 2621})});
}

TEST_CASE("random meshes round-trip") {
    for (const uint32_t joints : {1u, 3u, 40u, 4000u}) {
        const Mesh mesh = randomMesh(joints + 50, 20'001, joints);
        for (const Format& format : kFormats) checkFormat(mesh, format);
    }
}

TEST_CASE("degenerate meshes round-trip") {
    for (const auto& [name, mesh] : degenerateMeshes()) {
        CAPTURE(name);
        for (const Format& format : kFormats) checkFormat(mesh, format);
    }
    for (const Format& format : kFormats) CHECK(format.pack(Mesh{})->vertices.empty());
}

TEST_CASE("oss in 22 bits") {
    const SimplexCode code = *makeSimplexCode(22);
    const Mesh mesh = randomMesh(59, 5000, 12);
    const PackedVertices packed = *packSimplex(mesh, code);
    uint32_t wrong = 0;
    for (uint32_t v = 0; v < packed.vertexCount; ++v)
        wrong += countWrong(mesh, v, *readSimplex(packed, code, v), packed.grids, 7.26e-3f * 103 / 420);
    CHECK(wrong == 0);
    const auto over = packSimplex(randomMesh(58, 20'000, 4000), code);
    REQUIRE_FALSE(over);
    CHECK(over.error().text.find("oss22") != std::string::npos);
    CHECK(over.error().text.find("1024") != std::string::npos);
}

TEST_CASE("eight influences in uc16") {
    const auto pack = [](const Mesh& mesh) { return packUc16(mesh, 8); };
    checkFormat(randomMesh(57, 5000, 60, 8), {"uc16, 8 influences", pack, readUc16, 46, 1.0f / 65535});
}

TEST_CASE("eight influences in 64 bits") {
    const double error = worstErrorSingle(*configurePermutation(8, 65536, 64));
    checkFormat(randomMesh(60, 5000, 60, 8), {"pc, 8 influences", packPc8, readPc8, 22, static_cast<float>(error)});
}

TEST_CASE("quantised weights sum to 65535 and keep their order") {
    Random random(61);
    for (int r = 0; r < 200'000; ++r) {
        const Influences list = randomInfluences(random, 50, 10, 4);
        std::array<float, 4> w;
        const float scale = r % 3 == 0 ? 1.0f : static_cast<float>(random.unit() + 0.01);
        for (int i = 0; i < 4; ++i) w[i] = list.weights[i] * scale;
        const auto q = weightsToUnorm16(w);
        if (std::accumulate(q.begin(), q.begin() + 4, 0u) != 65535) FAIL_CHECK("sum");
        for (int i = 0; i < 3; ++i) {
            if (q[i] < q[i + 1]) FAIL_CHECK("order");
            if (w[i + 1] == 0 && q[i + 1] != 0) FAIL_CHECK("zero");
        }
    }
}

TEST_CASE("hostile bytes are decoded or refused, never followed out of bounds") {
    Random random(62);
    const Mesh mesh = randomMesh(63, 300, 30);
    for (const Format& format : kFormats) {
        const PackedVertices good = *format.pack(mesh);
        uint32_t refused = 0;
        for (int r = 0; r < 300; ++r) {
            PackedVertices bad = good;
            for (uint8_t& byte : bad.vertices) byte = static_cast<uint8_t>(random.next());
            for (uint32_t v = 0; v < bad.vertexCount; ++v) {
                const auto vertex = format.read(bad, v);
                refused += !vertex;
                if (vertex && !(std::abs(glm::length(vertex->normal) - 1) < 1e-4f)) FAIL_CHECK("normal");
            }
        }
        CHECK((refused > 0) == (format.stride == 18));
        // Truncated at every length: every vertex that is no longer whole is refused.
        for (size_t size = 0; size < good.vertices.size(); ++size) {
            PackedVertices cut = good;
            cut.vertices.resize(size);
            cut.vertices.shrink_to_fit();
            const uint32_t whole = static_cast<uint32_t>(size / format.stride);
            if (whole < cut.vertexCount) REQUIRE_FALSE(format.read(cut, whole).has_value());
            if (whole > 0) REQUIRE(format.read(cut, whole - 1).has_value());
        }
        CHECK_FALSE(format.read(good, good.vertexCount).has_value());
        CHECK_FALSE(format.read(good, 0xFFFFFFFF).has_value());
        PackedVertices other = good;
        other.stride = format.stride - 1;
        CHECK_FALSE(format.read(other, 0).has_value());
        if (format.stride == 18) {
            PackedVertices noTuples = good;
            noTuples.tuples.clear();
            CHECK_FALSE(format.read(noTuples, 0).has_value());
        }
    }
}

TEST_CASE("too many tuples, unclean weights and short arrays are named") {
    Mesh mesh = randomMesh(64, 3, 3);
    const auto resize = [&](uint32_t count) {
        mesh = {};
        for (uint32_t v = 0; v < count; ++v) {
            mesh.positions.emplace_back(v, 0, 0);
            mesh.normals.emplace_back(0, 0, 1);
            mesh.uvs.emplace_back(0, 0);
            mesh.influences.push_back(
                cleanInfluences({{static_cast<uint16_t>(v % 300), 0.6}, {static_cast<uint16_t>(300 + v / 300), 0.4}}));
        }
    };
    resize(65536);
    CHECK(packOss(mesh).has_value());
    CHECK(packPc(mesh).has_value());
    resize(65537);
    for (const Format& format : kFormats) {
        const auto packed = format.pack(mesh);
        CHECK(packed.has_value() == (format.stride == 30));
        if (!packed) {
            CHECK(packed.error().text.find("65537") != std::string::npos);
            CHECK(packed.error().text.find("65536") != std::string::npos);
            CHECK(packed.error().text.find(format.name) != std::string::npos);
        }
    }
    for (const Format& format : kFormats) {
        Mesh broken = randomMesh(65, 10, 3);
        broken.uvs.pop_back();
        CHECK_FALSE(format.pack(broken).has_value());
        broken = randomMesh(65, 10, 3);
        broken.influences[4].weights[0] = -1;
        CHECK(format.pack(broken).error().text.starts_with("vertex 4"));
    }
}
