// bench --list and verify --list.
#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

// The device that a run would open.
Result<DeviceCaps> capsOf(Api api, const std::string& device) {
    auto devices = listDevices(api);
    SKINBENCH_TRY(devices);
    const auto number = pickDevice(*devices, device);
    if (!number) return errorAt(namesOf(api).name, number.error());
    return (*devices)[*number];
}

std::optional<std::string> whySkipped(const Case& c, const std::map<Api, Result<DeviceCaps>>& devices) {
    if (c.route->api == Api::cpu) return std::nullopt;
    const Result<DeviceCaps>& caps = devices.at(c.route->api);
    return caps ? unsupported(c, *caps) : std::optional(caps.error().text);
}

void printLine(const std::string& name, const std::optional<std::string>& reason) {
    std::cout << name << (reason ? "  skipped: " + terminalText(*reason, kLongestMessage) : "") << "\n";
}

}  // namespace

int listCases(const RunOptions& options, const std::vector<Case>& cases, const std::vector<Unused>& unused) {
    std::map<Api, Result<DeviceCaps>> devices;
    for (const Case& c : cases)
        if (c.route->api != Api::cpu && !devices.contains(c.route->api))
            devices.emplace(c.route->api, capsOf(c.route->api, options.selectors.device));
    Json rows = Json::array(), words = Json::array();
    size_t skipped = 0;
    for (const Case& c : cases) {
        const auto reason = whySkipped(c, devices);
        skipped += reason.has_value();
        rows.push_back({{"id", caseId(c)}, {"skipped", reason ? Json(*reason) : Json(nullptr)}});
        if (!options.json) printLine(caseId(c), reason);
    }
    for (const Unused& word : unused) {
        words.push_back({{"option", word.option}, {"words", word.words}, {"reason", word.reason}});
        if (!options.json) printLine(word.option, word.reason);
    }
    if (options.json)
        std::cout << dumpJson(Json{{"schema", "skinbench-list/1"}, {"cases", rows}, {"unused", words}}) << "\n";
    else
        say(std::format("{} cases, {} of them skipped", cases.size(), skipped));
    return flushOutput();
}

}  // namespace skinbench
