// The result file's contract, its CSV and table.
#include <algorithm>
#include <sstream>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "tests/report/sample_results.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinRel;

namespace {

std::vector<std::string> keysOf(const Json& object) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.push_back(key);
    return keys;
}

using Keys = std::vector<std::string>;

// RFC 4180: fields, with quotes undone.
std::vector<std::vector<std::string>> parseCsv(const std::string& text) {
    std::vector<std::vector<std::string>> rows(1, {""});
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        std::string& field = rows.back().back();
        if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
            field += text[i++];
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && c == ',')
            rows.back().push_back("");
        else if (!quoted && c == '\n')
            rows.push_back({""});
        else
            field += c;
    }
    CHECK(!quoted);
    CHECK(rows.back() == std::vector<std::string>{""});
    rows.pop_back();
    return rows;
}

}  // namespace

TEST_CASE("the host has a name") {
    const RunContext context = hostContext();
    CHECK(context.os.find("Linux") != std::string::npos);
    CHECK(!context.cpu.empty());
    CHECK(!context.version.empty());
    CHECK(!context.revision.empty());
}

TEST_CASE("the result file has the keys of its schema") {
    const Json json = sample();
    CHECK(keysOf(json) == Keys{"schema", "tool", "host", "command", "devices", "scene", "settings", "environment",
                               "warnings", "answers", "baseline", "unused", "calibrations", "noise_floor", "self_test",
                               "axes", "limits", "cases"});
    CHECK(json["schema"] == "skinbench-results/1");
    CHECK(keysOf(json["tool"]) == Keys{"version", "revision", "build_type"});
    CHECK(keysOf(json["host"]) == Keys{"os", "cpu"});
    CHECK(keysOf(json["scene"]) ==
          Keys{"name", "vertices", "triangles", "joints", "unique_tuples", "mean_influences", "max_influences"});
    const Keys settings = {"copies",
                           "frames",
                           "warmup",
                           "width",
                           "height",
                           "pose",
                           "camera",
                           "character_pixels",
                           "vertices_in_view",
                           "triangles_in_view",
                           "copies_in_view",
                           "rounds",
                           "precision",
                           "time_limit_s",
                           "seed",
                           "placement",
                           "geometry",
                           "cache_order"};
    CHECK(keysOf(json["settings"]) == settings);
    REQUIRE(json["devices"].size() == 2);
    const Keys device = keysOf(json["devices"][0]);
    CHECK(Keys(device.begin(), device.begin() + 7) ==
          Keys{"route_api", "number", "name", "label", "uuid", "pci", "driver"});
    CHECK(json["devices"][0]["uuid"].is_null());
    CHECK(json["devices"][0]["label"] == "Lava <pipe> & co");
    for (const Json& row : json["cases"]) {
        const Keys wanted = {"id",       "route",        "variant",     "codec",           "builder",  "layout",
                             "cull",     "scenario",     "raster",      "options",         "work",     "status",
                             "reason",   "gpu_ms",       "passes_ms",   "unserialised_ms", "batch_ms", "host_ms",
                             "limit_ms", "limit_id",     "baseline_ms", "baseline_id",     "achieved", "counters",
                             "meshlets", "memory_bytes", "accuracy",    "culling"};
        CHECK(keysOf(row) == wanted);
        for (const auto& [option, value] : row["options"].items()) CHECK(value.is_string());
    }
    const Json& row = json["cases"][0];
    CHECK(keysOf(row["gpu_ms"]) ==
          Keys{"mean", "median", "min", "max", "p95", "cv", "interval", "outliers", "drift", "round_sizes", "samples"});
    CHECK(keysOf(row["counters"]) == Keys{"input_vertices", "input_primitives", "vertex_invocations",
                                          "clipping_invocations", "clipping_primitives", "fragment_invocations",
                                          "compute_invocations", "task_invocations", "mesh_invocations",
                                          "mesh_primitives"});
    CHECK(keysOf(json["limits"][0]) == Keys{"id", "route", "raster", "status", "reason", "gpu_ms", "counters"});
    CHECK(keysOf(row["passes_ms"]) == Keys{"skin", "depth", "draw"});
    CHECK(keysOf(row["host_ms"]) == Keys{"record", "submit"});
    CHECK(keysOf(row["memory_bytes"]) ==
          Keys{"vertex", "index", "meshlet", "additional_meshlet", "tuple", "palette", "skinned", "total"});
    CHECK(keysOf(row["accuracy"]) == Keys{"max_position_error", "max_normal_error", "tolerance", "codec_position_error",
                                          "codec_normal_error", "codec_position_bound", "palette_rows_error",
                                          "palette_rows_error_pixels", "undecided_vertices", "image_difference",
                                          "image_reference"});
}

TEST_CASE("the values of the result file") {
    const Json json = sample();
    CHECK(json["settings"]["copies"] == 7);
    CHECK(json["settings"]["pose"] == "frozen");
    CHECK(json["settings"]["geometry"] == "welded");
    CHECK(json["scene"]["mean_influences"] == 1.5);
    CHECK(json["devices"][0]["route_api"] == "vulkan");
    CHECK(json["devices"][0]["software"] == true);
    CHECK(json["devices"][1]["route_api"] == "opengl");
    CHECK(json["devices"][1]["mesh_ext"].is_null());
    CHECK(json["devices"][1]["mesh_nv"]["max_vertices"] == 256);

    const Json& mesh = json["cases"][0];
    CHECK(mesh["id"] == "vk-ext/mesh/uc/scan/redirect");
    CHECK(mesh["status"] == "ok");
    CHECK(mesh["gpu_ms"]["mean"] == 4);
    CHECK(mesh["gpu_ms"]["median"] == 3);
    CHECK(mesh["gpu_ms"]["samples"] == Json{1, 2, 4, 9});
    CHECK(mesh["passes_ms"]["draw"] == 3);
    CHECK(mesh["host_ms"]["record"] == 0.5);
    CHECK(mesh["meshlets"] == 12);
    CHECK(mesh["memory_bytes"]["total"] == 1024);
    CHECK(mesh["accuracy"]["max_position_error"] == 1.5e-7);
    const nlohmann::json options = {{"meshlet_limits", "64/124"},
                                    {"influences", "4"},
                                    {"submission", "per-copy"},
                                    {"back_faces", "culled"},
                                    {"meshlet_vertices", "64"},
                                    {"meshlet_triangles", "124"},
                                    {"group_size", "32"},
                                    {"joints", "vertex"},
                                    {"loads", "guarded"},
                                    {"records", "indexed"},
                                    {"palette", "storage"},
                                    {"method", "lbs"},
                                    {"palette_rows", "f32"},
                                    {"zero_weights", "skip"},
                                    {"arithmetic", "all"},
                                    {"cluster_cull", "off"},
                                    {"views", "1"}};
    CHECK(nlohmann::json(mesh["options"]) == options);
    CHECK(json["cases"][1]["passes_ms"]["skin"] == 0.2);
    CHECK(json["cases"][1]["accuracy"]["image_difference"] == 0.25);
    CHECK(json["cases"][2]["options"]["index_writes"] == "packed");
    CHECK(json["cases"][3]["options"]["vertex_fetch"] == "attributes");
}

TEST_CASE("what is measured beside a case") {
    RunContext context = makeContext();
    context.copyBandwidth[Api::vulkan] = 5e11;
    const Json json = resultsJson(context, makeResults());
    const Json& mesh = json["cases"][0];
    CHECK(mesh["gpu_ms"]["interval"] == Json{1.5, 6.5});
    CHECK(mesh["gpu_ms"]["round_sizes"] == Json{2, 2});
    CHECK(mesh["gpu_ms"]["drift"]["relative"] == 5 / 3.0);
    CHECK(mesh["limit_ms"] == 1);
    CHECK(mesh["limit_id"] == json["limits"][0]["id"]);
    CHECK(json["cases"].size() == 5);
    CHECK(mesh["counters"]["clipping_primitives"] == 77);
    CHECK(mesh["counters"]["mesh_invocations"] == 64);
    CHECK(mesh["counters"]["input_vertices"].is_null());
    CHECK(mesh["unserialised_ms"].is_null());
    CHECK(json["cases"][1]["unserialised_ms"]["median"] == 0.4);
    CHECK(json["cases"][1]["limit_ms"].is_null());
    // 200 triangles and 1024 bytes, 7 copies, 3 ms.
    CHECK_THAT(mesh["achieved"]["triangles_per_s"].get<double>(), WithinRel(1400 / 3e-3, 1e-12));
    CHECK_THAT(mesh["achieved"]["bytes_per_s"].get<double>(), WithinRel(7168 / 3e-3, 1e-12));
    CHECK(json["devices"][0]["peak"]["copy_bytes_per_s"] == 5e11);
    CHECK_THAT(json["devices"][0]["peak"]["triangles_per_s"].get<double>(), WithinRel(1400 / 1e-3, 1e-12));
    CHECK(json["devices"][1]["peak"].is_null());
    CHECK(json["noise_floor"].is_null());
    CHECK(json["self_test"].is_null());
}

TEST_CASE("warnings: clocks that moved, a build that is no release, rounds that drifted") {
    RunContext context = makeContext();
    const std::vector<CaseResult> none;
    CHECK(figureWarnings(context, none).empty());
    DeviceState before{.device = "GPU", .smClockMhz = 2000}, after = before;
    after.smClockMhz = 1970;
    context.deviceStates = {{before}, {after}};
    CHECK(figureWarnings(context, none).empty());
    context.deviceStates[1][0].smClockMhz = 1900;
    REQUIRE(figureWarnings(context, none).size() == 1);
    CHECK_THAT(figureWarnings(context, none)[0], ContainsSubstring("from 2000 to 1900 MHz"));
    // The clock of a card that the run did not use.
    context.devices[1].uuid = "a";
    context.deviceStates[0][0].uuid = "b";
    CHECK(figureWarnings(context, none).empty());
    context.deviceStates.clear();
    context.buildType = "Debug";
    REQUIRE(figureWarnings(context, none).size() == 1);
    CHECK_THAT(figureWarnings(context, none)[0], ContainsSubstring("Debug build"));
    context.buildType = "Release";
    std::vector<CaseResult> results{makeResult(scanCase("vk", "vertex"), CaseStatus::ok)};
    for (int i = 0; i < 20; ++i) results[0].total.push_back(i < 10 ? 1 + i * 1e-4 : 1.1 + i * 1e-4);
    results[0].roundSizes = {10, 10};
    results[0].figures = figuresOf(results[0]);
    REQUIRE(figureWarnings(context, results).size() == 1);
    CHECK_THAT(figureWarnings(context, results)[0], ContainsSubstring("1 of 1 case drifted"));
    for (double& sample : results[0].total) sample = 1;
    results[0].figures = figuresOf(results[0]);
    CHECK(figureWarnings(context, results).empty());
}

TEST_CASE("the self-test tells the largest difference of equal cases") {
    RunContext context = makeContext();
    context.bench.selfTest = true;
    std::vector<CaseResult> results;
    auto addPair = [&](const Case& c, double a, double b, double width) {
        for (double value : {a, b}) {
            results.push_back(makeResult(c, CaseStatus::ok));
            results.back().total = {value - width, value + width};
            results.back().roundSizes = {1, 1};
            results.back().figures = figuresOf(results.back());
        }
        results.back().isAgain = true;
    };
    addPair(scanCase("vk", "vertex"), 2, 2.004, 0.003);
    addPair(scanCase("vk", "compute"), 4, 4.008, 0.0005);
    addPair(scanCase("cpu", "cpu"), 1, 3, 0.1);
    REQUIRE(noiseFloor(results));
    CHECK_THAT(*noiseFloor(results), WithinRel(0.002, 1e-9));
    const Json json = resultsJson(context, results);
    CHECK_THAT(json["noise_floor"].get<double>(), WithinRel(0.002, 1e-9));
    REQUIRE(json["self_test"].size() == 3);
    CHECK(json["self_test"][0]["equal"] == true);
    CHECK(json["self_test"][1]["equal"] == false);
    CHECK(json["self_test"][2]["a_ms"] == 1);
    CHECK(json["self_test"][2]["b_ms"] == 3);
}

TEST_CASE("the self-test tells pairs apart by more than the interval of one case") {
    RunContext context = makeContext();
    context.bench.selfTest = true;
    auto equalAt = [&](double shift) {
        std::vector<CaseResult> results(2, makeResult(scanCase("vk", "vertex"), CaseStatus::ok));
        for (CaseResult& result : results) {
            result.total.clear();
            for (int i = 0; i < 8; ++i) result.total.push_back(100 + i + (&result == &results[1] ? shift : 0));
            result.roundSizes.assign(8, 1);
            result.figures = figuresOf(result);
        }
        results[1].isAgain = true;
        const bool overlap = results[1].figures->interval.low <= results[0].figures->interval.high;
        return std::pair(overlap, resultsJson(context, results)["self_test"][0]["equal"].get<bool>());
    };
    CHECK(equalAt(0) == std::pair(true, true));
    CHECK(equalAt(5) == std::pair(false, true));
    CHECK(equalAt(9) == std::pair(false, false));
}

TEST_CASE("null stands where nothing applies") {
    const Json json = sample();
    for (const char* key : {"gpu_ms", "passes_ms", "host_ms", "limit_ms", "meshlets", "memory_bytes", "accuracy"})
        CHECK(json["cases"][2][key].is_null());
    CHECK(json["cases"][2]["reason"] == "Real GPU has no GL_NV_mesh_shader");
    for (size_t ok : {0, 1, 4}) CHECK(json["cases"][ok]["reason"].is_null());
    for (const char* key : {"builder", "layout", "meshlets"}) CHECK(json["cases"][1][key].is_null());
    CHECK(json["cases"][0]["passes_ms"]["skin"].is_null());
    CHECK(json["cases"][0]["passes_ms"]["depth"].is_null());
    // Infinite errors, and no image on a route that draws none.
    CHECK(json["cases"][3]["accuracy"]["max_position_error"].is_null());
    CHECK(json["cases"][3]["accuracy"]["max_normal_error"] == 0.5);
    CHECK(json["cases"][4]["accuracy"]["image_difference"].is_null());
    CHECK(json["cases"][4]["gpu_ms"].is_null());
    CHECK(json.dump().find("Infinity") == std::string::npos);
}

TEST_CASE("a case that failed is published without a time") {
    std::vector<CaseResult> results = makeResults();
    results[0].status = CaseStatus::failed;
    results[0].reason = "wrong";
    const Json row = resultsJson(makeContext(), results)["cases"][0];
    CHECK(row["gpu_ms"].is_null());
    CHECK(row["passes_ms"].is_null());
    CHECK(row["host_ms"].is_null());
}

TEST_CASE("CSV: a line a case, quoted as RFC 4180 says") {
    const auto rows = parseCsv(resultsCsv(sample()));
    REQUIRE(rows.size() == 6);
    const auto& head = rows[0];
    for (const auto& row : rows) CHECK(row.size() == head.size());
    auto at = [&](size_t row, const std::string& column) {
        auto place = std::ranges::find(head, column);
        REQUIRE(place != head.end());
        return rows[row][static_cast<size_t>(place - head.begin())];
    };
    CHECK(head[0] == "scene");
    CHECK(at(1, "scene") == "hero, \"the\" <b>&amp;");
    CHECK(at(1, "id") == "vk-ext/mesh/uc/scan/redirect");
    CHECK(at(1, "device") == "Lava <pipe> & co");
    CHECK(at(1, "gpu_ms_median") == "3.0");
    CHECK(at(1, "gpu_ms_interval_low") == "1.5");
    CHECK(at(1, "gpu_ms_interval_high") == "6.5");
    CHECK(at(1, "limit_ms") == "1.0");
    CHECK(at(1, "joints") == "vertex");
    CHECK(at(2, "joints") == "");
    CHECK(at(3, "gpu_ms_interval_low") == "");
    CHECK(at(1, "memory_bytes_total") == "1024");
    CHECK(at(1, "reason") == "");
    CHECK(at(2, "builder") == "");
    CHECK(at(2, "passes_ms_skin") == "0.2");
    CHECK(at(3, "gpu_ms_mean") == "");
    CHECK(at(4, "reason") == "off by \"1\", <far>\nand more");
    CHECK(at(4, "accuracy_max_position_error") == "");
}

TEST_CASE("the table marks the times of software drivers, and only those") {
    const std::string table = resultsTable(sample());
    std::istringstream stream(table);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    auto lineOf = [&](const std::string& id) {
        auto line = std::ranges::find_if(lines, [&](const std::string& l) { return l.starts_with(id + " "); });
        REQUIRE(line != lines.end());
        return *line;
    };
    CHECK_THAT(lineOf("vk-ext/mesh/uc/scan/redirect"), ContainsSubstring("3.000*"));
    CHECK_THAT(lineOf("gl/compute/uc"), ContainsSubstring("0.500 "));
    CHECK(lineOf("gl/compute/uc").find('*') == std::string::npos);
    CHECK(lineOf("cpu/cpu/uc").find('*') == std::string::npos);
    CHECK_THAT(lineOf("gl-nv/mesh/uc/scan/redirect"), ContainsSubstring("skipped: Real GPU has no"));
    CHECK_THAT(lineOf("vk/vertex/uc"), ContainsSubstring("failed: off by"));
    CHECK_THAT(table, ContainsSubstring("* software driver"));

    RunContext hardware = makeContext();
    hardware.devices[0].software = false;
    CHECK(resultsTable(resultsJson(hardware, makeResults())).find('*') == std::string::npos);
}

TEST_CASE("text that is not ours stays a field of the CSV, a line of the table and an element of the page") {
    Json json = sample();
    json["scene"]["name"] = "=HYPERLINK(1)\rx,\"y\"\xff";
    json["cases"][1]["reason"] = "no\nskinbench: forged \x1b[31m";
    json["warnings"] = {"first\nsecond"};
    const std::string csv = resultsCsv(json);
    CHECK_THAT(csv, ContainsSubstring("\n\"'=HYPERLINK(1)\rx,\"\"y\"\"\xEF\xBF\xBD\","));
    const std::string table = resultsTable(json);
    CHECK_THAT(table, ContainsSubstring("no\\nskinbench: forged \\x1b[31m\n"));
    CHECK_THAT(table, ContainsSubstring("! first\\nsecond\n"));
    CHECK(table.find('\x1b') == std::string::npos);
    json["scene"]["name"] = "</script><script>alert(1)</script>";
    CHECK(reportHtml({json}, {"\"><img src=x>"}).find("alert(1)</script>") == std::string::npos);
    CHECK(reportHtml({json}, {"\"><img src=x>"}).find("<img src=x>") == std::string::npos);
}
