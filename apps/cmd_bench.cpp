#include <algorithm>
#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/file.h"
#include "common/measure/peaks.h"

namespace skinbench {
namespace {

Result<void> writeResults(const std::string& folder, const nlohmann::ordered_json& json) {
    if (folder.empty()) return {};
    if (auto written = writeWholeFile(folder + "/results.json", json.dump(1) + "\n"); !written) return written;
    return writeWholeFile(folder + "/results.csv", resultsCsv(json));
}

std::vector<const Route*> routesOf(const std::vector<Case>& cases) {
    std::vector<const Route*> needed;
    for (const Case& c : cases) needed.push_back(c.route);
    return needed;
}

// "auto" stands for the best route of the devices that are there.
Result<void> resolveAuto(Selectors& selectors) {
    std::vector<std::string>& routes = selectors.words["route"];
    if (routes != std::vector<std::string>{"auto"}) return {};
    std::vector<DeviceCaps> all;
    for (Api api : graphicsApis())
        if (auto devices = listDevices(api)) all.insert(all.end(), devices->begin(), devices->end());
    const Choice choice = chooseRoute(all);
    routes = {choice.route->name};
    std::cerr << "skinbench: route " << choice.route->name << ": " << choice.reason << "\n";
    return {};
}

// Pairs of the self-test that differ beyond their intervals.
int selfTestStatus(const nlohmann::ordered_json& json) {
    if (!json["self_test"].is_array()) return kExitDone;
    const auto& rows = json["self_test"];
    const auto unequal = std::ranges::count_if(rows, [](const auto& row) { return !row["equal"]; });
    if (unequal == 0) return kExitDone;
    const bool kept = json["settings"]["placement"] == "kept";
    return reportError(
        {Fault::device, std::format("{} of {} equal pairs differ beyond their intervals{}", unequal, rows.size(),
                                    kept ? "; --placement fresh averages over where buffers lie" : "")});
}

}  // namespace

int runCases(const RunOptions& options) {
    Selectors selectors = options.selectors;
    if (auto resolved = resolveAuto(selectors); !resolved) return reportError(resolved.error());
    auto cases = selectedCases(selectors);
    if (!cases) return reportError(cases.error());
    // Wrong settings are told before a device is opened, which takes a second.
    if (auto early = workloadSettings(selectors, false); !early) return reportError(early.error());
    auto devices = openDevices(routesOf(*cases), {selectors.device, selectors.validation});
    if (!devices) return reportError(devices.error());
    auto settings = workloadSettings(selectors, devices->anyHardware);
    auto workload = openWorkload(selectors.scene, *settings);
    if (!workload) return reportError(workload.error());
    auto scene = sceneFor(*workload, cases->front().influences);
    if (!scene) return reportError(scene.error());
    if (auto skinned = checkSkinned(**scene); !skinned) return reportError(skinned.error());
    const auto outside = viewWarning(*workload, cases->front().influences);
    if (!outside.empty()) warn(outside);

    RunContext context = runContext(*devices, *workload, **scene);
    context.bench = benchSettings(selectors, devices->anyHardware);
    context.bench.timed = options.timed;
    if (!outside.empty()) context.warnings.push_back(outside);
    if (options.timed)
        for (const auto& [api, open] : devices->byApi)
            if (open.backend) {
                auto bandwidth = measureCopyBandwidth(*open.backend, workload->shaders);
                if (bandwidth)
                    context.copyBandwidth[api] = *bandwidth;
                else
                    context.warnings.push_back("copy bandwidth: " + bandwidth.error().text);
            }

    catchInterrupts();
    if (selectors.shape == "auto") {
        auto calibrations = calibrateShapes(*workload, *cases, devices->byApi, context.bench);
        if (!calibrations) return reportError(calibrations.error());
        context.calibrations = std::move(*calibrations);
    }
    BenchEvents events = consoleEvents(context);
    events.checkpoint = nowAndThen([&](const std::vector<CaseResult>& results) {
        return writeResults(options.out, resultsJson(context, results));
    });
    if (auto first = events.checkpoint({}); !first) return reportError(first.error());
    auto results = runBench(*workload, *cases, devices->byApi, context.bench, events);
    if (!results) return reportError(results.error());

    const nlohmann::ordered_json json = resultsJson(context, *results);
    if (auto written = writeResults(options.out, json); !written) return reportError(written.error());
    if (!options.out.empty())
        if (auto written = writeWholeFile(options.out + "/report.html", reportHtml({json})); !written)
            return reportError(written.error());
    std::cout << (options.json ? json.dump(1) + "\n" : resultsTable(json));
    if (!options.out.empty()) std::cerr << "skinbench: " << options.out << "/results.json, results.csv, report.html\n";
    if (interrupted()) std::cerr << "skinbench: interrupted; what was measured until then is kept\n";
    const int status = statusOf(*results);
    return status == kExitDone ? selfTestStatus(json) : status;
}

}  // namespace skinbench
