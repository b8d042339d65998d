#include <algorithm>
#include <format>
#include <iostream>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/selectors.h"
#include "common/core/file.h"
#include "common/core/text.h"
#include "common/theses/reproduce.h"

namespace skinbench {
namespace {

// --- which cases -----------------------------------------------------------------------------------------------

// What every line of cases starts from: routes and raster modes as asked for, one value on all other axes.
AxisWords plainWords(const Selectors& given) {
    AxisWords words;
    words["route"] = given.words.at("route");
    words["raster"] = presetRasters(given);
    words["zero_weights"] = {"load"};  // as the programs of the theses do
    return words;
}

// `words` with other values on some axes.
AxisWords with(AxisWords words, const AxisWords& others) {
    for (const auto& [name, values] : others) words[name] = values;
    return words;
}

std::vector<AxisWords> torabiCases(const AxisWords& plain, bool cacheOrder) {
    const AxisWords own = with(plain, {{"builder", {"scan"}},
                                       {"vertex_fetch", {"attributes"}},
                                       {"ci_grouping", {ciGroupingName(CiGrouping::triangles)}},
                                       {"ci_key", {ciKeyName(CiKey::ordered)}},
                                       {"variant", {"vertex", "mesh", "mesh-ci"}}});
    if (!cacheOrder) return {own};
    return {
        with(own, {{"variant", {"none", "vertex", "compute", "mesh", "mesh-ci"}}, {"scenario", {"direct", "prepass"}}}),
        with(own, {{"variant", {"vertex"}}, {"vertex_fetch", {"pull"}}}),
        with(own, {{"variant", {"mesh"}}, {"cull", {"torabi", "compact"}}}),
        with(own, {{"variant", {"mesh-ci"}}, {"ci_vertices", {"fat"}}}),
        with(plain, {{"variant", {"mesh", "mesh-ci"}}})};
}

std::vector<AxisWords> kimmersdorferCases(const AxisWords& plain) {
    return {with(plain, {{"variant", {"mesh"}}, {"codec", {"uc", "oss", "pc", "pdc8", "pdc16", "pdc32", "dpdc16"}}}),
            with(plain, {{"variant", {"mesh"}}, {"codec", {"uc", "pc"}}, {"layout", {"fixed"}}}),
            with(plain, {{"variant", {"vertex"}}, {"codec", {"uc", "oss", "pc"}}, {"vertex_fetch", {"pull"}}})};
}

// One prepared scene and the lines of cases that are timed on it.
struct PlannedRun {
    Geometry geometry;
    bool cacheOrder;
    std::vector<AxisWords> lines;
    std::vector<Case> cases{};  // the lines, crossed
};

// With and without vertex-cache order.
std::vector<PlannedRun> torabiRuns(const AxisWords& plain) {
    return {{.geometry = Geometry::welded, .cacheOrder = true, .lines = torabiCases(plain, true)},
            {.geometry = Geometry::welded, .cacheOrder = false, .lines = torabiCases(plain, false)}};
}

std::vector<PlannedRun> kimmersdorferRuns(const AxisWords& plain) {
    return {{.geometry = Geometry::unwelded, .cacheOrder = true, .lines = kimmersdorferCases(plain)},
            {.geometry = Geometry::welded, .cacheOrder = true, .lines = kimmersdorferCases(plain)}};
}

struct Thesis {
    const char* name;
    Reproduction (*reproduce)(const std::vector<ReproduceScene>& scenes);
    std::vector<PlannedRun> (*runs)(const AxisWords& plain);
    bool roundedErrors = false;  // its tables hold the errors of rounded attributes
};

const std::vector<Thesis>& thesisTable() {
    static const std::vector<Thesis> rows = {
        {.name = "torabi", .reproduce = reproduceTorabi, .runs = torabiRuns},
        {.name = "kimmersdorfer",
         .reproduce = reproduceKimmersdorfer,
         .runs = kimmersdorferRuns,
         .roundedErrors = true},
    };
    return rows;
}

Result<std::vector<PlannedRun>> plannedRuns(const Thesis& thesis, const Selectors& given) {
    std::vector<PlannedRun> runs = thesis.runs(plainWords(given));
    for (PlannedRun& run : runs) {
        auto cases = crossedOnce(run.lines);
        SKINBENCH_TRY(cases);
        run.cases = std::move(*cases);
    }
    return runs;
}

// --- running them ----------------------------------------------------------------------------------------------

// Fills in what was not given: the geometry preset for a GPU, as little as shows the path for software drivers.
void chooseSizes(Selectors& s, bool anyHardware) {
    if (anyHardware) {
        s.preset = "geometry";
        return;
    }
    s.copies = s.copies ? s.copies : 1;
    s.frames = s.frames ? s.frames : 2;
    s.rounds = s.rounds ? s.rounds : 1;
}

struct Reproducing {
    const Thesis& thesis;
    const Selectors& selectors;
    const Devices& devices;
    const std::vector<PlannedRun>& runs;
    std::function<void(const ReproduceScene&)> save;  // with the scenes that are done
    std::vector<CaseResult> results;                  // of all runs
};

Result<ReproduceRun> runPlanned(Reproducing& all, const ReproduceScene& before, Workload& workload,
                                const PlannedRun& planned) {
    auto scene = sceneFor(workload, planned.cases.front().influences);
    SKINBENCH_TRY(scene);
    RunContext context = runContext(all.devices, workload, **scene);
    context.bench = benchSettings(all.selectors, all.devices.anyHardware);
    context.bench.limits = false;  // no table has them
    auto runOf = [&](const std::vector<CaseResult>& results) {
        return ReproduceRun{planned.geometry, planned.cacheOrder, resultsJson(context, results)};
    };
    BenchEvents events = consoleEvents(context);
    events.checkpoint = nowAndThen([&](const std::vector<CaseResult>& soFar) {
        ReproduceScene scene = before;
        scene.runs.push_back(runOf(soFar));
        all.save(scene);
    });
    auto results = runBench(workload, planned.cases, all.devices.byApi, context.bench, events);
    SKINBENCH_TRY(results);
    all.results.insert(all.results.end(), results->begin(), results->end());
    return runOf(*results);
}

Result<ReproduceScene> runScene(Reproducing& all, Workload& given) {
    InspectSettings settings;
    settings.all = true;
    settings.keys = {CiKey::ordered, CiKey::set, CiKey::fit};
    say(given.stored.name + ": cutting and coding");
    auto inspection = inspectScene(given.stored, settings);
    SKINBENCH_TRY(inspection);
    ReproduceScene scene{std::move(*inspection), {}, {}};
    if (all.thesis.roundedErrors) {
        auto errors = roundedErrors(given.stored);
        SKINBENCH_TRY(errors);
        scene.errors = std::move(*errors);
    }
    for (const PlannedRun& planned : all.runs) {
        say(std::format("{}: {}, {}{}", given.stored.name, counted(planned.cases.size(), "case"),
                        geometryName(planned.geometry), planned.cacheOrder ? "" : ", order of the file"));
        WorkloadSettings workloadSettings = given.settings;
        workloadSettings.prepare.geometry = planned.geometry;
        workloadSettings.prepare.cacheOrder = planned.cacheOrder;
        auto workload = makeWorkload(given.stored, given.shaders, workloadSettings);
        SKINBENCH_TRY(workload);
        auto run = runPlanned(all, scene, *workload, planned);
        SKINBENCH_TRY(run);
        scene.runs.push_back(std::move(*run));
    }
    return scene;
}

constexpr const char* kFiles[] = {"/reproduce.json", "/reproduce.md", "/reproduce.html"};

// Path and text of each, rebuilt from the scenes that are done; the JSON is the first.
std::vector<std::pair<std::string, std::string>> filesOf(const ReproduceOptions& options, const Thesis& thesis,
                                                         const std::vector<ReproduceScene>& scenes) {
    const Reproduction reproduction = thesis.reproduce(scenes);
    return {{options.out + kFiles[0], dumpJson(reproduceJson(reproduction, scenes)) + "\n"},
            {options.out + kFiles[1], reproduceMarkdown(reproduction, scenes)},
            {options.out + kFiles[2], reproduceHtml(reproduction, scenes)}};
}

// Files of an earlier run stay until this one has some of its own.
void keepOthers(const ReproduceOptions& options, bool& begun) {
    if (std::exchange(begun, true)) return;
    for (const char* name : kFiles) keepPrevious(options.out + name);
    noteKept(options.out + kFiles[0]);
}

void saveAll(const ReproduceOptions& options, const Thesis& thesis, const std::vector<ReproduceScene>& scenes,
             bool& begun, bool& warned) {
    warnOnce(warned, writeWholeFiles(filesOf(options, thesis, scenes), [&] { keepOthers(options, begun); }));
}

std::vector<const Route*> routesOf(const std::vector<PlannedRun>& runs) {
    std::vector<const Route*> needed;
    for (const PlannedRun& run : runs)
        for (const Case& c : run.cases) needed.push_back(c.route);
    return needed;
}

}  // namespace

int runReproduce(const ReproduceOptions& options) {
    const auto thesis = std::ranges::find(thesisTable(), options.thesis, &Thesis::name);
    if (thesis == thesisTable().end())
        return reportError(
            {Fault::input, std::format("no thesis '{}'; there is {}", options.thesis, tableNames(thesisTable()))});
    Selectors selectors = options.selectors;
    auto early = plannedRuns(*thesis, selectors);
    if (!early) return reportError(early.error());
    if (auto settings = workloadSettings(selectors, false); !settings) return reportError(settings.error());
    auto devices = openDevices(routesOf(*early), selectors.device, selectors.validation);
    if (!devices) return reportError(devices.error());
    chooseSizes(selectors, devices->anyHardware);
    auto settings = workloadSettings(selectors, devices->anyHardware);
    auto runs = plannedRuns(*thesis, selectors);
    if (!runs) return reportError(runs.error());

    std::vector<std::string> names;
    for (const std::string& name : options.scenes)
        if (!std::ranges::contains(names, name)) names.push_back(name);
    if (names.empty()) names = {"builtin:biped", "builtin:robot", "builtin:creature"};
    std::vector<Workload> workloads;
    for (const std::string& name : names) {
        auto workload = openWorkload(name, *settings);
        if (!workload) return reportError(workload.error());
        workloads.push_back(std::move(*workload));
    }
    // A folder that cannot be written is reported before minutes are spent.
    for (const char* name : kFiles)
        if (auto possible = checkOutput(options.out + name, names); !possible) return reportError(possible.error());
    catchInterrupts();
    std::vector<ReproduceScene> scenes;
    bool begun = false, warned = false;
    auto save = [&](const ReproduceScene& partly) {
        std::vector<ReproduceScene> all = scenes;
        all.push_back(partly);
        saveAll(options, *thesis, all, begun, warned);
    };
    Reproducing all{*thesis, selectors, *devices, *runs, save, {}};
    for (Workload& workload : workloads) {
        if (interrupted()) break;
        auto scene = runScene(all, workload);
        if (!scene) return reportError(scene.error());
        scenes.push_back(std::move(*scene));
        workload = {};
        saveAll(options, *thesis, scenes, begun, warned);
    }
    const auto files = filesOf(options, *thesis, scenes);
    std::cout << (options.json ? files.front().second : reproduceText(thesis->reproduce(scenes)));
    const int printed = flushOutput();
    const int written = writeOutputs(files, options.json, [&] { keepOthers(options, begun); });
    if (written == kExitDone) say(options.out + "/reproduce.md, reproduce.html, reproduce.json");
    const int status = statusOf(all.results);
    if (interrupted() && status == kExitDone) say("interrupted; what was measured until then is kept");
    return std::max({status, printed, written});
}

}  // namespace skinbench
