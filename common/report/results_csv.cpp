// Result files as tables for a spreadsheet.
#include <algorithm>

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

}  // namespace skinbench
