#include "common/report/columns.h"

#include <algorithm>
#include <cmath>
#include <format>
#include <ranges>

#include "common/report/answers.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

// --- values ----------------------------------------------------------------------------------------------------

// JSON has no infinity; null stands for a value that is not finite.
Json toJson(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json toJson(uint64_t value) { return value; }
Json toJson(const std::string& value) { return value.empty() ? Json(nullptr) : Json(value); }
Json toJson(const std::vector<double>& values) { return values; }
Json toJson(const std::vector<size_t>& values) { return values; }
Json toJson(const Interval& interval) { return Json::array({interval.low, interval.high}); }
template <class Value>
Json toJson(const std::optional<Value>& value) {
    return value ? toJson(*value) : Json(nullptr);
}

using Value = std::function<Json(const ResultInRun&)>;

// What `of` gives for the result, its figures, or its accuracy, as JSON.
template <class Of>
Value resultOf(Of of) {
    return [of](const ResultInRun& r) { return toJson(of(r.result)); };
}
template <class Of>
Value figureOf(Of of) {
    return [of](const ResultInRun& r) { return toJson(of(*r.result.figures)); };
}
template <class Of>
Value accuracyOf(Of of) {
    return [of](const ResultInRun& r) { return toJson(of(*r.result.accuracy)); };
}

Value passOf(const char* label) {
    return [label](const ResultInRun& r) {
        const auto& passes = r.result.figures->passes;
        const auto pass = passes.find(label);
        return pass == passes.end() ? Json(nullptr) : toJson(pass->second.median);
    };
}

std::string statusOf(const CaseResult& result) {
    constexpr const char* names[] = {"ok", "skipped", "failed"};
    return names[static_cast<size_t>(result.status)];
}

std::string reasonOf(const CaseResult& result) {
    return result.status == CaseStatus::ok ? std::string() : result.reason;
}

std::optional<double> imageDifferenceOf(const Accuracy& accuracy) {
    return accuracy.imageReference.empty() ? std::nullopt : std::optional(accuracy.imageDifference);
}

// One sample is no interval.
std::optional<Interval> intervalOf(const CaseResult& result) {
    return result.total.size() < 2 ? std::nullopt : std::optional(result.figures->interval);
}

const CaseResult* baselineOf(const ResultInRun& r) {
    return isTimed(r.result) ? baselineOf(r.context, r.results, r.result) : nullptr;
}

std::optional<double> limitOf(const ResultInRun& r) {
    const auto limit = std::ranges::find_if(
        r.results, [&](const CaseResult& other) { return other.isLimit && other.id == r.result.limitId; });
    if (limit == r.results.end() || !isTimed(*limit)) return std::nullopt;
    return limit->figures->total.median;
}

// How many a second, of what all copies have.
double aSecond(const ResultInRun& r, uint64_t ofOneCopy) {
    return static_cast<double>(ofOneCopy) * r.context.workload.copies / (r.result.figures->total.median * 1e-3);
}

bool isTimedResult(const ResultInRun& r) { return isTimed(r.result); }

// The objects that a case may lack.
struct Group {
    std::string_view key;
    bool (*applies)(const ResultInRun&);
};
constexpr Group kGroups[] = {
    {"gpu_ms", isTimedResult},
    {"passes_ms", isTimedResult},
    {"unserialised_ms", [](const ResultInRun& r) { return isTimed(r.result) && r.result.figures->overlapped; }},
    {"batch_ms", [](const ResultInRun& r) { return isTimed(r.result) && r.result.figures->batch; }},
    {"host_ms", isTimedResult},
    {"achieved",
     [](const ResultInRun& r) { return isTimed(r.result) && r.result.memory && r.result.figures->total.median > 0; }},
    {"counters", [](const ResultInRun& r) { return r.result.counters.has_value(); }},
    {"memory_bytes", [](const ResultInRun& r) { return r.result.memory.has_value(); }},
    {"accuracy", [](const ResultInRun& r) { return r.result.accuracy.has_value(); }},
    {"culling", [](const ResultInRun& r) { return r.result.culling.has_value(); }},
};

std::string_view topKey(std::string_view path) { return path.substr(0, path.find('.')); }

bool applies(const Column& column, const ResultInRun& of) {
    const auto group = std::ranges::find(kGroups, topKey(column.path), &Group::key);
    return group == std::end(kGroups) || group->applies(of);
}

// --- rows ------------------------------------------------------------------------------------------------------

using Columns = std::vector<Column>;
constexpr auto kText = ColumnKind::text, kInterval = ColumnKind::interval, kList = ColumnKind::list;

// What no table shows.
Column inFile(const char* path, const char* unit, Value value, ColumnKind kind = ColumnKind::number) {
    return {.path = path, .unit = unit, .kind = kind, .value = std::move(value)};
}

Column milliseconds(std::string path, Value value, PageColumn page) {
    page.marked = true;
    return {.path = std::move(path),
            .unit = "ms",
            .value = std::move(value),
            .form = Form::milliseconds,
            .page = std::move(page)};
}

void addTimes(Columns& rows) {
    rows.push_back(inFile("gpu_ms.mean", "ms", figureOf([](const auto& f) { return f.total.mean; })));
    rows.push_back(milliseconds("gpu_ms.median", figureOf([](const auto& f) { return f.total.median; }), {"median"}));
    rows.back().terminal = {.header = "median ms", .width = 10, .marked = true};
    rows.push_back({.path = "gpu_ms.interval",
                    .unit = "ms",
                    .kind = kInterval,
                    .form = Form::ends,
                    .page = PageColumn{.header = "95 % interval", .marked = true}});
    rows.push_back({.path = "gpu_ms.interval",
                    .kind = kInterval,
                    .per = "gpu_ms.median",
                    .scale = 50,  // half of the width, in percent
                    .digits = 2,
                    .terminal = TerminalColumn{"± %", 6}});
    auto spread = [](const char* name) { return PageColumn{.header = name, .group = "spread"}; };
    rows.push_back(milliseconds("gpu_ms.min", figureOf([](const auto& f) { return f.total.min; }), spread("min")));
    rows.push_back(milliseconds("gpu_ms.max", figureOf([](const auto& f) { return f.total.max; }), spread("max")));
    rows.push_back(milliseconds("gpu_ms.p95", figureOf([](const auto& f) { return f.total.p95; }), spread("p95")));
    rows.push_back({.path = "gpu_ms.cv",
                    .value = figureOf([](const auto& f) { return f.total.cv; }),
                    .scale = 100,
                    .digits = 2,
                    .page = PageColumn{.header = "cv", .unit = "%"}});
    rows.push_back(inFile("gpu_ms.interval", "ms", resultOf(intervalOf), kInterval));
    rows.push_back({.path = "gpu_ms.outliers",
                    .value = figureOf([](const auto& f) { return uint64_t{f.outliers}; }),
                    .page = spread("outliers")});
    rows.push_back({.path = "gpu_ms.drift.relative",
                    .value = figureOf([](const auto& f) { return f.drift.relative; }),
                    .scale = 100,
                    .digits = 2,
                    .page = PageColumn{.header = "drift", .unit = "%", .group = "spread"}});
    rows.push_back(inFile("gpu_ms.drift.p", "", figureOf([](const auto& f) { return f.drift.p; })));
    rows.push_back(inFile("gpu_ms.round_sizes", "", resultOf([](const auto& r) { return r.roundSizes; }), kList));
    rows.push_back(inFile("gpu_ms.samples", "ms", resultOf([](const auto& r) { return r.total; }), kList));
}

void addPasses(Columns& rows) {
    rows.push_back({.path = "gpu_ms.median",
                    .per = "baseline_ms",
                    .digits = 2,
                    .terminal = TerminalColumn{.header = "of baseline", .width = 9, .marked = true}});
    rows.push_back({.path = "gpu_ms.median",
                    .per = "limit_ms",
                    .digits = 2,
                    .terminal = TerminalColumn{"of its own limit", 16},
                    .page = PageColumn{.header = "× limit", .marked = true}});
    auto pass = [&](const char* label, bool leftOut) {
        rows.push_back(milliseconds(std::string("passes_ms.") + label, passOf(label), {label}));
        rows.back().leftOut = leftOut;
    };
    pass("skin", false);
    for (const char* label : {"bounds", "cluster", "cull", "views"}) pass(label, true);
    for (const char* label : {"depth", "draw"}) pass(label, false);
    rows.push_back(milliseconds("passes_ms.upload", passOf("upload"), {.header = "upload", .group = "passes"}));
    rows.back().leftOut = true;
    rows.push_back(milliseconds("unserialised_ms.median", figureOf([](const auto& f) { return f.overlapped->median; }),
                                {.header = "without barriers", .group = "passes"}));
    rows.push_back(inFile("unserialised_ms.interval", "ms",
                          figureOf([](const auto& f) { return f.overlappedInterval; }), kInterval));
    rows.push_back(milliseconds("batch_ms.median", figureOf([](const auto& f) { return f.batch->median; }),
                                {.header = "in a batch", .group = "passes"}));
    rows.back().terminal = {.header = "ms in a batch", .width = 13, .marked = true};
    rows.push_back(
        inFile("batch_ms.interval", "ms", figureOf([](const auto& f) { return f.batchInterval; }), kInterval));
    rows.push_back(inFile("batch_ms.round_sizes", "", resultOf([](const auto& r) { return r.batchRounds; }), kList));
    rows.push_back(inFile("batch_ms.samples", "ms", resultOf([](const auto& r) { return r.batches; }), kList));
    auto host = [](const char* name) { return PageColumn{.header = name, .unit = "ms host", .group = "host"}; };
    rows.push_back({.path = "host_ms.record",
                    .unit = "ms",
                    .value = figureOf([](const auto& f) { return f.record.median; }),
                    .form = Form::milliseconds,
                    .page = host("record")});
    rows.push_back({.path = "host_ms.submit",
                    .unit = "ms",
                    .value = figureOf([](const auto& f) { return f.submit.median; }),
                    .form = Form::milliseconds,
                    .page = host("submit")});
    rows.push_back(inFile("limit_ms", "ms", [](const ResultInRun& r) { return toJson(limitOf(r)); }));
    rows.push_back(inFile("limit_id", "", resultOf([](const auto& r) { return r.limitId; }), kText));
    rows.push_back(inFile("baseline_ms", "ms", [](const ResultInRun& r) {
        const CaseResult* const baseline = baselineOf(r);
        return baseline ? toJson(baseline->figures->total.median) : Json(nullptr);
    }));
    rows.push_back(inFile(
        "baseline_id", "",
        [](const ResultInRun& r) {
            const CaseResult* const baseline = baselineOf(r);
            return baseline ? Json(baseline->id) : Json(nullptr);
        },
        kText));
}

void addRates(Columns& rows) {
    rows.push_back({.path = "achieved.bytes_per_s",
                    .unit = "bytes/s",
                    .value = [](const ResultInRun& r) { return toJson(aSecond(r, r.result.memory->total())); },
                    .scale = 1e-9,
                    .digits = 1,
                    .page = PageColumn{"read", "GB/s", "rates", true}});
    rows.push_back({.path = "achieved.triangles_per_s",
                    .unit = "1/s",
                    .value =
                        [](const ResultInRun& r) {
                            return toJson(aSecond(r, r.context.scene.triangles * r.result.theCase.views));
                        },
                    .scale = 1e-9,
                    .digits = 3,
                    .page = PageColumn{"triangles", "10⁹/s", "rates", true}});
    for (const auto& [key, counter] : counterFields()) {
        std::string header = key;
        std::ranges::replace(header, '_', ' ');
        rows.push_back({.path = std::string("counters.") + key,
                        .value = resultOf([counter = counter](const auto& r) { return (*r.counters).*counter; }),
                        .page = PageColumn{.header = header, .group = "counters"}});
    }
}

void addMemory(Columns& rows) {
    rows.push_back({.path = "meshlets",
                    .value = resultOf([](const CaseResult& r) {
                        const bool any = r.theCase.builder && r.meshlets;
                        return any ? std::optional<uint64_t>(r.meshlets) : std::nullopt;
                    }),
                    .page = PageColumn{.header = "meshlets", .group = "meshlets"}});
    const std::pair<const char*, uint64_t MemoryBytes::*> buffers[] = {
        {"vertex", &MemoryBytes::vertex},   {"index", &MemoryBytes::index},
        {"meshlet", &MemoryBytes::meshlet}, {"additional_meshlet", &MemoryBytes::additionalMeshlet},
        {"tuple", &MemoryBytes::tuple},     {"palette", &MemoryBytes::palette},
        {"skinned", &MemoryBytes::skinned}};
    for (const auto& [key, buffer] : buffers)
        rows.push_back({.path = std::string("memory_bytes.") + key,
                        .unit = "bytes",
                        .value = resultOf([buffer](const auto& r) { return (*r.memory).*buffer; })});
    rows.push_back({.path = "memory_bytes.total",
                    .unit = "bytes",
                    .value = resultOf([](const auto& r) { return r.memory->total(); }),
                    .scale = 1.0 / 1024,
                    .digits = 1,
                    .terminal = TerminalColumn{"KiB / copy", 10},
                    .page = PageColumn{.header = "memory", .unit = "KiB a copy"}});
}

void addAccuracy(Columns& rows) {
    auto error = [&](const char* path, const char* unit, Value value, PageColumn page) {
        rows.push_back({.path = path,
                        .unit = unit,
                        .value = std::move(value),
                        .form = Form::scientific,
                        .digits = 1,
                        .page = std::move(page)});
    };
    error("accuracy.max_position_error", "", accuracyOf([](const auto& a) { return a.error.position; }),
          {"position error"});
    rows.back().terminal = {.header = "error", .width = 9};
    error("accuracy.max_normal_error", "rad", accuracyOf([](const auto& a) { return a.error.normal; }),
          {.header = "normal error", .group = "accuracy"});
    rows.push_back(inFile("accuracy.tolerance", "", accuracyOf([](const auto& a) { return a.tolerance; })));
    error("accuracy.codec_position_error", "", accuracyOf([](const auto& a) { return a.codecError.position; }),
          {.header = "codec position error", .group = "accuracy"});
    rows.push_back(
        inFile("accuracy.codec_normal_error", "rad", accuracyOf([](const auto& a) { return a.codecError.normal; })));
    rows.push_back(inFile("accuracy.codec_position_bound", "", accuracyOf([](const auto& a) { return a.codecBound; })));
    const auto rounding = [](double RowsError::*field) {
        return accuracyOf(
            [field](const auto& a) { return a.rowsError ? std::optional((*a.rowsError).*field) : std::nullopt; });
    };
    error("accuracy.palette_rows_error", "", rounding(&RowsError::position),
          {.header = "error of half rows", .group = "accuracy"});
    rows.push_back(inFile("accuracy.palette_rows_error_pixels", "px", rounding(&RowsError::pixels)));
    rows.push_back(inFile("accuracy.undecided_vertices", "", accuracyOf([](const auto& a) {
                              return a.error.undecided ? std::optional<uint64_t>(a.error.undecided) : std::nullopt;
                          })));
    rows.push_back(inFile("accuracy.image_difference", "", accuracyOf(imageDifferenceOf)));
    rows.push_back(
        inFile("accuracy.image_reference", "", accuracyOf([](const auto& a) { return a.imageReference; }), kText));
}

// What a case that culls left out, and the oracle's count beside it.
void addCulling(Columns& rows) {
    struct Test {
        const char* name;
        const char* of;
        LeftOut Culling::*count;
        uint64_t Culling::*all;
    };
    const Test tests[] = {{"frustum", "meshlets", &Culling::frustum, &Culling::meshlets},
                          {"cone", "meshlets", &Culling::cone, &Culling::meshlets},
                          {"frustum", "triangles", &Culling::triangleFrustum, &Culling::triangles},
                          {"back", "triangles", &Culling::triangleBack, &Culling::triangles},
                          {"small", "triangles", &Culling::triangleSmall, &Culling::triangles}};
    // Null where nothing of the kind is tested.
    auto number = [](uint64_t Culling::*all, auto value) {
        return resultOf([all, value](const CaseResult& r) {
            return (*r.culling).*all ? std::optional<uint64_t>(value(*r.culling)) : std::nullopt;
        });
    };
    for (const Test& test : tests) {
        const std::string all = std::string("culling.") + test.of, name = all + "_" + test.name;
        if (std::ranges::find(rows, all, &Column::path) == rows.end())
            rows.push_back({.path = all, .value = number(test.all, [test](const Culling& c) { return c.*test.all; })});
        rows.push_back({.path = name,
                        .value = number(test.all, [test](const Culling& c) { return (c.*test.count).count; }),
                        .per = all,
                        .scale = 100,
                        .digits = 1,
                        .page = PageColumn{std::string(test.of) + " by " + test.name, "%", "culling"}});
        rows.push_back({.path = name + "_possible",
                        .value = number(test.all, [test](const Culling& c) { return (c.*test.count).possible; }),
                        .per = all,
                        .scale = 100,
                        .digits = 1,
                        .page = PageColumn{"possible", "%", "culling"}});
    }
}

// The value as people read it; empty where there is none.
std::optional<double> printedNumber(const Column& column, const Json& row) {
    auto number = [&](std::string_view path) -> std::optional<double> {
        const Json value = valueAt(row, path);
        if (value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number())
            return value[1].get<double>() - value[0].get<double>();
        return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
    };
    const auto value = number(column.path);
    if (!value || column.per.empty()) return value ? std::optional(*value * column.scale) : std::nullopt;
    const auto per = number(column.per);
    return per && *per > 0 ? std::optional(*value / *per * column.scale) : std::nullopt;
}

}  // namespace

std::vector<Column>& columnTable() {
    static std::vector<Column> rows = [] {
        Columns table;
        table.push_back(inFile("work", "", resultOf([](const auto& r) { return workOf(r.theCase); }), kText));
        table.push_back(inFile("status", "", resultOf(statusOf), kText));
        table.push_back(inFile("reason", "", resultOf(reasonOf), kText));
        addTimes(table);
        addPasses(table);
        addRates(table);
        addMemory(table);
        addAccuracy(table);
        addCulling(table);
        return table;
    }();
    return rows;
}

const std::vector<Column>& columns() { return columnTable(); }

void putColumns(Json& row, const ResultInRun& of, const std::vector<std::string_view>& keys) {
    for (const Column& column : columns()) {
        const std::string_view key = topKey(column.path);
        if (!column.value || (!keys.empty() && std::ranges::find(keys, key) == keys.end())) continue;
        if (!applies(column, of)) {
            row[std::string(key)] = nullptr;
            continue;
        }
        Json value = column.value(of);
        if (value.is_null() && column.leftOut) continue;
        Json* place = &row;
        for (const auto part : std::views::split(column.path, '.'))
            place = &(*place)[std::string(part.begin(), part.end())];
        *place = std::move(value);
    }
}

Json valueAt(const Json& row, std::string_view path) {
    const Json* place = &row;
    for (const auto part : std::views::split(path, '.')) {
        if (!place->is_object()) return nullptr;
        const auto inner = place->find(std::string(part.begin(), part.end()));
        if (inner == place->end()) return nullptr;
        place = &*inner;
    }
    return *place;
}

std::string cellText(const Column& column, const Json& row) {
    const std::optional<double> value = printedNumber(column, row);
    if (!value) return "-";
    return column.form == Form::scientific
               ? std::format("{:.{}e}", *value, column.digits)
               : std::format("{:.{}f}", *value, column.form == Form::milliseconds ? 3 : column.digits);
}

Json columnsJson() {
    constexpr const char* kForms[] = {"fixed", "milliseconds", "scientific", "ends"};
    Json rows = Json::array();
    for (const Column& column : columns())
        if (column.page)
            rows.push_back({{"path", column.path},
                            {"per", column.per},
                            {"scale", column.scale},
                            {"form", kForms[static_cast<size_t>(column.form)]},
                            {"digits", column.digits},
                            {"header", column.page->header},
                            {"unit", column.page->unit.empty() ? column.unit : column.page->unit},
                            {"group", column.page->group},
                            {"marked", column.page->marked}});
    return rows;
}

const std::vector<CounterField>& counterFields() {
    static const std::vector<CounterField> fields = {{"input_vertices", &Counters::inputVertices},
                                                     {"input_primitives", &Counters::inputPrimitives},
                                                     {"vertex_invocations", &Counters::vertexInvocations},
                                                     {"clipping_invocations", &Counters::clippingInvocations},
                                                     {"clipping_primitives", &Counters::clippingPrimitives},
                                                     {"fragment_invocations", &Counters::fragmentInvocations},
                                                     {"compute_invocations", &Counters::computeInvocations},
                                                     {"task_invocations", &Counters::taskInvocations},
                                                     {"mesh_invocations", &Counters::meshInvocations},
                                                     {"mesh_primitives", &Counters::meshPrimitives}};
    return fields;
}

}  // namespace skinbench
