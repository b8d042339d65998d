// `inspect`: its figures recounted in another way, its JSON, and the command as a user calls it.
#include <algorithm>
#include <cmath>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <nlohmann/json.hpp>

#include "common/report/inspect.h"
#include "tests/apps/program_call.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using Json = nlohmann::ordered_json;

namespace {

Mesh preparedMesh(const Scene& stored, const MeshletRow& row, int influences) {
    auto scene = prepareScene(stored, {influences, row.geometry, row.cacheOrder});
    REQUIRE(scene);
    return std::move(scene->mesh);
}

// Counts meshlet by meshlet with sets.
void recountPlain(const Mesh& mesh, const MeshletRow& row, const MeshletLimits& limits) {
    const MeshletMesh cut = row.builder->build(mesh, limits);
    size_t references = 0, tuples = 0, joints = 0, largest = 0;
    for (const Meshlet& meshlet : cut.meshlets) {
        std::set<std::array<uint16_t, kMaxInfluences>> ofTuples;
        std::set<uint16_t> ofJoints;
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
            const Influences& influences = mesh.influences[cut.vertices[meshlet.firstVertex + i]];
            ofTuples.insert(influences.joints);
            for (uint16_t joint : influences.joints)
                if (joint != kNoJoint) ofJoints.insert(joint);
        }
        references += meshlet.vertexCount;
        tuples += ofTuples.size();
        joints += ofJoints.size();
        largest = std::max(largest, ofJoints.size());
    }
    const auto count = static_cast<double>(cut.meshlets.size());
    CHECK(row.stats.meshlets == cut.meshlets.size());
    CHECK_THAT(row.stats.meanVertices, WithinRel(static_cast<double>(references) / count, 1e-12));
    CHECK_THAT(row.stats.meanTriangles, WithinRel(static_cast<double>(mesh.indices.size() / 3) / count, 1e-12));
    CHECK_THAT(row.stats.vertexFill, WithinRel(row.stats.meanVertices / limits.vertices, 1e-12));
    CHECK_THAT(row.stats.triangleFill, WithinRel(row.stats.meanTriangles / limits.triangles, 1e-12));
    CHECK_THAT(row.stats.vertexReuse,
               WithinRel(static_cast<double>(references) / static_cast<double>(mesh.positions.size()), 1e-12));
    CHECK_THAT(row.stats.meanUniqueTuples, WithinRel(static_cast<double>(tuples) / count, 1e-12));
    CHECK_THAT(row.joints.mean, WithinRel(static_cast<double>(joints) / count, 1e-12));
    CHECK(row.joints.largest == largest);
}

void recount(const Scene& stored, InspectSettings settings) {
    settings.all = true;
    const auto inspection = inspectScene(stored, settings);
    REQUIRE(inspection);
    CHECK(inspection->meshlets.size() == 4 * builders().size() * (2 + settings.keys.size()));
    const MeshletRow* plain = nullptr;
    for (const MeshletRow& row : inspection->meshlets) {
        INFO(geometryName(row.geometry) << (row.cacheOrder ? " cache " : " file ") << row.builder->name << " grouping "
                                        << (row.grouping ? static_cast<int>(*row.grouping) : -1));
        const Mesh mesh = preparedMesh(stored, row, settings.influences);
        CHECK(row.vertices == mesh.positions.size());
        if (!row.grouping) {
            plain = &row;
            recountPlain(mesh, row, settings.limits);
            continue;
        }
        REQUIRE(plain);
        CHECK(row.key.has_value() == (row.grouping == CiGrouping::triangles));
        const CommonInfluenceCut cut =
            buildCommonInfluences(mesh, {row.builder, settings.limits, settings.influences, *row.grouping,
                                         row.key.value_or(CiKey::set), settings.minVertices});
        CHECK(row.stats.meshlets == cut.meshlets.meshlets.size());
        CHECK(row.commonMeshlets == cut.joints.size());
        CHECK(row.records == cut.mesh.positions.size());
        CHECK(row.commonRecords == cut.commonRecords);
        CHECK(row.remainderTriangles + cut.commonTriangles == mesh.indices.size() / 3);
        CHECK_THAT(row.stats.meanTriangles * row.stats.meshlets,
                   WithinRel(static_cast<double>(mesh.indices.size() / 3), 1e-12));
        CHECK_THAT(row.stats.vertexReuse * row.vertices,
                   WithinRel(static_cast<double>(cut.meshlets.vertices.size()), 1e-12));
        if (row.grouping != CiGrouping::meshlets) continue;
        CHECK(row.stats.meshlets == plain->stats.meshlets);
        CHECK(row.joints.largest == plain->joints.largest);
        CHECK(row.stats.meanUniqueTuples == plain->stats.meanUniqueTuples);
    }
}

// An error of 0 is that of a codec that gives back what it was given.
void checkExact(const CodecRow& row, const Mesh& mesh, int influences) {
    const bool weights = row.errors.weight.max == 0, normals = row.errors.normal.max == 0;
    if (!weights && !normals) return;
    const MeshletMesh cut = row.builder->build(mesh, InspectSettings().limits);
    const auto encoded = row.codec->encode({mesh, &cut, influences});
    REQUIRE(encoded);
    if (!encoded->decode) return;
    const Mesh decoded = encoded->decode();
    size_t wrong = 0;
    for (size_t v = 0; v < decoded.normals.size(); ++v) {
        const size_t source = encoded->sources.empty() ? v : encoded->sources[v];
        wrong += weights && decoded.influences[v].weights != mesh.influences[source].weights;
        wrong += normals && decoded.normals[v] != mesh.normals[source];
    }
    CHECK(wrong == 0);
}

void checkCodecRow(const CodecRow& row, const Mesh& mesh, int influences) {
    const auto vertices = static_cast<double>(mesh.positions.size());
    CHECK(row.vertices >= mesh.positions.size());
    CHECK(row.vertexBytes > 0);
    CHECK(row.indexBytes.has_value() == !row.codec->needsMeshlets);
    if (row.indexBytes) CHECK(*row.indexBytes == mesh.indices.size() * 4);
    for (const MeshletLayout& layout : meshletLayouts()) CHECK(row.dataBytes.at(layout.name) > 0);
    CHECK(row.descriptorBytes.at("redirect") % 8 == 0);
    const std::string name = row.codec->name;
    if (name == "uc") {
        CHECK(row.vertexBytes == mesh.positions.size() * (influences == 4 ? 64 : 96));
        CHECK(row.blendBytesPerVertex == (influences == 4 ? 32 : 64));
        CHECK(row.errors.weight.max == 0);
        CHECK(row.errors.position.max == 0);
        return;
    }
    CHECK(row.errors.weight.mean <= row.errors.weight.max);
    if (name == "uc16" || name == "oss" || name == "pc") CHECK(row.errors.weight.max > 0);
    CHECK(row.errors.weight.max < 0.08);
    checkExact(row, mesh, influences);
    CHECK(row.errors.position.max <= std::sqrt(3.0) / 2 / 65535 * 1.05);
    CHECK(row.errors.uv.max <= std::sqrt(2.0) / 2 / 65535 * 1.05);
    CHECK(row.errors.normal.max < 1e-4);
    CHECK(row.blendBytesPerVertex > 0);
    if (influences == 4 && (name == "oss" || name == "pc"))
        CHECK_THAT(row.blendBytesPerVertex,
                   WithinAbs(4 + static_cast<double>(row.tupleBytes.value_or(0)) / vertices, 4 / vertices));
}

std::set<std::string> keysOf(const Json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

}  // namespace

TEST_CASE("meshlet statistics of inspect are those of a recount") {
    recount(tinyScene(), {{16, 20}, 8, {CiKey::set}, 4});
    for (const char* name : {"biped", "robot"}) {
        const auto scene = makeBuiltin(name, 2500);
        REQUIRE(scene);
        recount(*scene, {});
    }
}

TEST_CASE("meshlet statistics of inspect on models are those of a recount") {
    if (modelFolder().empty()) SKIP("no models on this machine");
    for (const char* name : {"fox.glb", "cesium_man.glb"}) {
        const auto scene = loadScene(modelFolder() + "/" + name);
        REQUIRE(scene);
        INFO(name);
        recount(*scene, {});
    }
}

TEST_CASE("joints of a meshlet are counted once, and only with a weight") {
    Mesh mesh;
    mesh.positions.resize(4);
    mesh.influences.resize(4);
    for (auto& influences : mesh.influences) influences.joints.fill(kNoJoint);
    auto set = [&](size_t v, uint16_t a, uint16_t b, float weight) {
        mesh.influences[v].joints[0] = a;
        mesh.influences[v].joints[1] = b;
        mesh.influences[v].weights = {1 - weight, weight};
    };
    set(0, 1, 2, 0.5f);
    set(1, 2, 1, 0.25f);
    set(2, 3, 9, 0);
    set(3, 4, 5, 0.5f);
    const MeshletMesh cut{{}, {{0, 0, 3, 1}, {3, 1, 2, 1}}, {0, 1, 2, 3, 0}, {{0, 1, 2}, {0, 1, 1}}};
    const JointSpread spread = jointSpread(mesh, cut);
    CHECK(spread.mean == 3.5);  // {1, 2, 3} and {1, 2, 4, 5}
    CHECK(spread.largest == 4);
    CHECK(jointSpread(mesh, {}).mean == 0);
}

TEST_CASE("codec rows and attribute errors") {
    const auto stored = makeBuiltin("creature", 3000);
    REQUIRE(stored);
    for (int influences : {4, 8}) {
        InspectSettings settings;
        settings.influences = influences;
        settings.all = true;
        const auto inspection = inspectScene(*stored, settings);
        REQUIRE(inspection);
        CHECK(inspection->codecs.size() == 2 * builders().size() * codecs().size());
        for (const CodecRow& row : inspection->codecs) {
            INFO(row.codec->name << ' ' << geometryName(row.geometry) << ' ' << row.builder->name << ' ' << row.reason);
            const Mesh mesh = preparedMesh(*stored, {row.geometry, true}, influences);
            if (row.reason.empty()) {
                checkCodecRow(row, mesh, influences);
                continue;
            }
            const MeshletMesh cut = row.builder->build(mesh, settings.limits);
            CHECK(!row.codec->encode({mesh, &cut, influences}));
            CHECK(row.vertexBytes == 0);
            CHECK(row.errors.weight.max == 0);
        }
        const AttributeErrors& errors = inspection->attributes;
        for (int bits : {8, 10, 16, 21}) {
            const double step = 1.0 / (std::pow(2.0, bits) - 1);
            CHECK(errors.position.at(bits).max <= std::sqrt(3.0) / 2 * step * 1.05);
            CHECK(errors.position.at(bits).mean > 0.3 * step);
        }
        CHECK(errors.octahedral.mean < errors.spherical.mean);
        CHECK(errors.spherical.mean < errors.euclidean.mean);
    }
}

TEST_CASE("inspect's JSON has the keys of its schema") {
    InspectSettings settings;
    settings.all = true;
    const auto inspection = inspectScene(tinyScene(), settings);
    REQUIRE(inspection);
    const Json json = inspectJson(*inspection);
    CHECK(json["schema"] == "skinbench-inspect/1");
    CHECK(keysOf(json) == std::set<std::string>{"schema", "scene", "settings", "warnings", "meshlets", "attributes",
                                                "codecs", "encode_all"});
    CHECK(keysOf(json["scene"]) == std::set<std::string>{"name", "vertices", "triangles", "joints", "unique_tuples",
                                                         "mean_influences", "max_influences"});
    for (const Json& row : json["meshlets"]) {
        CHECK(keysOf(row) == std::set<std::string>{"geometry", "cache_order", "builder", "ci_grouping", "ci_key",
                                                   "vertices", "meshlets", "mean_vertices", "mean_triangles",
                                                   "vertex_fill", "triangle_fill", "vertex_reuse", "mean_unique_tuples",
                                                   "mean_joints", "max_joints", "common_meshlets",
                                                   "remainder_triangles", "records", "common_records"});
        CHECK(row["records"].is_null() == row["ci_grouping"].is_null());
    }
    for (const Json& row : json["codecs"]) {
        CHECK(keysOf(row) == std::set<std::string>{"codec", "geometry", "builder", "reason", "vertices", "memory_bytes",
                                                   "bytes_per_vertex_blend", "max_weight_error", "mean_weight_error",
                                                   "position_error", "normal_error", "uv_error", "encode_ms"});
        CHECK(row["memory_bytes"].is_null() == row["reason"].is_string());
        CHECK(row["encode_ms"].is_null() == row["reason"].is_string());
        if (row["reason"].is_null()) CHECK(row["memory_bytes"]["meshlet"] > 0);
    }
    CHECK(keysOf(json["attributes"]["position_error"]) == std::set<std::string>{"8", "10", "16", "21"});
    CHECK(json["encode_all"].size() == 2 * builders().size());
    for (const Json& total : json["encode_all"]) {
        CHECK(keysOf(total) == std::set<std::string>{"geometry", "builder", "codecs", "encode_ms"});
        size_t encoded = 0;
        double sum = 0;
        for (const Json& row : json["codecs"]) {
            if (row["geometry"] != total["geometry"] || row["builder"] != total["builder"]) continue;
            if (row["encode_ms"].is_null()) continue;
            CHECK(row["encode_ms"] > 0.0);
            sum += row["encode_ms"].get<double>();
            ++encoded;
        }
        CHECK(encoded > 0);
        CHECK(total["codecs"] == encoded);
        CHECK_THAT(total["encode_ms"].get<double>(), WithinRel(sum, 1e-12));
    }
}

TEST_CASE("the command inspect") {
    const program::Outcome drawn = program::call({"inspect", "builtin:robot:2500"});
    CHECK(drawn.status == 0);
    CHECK_THAT(drawn.out, ContainsSubstring("welded   cache  meshopt"));
    CHECK(drawn.out.find("unwelded") == std::string::npos);
    CHECK(drawn.out.find(" file ") == std::string::npos);
    const program::Outcome table = program::call({"inspect", "builtin:robot:2500", "--ci-min", "16", "--all"});
    CHECK(table.status == 0);
    for (const char* part :
         {"triangles/fit", "triangles/ordered", "unwelded", "octahedral", "uc", "encode ms", "encode all"})
        CHECK_THAT(table.out, ContainsSubstring(part));
    const program::Outcome json = program::call({"inspect", "builtin:robot:2500", "--json", "--meshlets", "32/40",
                                                 "--influences", "8", "--ci-key", "set", "--ci-min", "7"});
    CHECK(json.status == 0);
    const Json tree = Json::parse(json.out);
    CHECK(tree["settings"] == Json{{"meshlet_vertices", 32},
                                   {"meshlet_triangles", 40},
                                   {"influences", 8},
                                   {"ci_min", 7},
                                   {"ci_keys", {"set"}}});
    for (const Json& row : tree["meshlets"]) CHECK(row["mean_vertices"] <= 32.0);
}

TEST_CASE("inspect's help explains the columns that it prints") {
    const program::Outcome help = program::call({"inspect", "--help"});
    CHECK(help.status == 0);
    for (const char* column : {"v fill, t fill", "reuse", "joints, most", "records", "remainder", "blend"})
        CHECK_THAT(help.out, Catch::Matchers::ContainsSubstring(column));
}

TEST_CASE("inspect refuses bad input with one line") {
    fixture::writeText("broken.gltf", "{\"asset\": {");
    const std::vector<std::pair<program::Words, const char*>> calls = {
        {{"missing.glb"}, "there is no such file"},
        {{"broken.gltf"}, "JSON is broken"},
        {{"builtin:cat"}, "there is no built-in scene"},
        {{"builtin:robot:2500", "--meshlets", "2/124"}, "must lie between"},
        {{"builtin:robot:2500", "--meshlets", "many"}, "many"},
        {{"builtin:robot:2500", "--influences", "5"}, "there is 4, 8"},
        {{"builtin:robot:2500", "--ci-key", "union"}, "union"},
        {{"builtin:robot:2500", "--ci-min", "-1"}, "ci-min"},
        {{}, "SCENE is required"}};
    for (const auto& [words, part] : calls) {
        program::Words line = {"inspect"};
        line.insert(line.end(), words.begin(), words.end());
        const program::Outcome outcome = program::call(line);
        INFO(part << " in: " << outcome.err);
        CHECK(outcome.status == 2);
        CHECK(outcome.out == "");
        REQUIRE(program::linesOf(outcome.err).size() == 1);
        CHECK_THAT(outcome.err, ContainsSubstring(part));
    }
}
