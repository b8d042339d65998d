// The table of axes: no field of a case without a row, no row that something forgets. No driver takes part.
#include <algorithm>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <nlohmann/json.hpp>

#include "common/cases/axes.h"
#include "common/report/report.h"
#include "tests/cases.h"

using namespace skinbench;

namespace {

struct Anything {
    template <class T>
    operator T() const;
};

// How many members an aggregate has.
template <class T, class... Members>
constexpr size_t membersOf() {
    if constexpr (requires { T{Members{}..., Anything{}}; })
        return membersOf<T, Members..., Anything>();
    else
        return sizeof...(Members);
}

// Words that together change all that the axis may change.
std::vector<std::string> telling(const Axis& axis) {
    if (axis.name == "compute") return {"staged+previous+tangents+early-exit+packed+half-rate"};
    if (!axis.words.empty()) return axis.words;
    return {"7"};
}

// Adds a row for as long as it lives.
struct ExtraAxis {
    explicit ExtraAxis(Axis axis) { axisTable().push_back(std::move(axis)); }
    ExtraAxis(const ExtraAxis&) = delete;
    ~ExtraAxis() { axisTable().pop_back(); }
};

}  // namespace

// One axis for one field, but for the meshlet limits and the flags of `compute`.
TEST_CASE("every field of a case has an axis, and every axis a field of its own") {
    constexpr size_t groups = 4;  // MeshletLimits, MeshShape, CommonInfluences, ComputeOptions
    constexpr size_t fields = membersOf<Case>() - groups + membersOf<MeshletLimits>() + membersOf<MeshShape>() +
                              membersOf<CommonInfluences>() + membersOf<ComputeOptions>();
    size_t covered = 0;
    for (const Axis& axis : axes()) {
        const bool limits = axis.name == "meshlet_limits";
        covered += axis.name == "compute" ? membersOf<ComputeOptions>() : limits ? membersOf<MeshletLimits>() : 1;
        bool changes = false;
        for (const std::string& word : telling(axis)) {
            Case c;
            INFO(axis.name << " " << word);
            REQUIRE(axis.set(c, word));
            for (const Axis& other : axes())
                if (other.name != axis.name) CHECK(other.get(c) == other.get({}));
            changes = changes || axis.get(c) != axis.get({});
        }
        INFO(axis.name);
        CHECK(changes);
    }
    CHECK(covered == fields);
}

TEST_CASE("axes have names of their own, and their words lead there and back") {
    std::set<std::string> names, options, parts;
    for (const Axis& axis : axes()) {
        INFO(axis.name);
        CHECK(names.insert(axis.name).second);
        CHECK(options.insert(axis.option.name).second);
        for (const std::string& alias : axis.option.aliases) CHECK(options.insert(alias).second);
        CHECK((axis.beside.empty() || names.contains(axis.beside)));
        CHECK(!axis.set(*std::make_unique<Case>(), "no such word"));
        for (const std::string& word : axis.words) {
            Case c;
            REQUIRE(axis.set(c, word));
            Case again;
            REQUIRE(axis.set(again, axis.get(c)));
            CHECK(axis.get(again) == axis.get(c));
            if (axis.inPath || axis.idPart(c).empty() || axis.name == "meshlet_limits") continue;
            CHECK(parts.insert(axis.idPart(c)).second);
            Case read;
            CHECK(axis.readIdPart(read, axis.idPart(c)));
            CHECK(axis.get(read) == axis.get(c));
        }
    }
}

// Its value lies in a field that has an axis of its own.
TEST_CASE("an axis that is added is in the id, the file, the CSV, the keys and the crossing") {
    static bool on = false;
    Axis axis;
    axis.name = "extra_speed";
    axis.option = {"extra-speed", {}, ""};
    axis.changes = Changes::records;
    axis.words = {"slow", "fast"};
    axis.usual = "slow";
    axis.applies = [](const Case& c) { return c.variant->skins; };
    axis.get = [](const Case& c) { return std::string(on && c.groupSize == 99 ? "fast" : "slow"); };
    axis.set = [](Case& c, const std::string& word) {
        if (word != "slow" && word != "fast") return Result<void>(inputError("no speed '" + word + "'"));
        c.groupSize = word == "fast" ? 99 : 32;
        return Result<void>{};
    };
    axis.unnamed = [](const Case&) { return std::vector<std::string>{"slow"}; };
    axis.idPart = [get = axis.get](const Case& c) { return get(c) == "fast" ? "extra-fast" : ""; };
    axis.readIdPart = [](Case& c, std::string_view part) {
        if (part == "extra-fast") c.groupSize = 99;
        return part == "extra-fast";
    };
    const ExtraAxis added(axis);
    on = true;
    const auto crossed =
        crossCases({{"route", {"vk-ext"}}, {"variant", {"none", "mesh"}}, {"extra_speed", {"slow", "fast"}}});
    REQUIRE(crossed);
    REQUIRE(crossed->size() == 3);
    const Case &none = crossed->at(0), &slow = crossed->at(1), &fast = crossed->at(2);
    CHECK(caseId(none) == "vk-ext/none/uc/meshopt/redirect");
    CHECK(caseId(slow) == "vk-ext/mesh/uc/meshopt/redirect");
    CHECK(caseId(fast) == "vk-ext/mesh/uc/meshopt/redirect+group-99+extra-fast");
    const auto parsed = parseCaseId(caseId(fast));
    REQUIRE(parsed);
    CHECK(caseId(*parsed) == caseId(fast));
    CHECK(keyOf(slow, Changes::meshlets) == keyOf(fast, Changes::meshlets));
    for (Changes upTo : {Changes::records, Changes::encoding, Changes::plan, Changes::raster})
        CHECK(keyOf(slow, upTo) != keyOf(fast, upTo));

    std::vector<CaseResult> results(3);
    for (size_t i = 0; i < 3; ++i) {
        results[i].theCase = crossed->at(i);
        results[i].id = caseId(crossed->at(i));
    }
    const nlohmann::ordered_json json = resultsJson(hostContext(), results);
    CHECK(!json["cases"][0]["options"].contains("extra_speed"));
    CHECK(json["cases"][1]["options"]["extra_speed"] == "slow");
    CHECK(json["cases"][2]["options"]["extra_speed"] == "fast");
    const auto& rows = json["axes"];
    CHECK(std::ranges::any_of(rows, [](const auto& row) {
        return row["name"] == "extra_speed" && row["option"] == "--extra-speed" && row["values"].size() == 2;
    }));
    const std::string csv = resultsCsv(json);
    CHECK(csv.substr(0, csv.find('\n')).find(",extra_speed,") != std::string::npos);
    CHECK(csv.find(",fast,") != std::string::npos);
    CHECK(reportHtml({json}).find("{\"name\":\"extra_speed\",\"option\":\"--extra-speed\"") != std::string::npos);
    on = false;
}

TEST_CASE("keys differ where what they stand for differs, and only there") {
    auto key = [](const char* id, Changes upTo) {
        const auto c = parseCaseId(id);
        INFO(id);
        REQUIRE(c);
        return keyOf(*c, upTo);
    };
    constexpr auto meshlets = Changes::meshlets, records = Changes::records, encoding = Changes::encoding;
    const char *mesh = "vk-ext/mesh/uc/meshopt/redirect", *scan = "vk-ext/mesh/uc/scan/redirect";
    CHECK(key(mesh, meshlets) != key(scan, meshlets));
    CHECK(key(mesh, meshlets) != key("vk-ext/mesh/uc/meshopt/redirect+64-126", meshlets));
    CHECK(key(mesh, meshlets) == key("gl-nv/none/pc/meshopt/fixed+discard", meshlets));
    // Plain vertices are encoded once, whatever cuts them.
    CHECK(key(mesh, encoding) == key(scan, encoding));
    CHECK(key(mesh, encoding) == key("vk/vertex/uc+pull", encoding));
    CHECK(key("vk-ext/mesh/pdc8/meshopt/redirect", encoding) != key("vk-ext/mesh/pdc8/scan/redirect", encoding));
    CHECK(key("vk-ext/mesh/uc/meshopt/redirect+ordered-records", records) !=
          key("vk-ext/mesh/uc/scan/redirect+ordered-records", records));
    CHECK(key("vk-ext/mesh-ci/uc/meshopt/redirect", records) !=
          key("vk-ext/mesh-ci/uc/meshopt/redirect+ci-min-7", records));
    CHECK(key("vk-ext/mesh-ci/uc/meshopt/redirect", records) == key("vk-ext/mesh-ci/uc/meshopt/redirect+fat", records));
    CHECK(key("vk-ext/mesh-ci/uc/meshopt/redirect", encoding) !=
          key("vk-ext/mesh-ci/uc/meshopt/redirect+fat", encoding));
    CHECK(key("vk/palette/uc+slots-20", records) != key("vk/palette/uc+slots-24", records));
    CHECK(key(mesh, encoding) != key("vk-ext/mesh/uc/meshopt/redirect+joints-staged", encoding));
    CHECK(key(mesh, encoding) != key("vk-ext/mesh/uc/meshopt/redirect+8-influences", encoding));
    CHECK(key("vk/compute/uc", Changes::plan) == key("vk/compute/uc+discard", Changes::plan));
    CHECK(key("vk/compute/uc", Changes::plan) != key("gl/compute/uc", Changes::plan));
}

TEST_CASE("the limit of a case keeps what its draws are made of") {
    auto limit = [](const char* id) {
        const auto found = limitCase(*parseCaseId(id));
        return found ? caseId(*found) : "none";
    };
    CHECK(limit("vk/vertex/uc+8-influences+batched+keep-back-faces+discard") ==
          "vk/none/ids+8-influences+pull+batched+keep-back-faces+discard");
    CHECK(limit("gl/compute/pc+staged") == "gl/none/ids+pull");
    CHECK(limit("vk/compute/uc+no-fragments+4-views") == "vk/none/ids+pull+no-fragments+4-views");
    CHECK(limit("vk/palette/uc+slots-20") == "vk/none/ids+pull");
    CHECK(limit("vk-nv/mesh-ci/uc/scan/fixed+64-84+group-64+unpacked-writes+fat+cull-compact+no-fragments") ==
          "vk-nv/none/ids/scan/fixed+64-84+group-64+unpacked-writes+ordered-records+no-fragments");
    CHECK(limit("cpu/cpu/uc") == "none");
    CHECK(limit("vk/cpu/uc") == "none");
    CHECK(limit("vk/compute-cull/uc") == "none");
    CHECK(limit("vk/vertex/uc+prepass") == "none");
}

TEST_CASE("words that no case has are reported with what they need") {
    const auto reasonsOf = [](const AxisWords& words) {
        const auto cases = crossCases(words);
        REQUIRE(cases);
        std::string text;
        for (const Unused& unused : unusedWords(words, *cases)) text += unused.reason + "\n";
        return text;
    };
    CHECK(reasonsOf({{"route", {"vk", "gl"}}, {"variant", {"vertex", "compute", "mesh"}}}) ==
          "mesh needs vk-ext, vk-nv, gl-ext or gl-nv\n");
    CHECK(reasonsOf({{"route", {"vk", "cpu"}}, {"variant", {"vertex"}}}) == "cpu needs the variant cpu\n");
    CHECK(reasonsOf({{"route", {"vk"}}, {"builder", {"scan"}}, {"influences", {"4", "8"}}}) ==
          "--builders needs vk-ext, vk-nv, gl-ext or gl-nv\n");
    CHECK(reasonsOf({{"route", {"vk-ext"}}, {"variant", {"mesh"}}, {"ci_min", {"3"}}}) ==
          "--ci-min needs the variant mesh-ci\n");
    CHECK(reasonsOf({{"route", {"vk-ext"}}, {"index_writes", {"single"}}}) == "--index-writes needs vk-nv or gl-nv\n");
    CHECK(reasonsOf({{"route", {"vk-ext"}}, {"exchange", {"shared"}}}) ==
          "--exchange means nothing beside --cull off\n");
    // A word that fewer routes have than others of its axis.
    CHECK(reasonsOf({{"route", {"cpu"}}, {"queues", {"async"}}}) == "--queues async needs vk, vk-ext or vk-nv\n");
    CHECK(reasonsOf({{"route", {"cpu"}}, {"queues", {"one"}}}) ==
          "--queues needs vk, vk-ext, vk-nv, gl, gl-ext or gl-nv\n");
    CHECK(reasonsOf({{"route", {"gl"}}, {"variant", {"vertex"}}, {"queues", {"one", "async"}}}) ==
          "--queues needs the variant compute, compute-cull or compute-mesh\n"
          "--queues async needs vk, vk-ext or vk-nv\n");
    CHECK(reasonsOf({{"route", {"vk"}}, {"variant", {"vertex"}}, {"cluster_cull", {"off", "list", "task"}}}) ==
          "--cluster-cull needs the variant compute-cull, mesh, mesh-ci or compute-mesh\n"
          "--cluster-cull task needs vk-ext, vk-nv, gl-ext or gl-nv\n");
    CHECK(reasonsOf({{"route", {"gl"}}, {"cull", {"primitive"}}}) == "--cull primitive needs vk-ext or gl-ext\n");
    CHECK(reasonsOf({{"route", {"cpu"}}, {"zero_weights", {"count"}}}) ==
          "--zero-weights count needs vk-ext, vk-nv, gl-ext or gl-nv\n");
    CHECK(reasonsOf({{"meshlet_limits", {"64/124", "meshopt"}}, {"cull", {"compact", "off"}}}).empty());
    CHECK(reasonsOf({}).empty());
}

TEST_CASE("cases do the same work when they draw the same, however they skin") {
    const auto caseOf = [](const char* id) { return parseCaseId(id).value(); };
    CHECK(sameWork(caseOf("vk/vertex/uc"), caseOf("gl-nv/mesh/pc/meshopt/redirect+cull-compact")));
    for (const char* other : {"vk/vertex/uc+discard", "vk/vertex/uc+8-influences", "vk/vertex/uc+prepass",
                              "vk/vertex/uc+keep-back-faces", "vk/vertex/uc+2-views"})
        CHECK(!sameWork(caseOf("vk/vertex/uc"), caseOf(other)));
}
