// Result files that are read: older ones are completed, damaged ones refused.
#include <algorithm>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "tests/report/sample_results.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("a result file is read back as it was written") {
    const Json json = sample();
    const std::string path = fixture::writeText("results.json", json.dump(1));
    const auto loaded = loadResults(path);
    REQUIRE(loaded);
    CHECK(*loaded == json);
    CHECK(resultsCsv(*loaded) == resultsCsv(json));
}

TEST_CASE("a file of an older version is completed when it is read") {
    const Json json = sample();
    Json older = json;
    older.erase("axes");
    for (Json& device : older["devices"])
        for (const char* key : {"routes", "label", "uuid"}) device.erase(key);
    for (Json& row : older["cases"]) {
        row.erase("scenario");
        row["options"].erase("meshlet_limits");
    }
    older["cases"][0]["id"] = json["cases"][0]["id"].get<std::string>() + "+again";
    older["cases"][1]["id"] = "no such case";
    const auto loaded = loadResults(fixture::writeText("older.json", older.dump()));
    REQUIRE(loaded);
    CHECK((*loaded)["axes"] == json["axes"]);
    CHECK((*loaded)["devices"][0]["routes"] == Json{"vk", "vk-ext", "vk-nv"});
    CHECK((*loaded)["devices"][1]["routes"] == json["devices"][1]["routes"]);
    CHECK((*loaded)["devices"][1]["label"] == "Real GPU");
    CHECK((*loaded)["devices"][1]["uuid"].is_null());
    for (size_t i : {0, 2, 3, 4}) {
        CHECK(nlohmann::json((*loaded)["cases"][i]["options"]) == nlohmann::json(json["cases"][i]["options"]));
        CHECK((*loaded)["cases"][i]["scenario"] == json["cases"][i]["scenario"]);
    }
    CHECK((*loaded)["cases"][1]["options"] == older["cases"][1]["options"]);
    CHECK(isSoftware(*loaded, (*loaded)["cases"][0]));
    CHECK(!isSoftware(*loaded, (*loaded)["cases"][1]));
    CHECK(!isSoftwareRoute(*loaded, "cpu"));
    CHECK(!isSoftwareRoute(*loaded, "a route of tomorrow"));
}

TEST_CASE("a file from before there was a choice loaded zero weights, and wrote vertices last") {
    std::vector<CaseResult> results(1);
    results[0].theCase = makeCase("vk-ext", "mesh");
    results[0].theCase.cull = Cull::compact;
    results[0].id = caseId(results[0].theCase);
    Json older = resultsJson(hostContext(), results);
    const std::vector<std::string> later = {"zero_weights", "vertex_writes"};
    Json axes = Json::array();
    for (const Json& axis : older["axes"])
        if (std::ranges::find(later, axis["name"].get<std::string>()) == later.end()) axes.push_back(axis);
    older["axes"] = axes;
    Json& options = older["cases"][0]["options"];
    for (const std::string& name : later) CHECK(options.erase(name) == 1);
    const auto loaded = loadResults(fixture::writeText("older.json", older.dump()));
    REQUIRE(loaded);
    CHECK((*loaded)["cases"][0]["options"]["zero_weights"] == "load");
    CHECK((*loaded)["cases"][0]["options"]["vertex_writes"] == "last");
    CHECK((*loaded)["axes"].size() == axes.size() + 2);
}

TEST_CASE("what is no result file is told with its path") {
    auto refused = [](const std::string& path, const char* why) {
        const auto loaded = loadResults(path);
        INFO(why);
        REQUIRE(!loaded);
        CHECK(loaded.error().fault == Fault::input);
        CHECK(loaded.error().text.starts_with(path + ": "));
        CHECK_THAT(loaded.error().text, ContainsSubstring(why));
    };
    refused((fixture::temporaryFolder() / "nothing.json").string(), "No such file");
    const auto folder = fixture::temporaryFolder() / "a_folder";
    std::filesystem::create_directories(folder);
    refused(folder.string(), "is a folder without a results.json");
    fixture::writeText("a_folder/results.json", sample().dump());
    CHECK(loadResults(folder.string()).has_value());
    std::filesystem::remove(folder / "results.json");
    refused(fixture::writeText("empty.json", ""), "is not JSON");
    refused(fixture::writeText("broken.json", sample().dump().substr(0, 300)), "is not JSON");
    refused(fixture::writeText("array.json", "[1, 2]"), "schema is not skinbench-results/1");
    refused(fixture::writeText("number.json", "7"), "schema is not");
    refused(fixture::writeText("schema.json", "{\"schema\": \"skinbench-results/2\"}"), "schema is not");
    refused(fixture::writeText("number_schema.json", "{\"schema\": 1}"), "schema is not");
    for (const char* key : {"tool", "host", "devices", "scene", "settings", "cases"}) {
        Json json = sample();
        json.erase(key);
        refused(fixture::writeText("part.json", json.dump()), "is not a whole result file");
        json[key] = 5;
        refused(fixture::writeText("kind.json", json.dump()), "is not a whole result file");
    }
    for (const char* key :
         {"id", "route", "variant", "status", "reason", "raster", "gpu_ms", "passes_ms", "memory_bytes", "accuracy"}) {
        Json json = sample();
        json["cases"][1].erase(key);
        refused(fixture::writeText("case.json", json.dump()), key);
    }
    Json json = sample();
    json["cases"][1] = "text";
    refused(fixture::writeText("text_case.json", json.dump()), "entry 1 of 'cases' lacks the key 'id'");
    json = sample();
    json["devices"][0] = 5;
    refused(fixture::writeText("device.json", json.dump()), "entry 0 of 'devices' lacks");
    for (const auto& [group, key] : {std::pair{"scene", "mean_influences"}, {"settings", "copies"}, {"host", "cpu"}}) {
        json = sample();
        json[group].erase(key);
        refused(fixture::writeText("group.json", json.dump()), key);
    }
    for (const auto& [group, key] : {std::pair{"gpu_ms", "median"}, {"accuracy", "max_position_error"}}) {
        json = sample();
        json["cases"][0][group].erase(key);
        refused(fixture::writeText("figure.json", json.dump()), key);
        json["cases"][0][group] = 5;
        refused(fixture::writeText("figure.json", json.dump()), group);
    }
}

TEST_CASE("a value of the wrong kind is named with file, case and key") {
    auto refused = [](const char* pointer, const Json& value, const std::string& message) {
        Json json = sample();
        json[nlohmann::json_pointer<std::string>(pointer)] = value;
        const std::string path = fixture::writeText("wrong.json", json.dump());
        const auto loaded = loadResults(path);
        INFO(pointer);
        REQUIRE(!loaded);
        CHECK(loaded.error().text == path + ": " + message);
    };
    const std::string id = sample()["cases"][0]["id"];
    refused("/cases/0/gpu_ms/median", "fast", "case " + id + ": 'gpu_ms': 'median' is \"fast\", not a number");
    refused("/cases/0/gpu_ms/samples", {1, "2"},
            "case " + id + ": 'gpu_ms': 'samples' is [1,\"2\"], not a list of numbers");
    refused("/cases/0/status", 4, "case " + id + ": 'status' is 4, not a text");
    refused("/cases/0/id", 4, "entry 0 of 'cases': 'id' is 4, not a text");
    refused("/devices/0/software", "no", "entry 0 of 'devices': 'software' is \"no\", not true or false");
    refused("/scene/vertices", {}, "is not a whole result file: 'scene': 'vertices' is null, not a number");
    refused("/noise_floor", "low", "the file: 'noise_floor' is \"low\", not a number");
    refused("/warnings", {5}, "the file: 'warnings' is [5], not a list of texts");
}

TEST_CASE("result files that nest deeply or hold very many keys are refused before they are read") {
    auto refused = [](const std::string& text, const char* why) {
        const auto loaded = loadResults(fixture::writeText("large.json", text));
        REQUIRE(!loaded);
        CHECK_THAT(loaded.error().text, ContainsSubstring(why));
    };
    refused(std::string(70'000, '['), "nests its JSON deeper than 100 levels");
    std::string many = "{\"schema\": 1";
    for (int key = 0; key < 80'000; ++key) many += ", \"k" + std::to_string(key) + "\": 0";
    refused(many + "}", "more than 1000 keys");
}
