#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <format>
#include <iostream>
#include <random>
#include <utility>

#include "apps/apps.h"
#include "common/core/file.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

std::atomic<int64_t> stopRequested = 0;  // when, in nanoseconds; 0: it was not

// The first signal asks to end, a later one ends at once. Within a second it is the same request: coreutils' timeout
// sends its signal to the process and to the process's group.
void onSignal(int signal) {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const int64_t at = int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
    int64_t first = 0;
    if (stopRequested.compare_exchange_strong(first, at) || at - first < 1'000'000'000) return;
    ::signal(signal, SIG_DFL);
    raise(signal);
}

// Nothing was measured yet that could be kept.
void onEarlySignal(int signal) {
    constexpr std::string_view kLine = "skinbench: interrupted\n";
    const ssize_t written = write(STDERR_FILENO, kLine.data(), kLine.size());
    static_cast<void>(written);
    ::signal(signal, SIG_DFL);
    raise(signal);
}

// A signal that whoever started the program ignores stays ignored.
void catchWith(void (*handler)(int)) {
    for (int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action = {}, before = {};
        sigaction(signal, nullptr, &before);
        if (before.sa_handler == SIG_IGN) continue;
        action.sa_handler = handler;
        sigaction(signal, &action, nullptr);
    }
}

std::string leftText(double seconds) {
    return seconds < 90 ? std::format("{:.0f} s left", std::ceil(seconds))
                        : std::format("{:.0f} min left", std::ceil(seconds / 60));
}

// A bar with the time left, in one line of 80 columns, on a terminal only.
void drawProgress(const Progress& progress) {
    if (!isatty(STDERR_FILENO)) return;
    if (progress.fraction >= 1) {
        std::cerr << "\r\x1b[K" << std::flush;
        return;
    }
    const auto filled = static_cast<size_t>(progress.fraction * 16);
    const std::string left = progress.secondsLeft ? leftText(*progress.secondsLeft) : "";
    std::cerr << std::format("\r\x1b[K[{}{}] {:3.0f} %  {:>11}  {}", std::string(filled, '#'),
                             std::string(16 - filled, '.'), progress.fraction * 100, left, progress.what.substr(0, 40))
              << std::flush;
}

}  // namespace

void catchEarlyInterrupts() { catchWith(onEarlySignal); }

void catchInterrupts() {
    catchWith(onSignal);
    ::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() { return stopRequested != 0; }

BenchEvents consoleEvents(RunContext& context) {
    BenchEvents events;
    events.progress = [](const Progress& progress) {
        noteDoing(progress.what);
        drawProgress(progress);
    };
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

Checkpoint nowAndThen(Checkpoint write) {
    using Clock = std::chrono::steady_clock;
    return [write = std::move(write), next = Clock::now()](const std::vector<CaseResult>& results) mutable {
        const auto start = Clock::now();
        if (start < next) return;
        write(results);
        next = Clock::now() + (Clock::now() - start) * 10;
    };
}

void warnOnce(bool& warned, const Result<void>& written) {
    if (written || std::exchange(warned, true)) return;
    warn(written.error().text + "; the run goes on and tries again");
}

Result<void> checkSuffix(const std::string& path, const std::string& wanted) {
    const std::string suffix = std::filesystem::path(path).extension();
    if (suffix.empty() || std::ranges::equal(suffix, wanted, {}, [](unsigned char c) { return std::tolower(c); }))
        return {};
    return inputError(path + ": what is written is no " + suffix + " file; name one that ends in " + wanted);
}

void keepPrevious(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code failed;
    if (!fs::is_regular_file(fs::symlink_status(path, failed))) return;
    fs::path previous(path);
    previous.replace_extension(".previous" + previous.extension().string());
    const fs::path link = previous.string() + ".part";
    fs::remove(link, failed);
    fs::create_hard_link(path, link, failed);
    // A file system without links. Where the disk is full, what is there stays.
    const bool linked = !failed, without = failed == std::errc::operation_not_permitted ||
                                           failed == std::errc::operation_not_supported ||
                                           failed == std::errc::function_not_supported;
    if (linked || without) fs::rename(linked ? link : fs::path(path), previous, failed);
    if (linked) fs::remove(link, failed);  // rename leaves both where they are one file already
}

int writeOutputs(const std::vector<std::pair<std::string, std::string>>& files, bool printed,
                 const std::function<void()>& beforeReplacing) {
    const auto written = writeWholeFiles(files, beforeReplacing);
    if (written) return kExitDone;
    std::string text = written.error().text;
    if (!printed) {
        const std::string folder = std::filesystem::temp_directory_path();
        const std::string other = std::format("{}/skinbench-{:08x}.json", folder, std::random_device{}());
        if (writeWholeFile(other, files.front().second)) text += "; the results are in " + other;
    }
    return reportError({Fault::device, text});
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
        return reportError(
            {Fault::device, std::format("{} of {} failed; the first, {}: {}", failed, counted(results.size(), "case"),
                                        firstFailed->id, firstFailed->reason)});
    if (done || results.empty()) return kExitDone;
    if (interrupted()) return reportError({Fault::device, "interrupted before a case was done"});
    return reportError(
        {Fault::device, "no case could run; the first, " + results.front().id + ": " + results.front().reason});
}

}  // namespace skinbench
