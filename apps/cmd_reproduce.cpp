#include <format>
#include <iostream>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/file.h"
#include "common/theses/reproduce.h"

namespace skinbench {
namespace {

struct Thesis {
    const char* name;
    Geometry geometry;  // its own
    Reproduction (*reproduce)(const std::vector<ReproduceScene>& scenes);
};

const Thesis* findThesis(const std::string& name) {
    static const Thesis rows[] = {{theses()[0], Geometry::welded, reproduceTorabi},
                                  {theses()[1], Geometry::unwelded, reproduceKimmersdorfer}};
    for (const Thesis& thesis : rows)
        if (name == thesis.name) return &thesis;
    return nullptr;
}

// --- which cases -----------------------------------------------------------------------------------------------

// What every line of cases starts from: routes, raster modes and back faces as asked for, one value on all other axes.
Selectors plainSelectors(const Selectors& given) {
    Selectors s;
    s.routes = given.routes;
    s.preset = given.preset;
    return s;
}

// The crossings one behind the other, each case once.
Result<std::vector<Case>> crossedOnce(const std::vector<Selectors>& all) {
    std::vector<Case> cases;
    std::set<std::string> known;
    std::optional<Error> firstError;
    for (const Selectors& selectors : all) {
        auto crossed = crossCases(selectors);
        if (!crossed && !firstError) firstError = crossed.error();
        if (!crossed) continue;
        for (const Case& which : *crossed)
            if (known.insert(caseId(which)).second) cases.push_back(which);
    }
    // A route may lack some of the lines; that it has none, or does not exist, is an error.
    if (cases.empty()) return std::unexpected(*firstError);
    return cases;
}

std::vector<Selectors> torabiCases(const Selectors& given, bool cacheOrder) {
    Selectors s = plainSelectors(given);
    s.builders = {"scan"};
    s.fetches = {"attributes"};
    s.ciGroupings = {ciGroupingName(CiGrouping::triangles)};
    s.ciKeys = {ciKeyName(CiKey::ordered)};
    s.variants = {"vertex", "mesh", "mesh-ci"};
    if (!cacheOrder) return {s};
    std::vector<Selectors> all;
    s.variants = {"none", "vertex", "compute", "mesh", "mesh-ci"};
    s.scenarios = {"direct", "prepass"};
    all.push_back(s);
    s.scenarios.clear();
    Selectors pulling = s;
    pulling.variants = {"vertex"};
    pulling.fetches = {"pull"};
    all.push_back(pulling);
    Selectors culling = s;
    culling.variants = {"mesh"};
    culling.culls = {"torabi", "compact"};
    all.push_back(culling);
    Selectors fat = s;
    fat.variants = {"mesh-ci"};
    fat.ciVertices = {"fat"};
    all.push_back(fat);
    Selectors ours = plainSelectors(given);
    ours.variants = {"mesh", "mesh-ci"};
    all.push_back(ours);
    return all;
}

std::vector<Selectors> kimmersdorferCases(const Selectors& given) {
    Selectors mesh = plainSelectors(given);
    mesh.variants = {"mesh"};
    mesh.codecs = {"uc", "oss", "pc", "pdc8", "pdc16", "pdc32", "dpdc16"};
    Selectors fixed = mesh;
    fixed.codecs = {"uc", "pc"};
    fixed.layouts = {"fixed"};
    Selectors vertex = mesh;
    vertex.variants = {"vertex"};
    vertex.codecs = {"uc", "oss", "pc"};
    vertex.fetches = {"pull"};
    return {mesh, fixed, vertex};
}

struct PlannedRun {
    Geometry geometry;
    bool cacheOrder;
    std::vector<Case> cases;
};

Result<std::vector<PlannedRun>> plannedRuns(const Thesis& thesis, const Selectors& given) {
    std::vector<PlannedRun> runs;
    auto add = [&](Geometry geometry, bool cacheOrder, const std::vector<Selectors>& lines) -> Result<void> {
        auto cases = crossedOnce(lines);
        if (!cases) return std::unexpected(cases.error());
        runs.push_back({geometry, cacheOrder, std::move(*cases)});
        return {};
    };
    const bool torabi = thesis.geometry == Geometry::welded;
    for (bool first : {true, false}) {
        // Torabi: with and without vertex-cache order. Kimmersdorfer: unwelded and welded.
        auto added = torabi ? add(Geometry::welded, first, torabiCases(given, first))
                            : add(first ? Geometry::unwelded : Geometry::welded, true, kimmersdorferCases(given));
        if (!added) return std::unexpected(added.error());
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
    std::function<Result<void>(const ReproduceScene&)> save;  // with the scenes that are done
    std::vector<CaseResult> results;                          // of all runs
};

Result<ReproduceRun> runPlanned(Reproducing& all, const ReproduceScene& before, Workload& workload,
                                const PlannedRun& planned) {
    auto scene = sceneFor(workload, planned.cases.front().influences);
    if (!scene) return std::unexpected(scene.error());
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
        return all.save(scene);
    });
    auto results = runBench(workload, planned.cases, all.devices.byApi, context.bench, events);
    if (!results) return std::unexpected(results.error());
    all.results.insert(all.results.end(), results->begin(), results->end());
    return runOf(*results);
}

Result<ReproduceScene> runScene(Reproducing& all, Workload& given) {
    InspectSettings settings;
    settings.keys = {CiKey::ordered, CiKey::set, CiKey::fit};
    std::cerr << "skinbench: " << given.stored.name << ": cutting and coding\n";
    auto inspection = inspectScene(given.stored, settings);
    if (!inspection) return std::unexpected(inspection.error());
    ReproduceScene scene{std::move(*inspection), {}, {}};
    if (all.thesis.geometry == Geometry::unwelded) {
        auto errors = roundedErrors(given.stored);
        if (!errors) return std::unexpected(errors.error());
        scene.errors = std::move(*errors);
    }
    for (const PlannedRun& planned : all.runs) {
        std::cerr << std::format("skinbench: {}: {} cases, {}{}\n", given.stored.name, planned.cases.size(),
                                 geometryName(planned.geometry), planned.cacheOrder ? "" : ", order of the file");
        WorkloadSettings workloadSettings = given.settings;
        workloadSettings.prepare.geometry = planned.geometry;
        workloadSettings.prepare.cacheOrder = planned.cacheOrder;
        auto workload = makeWorkload(given.stored, given.shaders, workloadSettings);
        if (!workload) return std::unexpected(workload.error());
        auto run = runPlanned(all, scene, *workload, planned);
        if (!run) return std::unexpected(run.error());
        scene.runs.push_back(std::move(*run));
    }
    return scene;
}

// Rebuilds everything from the scenes that are done, and writes it.
Result<nlohmann::ordered_json> writeAll(const ReproduceOptions& options, const Thesis& thesis,
                                        const std::vector<ReproduceScene>& scenes) {
    const Reproduction reproduction = thesis.reproduce(scenes);
    nlohmann::ordered_json json = reproduceJson(reproduction, scenes);
    const std::pair<const char*, std::string> files[] = {{"/reproduce.json", json.dump(1) + "\n"},
                                                         {"/reproduce.md", reproduceMarkdown(reproduction, scenes)},
                                                         {"/reproduce.html", reproduceHtml(reproduction, scenes)}};
    for (const auto& [name, text] : files)
        if (auto written = writeWholeFile(options.out + name, text); !written) return std::unexpected(written.error());
    return json;
}

std::vector<const Route*> routesOf(const std::vector<PlannedRun>& runs) {
    std::vector<const Route*> needed;
    for (const PlannedRun& run : runs)
        for (const Case& which : run.cases) needed.push_back(which.route);
    return needed;
}

}  // namespace

int runReproduce(const ReproduceOptions& options) {
    const Thesis* thesis = findThesis(options.thesis);
    if (!thesis)
        return reportError(
            {Fault::input, std::format("no thesis '{}'; there is {}, {}", options.thesis, theses()[0], theses()[1])});
    Selectors selectors = options.selectors;
    auto early = plannedRuns(*thesis, selectors);
    if (!early) return reportError(early.error());
    if (auto settings = workloadSettings(selectors, false); !settings) return reportError(settings.error());
    auto devices = openDevices(routesOf(*early), {selectors.device, selectors.validation});
    if (!devices) return reportError(devices.error());
    chooseSizes(selectors, devices->anyHardware);
    auto settings = workloadSettings(selectors, devices->anyHardware);
    auto runs = plannedRuns(*thesis, selectors);
    if (!runs) return reportError(runs.error());

    std::vector<std::string> names = options.scenes;
    if (names.empty())
        for (const BuiltinScene& builtin : builtinScenes()) names.push_back(std::string("builtin:") + builtin.name);
    std::vector<Workload> workloads;
    for (const std::string& name : names) {
        auto workload = openWorkload(name, *settings);
        if (!workload) return reportError(workload.error());
        workloads.push_back(std::move(*workload));
    }
    catchInterrupts();
    std::vector<ReproduceScene> scenes;
    auto save = [&](const ReproduceScene& partly) -> Result<void> {
        std::vector<ReproduceScene> all = scenes;
        all.push_back(partly);
        auto written = writeAll(options, *thesis, all);
        return written ? Result<void>{} : std::unexpected(written.error());
    };
    Reproducing all{*thesis, selectors, *devices, *runs, save, {}};
    // A folder that cannot be written is told before minutes are spent.
    auto json = writeAll(options, *thesis, scenes);
    for (Workload& workload : workloads) {
        if (!json || interrupted()) break;
        auto scene = runScene(all, workload);
        if (!scene) return reportError(scene.error());
        scenes.push_back(std::move(*scene));
        workload = {};
        json = writeAll(options, *thesis, scenes);
    }
    if (!json) return reportError(json.error());
    std::cout << (options.json ? json->dump(1) + "\n" : reproduceText(thesis->reproduce(scenes)));
    std::cerr << "skinbench: " << options.out << "/reproduce.md, reproduce.html, reproduce.json\n";
    if (interrupted()) std::cerr << "skinbench: interrupted; what was measured until then is kept\n";
    return statusOf(all.results);
}

}  // namespace skinbench
