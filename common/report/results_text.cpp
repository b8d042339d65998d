// Result files as tables for a terminal and for a spreadsheet.
#include <algorithm>
#include <format>

#include <nlohmann/json.hpp>

#include "common/core/text.h"
#include "common/report/report.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

static std::string csvField(const Json& value) {
    if (value.is_null()) return "";
    return value.is_string() ? csvText(value.get<std::string>()) : dumpJson(value, -1);
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
        if (!row["reason"].is_null()) status += ": " + terminalText(row["reason"].get<std::string>(), kLongestMessage);
        text += std::format("{:<{}}  {:>9}{}  {:>6}  {:>6}  {:>7}  {:>10}  {:>9}  {}\n", row["id"].get<std::string>(),
                            width, number("gpu_ms", "median", 1, 3), marked ? "*" : " ", half,
                            number("gpu_ms", "cv", 100, 2), limit, number("memory_bytes", "total", 1.0 / 1024, 1),
                            error, status);
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
