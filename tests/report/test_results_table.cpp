// The table for people and its answers, over invented results. No driver takes part.
#include <algorithm>
#include <format>
#include <sstream>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <nlohmann/json.hpp>

#include "common/core/utf8.h"
#include "common/report/answers.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::ordered_json;

namespace {

// Eight frames in two rounds around the median.
CaseResult timed(const std::string& id, double median) {
    const auto c = parseCaseId(id);
    REQUIRE(c);
    CaseResult result;
    result.theCase = *c;
    result.id = id;
    result.status = CaseStatus::ok;
    for (int i = 0; i < 8; ++i) result.total.push_back(median * (1 + 0.001 * (i % 4 - 1.5)));
    result.roundSizes = {4, 4};
    result.passes["draw"] = result.total;
    result.record = result.submit = {0.1};
    result.memory = MemoryBytes{.vertex = 1024};
    result.accuracy = Accuracy{{1e-7, 1e-6}, 2e-6, {1e-7, 1e-6}, 0, id, {}};
    result.figures = figuresOf(result);
    return result;
}

CaseResult skipped(const std::string& id, const std::string& reason) {
    CaseResult result = timed(id, 1);
    result.status = CaseStatus::skipped;
    result.reason = reason;
    result.memory.reset();
    result.accuracy.reset();
    return result;
}

RunContext contextOf(bool software = false) {
    RunContext context = hostContext();
    context.buildType = "Release";
    DeviceCaps vulkan = generousCaps(Api::vulkan), opengl = generousCaps(Api::opengl);
    vulkan.name = opengl.name = "Sample GPU";
    vulkan.software = opengl.software = software;
    context.devices = {vulkan, opengl};
    context.sceneName = "hero";
    context.scene = {56842, 100000, 163, 40, 2.5, 4};
    context.workload.copies = 200;
    return context;
}

// Vulkan's mesh stages beat its compute pass, OpenGL's do not; NV beats EXT, and the APIs are not told apart in `vk`
// and `gl`.
std::vector<CaseResult> sampleRows() {
    return {timed("vk/none/uc", 1),
            timed("vk/vertex/uc", 20),
            timed("vk/vertex/uc+pull", 16),
            timed("vk/compute/uc", 14),
            timed("vk-ext/mesh/uc/meshopt/redirect", 13),
            timed("vk-nv/mesh/uc/meshopt/redirect", 12),
            timed("gl/vertex/uc", 21),
            timed("gl/compute/uc", 14.005),
            timed("gl-nv/mesh/uc/meshopt/redirect", 15),
            skipped("gl-ext/none/uc/meshopt/redirect", "Sample GPU has no GL_EXT_mesh_shader"),
            skipped("gl-ext/mesh/uc/meshopt/redirect", "Sample GPU has no GL_EXT_mesh_shader"),
            timed("cpu/cpu/uc", 2)};
}

std::string tableOf(const std::vector<CaseResult>& results, size_t width = 100,
                    const RunContext& context = contextOf()) {
    return resultsTable(resultsJson(context, results), width);
}

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

size_t columnsOf(std::string_view text) {
    size_t count = 0;
    for (; !text.empty(); ++count) text.remove_prefix(std::max<size_t>(1, utf8Length(text)));
    return count;
}

// Words of a line, joined by single spaces.
std::string squeezed(const std::string& line) {
    std::istringstream stream(line);
    std::string text;
    for (std::string word; stream >> word;) text += (text.empty() ? "" : " ") + word;
    return text;
}

bool hasLine(const std::string& table, const std::string& start) {
    const auto lines = linesOf(table);
    return std::ranges::any_of(lines, [&](const std::string& line) { return squeezed(line).starts_with(start); });
}

// The ratio to the baseline in the line of a case: its third number.
std::string ratioOf(const std::string& table, const std::string& start) {
    for (const std::string& line : linesOf(table)) {
        if (!squeezed(line).starts_with(start + " ")) continue;
        std::istringstream cells(squeezed(line).substr(start.size()));
        std::string width, ratio;
        cells >> width >> ratio;
        return ratio;
    }
    return "no such line";
}

}  // namespace

TEST_CASE("the table begins with what was drawn, and says once what all ids share") {
    const auto lines = linesOf(tableOf(sampleRows()));
    CHECK(lines[0] == "Sample GPU: 200 copies of hero (56,842 vertices, 163 joints), 1920x1080, raster full");
    CHECK(lines[1] == "in every id: /uc, with meshlets /meshopt/redirect");
    // In a pipe every case has its whole id and its status.
    const std::string piped = tableOf(sampleRows(), 0);
    CHECK(hasLine(piped, "vk-nv/mesh/uc/meshopt/redirect 12.000"));
    CHECK_THAT(piped, ContainsSubstring("  ok\n") && ContainsSubstring("skipped: Sample GPU has no GL_EXT"));
}

TEST_CASE("cases of a route are together, the fastest first, and what skins nothing last") {
    const auto lines = linesOf(tableOf(sampleRows()));
    std::vector<std::string> names;
    for (const std::string& line : lines)
        if (!squeezed(line).empty()) names.push_back(squeezed(line).substr(0, squeezed(line).find(' ')));
    const std::vector<std::string> wanted = {"vk",    "compute", "vertex+pull", "vertex", "none",    "vk-ext",
                                             "mesh",  "vk-nv",   "mesh",        "gl",     "compute", "vertex",
                                             "gl-nv", "mesh",    "cpu",         "cpu"};
    CHECK(!std::ranges::search(names, wanted).empty());
}

TEST_CASE("times are shown as ratios to the fastest vertex case of the API, or to a baseline that is named") {
    const std::string table = tableOf(sampleRows());
    CHECK_THAT(table, ContainsSubstring("  of vertex,\n") && ContainsSubstring("   same API  "));
    CHECK(ratioOf(table, "compute 14.000") == "0.88");
    CHECK(ratioOf(table, "compute 14.005") == "0.67");
    RunContext context = contextOf();
    context.baseline = "compute";
    CHECK_THAT(tableOf(sampleRows(), 100, context), ContainsSubstring("  of compute,\n"));
    CHECK(ratioOf(tableOf(sampleRows(), 100, context), "vertex+pull 16.000") == "1.14");
    context.baseline = "vk/compute/uc";
    const Json json = resultsJson(context, sampleRows());
    CHECK(json["baseline"] == "vk/compute/uc");
    CHECK(json["cases"][6]["baseline_id"] == "vk/compute/uc");
    CHECK(ratioOf(resultsTable(json, 100), "vertex 21.000") == "1.50");
    // Of another task there is none.
    std::vector<CaseResult> results = sampleRows();
    results.push_back(timed("vk/compute/uc+discard", 3));
    CHECK(resultsJson(contextOf(), results)["cases"].back()["baseline_id"].is_null());
}

TEST_CASE("the last lines say which case, stage, extension and API is the fastest") {
    const std::string table = tableOf(sampleRows());
    INFO(table);
    CHECK(hasLine(table, "fastest: vk-nv/mesh/uc/meshopt/redirect, 12.000 ms; 0.750 (0."));
    CHECK(hasLine(table, "next: vk-ext/mesh, 13.000 ms; 1.083 (1."));
    CHECK(hasLine(table, "mesh against compute, Vulkan 0.857 (0."));
    CHECK(hasLine(table, "mesh against vertex, OpenGL 0.714 (0."));
    CHECK_THAT(squeezed(table), ContainsSubstring("Of stages, palette counts as vertex, mesh-ci as mesh"));
    CHECK_THAT(table, ContainsSubstring("  mesh faster     vk-nv/mesh : vk/compute\n"));
    CHECK_THAT(table, ContainsSubstring("  compute faster  gl-nv/mesh : gl/compute\n"));
    CHECK_THAT(table, ContainsSubstring("  NV faster       vk-ext/mesh : vk-nv/mesh\n"));
    CHECK_THAT(table, ContainsSubstring("  not told apart  vk/compute : gl/compute\n"));
    CHECK(!hasLine(table, "EXT against NV, OpenGL"));
    CHECK(hasLine(table, "vk-nv against gl-nv 0.800 (0."));
    CHECK(table.find('*') == std::string::npos);
    const Json json = resultsJson(contextOf(), sampleRows());
    CHECK(json["answers"][0]["question"] == "fastest");
    CHECK(json["answers"][0]["first"] == "vk-nv/mesh/uc/meshopt/redirect");
    CHECK(json["answers"][0]["second"] == "vk/vertex/uc+pull");
    for (const Json& answer : json["answers"]) {
        CHECK(answer["first"] != "cpu/cpu/uc");
        CHECK(answer["first"] != "vk/none/uc");
    }
}

TEST_CASE("whatever draws, a compute pass that skins is the compute stage") {
    const std::string table =
        tableOf({timed("vk/vertex/uc", 20), timed("vk/compute/uc", 14), timed("vk/compute-cull/uc", 2),
                 timed("vk-ext/mesh/uc/meshopt/redirect", 10), timed("vk-ext/compute-mesh/uc/meshopt/redirect", 8)});
    INFO(table);
    CHECK(hasLine(table, "mesh against compute, Vulkan 5.000 (4."));
    CHECK(hasLine(table, "mesh against vertex, Vulkan 0.500 (0."));
    CHECK(hasLine(table, "compute against vertex, Vulkan 0.100 (0."));
}

TEST_CASE("what is not told apart from the fastest is called so, and too few frames are no answer") {
    std::vector<CaseResult> results = {timed("vk/vertex/uc", 10), timed("vk/compute/uc", 10.004)};
    CHECK(hasLine(tableOf(results), "fastest: vk/vertex/uc, 10.000 ms, itself the baseline"));
    CHECK(hasLine(tableOf(results), "not told apart from it: vk/compute, 10.004 ms"));
    for (CaseResult& result : results) {
        result.total = {result.total.front()};
        result.roundSizes = {1};
        result.figures = figuresOf(result);
    }
    const std::string table = tableOf(results);
    CHECK_THAT(table, ContainsSubstring("by too few frames, 6 are needed") &&
                          ContainsSubstring("  too few frames, 6 are needed"));
    // A single frame has no interval.
    CHECK(!hasLine(table, "vertex 9.985 0.00"));
    CHECK(hasLine(table, "vertex 9.985 1.00"));
    CHECK(resultsJson(contextOf(), results)["cases"][0]["gpu_ms"]["interval"].is_null());
}

TEST_CASE("a table has no column without a value, in a file neither") {
    std::vector<CaseResult> results = {timed("vk/vertex/uc", 10)};
    CHECK_THAT(tableOf(results, 0), ContainsSubstring("median ms") && ContainsSubstring("  of vertex, same API  "));
    results.front().total.clear();
    results.front().roundSizes.clear();
    results.front().passes.clear();
    results.front().figures.reset();
    const std::string verified = tableOf(results, 0);
    INFO(verified);
    CHECK(hasLine(verified, "case KiB / copy error status"));
    CHECK(hasLine(verified, "vk/vertex/uc 1.0 1.0e-07 ok"));
}

TEST_CASE("every task has answers of its own") {
    const std::vector<CaseResult> results = {timed("vk/vertex/uc+no-fragments", 10),
                                             timed("vk/compute/uc+no-fragments", 8), timed("vk/vertex/uc+discard", 5),
                                             timed("vk/compute/uc+discard", 6)};
    const std::string table = tableOf(results);
    INFO(table);
    CHECK_THAT(tableOf(results, 0), ContainsSubstring("raster no-fragments and discard\n"));
    CHECK_THAT(table, ContainsSubstring("\nno-fragments:\nvk\n  compute  "));
    CHECK_THAT(table, ContainsSubstring("\nno-fragments:\nfastest: vk/compute/uc+no-fragments"));
    CHECK_THAT(table, ContainsSubstring("\ndiscard:\nfastest: vk/vertex/uc+discard"));
}

TEST_CASE("times of software drivers are marked, answered for themselves, and compare nothing about a GPU") {
    const std::string table = tableOf(sampleRows(), 100, contextOf(true));
    CHECK(linesOf(table).front().starts_with("Sample GPU, a software driver: 200 copies"));
    CHECK(ratioOf(table, "compute 14.000*") == "0.88*");
    CHECK_THAT(table, ContainsSubstring("0.857* (0."));
    CHECK(linesOf(table).back() ==
          "* software driver: these times show that the paths work; they compare nothing about a GPU");
    // Beside a GPU they are no rivals.
    RunContext mixed = contextOf();
    mixed.devices[0].software = true;
    const std::string both = tableOf(sampleRows(), 100, mixed);
    CHECK_THAT(both, ContainsSubstring("\nfastest: gl/compute/uc, 14.005 ms;"));
    CHECK(!hasLine(both, "vk against gl"));
    CHECK_THAT(both, ContainsSubstring("* software driver"));
}

TEST_CASE("cases that were skipped for one reason are joined, and words without a case are listed with theirs") {
    RunContext context = contextOf();
    context.unused = {{"variant", "--variants", {"mesh-ci"}, "mesh-ci needs vk-ext, vk-nv, gl-ext or gl-nv"},
                      {"ci_min", "--ci-min", {"3", "4"}, "--ci-min needs the variant mesh-ci"}};
    const std::string table = tableOf(sampleRows(), 100, context);
    CHECK_THAT(table, ContainsSubstring("\nskipped\n  gl-ext none and mesh: Sample GPU has no GL_EXT_mesh_shader\n"
                                        "  --variants: mesh-ci needs vk-ext, vk-nv, gl-ext or gl-nv\n"
                                        "  --ci-min needs the variant mesh-ci\n"));
    CHECK_THAT(table, ContainsSubstring("10 of 12 cases verified and timed, 2 skipped\n"));
    CHECK_THAT(tableOf(sampleRows(), 0, context),
               ContainsSubstring("\n--variants mesh-ci ") && ContainsSubstring("  skipped: mesh-ci needs vk-ext"));
    const Json json = resultsJson(context, sampleRows());
    CHECK(json["unused"][0]["words"] == Json{"mesh-ci"});
}

TEST_CASE("what was verified and interrupted before it was timed counts as verified") {
    CaseResult interrupted = timed("vk/compute/uc", 1);
    interrupted.status = CaseStatus::skipped;
    interrupted.reason = "interrupted before it was timed";
    interrupted.total.clear();
    interrupted.figures.reset();
    const std::string table = tableOf({interrupted, skipped("vk/vertex/uc", "interrupted before it was verified")});
    CHECK_THAT(table, ContainsSubstring("1 of 2 cases verified, 2 skipped\n"));
}

TEST_CASE("no line is longer than the terminal") {
    std::vector<CaseResult> results = sampleRows();
    results.push_back(
        timed("vk-ext/mesh-ci/pdc16/scan/fixed+64-64+ci-triangles+ci-min-12+clamped-loads+8-influences", 9));
    results.push_back(
        skipped("vk/compute/uc+8-influences", std::format("a reason that goes on and on, {:o>90} {:n>60}", "", "")));
    RunContext context = contextOf(true);
    context.devices[0].name = "A GPU with a very long name that its driver gives, revision 17, on a bus of its own";
    context.warnings = {"a warning that has more to say than fits into one line of a terminal with so few columns"};
    for (const size_t width : {80, 100, 200}) {
        INFO(width);
        for (const std::string& line : linesOf(tableOf(results, width, context))) {
            INFO(line);
            CHECK((columnsOf(line) <= std::min<size_t>(width, 100) || line.contains("oooo") ||
                   line.contains("ci-triangles")));
        }
    }
}

TEST_CASE("a precision that was not reached is reported with its number, of the cases that are shown") {
    RunContext context = contextOf();
    context.bench.precision = 0.0005;
    context.bench.timeLimit = 5;
    std::vector<CaseResult> results = {timed("vk/vertex/uc", 10), timed("vk/compute/uc", 9)};
    results.push_back(timed("vk/none/ids+pull", 1));
    results.back().isLimit = true;
    for (int i = 0; i < 4; ++i) results[1].total[i] *= 1.1;
    results[1].figures = figuresOf(results[1]);
    const auto warnings = figureWarnings(context, results);
    REQUIRE(!warnings.empty());
    CHECK_THAT(warnings.back(),
               ContainsSubstring("precision: 2 of 2 cases did not reach 0.05 % within 5 s (--time-limit); the widest, "
                                 "vk/compute/uc, is known to ± "));
    context.bench.precision = 0.2;
    for (const std::string& warning : figureWarnings(context, results)) CHECK(!warning.contains("precision"));
}
