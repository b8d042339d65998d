// bench --list and verify --list.
#include <algorithm>
#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

// The device that a run would open.
Result<DeviceCaps> capsOn(Api wanted, const std::string& device, const std::vector<Api>& needed) {
    const Machine& machine = thisMachine();
    const auto api = std::ranges::find(machine.apis, wanted, &ApiDevices::api);
    if (!api->missing.empty()) return deviceError(api->missing);
    const auto number = pickDevice(machine, device, needed);
    SKINBENCH_TRY(number);
    const auto entry = entryOf(machine, *number, wanted);
    SKINBENCH_TRY(entry);
    return capsOf(machine, *number, api->devices[entry->number]);
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
    std::vector<Api> needed;
    for (const Case& c : cases)
        if (c.route->api != Api::cpu && std::ranges::find(needed, c.route->api) == needed.end())
            needed.push_back(c.route->api);
    std::map<Api, Result<DeviceCaps>> devices;
    for (Api api : needed) devices.emplace(api, capsOn(api, options.selectors.device, needed));
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
        say(std::format("{}, {} skipped", counted(cases.size(), "case"), skipped));
    return flushOutput();
}

}  // namespace skinbench
