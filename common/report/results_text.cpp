// Result files as tables for a terminal and for a spreadsheet.
#include <algorithm>
#include <format>

#include "common/core/text.h"
#include "common/report/columns.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

static std::string csvField(const Json& value) {
    if (value.is_null()) return "";
    return value.is_string() ? csvText(value.get<std::string>()) : dumpJson(value, -1);
}

// The label of the device that carries a case's route; null for routes of the host.
static Json deviceOf(const Json& results, const Json& row) {
    const Route* const route = findRoute(row["route"].get<std::string>());
    for (const Json& device : results["devices"])
        if (route && device["route_api"] == namesOf(route->api).key) return deviceLabel(device);
    return nullptr;
}

// The names of the CSV's columns that a column of the results makes.
static std::vector<std::string> csvNames(const Column& column) {
    std::string name = column.path;
    std::ranges::replace(name, '.', '_');
    if (!column.value || column.kind == ColumnKind::list) return {};
    if (column.kind == ColumnKind::interval) return {name + "_low", name + "_high"};
    return {name};
}

std::string resultsCsv(const Json& results) {
    std::string text = "scene,device,id";
    for (const Json& axis : results["axes"]) text += "," + axis["name"].get<std::string>();
    for (const Column& column : columns())
        for (const std::string& name : csvNames(column)) text += "," + name;
    text += "\n";
    for (const Json& row : results["cases"]) {
        text += csvField(results["scene"]["name"]) + "," + csvField(deviceOf(results, row)) + "," + csvField(row["id"]);
        for (const Json& axis : results["axes"]) {
            const Json& holder = axis["top_level"] ? row : row["options"];
            text += "," + csvField(valueAt(holder, axis["name"].get<std::string>()));
        }
        for (const Column& column : columns()) {
            const Json value = valueAt(row, column.path);
            for (size_t i = 0; i < csvNames(column).size(); ++i)
                text += "," + csvField(value.is_array() && i < value.size() ? value[i] : value);
        }
        text += "\n";
    }
    return text;
}

std::string resultsTable(const Json& results) {
    size_t width = 4;
    for (const Json& row : results["cases"]) width = std::max(width, row["id"].get<std::string>().size());
    auto lineOf = [&](const std::string& id, const auto& cellOf, const std::string& status) {
        std::string line = std::format("{:<{}}  ", id, width);
        for (const Column& column : columns())
            if (column.terminal) line += std::format("{:>{}}  ", cellOf(column), column.terminal->width);
        return line + status + "\n";
    };
    auto header = [](const Column& column) { return column.terminal->header; };
    std::string text = lineOf("case", header, "status");
    bool software = false;
    for (const Json& row : results["cases"]) {
        const bool marked = isSoftware(results, row) && !row["gpu_ms"].is_null();
        software = software || marked;
        auto cell = [&](const Column& column) {
            return cellText(column, row) + (column.terminal->marked ? marked ? "*" : " " : "");
        };
        std::string status = row["status"];
        if (!row["reason"].is_null()) status += ": " + terminalText(row["reason"].get<std::string>(), kLongestMessage);
        text += lineOf(row["id"], cell, status);
    }
    for (const Json& warning : results.value("warnings", Json::array()))
        text += "! " + terminalText(warning.get<std::string>(), kLongestMessage) + "\n";
    if (results.contains("noise_floor") && results["noise_floor"].is_number())
        text += std::format("equal cases differ by {:.2f} % at the most: smaller differences mean nothing\n",
                            results["noise_floor"].get<double>() * 100);
    if (software) text += "* software driver: shows that the path works, not how fast a GPU is\n";
    return text;
}

}  // namespace skinbench
