// The columns of results: a figure of a case is a row, which the result file, its CSV, the table for a terminal and the
// page of reports read.
//
// To add a figure: measure it (CaseResult), a row in columns.cpp, a line in docs/results-file.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/report/report.h"

namespace skinbench {

// A result among those of its run.
struct ResultInRun {
    const RunContext& context;
    const std::vector<CaseResult>& results;
    const CaseResult& result;
};

// An interval, [low, high], is two columns of the CSV. A list is in the result file alone.
enum class ColumnKind { number, text, interval, list };

// How people read a number: with `digits`, or as milliseconds with as many as their size deserves (on a terminal 3).
// Form::ends prints an interval as "low–high", on the page alone; other forms print its width.
enum class Form { fixed, milliseconds, scientific, ends };

struct TerminalColumn {
    std::string header;
    int width = 0;
    bool marked = false;  // carries the mark of software drivers
};

struct PageColumn {
    std::string header;
    std::string unit{};   // as printed; empty: Column::unit
    std::string group{};  // of columns that are hidden until a reader asks for them; empty: always there
    bool marked = false;
};

struct Column {
    std::string path;    // key of a case in result files, "gpu_ms.median"; in the CSV with _ for .
    std::string unit{};  // in both; empty: none
    ColumnKind kind = ColumnKind::number;
    // Null where it does not apply. Empty: a column of tables alone, made of values that other rows put into the file.
    std::function<nlohmann::ordered_json(const ResultInRun&)> value{};
    bool leftOut = false;  // the file has no key where it does not apply
    std::string per{};     // people read it divided by the value at this path
    double scale = 1;      // and multiplied by this
    Form form = Form::fixed;
    int digits = 0;
    std::optional<TerminalColumn> terminal{};
    std::optional<PageColumn> page{};
};

// In the order of files and tables. Tests may append rows.
std::vector<Column>& columnTable();
const std::vector<Column>& columns();

// Writes the values into a case of a result file, or only those under these top-level keys. An object that does not
// apply, such as `gpu_ms` of a case that has no time, is null as a whole.
void putColumns(nlohmann::ordered_json& row, const ResultInRun& of, const std::vector<std::string_view>& keys = {});

// The value at a path of a case of a result file; null where it is missing.
nlohmann::ordered_json valueAt(const nlohmann::ordered_json& row, std::string_view path);

// A cell of the terminal's table; "-" where there is no value.
std::string cellText(const Column& column, const nlohmann::ordered_json& row);

// What the page reads of the rows that it shows.
nlohmann::ordered_json columnsJson();

// The counters of one frame by their keys in result files.
struct CounterField {
    const char* key;
    std::optional<uint64_t> Counters::*value;
};
const std::vector<CounterField>& counterFields();

}  // namespace skinbench
