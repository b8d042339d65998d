// The decoders of shaders_glsl/codecs/, compiled as C++, against the CPU's readers; and as GLSL in every dialect.
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <nlohmann/json.hpp>

#include "common/codecs/packed.h"
#include "common/codecs/permutation.h"
#include "common/codecs/simplex.h"
#include "tests/cases.h"
#include "tests/codec_test.h"
#include "tests/codecs/glsl_decoders.h"
#include "tests/glslang_check.h"

using namespace skinbench;
using namespace skinbench::test;
using nlohmann::json;

namespace {

// The integers of a define's text: its literals with a suffix, or the whole text.
std::vector<uint32_t> literals(const std::string& text) {
    std::vector<uint32_t> values;
    for (size_t i = 0; i < text.size(); ++i) {
        if (!std::isdigit(static_cast<unsigned char>(text[i]))) continue;
        size_t length = 0;
        const auto value = static_cast<uint32_t>(std::stoul(text.substr(i), &length, 0));
        i += length;
        if (i == text.size() || text[i] == 'u') values.push_back(value);
    }
    return values;
}

template <class Vector>
void setFloats(Vector& vector, const std::vector<uint32_t>& bits) {
    REQUIRE(bits.size() == static_cast<size_t>(Vector::length()));
    for (int i = 0; i < Vector::length(); ++i) vector[i] = std::bit_cast<float>(bits[static_cast<size_t>(i)]);
}

// Hands an encoder's defines to the decoder, those that it was compiled with excepted: they must agree.
void setDefines(const glsl::Decoder& decoder, const EncodedMesh& encoded) {
    glsl::Numbers& n = glsl::numbers;
    n = {};
    n.vertexCount = encoded.vertexCount;
    glsl::lists["SECTIONS"].clear();
    const std::map<std::string, uint32_t*> known = {{"BUFFER_WORDS", &n.bufferWords}, {"TUPLE_COUNT", &n.tupleCount},
                                                    {"MOST_TUPLES", &n.mostTuples},   {"PC_VALUES", &n.values},
                                                    {"OSS_BITS", &n.simplexBits},     {"OSS_POINTS", &n.simplexPoints}};
    const std::map<std::string, uint32_t> compiled = {
        {"VERTEX_BYTES", decoder.vertexBytes}, {"VERTEX_ALIGNMENT", decoder.alignment}, {"PC_BITS", decoder.bits}};
    for (const auto& [name, text] : encoded.defines) {
        INFO("define " << name << " " << text);
        const std::vector<uint32_t> values = literals(text);
        if (name == "POSITION_MIN") {
            setFloats(n.positionMin, values);
        } else if (name == "POSITION_EXTENT") {
            setFloats(n.positionExtent, values);
        } else if (name == "UV_MIN") {
            setFloats(n.uvMin, values);
        } else if (name == "UV_EXTENT") {
            setFloats(n.uvExtent, values);
        } else if (name == "SECTIONS" || name == "PC_EXTRA") {
            glsl::lists[name] = values;
        } else {
            REQUIRE(values.size() == 1);
            REQUIRE((known.contains(name) || compiled.contains(name)));
            if (known.contains(name)) *known.at(name) = values[0];
            if (compiled.contains(name)) CHECK(compiled.at(name) == values[0]);
        }
    }
}

// Binds `copies` copies; all but the last are noise.
void bind(int slot, const Bytes& bytes, uint32_t copies) {
    std::vector<uint32_t>& words = glsl::memory[static_cast<size_t>(slot)];
    words.clear();
    if (!bytes) return;
    REQUIRE(bytes->size() % 4 == 0);
    const size_t count = bytes->size() / 4;
    Random random(91);
    words.resize(count * copies);
    for (uint32_t& word : words) word = static_cast<uint32_t>(random.next());
    if (count > 0) std::memcpy(&words[count * (copies - 1)], bytes->data(), bytes->size());
}

// Bit for bit, but for the weights of oss: the CPU rounds them from double precision.
bool differs(const glsl::Decoded& got, const Mesh& expected, uint32_t v, float tolerance) {
    bool wrong =
        got.position != expected.positions[v] || got.normal != expected.normals[v] || got.uv != expected.uvs[v];
    const Influences& influences = expected.influences[v];
    for (size_t i = 0; i < kMaxInfluences; ++i) {
        wrong |= !(std::abs(got.weights[i] - influences.weights[i]) <= tolerance);
        wrong |= influences.weights[i] == 0 && got.weights[i] != 0;
        wrong |= influences.weights[i] != 0 && got.joints[i] != influences.joints[i];
        wrong |= influences.weights[i] == 0 && influences.joints[i] == kNoJoint && got.joints[i] == kNoJoint;
    }
    return wrong;
}

// Decodes every vertex of the last of `copies` copies as the shader does and counts those that differ from the CPU's.
uint64_t countWrong(const glsl::Decoder& decoder, const EncodedMesh& encoded, const Mesh& expected, uint32_t copies) {
    setDefines(decoder, encoded);
    bind(SLOT_VERTEX, encoded.vertices, copies);
    bind(SLOT_TUPLE, encoded.tuples, copies);
    bind(SLOT_MESHLET_EXTRA, encoded.meshletExtra, copies);
    const float tolerance = std::string(decoder.codec).starts_with("oss") ? 0x1p-24f : 0.0f;
    const uint32_t copy = copies - 1;
    uint64_t wrong = 0;
    if (!encoded.meshlets) {
        for (uint32_t v = 0; v < encoded.vertexCount; ++v)
            wrong += differs(decoder.load(copy * encoded.vertexCount + v, copy, 0, 0), expected, v, tolerance);
        return wrong;
    }
    const MeshletMesh& cut = *encoded.meshlets;
    glsl::numbers.meshletCount = static_cast<uint32_t>(cut.meshlets.size());
    for (uint32_t m = 0; m < cut.meshlets.size(); ++m)
        for (uint32_t i = 0; i < cut.meshlets[m].vertexCount; ++i) {
            const uint32_t v = cut.vertices[cut.meshlets[m].firstVertex + i];
            wrong += differs(decoder.load(copy * encoded.vertexCount + v, copy, m, encoded.blendBytes[m]), expected, v,
                             tolerance);
        }
    return wrong;
}

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
std::set<std::string> checkMesh(const Mesh& mesh, const MeshletMesh& meshlets) {
    std::set<std::string> done;
    for (const glsl::Decoder* decoder : glsl::kDecoders) {
        INFO("codec " << decoder->codec << ", " << decoder->influences << " influences");
        if (mostInfluences(mesh) > decoder->influences) continue;
        const auto encoded = encodeFor(*decoder, mesh, meshlets);
        if (!encoded) continue;
        const Mesh decoded = decodeOnCpu(mesh, *encoded);
        checkSources(mesh, *encoded, decoded);
        glsl::readsOutside = 0;
        CHECK(countWrong(*decoder, *encoded, decoded, 1) == 0);
        CHECK(countWrong(*decoder, *encoded, decoded, 3) == 0);
        CHECK(glsl::readsOutside == 0);
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
            checkHolds(checkMesh(mesh, cutMeshlets(mesh, limits)));
    }
}

TEST_CASE("shader decoders: eight influences") {
    const Mesh mesh = randomMesh(94, 5000, 60, 8);
    const auto done = checkMesh(mesh, cutMeshlets(mesh));
    CHECK(done == std::set<std::string>{"uc", "uc16", "pc", "pc32"});
}

TEST_CASE("shader decoders: degenerate meshes") {
    for (const auto& [name, mesh] : degenerateMeshes()) {
        CAPTURE(name);
        checkHolds(checkMesh(mesh, cutMeshlets(mesh)));
    }
}

TEST_CASE("shader decoders: constant meshlets of one code share vertices and weights") {
    Mesh mesh = randomMesh(95, 600, 40);
    for (size_t v = 0; v < mesh.influences.size(); ++v)
        mesh.influences[v] = cleanInfluences({{1, 0.75 + 1e-5 * static_cast<double>(v % 7)}, {2, 0.25}});
    checkHolds(checkMesh(mesh, cutMeshlets(mesh, {16, 16})));
}

TEST_CASE("shader decoders: more merged tuples than 13 bits count") {
    Mesh mesh = randomMesh(96, 9000, 4);
    for (size_t v = 0; v < mesh.influences.size(); ++v)
        mesh.influences[v] = cleanInfluences({{0, 0.4},
                                              {1, 0.3},
                                              {static_cast<uint16_t>(2 + v % 256), 0.2},
                                              {static_cast<uint16_t>(300 + v / 256), 0.1}});
    const MeshletMesh meshlets = cutMeshlets(mesh);
    checkHolds(checkMesh(mesh, meshlets));
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
            checkHolds(checkMesh(scene->mesh, findBuilder("meshopt")->build(scene->mesh, {})));
        }
        const auto eight = prepareScene(*loaded, {.influences = 8});
        REQUIRE(eight);
        const auto done = checkMesh(eight->mesh, findBuilder("scan")->build(eight->mesh, {}));
        CHECK((done.contains("pc") && done.contains("uc16")));
    }
}

namespace {

// The text's result for one code, in the order of PermutationBlend.
template <class Blend>
PermutationBlend ascending(const PermutationCode& code, const Blend& blend) {
    PermutationBlend result;
    result.tuple = blend.tuple;
    for (int i = 0; i <= code.entries; ++i) result.weights[i] = blend.weights[code.entries - i];
    return result;
}

PermutationBlend decodeAsShader(const PermutationCode& code, uint64_t value) {
    glsl::numbers.values = code.values;
    glsl::lists["PC_EXTRA"].assign(code.extra.begin(), code.extra.begin() + code.entries);
    const glm::uvec2 words(static_cast<uint32_t>(value), static_cast<uint32_t>(value >> 32));
    if (code.entries == 7)
        return code.bits > 32 ? ascending(code, glsl::pc8::decodePermutation(words))
                              : ascending(code, glsl::pc32x8::decodePermutation(words));
    return code.bits > 32 ? ascending(code, glsl::pc64::decodePermutation(words))
                          : ascending(code, glsl::pc4::decodePermutation(words));
}

}  // namespace

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
            wrong += !(decodeAsShader(code, value) == *expected);
        }
        CHECK(taken >= 100'000);
        CHECK(wrong == 0);
    }
}

TEST_CASE("shader decoders: every simplex code") {
    for (const int bits : {8, 16, 22}) {
        const SimplexCode code = *makeSimplexCode(bits);
        glsl::numbers.simplexPoints = static_cast<uint32_t>(code.n);
        float most = 0;
        for (uint32_t value = 0; value < code.count; ++value) {
            const glm::vec4 got = glsl::simplex16::simplexWeights(value);
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
            const auto got = decodeAsShader(code, cells[k + 1] | uint64_t{cells[k + 2]} << 32);
            wrong += got.tuple != cells[k];
            for (size_t i = 0; i < k; ++i)
                wrong +=
                    !(std::abs(got.weights[i] - std::bit_cast<float>(cells[k + 3 + i])) <= (k == 4 ? 2.5e-7f : 5e-7f));
            ++rows;
        }
    }
    const json simplex = json::parse(std::ifstream(folder + "/oss.json"));
    for (const json& config : simplex["configs"]) {
        glsl::numbers.simplexPoints = config["N"].get<uint32_t>();
        for (const json& row : config["rows"]) {
            const auto cells = row.get<std::vector<uint32_t>>();
            const glm::vec4 got = glsl::simplex16::simplexWeights(cells[4]);
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
    for (const char* name : {"oss", "oss22", "pdc8", "pdc16", "pdc32", "dpdc16"}) {
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
    for (const glsl::Decoder* decoder : glsl::kDecoders) names.erase(decoder->codec);
    CHECK(names.empty());
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
    for (const glsl::Decoder* decoder : glsl::kDecoders) {
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
