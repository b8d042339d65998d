#include <algorithm>
#include <format>

#include <nlohmann/json.hpp>

#include "common/report.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

const char* kStyle = R"css(
:root { color-scheme: light dark; --line: #8884; --soft: #8882; --bar: #2a78d6; --soft-bar: #9a9a94; --bad: #c43c2e; }
* { box-sizing: border-box; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 0 auto; max-width: 1180px; padding: 24px 16px 64px; }
h1 { font-size: 1.5rem; margin: 0 0 4px; } h2 { font-size: 1.15rem; margin: 40px 0 8px; }
p { margin: 4px 0; } .note { opacity: .75; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; width: 100%; }
th, td { border-bottom: 1px solid var(--line); padding: 5px 10px; text-align: left; white-space: nowrap; }
th { font-weight: 600; } td.n, th.n { text-align: right; } td.why { white-space: normal; min-width: 220px; }
.failed { color: var(--bad); font-weight: 600; }
.chart { display: grid; grid-template-columns: max-content 1fr; gap: 4px 12px; align-items: center; }
.chart code { font-size: 12.5px; } .track { display: flex; align-items: center; gap: 8px; min-width: 160px; }
.bar { background: var(--bar); height: 14px; border-radius: 0 3px 3px 0; min-width: 2px; }
.bar.software { background: var(--soft-bar); } .track span { font-size: 12.5px; white-space: nowrap; }
@media (max-width: 640px) { .chart { grid-template-columns: 1fr; gap: 0; } .chart .track { margin-bottom: 6px; } }
)css";

std::string escape(const std::string& text) {
    std::string safe;
    for (char c : text) {
        if (c == '&')
            safe += "&amp;";
        else if (c == '<')
            safe += "&lt;";
        else if (c == '>')
            safe += "&gt;";
        else if (c == '"')
            safe += "&quot;";
        else
            safe += c;
    }
    return safe;
}

std::string word(const Json& value, const std::string& fallback = "–") {
    if (value.is_null()) return fallback;
    return escape(value.is_string() ? value.get<std::string>() : value.dump());
}

std::string number(const Json& row, const char* group, const char* name, double scale, int digits) {
    if (row[group].is_null() || !row[group].contains(name) || row[group][name].is_null()) return "–";
    return std::format("{:.{}f}", row[group][name].get<double>() * scale, digits);
}

bool softwareRoute(const Json& results, const std::string& route) {
    const std::string api = route.starts_with("vk") ? "vulkan" : route.starts_with("gl") ? "opengl" : "";
    return std::ranges::any_of(results["devices"], [&](const Json& device) {
        return device.value("route_api", "") == api && device.value("software", false);
    });
}

std::string contextHtml(const Json& results) {
    const Json &scene = results["scene"], &settings = results["settings"];
    std::string html = std::format(
        "<p>{} vertices, {} triangles, {} joints, {} unique tuples, {:.2f} influences a vertex (at most {}); {} copies "
        "at "
        "{}×{}, {} frames in rounds, pose {}.</p>\n",
        word(scene["vertices"]), word(scene["triangles"]), word(scene["joints"]), word(scene["unique_tuples"]),
        scene["mean_influences"].get<double>(), word(scene["max_influences"]), word(settings["copies"]),
        word(settings["width"]), word(settings["height"]), word(settings["frames"]), word(settings["pose"]));
    for (const Json& device : results["devices"])
        html += std::format("<p>{}: {}, {}{}</p>\n", device["route_api"] == "vulkan" ? "Vulkan" : "OpenGL",
                            word(device["name"]), word(device["driver"]),
                            device.value("software", false)
                                ? " – <b>software driver: shows that a path works, not how fast a GPU is</b>"
                                : "");
    return html + std::format("<p class=note>{}; {}; skinbench {} ({})</p>\n", word(results["host"]["os"]),
                              word(results["host"]["cpu"]), word(results["tool"]["version"]),
                              word(results["tool"]["revision"]));
}

// One bar a timed case, fastest first within its raster mode.
std::string chartHtml(const Json& results, const std::string& raster) {
    std::vector<const Json*> timed;
    double longest = 0;
    for (const Json& row : results["cases"]) {
        if (row["gpu_ms"].is_null() || row["raster"] != raster) continue;
        timed.push_back(&row);
        longest = std::max(longest, row["gpu_ms"]["median"].get<double>());
    }
    if (timed.empty() || longest <= 0) return {};
    std::ranges::stable_sort(timed, {}, [](const Json* row) { return (*row)["gpu_ms"]["median"].get<double>(); });
    std::string html =
        "<h3>Milliseconds a frame, raster " + escape(raster) + " (median, all copies)</h3>\n<div class=chart>\n";
    for (const Json* row : timed) {
        const double ms = (*row)["gpu_ms"]["median"];
        html += std::format(
            "<code>{}</code><div class=track><div class=\"bar{}\" style=\"width:{:.2f}%\"></div>"
            "<span>{:.3f}</span></div>\n",
            word((*row)["id"]), softwareRoute(results, (*row)["route"]) ? " software" : "", ms / longest * 80, ms);
    }
    return html + "</div>\n";
}

std::string tableHtml(const Json& results) {
    std::string html =
        "<div class=wide><table><thead><tr><th>case</th><th class=n>median ms</th><th class=n>min</th><th class=n>cv %"
        "</th><th class=n>skin</th><th class=n>draw</th><th class=n>meshlets</th><th class=n>KiB a copy</th>"
        "<th class=n>position error</th><th>status</th></tr></thead><tbody>\n";
    for (const Json& row : results["cases"]) {
        std::string error = "–";
        if (!row["accuracy"].is_null() && !row["accuracy"]["max_position_error"].is_null())
            error = std::format("{:.1e}", row["accuracy"]["max_position_error"].get<double>());
        const std::string status = row["status"];
        html += std::format(
            "<tr><td><code>{}</code></td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td>"
            "<td class=n>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td><td class=why>"
            "<span class={}>{}</span>{}</td></tr>\n",
            word(row["id"]), number(row, "gpu_ms", "median", 1, 3), number(row, "gpu_ms", "min", 1, 3),
            number(row, "gpu_ms", "cv", 100, 2), number(row, "passes_ms", "skin", 1, 3),
            number(row, "passes_ms", "draw", 1, 3), word(row.value("meshlets", Json(nullptr))),
            number(row, "memory_bytes", "total", 1.0 / 1024, 1), error, escape(status), escape(status),
            row["reason"].is_null() ? "" : ": " + word(row["reason"]));
    }
    return html + "</tbody></table></div>\n";
}

}  // namespace

std::string reportHtml(const std::vector<Json>& all) {
    std::string html =
        "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
        "content=\"width=device-width, initial-scale=1\"><title>skinbench report</title><style>" +
        std::string(kStyle) + "</style></head><body>\n<h1>skinbench report</h1>\n" +
        "<p class=note>Every case was checked against a double-precision CPU reference before it was timed.</p>\n";
    for (const Json& results : all) {
        html += "<section><h2>" + word(results["scene"]["name"]) + "</h2>\n" + contextHtml(results);
        for (const char* raster : {"full", "no-fragments", "discard"}) html += chartHtml(results, raster);
        html += "<h3>All cases</h3>\n" + tableHtml(results) + "</section>\n";
    }
    return html + "</body></html>\n";
}

}  // namespace skinbench
