// Result files back from disk. They may come from another version of the program, from a person, or from a stranger.
#include <algorithm>
#include <filesystem>
#include <format>

#include <nlohmann/json.hpp>

#include "common/core/file.h"
#include "common/core/text.h"
#include "common/report/report.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

enum class Kind { text, number, flag, texts, numbers };

// What reads result files relies on: a key that is needed is there, one that is there is of its kind.
struct Key {
    const char* name;
    Kind kind;
    bool needed = true;
    bool nullable = false;
};

struct KeyGroup {
    const char* name;
    std::vector<Key> keys;
};

const std::vector<KeyGroup>& groups() {
    static const std::vector<KeyGroup> rows = {{"tool", {{"version", Kind::text}, {"revision", Kind::text}}},
                                            {"host", {{"os", Kind::text}, {"cpu", Kind::text}}},
                                            {"scene",
                                             {{"name", Kind::text},
                                              {"vertices", Kind::number},
                                              {"triangles", Kind::number},
                                              {"joints", Kind::number},
                                              {"unique_tuples", Kind::number},
                                              {"mean_influences", Kind::number},
                                              {"max_influences", Kind::number}}},
                                            {"settings",
                                             {{"copies", Kind::number},
                                              {"frames", Kind::number},
                                              {"width", Kind::number},
                                              {"height", Kind::number},
                                              {"pose", Kind::text},
                                              {"placement", Kind::text, false}}}};
    return rows;
}

const std::vector<KeyGroup>& lists() {
    static const std::vector<KeyGroup> rows = {{"devices",
                                             {{"route_api", Kind::text},
                                              {"name", Kind::text},
                                              {"driver", Kind::text},
                                              {"software", Kind::flag},
                                              {"label", Kind::text, false},
                                              {"uuid", Kind::text, false, true},
                                              {"pci", Kind::text, false, true}}},
                                            {"cases",
                                             {{"id", Kind::text},
                                              {"route", Kind::text},
                                              {"variant", Kind::text},
                                              {"status", Kind::text},
                                              {"reason", Kind::text, true, true},
                                              {"raster", Kind::text},
                                              {"limit_ms", Kind::number, false, true}}}};
    return rows;
}

// Of a case; each may be null.
const std::vector<KeyGroup>& figures() {
    static const std::vector<KeyGroup> rows = {
        {"gpu_ms",
         {{"median", Kind::number},
          {"min", Kind::number},
          {"cv", Kind::number},
          {"samples", Kind::numbers, false},
          {"round_sizes", Kind::numbers, false, true},
          {"interval", Kind::numbers, false, true}}},
        {"passes_ms", {{"skin", Kind::number, true, true}, {"draw", Kind::number, true, true}}},
        {"memory_bytes", {{"total", Kind::number}}},
        {"accuracy", {{"max_position_error", Kind::number, true, true}}}};
    return rows;
}

bool isOf(const Json& value, Kind kind) {
    switch (kind) {
        case Kind::text:
            return value.is_string();
        case Kind::number:
            return value.is_number();
        case Kind::flag:
            return value.is_boolean();
        case Kind::texts:
            return value.is_array() && std::ranges::all_of(value, [](const Json& one) { return one.is_string(); });
        case Kind::numbers:
            return value.is_array() && std::ranges::all_of(value, [](const Json& one) { return one.is_number(); });
    }
    return false;
}

const char* kindName(Kind kind) {
    const char* names[] = {"a text", "a number", "true or false", "a list of texts", "a list of numbers"};
    return names[static_cast<size_t>(kind)];
}

// The key that is not there, or whose value is of another kind; `where` is what the message calls the object.
Result<void> checkKeys(const Json& object, const std::vector<Key>& keys, const std::string& where) {
    for (const Key& key : keys) {
        const bool there = object.is_object() && object.contains(key.name);
        if (!there && key.needed) return inputError(std::format("{} lacks the key '{}'", where, key.name));
        if (!there || (key.nullable && object[key.name].is_null()) || isOf(object[key.name], key.kind)) continue;
        return inputError(std::format("{}: '{}' is {}, not {}", where, key.name,
                                      terminalText(dumpJson(object[key.name], -1), 40), kindName(key.kind)));
    }
    return {};
}

// "case vk/none/uc", or its number where it has no name.
std::string nameOf(const Json& row, size_t number, const std::string& list) {
    if (list == "cases" && row.is_object() && row.contains("id") && row["id"].is_string())
        return "case " + row["id"].get<std::string>();
    return std::format("entry {} of '{}'", number, list);
}

Result<void> checkFigures(const Json& row, const std::string& name) {
    for (const auto& [group, keys] : figures()) {
        if (!row.contains(group)) return inputError(std::format("{} lacks the key '{}'", name, group));
        if (row[group].is_null()) continue;
        SKINBENCH_TRY(checkKeys(row[group], keys, std::format("{}: '{}'", name, group)));
    }
    const Json interval = row["gpu_ms"].is_null() ? Json(nullptr) : row["gpu_ms"].value("interval", Json(nullptr));
    if (!interval.is_null() && interval.size() != 2)
        return inputError(name + ": 'interval' of 'gpu_ms' does not have two numbers");
    return {};
}

Result<void> checkResults(const Json& json) {
    if (!json.is_object() || !json.contains("schema") || json["schema"] != kResultsSchema)
        return inputError(std::string("is not a result file; its schema is not ") + kResultsSchema);
    for (const auto& [group, keys] : groups()) {
        if (!json.contains(group)) return inputError(std::format("is not a whole result file: '{}' is missing", group));
        SKINBENCH_TRY(checkKeys(json[group], keys, std::format("is not a whole result file: '{}'", group)));
    }
    for (const auto& [list, keys] : lists()) {
        if (!json.contains(list) || !json[list].is_array())
            return inputError(std::format("is not a whole result file: the list '{}' is missing", list));
        for (size_t i = 0; i < json[list].size(); ++i) {
            const Json& row = json[list][i];
            const std::string name = nameOf(row, i, list);
            SKINBENCH_TRY(checkKeys(row, keys, name));
            if (list != std::string("cases")) continue;
            SKINBENCH_TRY(checkFigures(row, name));
        }
    }
    return checkKeys(json, {{"noise_floor", Kind::number, false, true}, {"warnings", Kind::texts, false}}, "the file");
}

}  // namespace

std::string resultsFileOf(const std::string& path) {
    std::error_code failed;
    return std::filesystem::is_directory(path, failed) ? (std::filesystem::path(path) / "results.json").string() : path;
}

Result<Json> loadResults(const std::string& path) {
    const std::string file = resultsFileOf(path);
    std::error_code failed;
    if (file != path && !std::filesystem::exists(file, failed))
        return inputError(path + ": is a folder without a results.json");
    auto text = readWholeFile(file);
    SKINBENCH_TRY(text);
    if (auto small = checkJsonShape(*text); !small) return inputError(path + ": " + small.error().text);
    Json json = Json::parse(*text, nullptr, false);
    if (json.is_discarded()) return inputError(path + ": is not JSON");
    if (auto right = checkResults(json); !right) return inputError(path + ": " + right.error().text);
    completeResults(json);
    return json;
}

}  // namespace skinbench
