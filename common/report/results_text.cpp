// Result files as tables for a terminal and for a spreadsheet, and back from disk.
#include <algorithm>
#include <format>

#include <nlohmann/json.hpp>

#include "common/core/file.h"
#include "common/report/report.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

static std::string csvField(const Json& value) {
    if (value.is_null()) return "";
    std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string resultsCsv(const Json& results) {
    const std::vector<std::string> plain = {"status", "reason", "limit_ms", "meshlets"};
    const std::vector<std::pair<std::string, std::vector<std::string>>> nested = {
        {"gpu_ms", {"mean", "median", "min", "max", "cv"}},
        {"passes_ms", {"skin", "depth", "draw"}},
        {"memory_bytes", {"vertex", "index", "meshlet", "additional_meshlet", "tuple", "palette", "skinned", "total"}},
        {"accuracy", {"max_position_error", "max_normal_error", "tolerance"}}};
    const Json columns = results.value("axes", axesJson());
    std::string text = "scene,id";
    for (const Json& axis : columns) text += "," + axis["name"].get<std::string>();
    for (const std::string& name : plain) text += "," + name;
    for (const auto& [group, names] : nested)
        for (const std::string& name : names) text += "," + group + "_" + name;
    text += "\n";
    for (const Json& row : results["cases"]) {
        text += csvField(results["scene"]["name"]) + "," + csvField(row["id"]);
        for (const Json& axis : columns) {
            const Json& holder = axis["top_level"] ? row : row["options"];
            text += "," + csvField(holder.value(axis["name"].get<std::string>(), Json(nullptr)));
        }
        for (const std::string& name : plain) text += "," + csvField(row[name]);
        for (const auto& [group, names] : nested)
            for (const std::string& name : names)
                text += "," + (row[group].is_null() ? std::string() : csvField(row[group].value(name, Json(nullptr))));
        text += "\n";
    }
    return text;
}

bool isSoftware(const Json& results, const Json& row) {
    const std::string route = row["route"];
    const std::string api = route.starts_with("vk") ? "vulkan" : route.starts_with("gl") ? "opengl" : "";
    return std::ranges::any_of(results["devices"],
                               [&](const Json& device) { return device["route_api"] == api && device["software"]; });
}

std::string resultsTable(const Json& results) {
    size_t width = 4;
    for (const Json& row : results["cases"]) width = std::max(width, row["id"].get<std::string>().size());
    std::string text = std::format("{:<{}}  {:>10}  {:>6}  {:>6}  {:>7}  {:>10}  {:>9}  {}\n", "case", width,
                                   "median ms", "± %", "cv %", "x limit", "KiB / copy", "error", "status");
    bool software = false;
    for (const Json& row : results["cases"]) {
        auto number = [&](const char* group, const char* name, double scale, int digits) {
            if (row[group].is_null() || row[group][name].is_null()) return std::string("-");
            return std::format("{:.{}f}", row[group][name].get<double>() * scale, digits);
        };
        std::string error = "-", half = "-", limit = "-";
        if (!row["gpu_ms"].is_null() && row["gpu_ms"]["median"].get<double>() > 0) {
            const double median = row["gpu_ms"]["median"];
            if (const Json& interval = row["gpu_ms"].value("interval", Json(nullptr)); interval.is_array())
                half = std::format(
                    "{:.2f}", 100 * relativeHalfWidth({interval[0].get<double>(), interval[1].get<double>()}, median));
            if (row.contains("limit_ms") && row["limit_ms"].is_number() && row["limit_ms"].get<double>() > 0)
                limit = std::format("{:.2f}", median / row["limit_ms"].get<double>());
        }
        if (!row["accuracy"].is_null() && !row["accuracy"]["max_position_error"].is_null())
            error = std::format("{:.1e}", row["accuracy"]["max_position_error"].get<double>());
        const bool marked = isSoftware(results, row) && !row["gpu_ms"].is_null();
        software = software || marked;
        std::string status = row["status"];
        if (!row["reason"].is_null()) status += ": " + row["reason"].get<std::string>();
        text += std::format("{:<{}}  {:>9}{}  {:>6}  {:>6}  {:>7}  {:>10}  {:>9}  {}\n", row["id"].get<std::string>(),
                            width, number("gpu_ms", "median", 1, 3), marked ? "*" : " ", half,
                            number("gpu_ms", "cv", 100, 2), limit, number("memory_bytes", "total", 1.0 / 1024, 1),
                            error, status);
    }
    for (const Json& warning : results.value("warnings", Json::array()))
        text += "! " + warning.get<std::string>() + "\n";
    if (results.contains("noise_floor") && results["noise_floor"].is_number())
        text += std::format("equal cases differ by {:.2f} % at the most: smaller differences mean nothing\n",
                            results["noise_floor"].get<double>() * 100);
    if (software) text += "* software driver: shows that the path works, not how fast a GPU is\n";
    return text;
}

// What a page reads; a file may come from another version of the program or from a person.
using NeededKeys = std::vector<std::pair<std::string, std::vector<const char*>>>;

static const NeededKeys kGroups = {
    {"tool", {"version", "revision"}},
    {"host", {"os", "cpu"}},
    {"scene", {"name", "vertices", "triangles", "joints", "unique_tuples", "mean_influences", "max_influences"}},
    {"settings", {"copies", "frames", "width", "height", "pose"}}};

static const NeededKeys kLists = {
    {"devices", {"route_api", "name", "driver", "software"}},
    {"cases",
     {"id", "route", "variant", "status", "reason", "raster", "gpu_ms", "passes_ms", "memory_bytes", "accuracy"}}};

static const NeededKeys kFigures = {{"gpu_ms", {"median", "min", "cv"}},
                                    {"passes_ms", {"skin", "draw"}},
                                    {"memory_bytes", {"total"}},
                                    {"accuracy", {"max_position_error"}}};

// The first key that is not there, else null.
static const char* lacks(const Json& object, const std::vector<const char*>& keys) {
    if (!object.is_object()) return keys.front();
    auto missing = std::ranges::find_if(keys, [&](const char* key) { return !object.contains(key); });
    return missing == keys.end() ? nullptr : *missing;
}

Result<Json> loadResults(const std::string& path) {
    auto text = readWholeFile(path);
    SKINBENCH_TRY(text);
    Json json = Json::parse(*text, nullptr, false);
    if (json.is_discarded()) return inputError(path + ": is not JSON");
    if (!json.is_object() || !json.contains("schema") || json["schema"] != kResultsSchema)
        return inputError(path + ": is not a result file; its schema is not " + kResultsSchema);
    for (const auto& [group, keys] : kGroups) {
        if (!json.contains(group)) return inputError(path + ": is not a whole result file: '" + group + "' is missing");
        if (const char* key = lacks(json[group], keys))
            return inputError(path + ": is not a whole result file: '" + group + "' lacks '" + key + "'");
    }
    for (const auto& [list, keys] : kLists) {
        if (!json.contains(list) || !json[list].is_array())
            return inputError(path + ": is not a whole result file: the list '" + list + "' is missing");
        for (const Json& row : json[list])
            if (const char* key = lacks(row, keys))
                return inputError(path + ": an entry of '" + list + "' lacks the key '" + key + "'");
    }
    for (const Json& row : json["cases"])
        for (const auto& [group, keys] : kFigures)
            if (const char* key = row[group].is_null() ? nullptr : lacks(row[group], keys))
                return inputError(path + ": '" + group + "' of a case lacks the key '" + key + "'");
    return json;
}

}  // namespace skinbench
