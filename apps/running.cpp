#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <format>
#include <iostream>

#include "apps/apps.h"

namespace skinbench {
namespace {

std::atomic<bool> stopRequested = false;

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

}  // namespace

void catchInterrupts() {
    struct sigaction action = {};
    action.sa_handler = [](int) { stopRequested = true; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return stopRequested; }

BenchEvents consoleEvents(RunContext& context) {
    BenchEvents events;
    events.progress = [bar = ProgressBar{}](const std::string& what, double fraction) { bar.draw(what, fraction); };
    events.stop = interrupted;
    events.timing = [&context, start = std::chrono::steady_clock::now()]() mutable {
        const auto now = std::chrono::steady_clock::now();
        (context.deviceStates.empty() ? context.verifiedSeconds : context.timedSeconds) =
            std::chrono::duration<double>(now - start).count();
        start = now;
        context.deviceStates.push_back(readDeviceStates());
    };
    return events;
}

RunContext runContext(const Devices& devices, const Workload& workload, const Scene& scene) {
    RunContext context = hostContext();
    context.devices = devices.caps;
    context.sceneName = scene.name;
    context.scene = sceneStats(scene);
    context.workload = workload.settings;
    return context;
}

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
    if (done || interrupted() || results.empty()) return kExitDone;
    return reportError(
        {Fault::device, "no case could run; the first, " + results.front().id + ": " + results.front().reason});
}

}  // namespace skinbench
