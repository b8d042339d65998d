// Results as lines for people.
#include <algorithm>
#include <array>
#include <format>
#include <map>

#include "common/core/text.h"
#include "common/report/answers.h"
#include "common/report/columns.h"
#include "common/report/labels.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

constexpr size_t kLeastWidth = 80, kMostWidth = 100;  // columns of a terminal
constexpr size_t kNeededColumns = 3;                  // of the table, where it gets narrow: median, ± %, of baseline

struct Table {
    const Json& results;
    size_t width = 0;  // 0: a file or a pipe
    SharedParts shared{};
    std::vector<const Column*> columns{};
    size_t nameWidth = 0;
};

std::string textOf(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }
std::string printed(const Json& value) { return terminalText(textOf(value), kLongestMessage); }
bool isTimed(const Json& row) { return row["status"] == "ok" && !row["gpu_ms"].is_null(); }
bool onCpu(const Json& row) { return row["route"] == "cpu"; }

std::string line(const Table& table, const std::string& text, size_t indent) {
    return wrapText(text, table.width, indent) + "\n";
}

// 56842 as "56,842 vertices"
std::string grouped(const Json& value, const std::string& one, const std::string& many) {
    std::string digits = value.is_number() ? std::to_string(value.get<uint64_t>()) : "?";
    for (size_t place = digits.size(); place > 3; place -= 3) digits.insert(place - 3, ",");
    return digits + " " + (value == 1 ? one : many);
}

std::string joined(const std::vector<std::string>& words, const char* last) {
    std::string text;
    for (size_t i = 0; i < words.size(); ++i)
        text += (i == 0 ? "" : i + 1 == words.size() ? std::string(" ") + last + " " : ", ") + words[i];
    return text;
}

void addOnce(std::vector<std::string>& words, const std::string& word) {
    if (!word.empty() && std::ranges::find(words, word) == words.end()) words.push_back(word);
}

// The device, or both of them where the APIs have different ones.
std::string devicesText(const Json& results) {
    std::vector<std::string> names;
    bool software = false, hardware = false;
    for (const Json& device : results["devices"]) {
        addOnce(names, printed(deviceLabel(device)));
        (device["software"] == true ? software : hardware) = true;
    }
    if (names.empty()) return printed(results["host"]["cpu"]);
    if (!hardware) return joined(names, "and") + (names.size() == 1 ? ", a software driver" : ", software drivers");
    std::vector<std::string> described;
    for (const Json& device : results["devices"])
        addOnce(described, printed(deviceLabel(device)) + (device["software"] == true ? " (software driver)" : ""));
    return joined(described, "and");
}

std::vector<std::string> worksOf(const Json& results) {
    std::vector<std::string> works;
    for (const Json& row : results["cases"])
        if (!onCpu(row)) addOnce(works, textOf(row["work"]));
    return works;
}

std::string sentence(const Json& results) {
    const Json &scene = results["scene"], &settings = results["settings"];
    std::vector<std::string> rasters;
    for (const Json& row : results["cases"])
        if (!onCpu(row)) addOnce(rasters, textOf(row["raster"]));
    return std::format("{}: {} of {} ({}, {}), {}x{}{}", devicesText(results),
                       grouped(settings["copies"], "copy", "copies"), printed(scene["name"]),
                       grouped(scene["vertices"], "vertex", "vertices"), grouped(scene["joints"], "joint", "joints"),
                       dumpJson(settings["width"]), dumpJson(settings["height"]),
                       rasters.empty() ? "" : ", raster " + joined(rasters, "and"));
}

std::string headerOf(const Table& table, const Column& column) {
    if (column.per != "baseline_ms") return column.terminal->header;
    const std::string baseline = textOf(table.results["baseline"]);
    return findVariant(baseline) ? "of " + baseline + ", same API" : "of baseline";
}

// On a terminal a header with a comma has two lines; all others are in the second one.
std::array<std::string, 2> headerLines(const Table& table, const Column& column) {
    const std::string header = headerOf(table, column), mark = column.terminal->marked ? " " : "";
    const size_t comma = table.width ? header.find(", ") : std::string::npos;
    if (comma == std::string::npos) return {"", header + mark};
    return {header.substr(0, comma + 1) + mark, header.substr(comma + 2) + mark};
}

size_t widthOf(const Table& table, const Column& column) {
    const auto [above, below] = headerLines(table, column);
    return std::max({static_cast<size_t>(column.terminal->width), above.size(), below.size()});
}

std::string cellOf(const Table& table, const Column& column, const Json& row) {
    const bool marked = isSoftware(table.results, row) && !row["gpu_ms"].is_null();
    const std::string text = cellText(column, row);
    return text + (column.terminal->marked ? marked && text != "-" ? "*" : " " : "");
}

std::string nameOf(const Table& table, const Json& row) {
    const std::string id = terminalText(textOf(row["id"]), kLongestMessage);
    return table.width ? "  " + shortName(id, withWork(table.shared, textOf(row["work"]))) : id;
}

// "--variants mesh,mesh-ci"
std::string nameOfUnused(const Json& unused) {
    std::string words;
    for (const Json& word : unused["words"]) words += (words.empty() ? " " : ",") + printed(word);
    return printed(unused["option"]) + words;
}

// Columns with a value, and on a terminal as many of them as there is room for.
void chooseColumns(Table& table, const std::vector<const Json*>& rows) {
    size_t used = 0;
    for (const Column& column : columns()) {
        const bool any = std::ranges::any_of(rows, [&](const Json* row) { return cellText(column, *row) != "-"; });
        if (!column.terminal || !any) continue;
        table.columns.push_back(&column);
        used += widthOf(table, column) + 2;
    }
    for (const Json* row : rows) table.nameWidth = std::max(table.nameWidth, nameOf(table, *row).size());
    if (!table.width)
        for (const Json& unused : table.results.value("unused", Json::array()))
            table.nameWidth = std::max(table.nameWidth, nameOfUnused(unused).size());
    if (!table.width) return;
    while (used + table.nameWidth > table.width && table.columns.size() > kNeededColumns) {
        used -= widthOf(table, *table.columns.back()) + 2;
        table.columns.pop_back();
    }
    // Longer names get lines of their own.
    table.nameWidth = std::min(table.nameWidth, table.width - std::min(used, table.width / 2));
}

template <class Cell>
std::string tableLine(const Table& table, const std::string& name, const Cell& cell, const std::string& status) {
    std::string text = std::format("{:<{}}", name, table.nameWidth);
    if (table.width && name.size() > table.nameWidth) text = name + "\n" + std::string(table.nameWidth, ' ');
    for (const Column* column : table.columns) text += std::format("  {:>{}}", cell(*column), widthOf(table, *column));
    if (!status.empty()) text += "  " + status;
    return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
}

std::string caseLine(const Table& table, const Json& row) {
    std::string status;
    if (!table.width) status = textOf(row["status"]);
    if (!table.width && !row["reason"].is_null()) status += ": " + printed(row["reason"]);
    return tableLine(
        table, nameOf(table, row), [&](const Column& column) { return cellOf(table, column, row); }, status);
}

// The fastest first; what is no rival, such as `none`, behind the rivals, and what has no time at the end.
bool comesBefore(const Json* a, const Json* b) {
    auto rank = [](const Json& row) {
        if (row["status"] != "ok") return 3;
        if (!isTimed(row)) return 2;
        return textOf(row["variant"]) == "none" ? 1 : 0;
    };
    if (rank(*a) != rank(*b)) return rank(*a) < rank(*b);
    return rank(*a) < 2 && (*a)["gpu_ms"]["median"] < (*b)["gpu_ms"]["median"];
}

using Rows = std::vector<const Json*>;

// Of one work, route after route in the order of the table of routes.
std::string blockText(const Table& table, const Rows& rows) {
    std::vector<std::string> order;
    for (const Route& route : routes()) order.push_back(route.name);
    for (const Json* row : rows) addOnce(order, textOf((*row)["route"]));
    std::string text;
    for (const std::string& route : order) {
        Rows own;
        for (const Json* row : rows)
            if ((*row)["route"] == route) own.push_back(row);
        if (own.empty()) continue;
        std::ranges::stable_sort(own, comesBefore);
        if (table.width) text += terminalText(route, kLongestMessage) + "\n";
        for (const Json* row : own) text += caseLine(table, *row);
    }
    return text;
}

// Route cpu draws nothing and is shown with the last work.
std::string casesText(const Table& table, const Rows& rows) {
    std::vector<std::string> works = worksOf(table.results);
    if (works.empty()) works.emplace_back();
    std::string text;
    for (const size_t i : {0u, 1u})
        text += tableLine(
            table, table.width || i == 0 ? "" : "case",
            [&](const Column& column) { return headerLines(table, column)[i]; }, table.width || i == 0 ? "" : "status");
    text.erase(0, text.find_first_not_of('\n'));
    for (const std::string& work : works) {
        Rows own;
        for (const Json* row : rows)
            if (onCpu(*row) ? work == works.back() : textOf((*row)["work"]) == work) own.push_back(row);
        if (own.empty()) continue;
        if (works.size() > 1 && table.width) text += (work == works.front() ? "" : "\n") + work + ":\n";
        text += blockText(table, own);
    }
    return text;
}

// Cases without a result, those with one reason together: "vk-nv none, mesh, mesh-ci: LLVM has no VK_NV_mesh_shader".
std::string reasonsText(const Table& table, const char* status) {
    constexpr size_t kMostNames = 6;
    std::vector<std::string> reasons;
    std::map<std::string, std::vector<std::string>> routesOf;                         // by reason
    std::map<std::pair<std::string, std::string>, std::vector<std::string>> namesOf;  // by reason and route
    for (const Json& row : table.results["cases"]) {
        if (row["status"] != status) continue;
        const std::string reason = printed(row["reason"]), id = printed(row["id"]), route = printed(row["route"]);
        addOnce(reasons, reason);
        addOnce(routesOf[reason], route);
        addOnce(namesOf[{reason, route}], shortName(id, withWork(table.shared, textOf(row["work"]))));
    }
    std::string text;
    for (const std::string& reason : reasons) {
        std::string who;
        for (const std::string& route : routesOf[reason]) {
            const auto& names = namesOf[{reason, route}];
            who += (who.empty() ? "" : "; ") + route + " ";
            who += names.size() > kMostNames ? std::format("({} cases)", names.size()) : joined(names, "and");
        }
        text += line(table, "  " + who + ": " + reason, 6);
    }
    if (status == std::string("skipped"))
        for (const Json& unused : table.results.value("unused", Json::array())) {
            const std::string option = printed(unused["option"]), reason = printed(unused["reason"]);
            text += line(table, "  " + (reason.starts_with(option) ? "" : option + ": ") + reason, 6);
        }
    return text.empty() ? "" : std::string(status) + "\n" + text;
}

// In a file or a pipe the cases are above, and only the words are left.
std::string unusedText(const Table& table) {
    std::string text;
    for (const Json& unused : table.results.value("unused", Json::array()))
        text += tableLine(
            table, nameOfUnused(unused), [](const Column&) { return "-"; }, "skipped: " + printed(unused["reason"]));
    return text;
}

std::string countsText(const Json& results) {
    const Json& cases = results["cases"];
    const auto with = [&](const char* status) {
        return std::ranges::count_if(cases, [&](const Json& row) { return row["status"] == status; });
    };
    const auto timed = std::ranges::count_if(cases, isTimed);
    // What was interrupted before it was timed is skipped, and verified all the same.
    const auto verified = std::ranges::count_if(cases, [](const Json& row) {
        return row["status"] == "ok" || (row["status"] == "skipped" && !row["accuracy"].is_null());
    });
    std::string text = std::format("{} of {} verified", timed ? with("ok") : verified, counted(cases.size(), "case"));
    if (timed) text += " and timed";
    if (with("skipped")) text += std::format(", {} skipped", with("skipped"));
    if (with("failed")) text += std::format(", {} failed", with("failed"));
    return text;
}

}  // namespace

std::string resultsTable(const Json& results, size_t width) {
    Table table{results, width ? std::clamp(width, kLeastWidth, kMostWidth) : 0};
    Rows rows;
    std::vector<std::string> ids;  // that have options to share: route cpu draws nothing
    for (const Json& row : results["cases"]) {
        if (!table.width || row["status"] == "ok") rows.push_back(&row);
        if (!onCpu(row)) ids.push_back(textOf(row["id"]));
    }
    if (table.width) table.shared = sharedParts(ids);
    chooseColumns(table, rows);
    std::string text = line(table, sentence(results), 2);
    const std::string said = sharedText(table.shared);
    if (!said.empty()) text += line(table, "in every id: " + said, 2);
    if (!rows.empty()) text += "\n" + casesText(table, rows);
    text += table.width ? "\n" + reasonsText(table, "skipped") + reasonsText(table, "failed") : unusedText(table);
    text += countsText(results) + "\n";
    for (const Json& warning : results.value("warnings", Json::array()))
        text += line(table, "! " + printed(warning), 2);
    text += answersText(results, table.shared, table.width);
    return text;
}

}  // namespace skinbench
