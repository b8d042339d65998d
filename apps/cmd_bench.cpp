#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/file.h"

namespace skinbench {
namespace {

std::atomic<bool> stopRequested = false;

// The first Ctrl-C ends the run after the current case, the second one at once.
void catchInterrupts() {
    struct sigaction action = {};
    action.sa_handler = [](int) { stopRequested = true; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

// A bar with the time left, on a terminal only.
struct ProgressBar {
    bool shown = isatty(STDERR_FILENO);
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

    void draw(const std::string& what, double fraction) const {
        if (!shown) return;
        const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const auto filled = static_cast<size_t>(fraction * 24);
        const std::string left =
            fraction > 0.02 ? std::format("{:.0f} s left", std::ceil(passed * (1 - fraction) / fraction)) : "";
        if (fraction >= 1)
            std::cerr << "\r\x1b[K" << std::flush;
        else
            std::cerr << std::format("\r\x1b[K[{}{}] {:3.0f} %  {:>10}  {}", std::string(filled, '#'),
                                     std::string(24 - filled, '.'), fraction * 100, left, what.substr(0, 60))
                      << std::flush;
    }
};

Result<void> writeResults(const std::string& folder, const nlohmann::ordered_json& json) {
    if (folder.empty()) return {};
    if (auto written = writeWholeFile(folder + "/results.json", json.dump(1) + "\n"); !written) return written;
    return writeWholeFile(folder + "/results.csv", resultsCsv(json));
}

std::vector<const Route*> routesOf(const std::vector<Case>& cases) {
    std::vector<const Route*> needed;
    for (const Case& which : cases) needed.push_back(which.route);
    return needed;
}

// "auto" stands for the best route of the devices that are there.
Result<void> resolveAuto(Selectors& selectors) {
    if (selectors.routes != std::vector<std::string>{"auto"}) return {};
    std::vector<DeviceCaps> all;
    for (Api api : graphicsApis())
        if (auto devices = listDevices(api)) all.insert(all.end(), devices->begin(), devices->end());
    const Choice choice = chooseRoute(all);
    selectors.routes = {choice.route->name};
    std::cerr << "skinbench: route " << choice.route->name << ": " << choice.reason << "\n";
    return {};
}

// One line on standard error for what went wrong; the table has the rest.
int statusOf(const std::vector<CaseResult>& results) {
    size_t done = 0, failed = 0;
    const CaseResult* firstFailed = nullptr;
    for (const CaseResult& result : results) {
        done += result.status == CaseStatus::ok;
        failed += result.status == CaseStatus::failed;
        if (!firstFailed && result.status == CaseStatus::failed) firstFailed = &result;
    }
    if (firstFailed)
        return reportError({Fault::device, std::format("{} of {} cases failed; the first, {}: {}", failed,
                                                       results.size(), firstFailed->id, firstFailed->reason)});
    if (done || stopRequested) return kExitDone;
    return reportError(
        {Fault::device, "no case could run; the first, " + results.front().id + ": " + results.front().reason});
}

}  // namespace

int runCases(const RunOptions& options) {
    Selectors selectors = options.selectors;
    if (auto resolved = resolveAuto(selectors); !resolved) return reportError(resolved.error());
    auto cases = crossCases(selectors);
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

    RunContext context = hostContext();
    context.devices = devices->caps;
    context.sceneName = (*scene)->name;
    context.scene = sceneStats(**scene);
    context.workload = *settings;
    context.bench = benchSettings(selectors, devices->anyHardware);
    context.bench.timed = options.timed;
    if (options.timed && context.buildType != "Release")
        warn("this is a " + context.buildType + " build; times of the host are not those of a release");

    catchInterrupts();
    if (selectors.shape == "auto") {
        auto calibrations = calibrateShapes(*workload, *cases, devices->byApi, context.bench);
        if (!calibrations) return reportError(calibrations.error());
        context.calibrations = std::move(*calibrations);
    }
    const ProgressBar bar;
    BenchEvents events;
    events.progress = [&](const std::string& what, double fraction) { bar.draw(what, fraction); };
    events.checkpoint = [&](const std::vector<CaseResult>& results) {
        return writeResults(options.out, resultsJson(context, results));
    };
    events.stop = [] { return stopRequested.load(); };
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
    if (stopRequested) std::cerr << "skinbench: interrupted; what was measured until then is kept\n";
    return statusOf(*results);
}

}  // namespace skinbench
