// The decoders of shaders_glsl/codecs/, compiled as C++, against the CPU's readers; and as GLSL in every dialect.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <format>
#include <fstream>
#include <set>
#include <span>

#include <catch2/catch_test_macros.hpp>
#include <nlohmann/json.hpp>

#include "common/codecs/packed.h"
#include "common/codecs/permutation.h"
#include "common/codecs/simplex.h"
#include "tests/cases.h"
#include "tests/codec_test.h"
#include "tests/codecs/shader_decoders.h"
#include "tests/glslang_check.h"

using namespace skinbench;
using namespace skinbench::test;
using nlohmann::json;

namespace {

// What was decoded lies within the codec's error of what it came from.
void checkSources(const Mesh& mesh, const EncodedMesh& encoded, const Mesh& decoded) {
    REQUIRE(decoded.positions.size() == encoded.vertexCount);
    if (encoded.sources.empty()) REQUIRE(encoded.vertexCount == mesh.positions.size());
    const glm::vec3 step = positionGrid(mesh.positions).extent / 65535.0f;
    uint64_t wrong = 0;
    for (uint32_t v = 0; v < encoded.vertexCount; ++v) {
        const uint32_t source = encoded.sources.empty() ? v : encoded.sources[v];
        REQUIRE(source < mesh.positions.size());
        const glm::vec3 off = glm::abs(decoded.positions[v] - mesh.positions[source]);
        for (int a = 0; a < 3; ++a) wrong += !(off[a] <= 0.51f * step[a] + 1e-6f * std::abs(mesh.positions[source][a]));
        float sum = 0;
        for (const float weight : decoded.influences[v].weights) sum += weight;
        wrong += !(std::abs(sum - 1) <= 1e-6f);
    }
    CHECK(wrong == 0);
}

// Null where the codec says why it cannot hold the mesh.
std::optional<EncodedMesh> encodeFor(const glsl::Decoder& decoder, const Mesh& mesh, const MeshletMesh& meshlets) {
    const Codec* codec = findCodec(decoder.codec);
    REQUIRE(codec != nullptr);
    auto encoded = codec->encode({mesh, codec->needsMeshlets ? &meshlets : nullptr, decoder.influences});
    if (!encoded) {
        CHECK(encoded.error().text.size() > 20);
        return {};
    }
    CHECK(encoded->meshlets.has_value() == codec->needsMeshlets);
    return std::move(*encoded);
}

int mostInfluences(const Mesh& mesh) {
    int most = 1;
    for (const Influences& list : mesh.influences)
        for (int i = 0; i < kMaxInfluences; ++i)
            if (list.weights[static_cast<size_t>(i)] > 0) most = std::max(most, i + 1);
    return most;
}

// Names of the decoders that could decode the mesh.
std::set<std::string> checkDecoded(const Mesh& mesh, const MeshletMesh& meshlets) {
    std::set<std::string> done;
    for (const glsl::Decoder* decoder : glsl::decoders()) {
        INFO("codec " << decoder->codec << ", " << decoder->influences << " influences");
        if (mostInfluences(mesh) > decoder->influences) continue;
        const auto encoded = encodeFor(*decoder, mesh, meshlets);
        if (!encoded) continue;
        const Mesh decoded = decodeOnCpu(mesh, *encoded);
        checkSources(mesh, *encoded, decoded);
        for (const uint32_t copies : {1u, 3u}) {
            const glsl::Differences differences = glsl::compareDecoded(*decoder, *encoded, decoded, copies);
            CHECK(differences.fault == "");
            CHECK(differences.vertices == 0);
            CHECK(differences.readsOutside == 0);
        }
        done.insert(decoder->codec);
    }
    return done;
}

const std::set<std::string> kAlways = {"uc",   "uc16", "oss",  "pc",    "pc40",  "pc48",
                                       "pc56", "pc64", "pdc8", "pdc16", "pdc32", "dpdc16"};

void checkHolds(const std::set<std::string>& done) {
    for (const std::string& name : kAlways) {
        INFO("codec " << name);
        CHECK(done.contains(name));
    }
}

}  // namespace

TEST_CASE("shader decoders: random meshes") {
    for (const uint32_t joints : {1u, 3u, 40u, 900u}) {
        const Mesh mesh = randomMesh(joints + 90, 3001, joints);
        for (const MeshletLimits limits : {MeshletLimits{64, 124}, {3, 1}, {256, 256}})
            checkHolds(checkDecoded(mesh, cutMeshlets(mesh, limits)));
    }
}

TEST_CASE("shader decoders: eight influences") {
    const Mesh mesh = randomMesh(94, 5000, 60, 8);
    const auto done = checkDecoded(mesh, cutMeshlets(mesh));
    CHECK(done == std::set<std::string>{"uc", "uc16", "pc", "pc32"});
}

TEST_CASE("shader decoders: degenerate meshes") {
    for (const auto& [name, mesh] : degenerateMeshes()) {
        CAPTURE(name);
        checkHolds(checkDecoded(mesh, cutMeshlets(mesh)));
    }
}

TEST_CASE("shader decoders: constant meshlets of one code share vertices and weights") {
    Mesh mesh = randomMesh(95, 600, 40);
    for (size_t v = 0; v < mesh.influences.size(); ++v)
        mesh.influences[v] = cleanInfluences({{1, 0.75 + 1e-5 * static_cast<double>(v % 7)}, {2, 0.25}});
    checkHolds(checkDecoded(mesh, cutMeshlets(mesh, {16, 16})));
}

TEST_CASE("shader decoders: more merged tuples than 13 bits count") {
    Mesh mesh = randomMesh(96, 9000, 4);
    for (size_t v = 0; v < mesh.influences.size(); ++v)
        mesh.influences[v] = cleanInfluences({{0, 0.4},
                                              {1, 0.3},
                                              {static_cast<uint16_t>(2 + v % 256), 0.2},
                                              {static_cast<uint16_t>(300 + v / 256), 0.1}});
    const MeshletMesh meshlets = cutMeshlets(mesh);
    checkHolds(checkDecoded(mesh, meshlets));
    const auto encoded = *findCodec("dpdc16")->encode({mesh, &meshlets, 4});
    CHECK(std::ranges::count(encoded.defines, std::pair<std::string, std::string>("MOST_TUPLES", "16384")) == 1);
}

TEST_CASE("shader decoders: real models") {
    const std::string folder = folderOf("SKINBENCH_MODELS", "/../shared/models");
    if (!std::filesystem::is_directory(folder)) SKIP("no folder " << folder << ": set SKINBENCH_MODELS");
    for (const char* name : {"human_female.glb", "dragon.glb", "mannequiny.glb"}) {
        INFO("model " << name);
        const auto loaded = loadGltf(folder + "/" + name);
        if (!loaded) SKIP(loaded.error().text);
        for (const Geometry geometry : {Geometry::welded, Geometry::unwelded}) {
            const auto scene = prepareScene(*loaded, {.geometry = geometry});
            REQUIRE(scene);
            checkHolds(checkDecoded(scene->mesh, findBuilder("meshopt")->build(scene->mesh, {})));
        }
        const auto eight = prepareScene(*loaded, {.influences = 8});
        REQUIRE(eight);
        const auto done = checkDecoded(eight->mesh, findBuilder("scan")->build(eight->mesh, {}));
        CHECK((done.contains("pc") && done.contains("uc16")));
    }
}

TEST_CASE("shader decoders: any permutation code that the CPU takes") {
    std::vector<PermutationCode> codes = {kPermutationPc, kPermutationDpdc16, kPermutationDpdc16Text,
                                          kPermutationDpdc16Mixed};
    for (const int influences : {4, 8})
        for (const uint32_t tuples : {1u, 300u, 65536u})
            for (const int bits : {24, 32, 48, 64})
                if (const auto code = configurePermutation(influences, tuples, bits)) codes.push_back(*code);
    CHECK(codes.size() > 20);
    Random random(97);
    for (const PermutationCode& code : codes) {
        INFO("influences " << code.entries + 1 << ", bits " << code.bits << ", tuples " << code.tuples);
        uint32_t taken = 0, wrong = 0;
        for (int r = 0; r < 200'000; ++r) {
            uint64_t value = random.next() >> (64 - code.bits);
            if (r % 2 == 0) {
                const Influences list = randomInfluences(random, 50, 9, static_cast<uint32_t>(code.entries + 1));
                value = encodeInfluences(code, list, random.below(static_cast<uint32_t>(code.tuples)));
            }
            const auto expected = decodePermutation(code, value);
            if (!expected) continue;
            ++taken;
            wrong += !(glsl::decodePermutation(code, value) == *expected);
        }
        CHECK(taken >= 100'000);
        CHECK(wrong == 0);
    }
}

TEST_CASE("shader decoders: every simplex code") {
    for (const int bits : {8, 16, 22}) {
        const SimplexCode code = *makeSimplexCode(bits);
        float most = 0;
        for (uint32_t value = 0; value < code.count; ++value) {
            const glm::vec4 got = glsl::simplexWeights(static_cast<uint32_t>(code.n), value);
            const glm::vec4 expected = *decodeSimplex(code, value);
            for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(got[i] - expected[i]));
        }
        CHECK(most <= 0x1p-24f);
    }
}

TEST_CASE("shader decoders: reference vectors") {
    const std::string folder = folderOf("SKINBENCH_VECTORS", "/../shared/vectors");
    if (!std::filesystem::is_directory(folder)) SKIP("no folder " << folder << ": set SKINBENCH_VECTORS");
    uint32_t rows = 0, wrong = 0;
    const json permutation = json::parse(std::ifstream(folder + "/permutation_coding.json"));
    for (const json& config : permutation["configs"]) {
        const auto code = *makePermutationCode(config["extra_value_counts"].get<std::vector<uint32_t>>(),
                                               config["weight_value_count"].get<uint32_t>(),
                                               config["tuple_count"].get<uint64_t>(), config["code_bits"].get<int>());
        const size_t k = static_cast<size_t>(code.entries) + 1;
        if (k != 4 && k != 8) continue;
        for (const json& row : config["rows"]) {
            const auto cells = row.get<std::vector<uint32_t>>();
            const auto got = glsl::decodePermutation(code, cells[k + 1] | uint64_t{cells[k + 2]} << 32);
            wrong += got.tuple != cells[k];
            for (size_t i = 0; i < k; ++i)
                wrong +=
                    !(std::abs(got.weights[i] - std::bit_cast<float>(cells[k + 3 + i])) <= (k == 4 ? 2.5e-7f : 5e-7f));
            ++rows;
        }
    }
    const json simplex = json::parse(std::ifstream(folder + "/oss.json"));
    for (const json& config : simplex["configs"]) {
        const auto points = config["N"].get<uint32_t>();
        for (const json& row : config["rows"]) {
            const auto cells = row.get<std::vector<uint32_t>>();
            const glm::vec4 got = glsl::simplexWeights(points, cells[4]);
            for (int i = 0; i < 4; ++i) wrong += !(std::abs(got[i] - std::bit_cast<float>(cells[5 + i])) <= 2.5e-7f);
            ++rows;
        }
    }
    CHECK(rows > 300);
    CHECK(wrong == 0);
}

TEST_CASE("codecs that cannot hold a mesh say why") {
    const Mesh four = randomMesh(98, 300, 20);
    const Mesh eight = randomMesh(98, 300, 20, 8);
    const MeshletMesh meshlets = cutMeshlets(four);
    for (const char* name : {"oss", "oss22", "pdc8", "pdc16", "pdc32", "dpdc16", "wicked"}) {
        const auto encoded = findCodec(name)->encode({eight, &meshlets, 8});
        REQUIRE_FALSE(encoded);
        CHECK(encoded.error().text.find(std::string("codec ") + name + " holds 4 influences") == 0);
    }
    for (const char* name : {"pdc8", "pdc16", "pdc32", "dpdc16"}) {
        const auto encoded = findCodec(name)->encode({four, nullptr, 4});
        REQUIRE_FALSE(encoded);
        CHECK(encoded.error().text.find("needs meshlets") != std::string::npos);
    }
    const auto narrow = findCodec("pc16")->encode({randomMesh(99, 20'000, 3000), nullptr, 4});
    REQUIRE_FALSE(narrow);
    CHECK(narrow.error().text.find("16 bits") != std::string::npos);
    CHECK(findCodec("pc20") == nullptr);
    CHECK(findCodec("") == nullptr);
}

TEST_CASE("every codec row can be found, and its names are unique") {
    std::set<std::string> names;
    for (const Codec& codec : codecs()) {
        CHECK(names.insert(codec.name).second);
        CHECK(findCodec(codec.name) == &codec);
    }
    // Those without a block in tests/codecs/glsl_decoders.h.
    for (const glsl::Decoder* decoder : glsl::decoders()) names.erase(decoder->codec);
    CHECK(names == std::set<std::string>());
}

TEST_CASE("how a vertex is stored is said in words: the tuple has the joints that decode") {
    const Mesh mesh = randomMesh(5, 400, 30);
    const MeshletMesh cut = cutMeshlets(mesh, {32, 32});
    for (const char* name : {"pc", "pc24", "oss", "oss22", "pdc8", "pdc16", "pdc32", "dpdc16"}) {
        INFO("codec " << name);
        const auto encoded = findCodec(name)->encode({mesh, &cut, 4});
        REQUIRE(encoded);
        REQUIRE(encoded->blendText);
        const Mesh decoded = encoded->decode();
        const MeshletMesh& meshlets = encoded->meshlets ? *encoded->meshlets : cut;
        std::vector<uint16_t> tuples(encoded->tuples->size() / sizeof(uint16_t));
        std::memcpy(tuples.data(), encoded->tuples->data(), encoded->tuples->size());
        size_t wrong = 0;
        for (size_t m = 0; m < meshlets.meshlets.size(); ++m)
            for (uint32_t i = 0; i < meshlets.meshlets[m].vertexCount; ++i) {
                const uint32_t vertex = meshlets.vertices[meshlets.meshlets[m].firstVertex + i];
                const std::string text = encoded->blendText(vertex, m);
                INFO(text);
                const size_t place = text.find("tuple ");
                REQUIRE(place != std::string::npos);
                const size_t tuple = std::stoul(text.substr(place + 6)) * 4;
                REQUIRE(tuple + 4 <= tuples.size());
                const std::span<const uint16_t> joints(&tuples[tuple], 4);
                for (int k = 0; k < 4; ++k) {
                    const Influences& own = decoded.influences[vertex];
                    wrong += own.weights[k] > 0 && std::ranges::find(joints, own.joints[k]) == joints.end();
                }
                if (encoded->blendBytes.empty() || encoded->blendBytes[m] == 0) continue;
                wrong += !text.contains(std::format("in {} bits", encoded->blendBytes[m] * 8));
            }
        CHECK(wrong == 0);
    }
    for (const char* name : {"uc", "uc16"}) CHECK(!findCodec(name)->encode({mesh, &cut, 4})->blendText);
}

TEST_CASE("every decoder compiles in every stage and dialect") {
    ShaderLibrary library = testShaders();
    library.files["stand_in.glsl"] = R"(
#include CODEC_FILE
#if STAGE_MESH
layout(local_size_x = 1) in;
layout(triangles, max_vertices = 3, max_primitives = 1) out;
#elif STAGE_COMPUTE
layout(local_size_x = 1) in;
layout(std430, binding = SLOT_SKINNED) writeonly restrict buffer SinkBlock { vec4 sink[]; };
#endif
vec4 use(Vertex v) {
    vec4 sum = vec4(v.position + v.normal, v.uv.x + v.uv.y) + vec4(v.joints0) * v.weights0;
#if INFLUENCES == 8
    sum += vec4(v.joints1) * v.weights1;
#endif
    return sum;
}
#if CODEC_PER_MESHLET
#define LOAD(place) loadMeshletVertex(firstByteOf(place, 2u), 1u, 2u, loadMeshletBlend(0u, 1u))
#else
#define LOAD(place) loadVertex(place, 1u)
#endif
void main() {
#if STAGE_VERTEX
    gl_Position = use(LOAD(7u));
#elif STAGE_COMPUTE
    sink[0] = use(LOAD(gl_GlobalInvocationID.x));
#elif MESH_NV
    gl_MeshVerticesNV[0].gl_Position = use(LOAD(7u));
#else
    gl_MeshVerticesEXT[0].gl_Position = use(LOAD(7u));
#endif
}
)";
    const Mesh mesh = randomMesh(90, 200, 20);
    const MeshletMesh meshlets = cutMeshlets(mesh);
    for (const glsl::Decoder* decoder : glsl::decoders()) {
        const auto encoded = encodeFor(*decoder, mesh, meshlets);
        if (!encoded) continue;
        const Codec* codec = findCodec(decoder->codec);
        Defines defines = {{"CODEC_FILE", std::string("\"") + codec->shader + "\""},
                           {"INFLUENCES", std::to_string(decoder->influences)},
                           {"VERTEX_COUNT", std::to_string(encoded->vertexCount)},
                           {"MESHLET_COUNT", std::to_string(meshlets.meshlets.size())}};
        defines.insert(defines.end(), encoded->defines.begin(), encoded->defines.end());
        for (const Api api : {Api::vulkan, Api::opengl})
            for (const auto& [stage, dialect] :
                 std::initializer_list<std::pair<Stage, MeshDialect>>{{Stage::vertex, MeshDialect::none},
                                                                      {Stage::compute, MeshDialect::none},
                                                                      {Stage::mesh, MeshDialect::ext},
                                                                      {Stage::mesh, MeshDialect::nv}}) {
                const auto text = shaderText(
                    library,
                    {.file = "stand_in.glsl", .stage = stage, .api = api, .dialect = dialect, .defines = defines});
                REQUIRE(text);
                INFO("codec " << decoder->codec << ", " << stageName(stage) << ", api " << static_cast<int>(api));
                CHECK(glslangErrors(*text, api) == "");
            }
    }
}
