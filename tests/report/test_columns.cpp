// The table of columns: what is measured is in the file, the CSV, the terminal's table and the page. No driver takes
// part.
#include <algorithm>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/report/columns.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::ordered_json;

namespace {

CaseResult timedResult() {
    CaseResult result;
    result.theCase = makeCase("vk", "compute");
    result.id = caseId(result.theCase);
    result.status = CaseStatus::ok;
    result.total = {2, 4};
    result.roundSizes = {1, 1};
    result.overlapped = {1, 3};
    result.batches = {1.5, 1.25, 1.75};
    result.batchRounds = {1, 1, 1};
    result.passes = {{"skin", {1, 1}}, {"draw", {1, 3}}, {"blend", {5, 5}}};
    result.record = {0.5, 0.5};
    result.submit = {0.25, 0.25};
    result.figures = figuresOf(result);
    result.counters = Counters{};
    result.memory = MemoryBytes{.vertex = 512, .skinned = 512};
    result.accuracy = Accuracy{{1e-7, 1e-6}, 2e-6, {1e-7, 1e-6}, 0.5, "vk/vertex/uc"};
    result.culling = Culling{.meshlets = 8, .frustum = {3, 4}, .triangles = 90, .triangleSmall = {20, 30}};
    return result;
}

CaseResult skippedResult() {
    CaseResult result;
    result.theCase = makeCase("vk", "vertex");
    result.id = caseId(result.theCase);
    return result;
}

Json resultsOf(const std::vector<CaseResult>& results) { return resultsJson(hostContext(), results); }

std::vector<std::string> splitLine(const std::string& text, size_t number) {
    size_t start = 0;
    for (size_t i = 0; i < number; ++i) start = text.find('\n', start) + 1;
    std::vector<std::string> fields(1);
    for (size_t i = start; text[i] != '\n'; ++i)
        text[i] == ',' ? void(fields.emplace_back()) : void(fields.back() += text[i]);
    return fields;
}

// The CSV's name of every value in a case that a field can hold.
void addNames(const Json& value, const std::string& name, std::set<std::string>& names) {
    if (value.is_object())
        for (const auto& [key, inner] : value.items()) addNames(inner, name.empty() ? key : name + "_" + key, names);
    else
        names.insert(name);
}

// Adds a row for as long as it lives.
struct ExtraColumn {
    explicit ExtraColumn(Column column) { columnTable().push_back(std::move(column)); }
    ExtraColumn(const ExtraColumn&) = delete;
    ~ExtraColumn() { columnTable().pop_back(); }
};

}  // namespace

TEST_CASE("a column that is added is in the file, the CSV, the table and the page") {
    const ExtraColumn added({.path = "gpu_ms.range",
                             .unit = "ms",
                             .value =
                                 [](const ResultInRun& of) {
                                     const Summary& total = of.result.figures->total;
                                     return Json(total.max - total.min);
                                 },
                             .scale = 1000,
                             .digits = 1,
                             .terminal = TerminalColumn{"range µs", 9},
                             .page = PageColumn{.header = "range of samples", .unit = "µs"}});
    const Json json = resultsOf({timedResult(), skippedResult()});
    CHECK(json["cases"][0]["gpu_ms"]["range"] == 2);
    CHECK(json["cases"][1]["gpu_ms"].is_null());

    const std::string csv = resultsCsv(json);
    const auto head = splitLine(csv, 0);
    const auto place = std::ranges::find(head, "gpu_ms_range") - head.begin();
    REQUIRE(place < std::ssize(head));
    CHECK(splitLine(csv, 1)[place] == "2.0");
    CHECK(splitLine(csv, 2)[place] == "");

    const std::string table = resultsTable(json);
    CHECK_THAT(table, ContainsSubstring("  range µs  ") && ContainsSubstring("     2000.0  ok\n"));
    CHECK_THAT(reportHtml({json}), ContainsSubstring("\"path\":\"gpu_ms.range\"") &&
                                       ContainsSubstring("\"header\":\"range of samples\",\"unit\":\"µs\""));
}

TEST_CASE("the CSV has every value of a case that is no list, by the name of its key") {
    Json json = resultsOf({timedResult(), skippedResult()});
    const auto head = splitLine(resultsCsv(json), 0);
    const std::set<std::string> columns(head.begin(), head.end());
    CHECK(columns.size() == head.size());
    std::set<std::string> names;
    Json row = json["cases"][0];
    row.erase("options");
    addNames(row, "", names);
    for (const auto& [name, value] : json["cases"][0]["options"].items()) names.insert(name);
    for (const char* list : {"gpu_ms_samples", "gpu_ms_round_sizes", "batch_ms_samples", "batch_ms_round_sizes"})
        CHECK(names.erase(list) == 1);
    for (const char* interval : {"gpu_ms_interval", "unserialised_ms_interval", "batch_ms_interval"}) {
        CHECK(names.erase(interval) == 1);
        for (const char* end : {"_low", "_high"}) CHECK(columns.contains(std::string(interval) + end));
    }
    CHECK(names.erase("passes_ms_blend") == 1);  // a pass without a column
    for (const std::string& name : names) {
        INFO(name);
        CHECK(columns.contains(name));
    }
}

TEST_CASE("a pass that has no column is in the file") {
    const Json json = resultsOf({timedResult()});
    CHECK(json["cases"][0]["passes_ms"]["blend"] == 5);
    CHECK(json["cases"][0]["passes_ms"]["depth"].is_null());
    CHECK(!json["cases"][0]["passes_ms"].contains("upload"));
}

TEST_CASE("columns that a file holds have paths of their own, and the others refer to such") {
    std::set<std::string> paths;
    for (const Column& column : columns())
        if (column.value) CHECK(paths.insert(column.path).second);
    for (const Column& column : columns()) {
        INFO(column.path);
        CHECK(paths.contains(column.path));
        CHECK((column.per.empty() || paths.contains(column.per)));
        CHECK((column.value || column.terminal || column.page));
    }
}

TEST_CASE("a cell is a dash where its value, or what it is divided by, is missing") {
    const Column ratio{.path = "gpu_ms.median", .per = "limit_ms", .digits = 2};
    const Column width{.path = "gpu_ms.interval", .kind = ColumnKind::interval, .digits = 1};
    const Json row = {{"gpu_ms", {{"median", 3}, {"interval", {2, 4.5}}}}, {"limit_ms", 2}};
    CHECK(cellText(ratio, row) == "1.50");
    CHECK(cellText(width, row) == "2.5");
    for (const Json& limit : {Json(nullptr), Json(0), Json("2")}) {
        Json without = row;
        without["limit_ms"] = limit;
        CHECK(cellText(ratio, without) == "-");
    }
    CHECK(cellText(ratio, {{"gpu_ms", nullptr}, {"limit_ms", 2}}) == "-");
    CHECK(cellText(width, {{"gpu_ms", {{"interval", nullptr}}}}) == "-");
    CHECK(cellText({.path = "error", .form = Form::scientific, .digits = 1}, {{"error", 1.25e-7}}) == "1.2e-07");
}
