#include <algorithm>
#include <filesystem>
#include <format>
#include <iostream>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/selectors.h"
#include "common/core/file.h"
#include "common/core/text.h"
#include "common/measure/peaks.h"

namespace skinbench {
namespace {

// The files of --out. Those of an earlier run stay until this one has a time, or as `verify` a verified case, of its
// own; then they are kept beside as results.previous.json and so on.
struct ResultFiles {
    std::string folder;  // empty: none
    bool timed = true;
    bool begun = false;  // ours are there

    std::string path(const char* name) const { return folder + "/" + name; }
};

constexpr const char* kResultFiles[] = {"results.json", "results.csv", "report.html"};

// Told before minutes are spent.
Result<void> checkFiles(const ResultFiles& files, const std::string& scene) {
    if (files.folder.empty()) return {};
    for (const char* name : kResultFiles) {
        std::error_code failed;
        const auto there = std::filesystem::symlink_status(files.path(name), failed);
        if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))
            return inputError(files.path(name) + ": is no regular file, and would be written again and again");
        SKINBENCH_TRY(checkOutput(files.path(name), {&scene, 1}));
    }
    return {};
}

bool isWorthAFile(const ResultFiles& files, const std::vector<CaseResult>& results) {
    return std::ranges::any_of(results, [&](const CaseResult& result) {
        return files.timed ? !result.total.empty() : result.status == CaseStatus::ok;
    });
}

// `own`: the run has something of its own.
bool mayWrite(const ResultFiles& files, bool own) {
    std::error_code failed;
    return !files.folder.empty() &&
           (files.begun || own || !std::filesystem::exists(files.path("results.json"), failed));
}

// Before the first files of this run replace those of the run before.
void keepOthers(ResultFiles& files) {
    if (std::exchange(files.begun, true)) return;
    for (const char* name : kResultFiles) keepPrevious(files.path(name));
    noteKept(files.path("results.json"));
}

std::vector<std::pair<std::string, std::string>> contentOf(const ResultFiles& files,
                                                           const nlohmann::ordered_json& json) {
    return {{files.path(kResultFiles[0]), dumpJson(json) + "\n"},
            {files.path(kResultFiles[1]), resultsCsv(json)},
            {files.path(kResultFiles[2]), reportHtml({json})}};
}

std::vector<const Route*> routesOf(const std::vector<Case>& cases) {
    std::vector<const Route*> needed;
    for (const Case& c : cases) needed.push_back(c.route);
    return needed;
}

// "auto" stands for the best route of the device.
Result<void> resolveAuto(Selectors& selectors) {
    std::vector<std::string>& routes = selectors.words["route"];
    const auto chosen = namesAuto(routes);
    SKINBENCH_TRY(chosen);
    if (!*chosen) return {};
    const auto choice = chooseRouteOf(selectors.device);
    SKINBENCH_TRY(choice);
    routes = {choice->route->name};
    say(std::string("route ") + choice->route->name + ": " + choice->reason);
    return {};
}

// The name of a variant, or the id of a case. What was named is selected.
Result<std::string> baselineOf(const RunOptions& options, const std::vector<Case>& cases) {
    const std::string& word = options.baseline;
    if (word.empty()) return kUsualBaseline;
    if (const Variant* const variant = findVariant(word)) {
        if (std::ranges::contains(cases, variant, &Case::variant)) return word;
        return inputError("--baseline " + word + ": no case of this run has that variant; --list shows them");
    }
    if (!word.contains('/'))
        return inputError(std::format("--baseline '{}' is neither a variant ({}) nor the id of a case", word,
                                      tableNames(variants())));
    auto parsed = parseCaseId(word);
    SKINBENCH_TRY(parsed);
    const std::string id = caseId(*parsed);
    if (std::ranges::find(cases, id, caseId) == cases.end())
        return inputError("--baseline " + id + " is not among the cases of this run; --list shows them");
    return id;
}

// A baseline that was named and has no time: its column is left out.
void sayUntimed(const RunOptions& options, const nlohmann::ordered_json& json) {
    const auto divided = [](const auto& row) { return !row["baseline_ms"].is_null(); };
    const auto timed = [](const auto& row) { return !row["gpu_ms"].is_null(); };
    if (!options.baseline.empty() && std::ranges::any_of(json["cases"], timed) &&
        std::ranges::none_of(json["cases"], divided))
        say("--baseline " + options.baseline + " has no time in this run, so no time is divided by it");
}

// Pairs of the self-test that differ beyond their intervals.
int selfTestStatus(const nlohmann::ordered_json& json) {
    if (!json["self_test"].is_array()) return kExitDone;
    const auto& rows = json["self_test"];
    const auto unequal = std::ranges::count_if(rows, [](const auto& row) { return !row["equal"]; });
    if (unequal == 0) return kExitDone;
    const bool kept = json["settings"]["placement"] == "kept";
    return reportError(
        {Fault::device, std::format("{} of {} {} beyond the intervals{}", unequal, counted(rows.size(), "equal pair"),
                                    unequal == 1 ? "differs" : "differ",
                                    kept ? "; --placement fresh averages over where buffers lie" : "")});
}

// What was measured goes to standard output first: the files' disk may be full.
int finishRun(const RunOptions& options, ResultFiles& files, const nlohmann::ordered_json& json,
              const std::vector<CaseResult>& results) {
    std::cout << (options.json ? dumpJson(json) + "\n" : resultsTable(json, terminalWidth()));
    const int printed = flushOutput();
    sayUntimed(options, json);
    const bool own = isWorthAFile(files, results);
    int written = kExitDone;
    if (mayWrite(files, own || !interrupted())) {
        written = writeOutputs(contentOf(files, json), options.json, [&] { keepOthers(files); });
        if (written == kExitDone) say(files.folder + "/results.json, results.csv, report.html");
    } else if (!files.folder.empty()) {
        say(files.path("results.json") + " is that of an earlier run");
    }
    if (interrupted() && own) say("interrupted; what was measured until then is kept");
    int status = statusOf(results);
    if (status == kExitDone) status = selfTestStatus(json);
    return std::max({status, printed, written});
}

// An id may have what the options do not offer: the views, whose frames do other work than the case.
Result<void> checkBenched(const std::vector<Case>& cases) {
    for (const Case& c : cases)
        for (const Axis& axis : axes())
            if (!axis.benched && axis.applies(c) && axis.get(c) != axis.usual)
                return inputError(std::format("{}: what is measured is the usual {}, {}; leave out {}", caseId(c),
                                              axis.name, axis.usual, axis.idPart(c)));
    return {};
}

int runOnDevice(const RunOptions& options) {
    Selectors selectors = options.selectors;
    if (auto resolved = resolveAuto(selectors); !resolved) return reportError(resolved.error());
    auto cases = selectedCases(selectors);
    if (!cases) return reportError(cases.error());
    if (auto benched = checkBenched(*cases); !benched) return reportError(benched.error());
    const auto baseline = baselineOf(options, *cases);
    if (!baseline) return reportError(baseline.error());
    const auto unused = selectors.caseIds.empty() ? unusedWords(selectors.words, *cases) : std::vector<Unused>();
    // Wrong settings are told before a device is opened, which takes a second.
    if (auto early = workloadSettings(selectors, false); !early) return reportError(early.error());
    if (options.list) return listCases(options, *cases, unused);
    auto devices = openDevices(routesOf(*cases), selectors.device, selectors.validation);
    if (!devices) return reportError(devices.error());
    auto settings = workloadSettings(selectors, devices->anyHardware);
    auto workload = openWorkload(selectors.scene, *settings);
    if (!workload) return reportError(workload.error());
    auto scene = sceneFor(*workload, cases->front().influences);
    if (!scene) return reportError(scene.error());
    if (auto skinned = checkSkinned(**scene); !skinned) return reportError(skinned.error());
    const auto seen = inView(*workload, cases->front().influences);
    if (!seen) return reportError(seen.error());
    const auto outside = viewWarning(*workload, *seen);
    if (!outside.empty()) warn(outside);

    ResultFiles files{options.out, options.timed};
    if (auto possible = checkFiles(files, selectors.scene); !possible) return reportError(possible.error());

    RunContext context = runContext(*devices, *workload, **scene);
    context.bench = benchSettings(selectors, devices->anyHardware);
    context.bench.timed = options.timed;
    context.inView = *seen;
    context.warnings = devices->notes;
    context.command = options.command;
    context.baseline = *baseline;
    context.unused = unused;
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
    bool warned = false;
    events.checkpoint = nowAndThen([&](const std::vector<CaseResult>& results) {
        if (!mayWrite(files, isWorthAFile(files, results))) return;
        const auto content = contentOf(files, resultsJson(context, results));
        warnOnce(warned, writeWholeFiles(content, [&] { keepOthers(files); }));
    });
    auto results = runBench(*workload, *cases, devices->byApi, context.bench, events);
    if (!results) return reportError(results.error());
    return finishRun(options, files, resultsJson(context, *results), *results);
}

}  // namespace

int runCases(const RunOptions& options) {
    return options.selectors.device == "all" ? runOnAllDevices(options, runOnDevice) : runOnDevice(options);
}

}  // namespace skinbench
