// `reproduce`: the arithmetic of the published figures, tables from known times and from real cuts, what is written,
// and the command as a user calls it.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <nlohmann/json.hpp>

#include "common/report/report.h"
#include "common/theses/reproduce.h"
#include "tests/apps/program_call.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using Json = nlohmann::ordered_json;

namespace {

double meanOf(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Slip slipAt(const Reproduction& all, const std::string& where) {
    const auto slip = std::ranges::find(all.slips, where, &Slip::where);
    REQUIRE(slip != all.slips.end());
    return *slip;
}

ReproduceTable tableOf(const Reproduction& all, const std::string& id) {
    const auto table = std::ranges::find(all.tables, id, &ReproduceTable::id);
    REQUIRE(table != all.tables.end());
    return *table;
}

// The only row with these labels.
ReproduceRow rowOf(const ReproduceTable& table, const std::vector<std::string>& labels) {
    INFO(table.id << " " << labels.front() << " " << labels.back());
    REQUIRE(std::ranges::count(table.rows, labels, &ReproduceRow::labels) == 1);
    return *std::ranges::find(table.rows, labels, &ReproduceRow::labels);
}

double valueOf(const Figure& figure) {
    REQUIRE(figure.value);
    CHECK(figure.value->low == figure.value->high);
    return figure.value->low;
}

// A timed case as bench would write it.
CaseResult timed(const char* route, const char* variant, double milliseconds) {
    CaseResult result;
    Case& c = result.theCase;
    c = makeCase(route, variant);
    if (c.builder) {
        c.builder = findBuilder("scan");
        c.ci.grouping = CiGrouping::triangles;
        c.ci.key = CiKey::ordered;
        result.meshlets = c.variant == findVariant("mesh") ? 100 : 125;
    }
    result.status = CaseStatus::ok;
    result.total = {milliseconds, milliseconds, milliseconds};
    result.roundSizes = {3};
    result.figures = figuresOf(result);
    result.memory = MemoryBytes{.vertex = 1000};
    result.accuracy.emplace();
    result.accuracy->error = {1e-7, 1e-4};
    result.accuracy->tolerance = 2e-6;
    return result;
}

// Vulkan by a software driver, OpenGL by a GPU.
Json resultsOf(std::vector<CaseResult> results) {
    RunContext context;
    context.version = "1.2.3";
    context.revision = "abc";
    DeviceCaps vulkan = generousCaps(Api::vulkan);
    vulkan.name = "Lava <pipe> & co";
    vulkan.software = true;
    context.devices = {vulkan, generousCaps(Api::opengl)};
    context.sceneName = "hero";
    for (CaseResult& result : results) result.id = caseId(result.theCase);
    return resultsJson(context, results);
}

ReproduceScene sceneWith(std::vector<CaseResult> results) {
    ReproduceScene scene;
    scene.inspection.scene = "hero";
    scene.runs.push_back({Geometry::welded, true, resultsOf(std::move(results))});
    return scene;
}

ReproduceScene inspected(const std::string& name) {
    auto stored = loadScene(name);
    REQUIRE(stored);
    InspectSettings settings;
    settings.all = true;
    settings.keys = {CiKey::ordered, CiKey::set, CiKey::fit};
    auto inspection = inspectScene(*stored, settings);
    REQUIRE(inspection);
    auto errors = roundedErrors(*stored);
    REQUIRE(errors);
    return {std::move(*inspection), std::move(*errors), {}};
}

}  // namespace

TEST_CASE("published figures agree with each other") {
    const PublishedKimmersdorfer& k = publishedKimmersdorfer();
    std::map<std::string, std::vector<double>> blend;
    double reused = 0, merged = 0;
    for (const PublishedScene& scene : k.scenes) {
        for (const auto& [codec, bytes] : scene.blendBytes) blend[codec].push_back(bytes);
        if (!scene.mergedTuples) continue;
        CHECK(*scene.mergedTuples < *scene.reusedTuples);
        CHECK(*scene.reusedTuples <= *scene.tuples);
        CHECK(scene.blendBytes.at("pdc8") < scene.blendBytes.at("pc"));
        reused += *scene.reusedTuples;
        merged += *scene.mergedTuples;
    }
    REQUIRE(blend.size() == 6);
    for (const auto& [codec, bytes] : blend) {
        INFO(codec);
        CHECK(bytes.size() == 5);
        CHECK_THAT(meanOf(bytes), WithinAbs(k.blendAverages.at(codec), 0.0101));
    }
    std::vector<double> savings;
    for (size_t i = 0; i < 5; ++i) savings.push_back(1 - blend["pdc8"][i] / blend["pc"][i]);
    CHECK_THAT(savings.front(), WithinAbs(k.bestSaving, 5e-5));
    CHECK_THAT(1 - blend["pdc8"].front() / 32, WithinAbs(k.bestSavingOverRaw, 5e-5));
    CHECK_THAT(meanOf(savings), WithinAbs(k.meanSaving, 5e-5));
    CHECK_THAT(meanOf(savings) * 4 / 18, WithinAbs(k.meanBufferSaving, 5e-5));
    CHECK_THAT(1 - merged / reused, WithinAbs(k.tupleSaving, 1e-4));
    // The printed shares are those of the other 14 bytes, cut to whole percent.
    for (const auto& [codec, share] :
         std::map<std::string, double>{{"pdc8", k.pdc8ShareOfBuffer}, {"pdc32", k.pdc32ShareOfBuffer}}) {
        CHECK_THAT(std::floor(100 * k.blendAverages.at(codec) / k.baseBytes), WithinAbs(100 * share, 1e-9));
        CHECK(k.blendAverages.at(codec) / (k.baseBytes + k.blendAverages.at(codec)) < share - 0.005);
    }
    // Floor rounding of evenly spread positions is off by 0.960592 / S in the mean.
    for (const auto& [bits, range] : k.positionErrors) {
        const double expected = 0.960592 / (std::pow(2, bits) - 1);
        CHECK(range.low < expected * 1.01);
        CHECK(range.high > expected * 0.93);
    }
}

TEST_CASE("slips of Kimmersdorfer are computed from its figures") {
    const Reproduction all = reproduceKimmersdorfer({});
    const std::string shares = slipAt(all, "4, share of the blend attributes").arithmetic;
    for (const char* part : {"= 11.5 %", "= 10.3 %", "= 16.0 %", "= 13.8 %", "= 22.4 %"})
        CHECK_THAT(shares, ContainsSubstring(part));
    const std::string best = slipAt(all, "4, best saving").arithmetic;
    for (const char* part : {"92.75 %", "99.09 %", "60.24 %", "60.08 %"}) CHECK_THAT(best, ContainsSubstring(part));
    CHECK_THAT(slipAt(all, "4, merged tuples").arithmetic, ContainsSubstring("6841/17343 = 60.55 %"));
    CHECK_THAT(slipAt(all, "3.2, redirected layout").arithmetic, ContainsSubstring("= 25.6 %"));
    CHECK_THAT(slipAt(all, "4.1, welding").arithmetic, ContainsSubstring("3.35 times"));
    CHECK_THAT(slipAt(all, "3.3, DPDC16").arithmetic, ContainsSubstring("32.92 of 32"));
    CHECK_THAT(slipAt(all, "program, bits of a difference").arithmetic,
               ContainsSubstring("16777216 it gives 24 bits; 25"));
    CHECK_THAT(slipAt(all, "equations 2.20, 2.21").arithmetic, ContainsSubstring("the right one gives 1, 1, 1"));
    CHECK_THAT(slipAt(all, "4.2, 4.3, Michelle").arithmetic, ContainsSubstring("5 scenes, not 6"));
}

TEST_CASE("slips of Torabi: single precision takes a front face for a back face") {
    const std::string arithmetic = slipAt(reproduceTorabi({}), "5.1.3, culling").arithmetic;
    CHECK_THAT(arithmetic, ContainsSubstring(": 7.9"));
    CHECK_THAT(arithmetic, ContainsSubstring(", -7."));
}

TEST_CASE("times are ratios to their baseline, marked where a software driver took part") {
    CaseResult skipped = timed("vk-nv", "mesh", 1), failed = timed("gl-ext", "mesh-ci", 1);
    skipped.status = CaseStatus::skipped;
    skipped.reason = "no extension";
    failed.status = CaseStatus::failed;
    failed.reason = "positions are off";
    ReproduceScene scene =
        sceneWith({timed("vk", "vertex", 2), timed("vk-ext", "mesh", 3), timed("vk-ext", "mesh-ci", 3.15),
                   timed("gl", "vertex", 4), timed("gl-ext", "mesh", 2), skipped, failed});
    for (Json& c : scene.runs[0].results["cases"])
        if (c["route"] == "gl" || c["route"] == "gl-ext") {
            const double median = c["gpu_ms"].is_null() ? 0 : c["gpu_ms"]["median"].get<double>();
            if (median > 0) c["gpu_ms"]["interval"] = {median * 0.9, median * 1.2};
        } else if (!c["gpu_ms"].is_null()) {
            c["gpu_ms"]["interval"] = nullptr;
        }
    const Reproduction all = reproduceTorabi({scene});
    const ReproduceTable table = tableOf(all, "figs-4.2-4.3");
    const ReproduceRow mesh = rowOf(table, {"hero", "vk-ext", "mesh, naive meshlets", "full"});
    CHECK_THAT(valueOf(mesh.ours), WithinRel(1.5, 1e-12));
    CHECK(mesh.ours.text == "1.500*");
    CHECK(mesh.details[0].text == "");
    CHECK(mesh.published.text == "about the same");
    CHECK(!mesh.published.value);
    CHECK(!mesh.ratio.value);
    const ReproduceRow gl = rowOf(table, {"hero", "gl-ext", "mesh, naive meshlets", "full"});
    CHECK(gl.ours.text == "0.500");
    REQUIRE(gl.details[0].value);
    CHECK_THAT(gl.details[0].value->low, WithinRel(0.5 * 0.9 / 1.2, 1e-12));
    CHECK_THAT(gl.details[0].value->high, WithinRel(0.5 * 1.2 / 0.9, 1e-12));
    CHECK(rowOf(table, {"hero", "gl-ext", "mesh-ci, Torabi's groups", "full"}).ours.text == "failed");
    CHECK(rowOf(table, {"hero", "vk", "vertex, five attributes", "full"}).ours.text == "1.000*");
    CHECK(std::ranges::none_of(table.rows, [](const ReproduceRow& row) { return row.labels[1] == "vk-nv"; }));
    std::string notes;
    for (const std::string& note : table.notes) notes += note + "\n";
    CHECK_THAT(notes, ContainsSubstring("software driver"));
    CHECK_THAT(notes, ContainsSubstring("95 %"));
    CHECK_THAT(notes, ContainsSubstring("vk-nv skipped: no extension (1 case)"));
    CHECK_THAT(notes, ContainsSubstring("gl-ext failed: positions are off (1 case)"));

    // 3.15 / 125 over 3 / 100 is 0.84; a software driver's time is compared with nothing published.
    const ReproduceRow perMeshlet = rowOf(tableOf(all, "abstract"), {"hero", "vk-ext", "full"});
    CHECK_THAT(valueOf(perMeshlet.ours), WithinRel(0.84, 1e-12));
    CHECK(perMeshlet.published.text == "0.78 to 0.85");
    CHECK(perMeshlet.ours.software);
    CHECK(!perMeshlet.ratio.value);
}

TEST_CASE("a GPU's time is compared with a published range") {
    const ReproduceScene scene =
        sceneWith({timed("gl", "vertex", 2), timed("gl-ext", "mesh", 3), timed("gl-ext", "mesh-ci", 3.15)});
    const Reproduction all = reproduceTorabi({scene});
    const ReproduceRow row = rowOf(tableOf(all, "abstract"), {"hero", "gl-ext", "full"});
    CHECK(row.ours.text == "0.840");
    REQUIRE(row.ratio.value);
    CHECK_THAT(row.ratio.value->low, WithinRel(0.84 / 0.85, 1e-12));
    CHECK_THAT(row.ratio.value->high, WithinRel(0.84 / 0.78, 1e-12));
    const Json json = reproduceJson(all, {scene});
    for (const Json& table : json["tables"])
        if (table["id"] == "abstract") {
            CHECK(table["rows"][0]["software"] == false);
            CHECK_THAT(table["rows"][0]["published"][0].get<double>(), WithinRel(0.78, 1e-12));
        }
}

TEST_CASE("a ratio without its baseline is not made up") {
    const Reproduction all = reproduceTorabi({sceneWith({timed("gl-ext", "mesh", 2)})});
    const ReproduceRow row = rowOf(tableOf(all, "figs-4.2-4.3"), {"hero", "gl-ext", "mesh, naive meshlets", "full"});
    CHECK(row.ours.text == "no baseline");
    CHECK(!row.ours.value);
    CHECK(tableOf(all, "abstract").rows.empty());
}

TEST_CASE("nothing of Torabi's tables is published here but the abstract") {
    const Reproduction all = reproduceTorabi(
        {sceneWith({timed("gl", "vertex", 4), timed("gl-ext", "mesh", 2), timed("gl-ext", "mesh-ci", 2)})});
    size_t rows = 0;
    for (const ReproduceTable& table : all.tables)
        for (const ReproduceRow& row : table.rows) {
            INFO(table.id);
            CHECK(row.published.value.has_value() == (table.id == "abstract"));
            CHECK(row.labels.size() == table.labels.size());
            CHECK(row.details.size() == table.details.size());
            ++rows;
        }
    CHECK(rows > 5);
    CHECK(tableOf(all, "table-4.1").rows.back().ours.text == "1.00e-07");
}

TEST_CASE("Kimmersdorfer's tables from a real scene") {
    const ReproduceScene scene = inspected("builtin:biped:4000");
    const Reproduction all = reproduceKimmersdorfer({scene});
    for (int bits : {8, 10, 16}) {
        const ReproduceRow row = rowOf(tableOf(all, "table-2.1"), {"biped", std::to_string(bits)});
        CHECK_THAT(valueOf(row.ours), WithinRel(0.960592 / (std::pow(2, bits) - 1), 0.05));
        CHECK_THAT(valueOf(row.details[1]), WithinRel(0.480296 / (std::pow(2, bits) - 1), 0.05));
        REQUIRE(row.ratio.value);
        CHECK_THAT(row.ratio.value->low, WithinRel(1.0, 0.06));
    }
    for (const CodecRow& codec : scene.inspection.codecs) {
        const std::string name = codec.codec->name;
        if (codec.builder != findBuilder("meshopt") || !publishedKimmersdorfer().blendAverages.contains(name)) continue;
        const ReproduceRow row =
            rowOf(tableOf(all, "table-4.3"), {"biped", geometryName(codec.geometry), codec.codec->name});
        CHECK(valueOf(row.ours) == codec.blendBytesPerVertex);
        // The thesis has no welded scene.
        CHECK(row.published.value.has_value() == (codec.geometry == Geometry::unwelded));
        CHECK(row.ratio.value.has_value() == (codec.geometry == Geometry::unwelded));
    }
    const ReproduceTable buffers = tableOf(all, "table-4.2");
    CHECK_THAT(valueOf(rowOf(buffers, {"biped", "unwelded", "uc"}).ratio), WithinRel(1.0, 1e-12));
    CHECK_THAT(valueOf(rowOf(buffers, {"biped", "unwelded", "pc"}).ours), WithinAbs(18, 0.01));
    CHECK(rowOf(buffers, {"biped", "unwelded", "pdc8"}).published.text == "not available");
    const ReproduceRow corners = rowOf(tableOf(all, "table-4.1"), {"biped", "unwelded"});
    CHECK(valueOf(corners.details[0]) == 3 * valueOf(corners.details[1]));
    const ReproduceRow michelle = rowOf(tableOf(all, "table-4.1"), {"Michelle (Kimmersdorfer)", "unwelded"});
    CHECK(michelle.published.text == "886");
    CHECK(!michelle.ours.value);
    CHECK_THAT(slipAt(reproduceTorabi({scene}), "listing A.2, grouping").arithmetic, ContainsSubstring("ordered"));
}

TEST_CASE("names from files are no markup") {
    ReproduceScene scene = sceneWith({timed("gl", "vertex", 4), timed("gl-ext", "mesh", 2)});
    scene.inspection.scene = "<b>hero</b>|x_y\n# \"two\" & `three`";
    const Reproduction all = reproduceTorabi({scene});
    const std::string page = reproduceHtml(all, {scene});
    CHECK(page.find("<b>hero") == std::string::npos);
    CHECK_THAT(page, ContainsSubstring("&lt;b&gt;hero&lt;/b&gt;|x_y"));
    CHECK_THAT(page, ContainsSubstring("Lava &lt;pipe&gt; &amp; co"));
    CHECK(page.find("http") == std::string::npos);
    const std::string text = reproduceMarkdown(all, {scene});
    CHECK(text.find("<b>") == std::string::npos);
    CHECK_THAT(text, ContainsSubstring("| &lt;b>hero&lt;/b>\\|x\\_y\\\\n\\# \"two\" &amp; \\`three\\` | gl |"));
    // Every line of a table has as many cells as the heading above it.
    size_t cells = 0;
    for (const std::string& line : program::linesOf(text)) {
        size_t count = 0;
        for (size_t i = 0; i < line.size(); ++i) count += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
        if (!line.starts_with("|"))
            cells = 0;
        else if (!cells)
            cells = count;
        CHECK((!cells || count == cells));
    }
    const Json json = reproduceJson(all, {scene});
    CHECK(json["schema"] == "skinbench-reproduce/1");
    CHECK(json["scenes"][0] == scene.inspection.scene);
    CHECK(json["runs"].size() == 1);
}

TEST_CASE("reproduce as a user calls it") {
    const program::Words small = {"--size", "64x64", "--frames", "2", "--rounds", "1"};
    for (const std::string thesis : {"torabi", "kimmersdorfer"}) {
        program::Words words = {
            "reproduce", thesis, "builtin:robot:2000", "builtin:robot:2000", "--routes", "vk,vk-ext",
            "--out",     thesis};  // equal scenes are one
        words.insert(words.end(), small.begin(), small.end());
        const program::Outcome outcome = program::call(words);
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK_THAT(outcome.out, ContainsSubstring("ours / published"));
        const Json json = Json::parse(readWholeFile(program::pathOf(thesis + "/reproduce.json")).value_or(""));
        CHECK(json["thesis"]["name"] == thesis);
        CHECK(json["runs"].size() == 2);
        for (const Json& run : json["runs"])
            for (const Json& c : run["cases"]) {
                INFO(c["id"] << " " << c["reason"]);
                CHECK(c["status"] != "failed");
            }
        size_t timesAsRatios = 0;
        for (const Json& table : json["tables"])
            if (table["id"] == "figs-4.2-4.3" || table["id"] == "table-4.4")
                for (const Json& row : table["rows"]) {
                    timesAsRatios += row["ours"].is_number();
                    CHECK((!row["software"] || row["ratio"].is_null()));
                }
        CHECK(timesAsRatios >= 5);
        const std::string page = readWholeFile(program::pathOf(thesis + "/reproduce.html")).value_or("");
        CHECK_THAT(page, ContainsSubstring("Known slips"));
        CHECK_THAT(page, ContainsSubstring("not available"));
        CHECK_THAT(readWholeFile(program::pathOf(thesis + "/reproduce.md")).value_or(""),
                   ContainsSubstring("## Known slips"));
    }
}

TEST_CASE("a reproduction that is killed keeps what was measured") {
    const program::Running running =
        program::start({"reproduce", "torabi", "builtin:robot:2000", "--routes", "vk,vk-ext", "--size", "64x64",
                        "--frames", "4000", "--rounds", "1000", "--out", "killed"});
    Json json;
    const auto measured = [&] {
        const auto text = readWholeFile(program::pathOf("killed/reproduce.json"));
        json = Json::parse(text.value_or(""), nullptr, false);
        return json.is_object() && !json["runs"].empty() &&
               std::ranges::any_of(json["runs"][0]["cases"], [](const Json& c) { return c["gpu_ms"].is_object(); });
    };
    bool found = false;
    for (int tries = 0; tries < 2000 && !found; ++tries) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        found = measured();
    }
    kill(running.pid, SIGKILL);
    const program::Outcome outcome = program::finish(running);
    INFO(outcome.err);
    CHECK(outcome.status == 128 + SIGKILL);
    CHECK(found);
    CHECK(measured());
    CHECK_THAT(readWholeFile(program::pathOf("killed/reproduce.md")).value_or(""), ContainsSubstring("robot"));
}
