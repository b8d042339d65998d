#include "common/report/report.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <format>
#include <fstream>

#include "common/core/text.h"
#include "common/core/version.h"
#include "common/report/answers.h"
#include "common/report/columns.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

static std::string firstValue(const char* file, const std::string& key, char separator) {
    std::ifstream lines(file);
    for (std::string line; std::getline(lines, line);) {
        if (line.compare(0, key.size(), key) != 0) continue;
        size_t start = line.find(separator);
        if (start == std::string::npos) continue;
        start = line.find_first_not_of(" \t\"", start + 1);
        if (start == std::string::npos) continue;
        return line.substr(start, line.find_last_not_of(" \t\"") + 1 - start);
    }
    return {};
}

RunContext hostContext() {
    RunContext context;
    context.version = SKINBENCH_VERSION;
    context.revision = SKINBENCH_REVISION;
    context.buildType = SKINBENCH_BUILD_TYPE;
    utsname system{};
    uname(&system);
    context.os = firstValue("/etc/os-release", "PRETTY_NAME", '=') + ", " + system.sysname + " " + system.release;
    context.cpu = firstValue("/proc/cpuinfo", "model name", ':');
    if (context.cpu.empty()) context.cpu = system.machine;
    return context;
}

Json sceneJson(const std::string& name, const SceneStats& stats) {
    return {{"name", name},
            {"vertices", stats.vertices},
            {"triangles", stats.triangles},
            {"joints", stats.joints},
            {"unique_tuples", stats.uniqueTuples},
            {"mean_influences", stats.meanInfluences},
            {"max_influences", stats.maxInfluences}};
}

std::string sceneText(const SceneStats& stats) {
    return std::format("{}, {}, {}, {}, {:.2f} influences ({} at the most)",
                       counted(stats.vertices, "vertex", "vertices"), counted(stats.triangles, "triangle"),
                       counted(stats.joints, "joint"), counted(stats.uniqueTuples, "tuple"), stats.meanInfluences,
                       stats.maxInfluences);
}

static Json meshLimitsJson(const MeshLimitsOfDevice& limits) {
    if (!limits.available) return nullptr;
    return {{"max_vertices", limits.maxVertices},
            {"max_triangles", limits.maxTriangles},
            {"max_group_size", limits.maxGroupSize},
            {"max_group_count", limits.maxGroupCount},
            {"max_output_bytes", limits.maxOutputBytes},
            {"max_shared_bytes", limits.maxSharedBytes},
            {"preferred_group_size", limits.preferredGroupSize}};
}

static Json wordOrNull(const std::string& word) { return word.empty() ? Json(nullptr) : Json(word); }

Json capsJson(const DeviceCaps& caps) {
    return {{"route_api", namesOf(caps.api).key},
            {"number", caps.number},
            {"name", caps.name},
            {"label", caps.label.empty() ? caps.name : caps.label},
            {"uuid", wordOrNull(caps.uuid)},
            {"pci", wordOrNull(caps.pci)},
            {"driver", caps.driver},
            {"software", caps.software},
            {"timestamp_period_ns", caps.timestampPeriodNs},
            {"version", caps.version},
            {"timestamp_bits", caps.timestampBits},
            {"mesh_ext", meshLimitsJson(caps.ext)},
            {"mesh_nv", meshLimitsJson(caps.nv)},
            {"subgroup_size", caps.subgroupSize},
            {"mesh_subgroups", caps.meshSubgroups},
            {"subpixel_bits", caps.subpixelBits},
            {"max_compute_shared_bytes", caps.maxComputeSharedBytes},
            {"max_compute_group_size", caps.maxComputeGroupSize},
            {"max_storage_bytes", caps.maxStorageBytes},
            {"max_uniform_bytes", caps.maxUniformBytes},
            {"storage_blocks_vertex", caps.storageBlocksVertex},
            {"device_bytes", caps.deviceBytes},
            {"pipeline_statistics", caps.pipelineStatistics},
            {"mesh_counters", caps.meshCounters},
            {"last_mesh_output_lost", caps.lastMeshOutputLost},
            {"mesh_depth_differs", caps.meshDepthDiffers},
            {"primitive_cull_ignored", caps.primitiveCullIgnored}};
}

std::string deviceLabel(const Json& device) {
    const auto label = device.find("label");
    return (label != device.end() && label->is_string() ? *label : device["name"]).get<std::string>();
}

// Keys of the case itself, or of its `options`; the latter hold what means something to the case, as words.
static void addAxes(Json& to, const Case& c, bool topLevel) {
    for (const Axis& axis : axes()) {
        if (!axis.benched || axis.topLevel != topLevel || (!topLevel && !axis.applies(c))) continue;
        const std::string word = axis.get(c);
        to[axis.name] = word.empty() ? Json(nullptr) : Json(word);
    }
}

static Json optionsJson(const Case& c) {
    Json options = Json::object();
    addAxes(options, c, false);
    if (c.builder) {
        options["meshlet_vertices"] = std::to_string(c.limits.vertices);
        options["meshlet_triangles"] = std::to_string(c.limits.triangles);
    }
    return options;
}

// The names of an API's routes, by the API as devices name it.
static Json routesOf(const std::string& api) {
    Json names = Json::array();
    for (const Route& route : routes())
        if (namesOf(route.api).key == api) names.push_back(route.name);
    return names;
}

Json routeTableJson() {
    constexpr const char* kDialects[] = {"none", "ext", "nv"};
    Json rows = Json::array();
    for (const Route& route : routes())
        rows.push_back({{"name", route.name},
                        {"api", namesOf(route.api).key},
                        {"api_name", namesOf(route.api).name},
                        {"dialect", kDialects[static_cast<size_t>(route.dialect)]}});
    return rows;
}

Json axesJson() {
    Json rows = Json::array();
    for (const Axis& axis : axes()) {
        if (!axis.benched) continue;
        rows.push_back({{"name", axis.name},
                        {"option", "--" + axis.option.name},
                        {"changes", changesName(axis.changes)},
                        {"top_level", axis.topLevel},
                        {"usual", axis.usual.empty() ? Json(nullptr) : Json(axis.usual)},
                        {"values", axis.words},
                        {"beside", axis.beside.empty() ? Json(nullptr) : Json(axis.beside)}});
    }
    return rows;
}

static Json caseJson(const ResultInRun& of) {
    const CaseResult& result = of.result;
    Json json = {{"id", result.id}};
    addAxes(json, result.theCase, true);
    json["options"] = optionsJson(result.theCase);
    putColumns(json, of);
    // Passes that a variant names as it likes have no column.
    if (isTimed(result))
        for (const auto& [label, times] : result.figures->passes) json["passes_ms"][label] = times.median;
    return json;
}

static Json limitJson(const ResultInRun& of) {
    const Case& c = of.result.theCase;
    Json json = {{"id", of.result.id}, {"route", c.route->name}, {"raster", findAxis("raster")->get(c)}};
    putColumns(json, of, {"status", "reason", "gpu_ms", "counters"});
    return json;
}

// The device's copy bandwidth, and the most triangles a second that a limit of this run reached.
static Json peakJson(const RunContext& context, const std::vector<CaseResult>& results, Api api) {
    double most = 0;
    for (const CaseResult& result : results)
        if (result.isLimit && result.theCase.route->api == api && isTimed(result) && medianOf(result) > 0)
            most = std::max(most, static_cast<double>(context.scene.triangles) * context.workload.copies *
                                      result.theCase.views / (medianOf(result) * 1e-3));
    auto copied = context.copyBandwidth.find(api);
    if (most == 0 && copied == context.copyBandwidth.end()) return nullptr;
    return {{"copy_bytes_per_s", copied == context.copyBandwidth.end() ? Json(nullptr) : Json(copied->second)},
            {"triangles_per_s", most > 0 ? Json(most) : Json(nullptr)}};
}

static Json statesJson(const std::vector<DeviceState>& states) {
    auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
    Json list = Json::array();
    for (const DeviceState& state : states)
        list.push_back({{"device", state.device},
                        {"uuid", wordOrNull(state.uuid)},
                        {"pci", wordOrNull(state.pci)},
                        {"sm_clock_mhz", number(state.smClockMhz)},
                        {"memory_clock_mhz", number(state.memoryClockMhz)},
                        {"temperature_c", number(state.temperatureC)},
                        {"power_w", number(state.powerW)},
                        {"power_state", wordOrNull(state.powerState)}});
    return list;
}

static Json environmentJson(const RunContext& context) {
    const auto& states = context.deviceStates;
    return {{"before", states.empty() ? Json::array() : statesJson(states.front())},
            {"after", states.size() < 2 ? Json::array() : statesJson(states.back())},
            {"verified_s", context.verifiedSeconds},
            {"timed_s", context.timedSeconds}};
}

// A case of the self-test and its twin behind it.
struct Twins {
    const CaseResult *a, *b;
};

static std::vector<Twins> timedTwins(const std::vector<CaseResult>& results) {
    std::vector<Twins> twins;
    for (size_t i = 1; i < results.size(); ++i)
        if (results[i].isAgain && isTimed(results[i]) && isTimed(results[i - 1]))
            twins.push_back({&results[i - 1], &results[i]});
    return twins;
}

static double differenceOf(const Twins& twins) {
    const double a = medianOf(*twins.a), b = medianOf(*twins.b);
    return a == 0 ? 0 : std::abs(b - a) / a;
}

// Below it a difference is never told: what timestamps and clocks round.
constexpr double kResolution = 0.001;

static bool skinsOnHost(const CaseResult& result) { return result.theCase.variant->skinsOnHost; }

std::optional<double> noiseFloor(const std::vector<CaseResult>& results) {
    std::optional<double> floor;
    for (const Twins& twins : timedTwins(results))
        if (!skinsOnHost(*twins.a)) floor = std::max(floor.value_or(0), differenceOf(twins));
    return floor;
}

static Json selfTestJson(const std::vector<CaseResult>& results) {
    Json rows = Json::array();
    for (const Twins& twins : timedTwins(results)) {
        const Interval &a = twins.a->figures->wideInterval, &b = twins.b->figures->wideInterval;
        rows.push_back({{"id", twins.a->id},
                        {"a_ms", medianOf(*twins.a)},
                        {"b_ms", medianOf(*twins.b)},
                        {"difference", differenceOf(twins)},
                        {"equal", (a.low <= b.high && b.low <= a.high) || differenceOf(twins) <= kResolution}});
    }
    return rows;
}

// Whether a state is surely of a device that the run did not use.
static bool isOtherDevice(const RunContext& context, const DeviceState& state) {
    return !state.uuid.empty() && std::ranges::all_of(context.devices, [&](const DeviceCaps& caps) {
        return caps.software || (!caps.uuid.empty() && caps.uuid != state.uuid);
    });
}

constexpr double kMovedClock = 0.02, kDrift = 0.01, kUnlikely = 0.01;

static bool isTimedCase(const CaseResult& result) { return isTimed(result) && !result.isLimit; }

static std::string countedCases(const std::vector<CaseResult>& results) {
    return counted(static_cast<uint64_t>(std::ranges::count_if(results, isTimedCase)), "case");
}

static void addDrift(std::vector<std::string>& warnings, const std::vector<CaseResult>& results) {
    size_t drifted = 0;
    for (const CaseResult& result : results) {
        if (!isTimedCase(result) || skinsOnHost(result)) continue;
        const Drift& drift = result.figures->drift;
        drifted += drift.p && *drift.p < kUnlikely && drift.relative > kDrift;
    }
    if (drifted > 0)
        warnings.push_back(std::format("{} of {} drifted by more than {:.0f} % between rounds", drifted,
                                       countedCases(results), kDrift * 100));
}

static void addPrecision(std::vector<std::string>& warnings, const BenchSettings& settings,
                         const std::vector<CaseResult>& results) {
    size_t wide = 0;
    double worst = 0;
    const CaseResult* widest = nullptr;
    for (const CaseResult& result : results) {
        if (!isTimedCase(result) || settings.precision <= 0) continue;
        const double width = relativeHalfWidth(result.figures->interval, medianOf(result));
        wide += width > settings.precision;
        if (width <= worst) continue;
        worst = width;
        widest = &result;
    }
    if (wide > 0)
        warnings.push_back(
            std::format("precision: {} of {} did not reach {:g} %{}; the widest, {}, is known to ± {:.3g} %", wide,
                        countedCases(results), settings.precision * 100,
                        settings.timeLimit > 0 ? std::format(" within {:g} s (--time-limit)", settings.timeLimit) : "",
                        widest->id, worst * 100));
}

std::vector<std::string> figureWarnings(const RunContext& context, const std::vector<CaseResult>& results) {
    std::vector<std::string> warnings = context.warnings;
    if (context.buildType != "Release")
        warnings.push_back("this is a " + context.buildType + " build; times of the host are not those of a release");
    if (context.deviceStates.size() >= 2) {
        const auto &before = context.deviceStates.front(), &after = context.deviceStates.back();
        for (size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
            const auto &from = before[i].smClockMhz, &to = after[i].smClockMhz;
            if (isOtherDevice(context, before[i])) continue;
            if (from && to && std::abs(*to - *from) > kMovedClock * *from)
                warnings.push_back(std::format("the clock of {} moved from {:.0f} to {:.0f} MHz while cases were timed",
                                               before[i].device, *from, *to));
        }
    }
    addDrift(warnings, results);
    addPrecision(warnings, context.bench, results);
    return warnings;
}

static Json settingsJson(const RunContext& context) {
    auto positive = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
    return {{"copies", context.workload.copies},
            {"frames", context.bench.frames},
            {"warmup", context.bench.warmup},
            {"width", context.workload.width},
            {"height", context.workload.height},
            {"pose", context.workload.animated ? "animated" : "frozen"},
            {"camera", cameraNames()[static_cast<size_t>(context.workload.camera)]},
            {"character_pixels", positive(context.workload.characterPixels)},
            {"vertices_in_view", context.inView ? Json(context.inView->vertices) : Json(nullptr)},
            {"triangles_in_view", context.inView ? Json(context.inView->triangles) : Json(nullptr)},
            {"copies_in_view", context.inView ? Json(context.inView->copies) : Json(nullptr)},
            {"rounds", context.bench.rounds},
            {"precision", positive(context.bench.precision)},
            {"time_limit_s", positive(context.bench.timeLimit)},
            {"seed", context.bench.seed},
            {"placement", context.bench.freshPlacement ? "fresh" : "kept"},
            {"geometry", geometryName(context.workload.prepare.geometry)},
            {"cache_order", context.workload.prepare.cacheOrder}};
}

Json resultsJson(const RunContext& context, const std::vector<CaseResult>& results) {
    Json devices = Json::array(), limits = Json::array(), cases = Json::array();
    for (const DeviceCaps& caps : context.devices) {
        devices.push_back(capsJson(caps));
        devices.back()["routes"] = routesOf(namesOf(caps.api).key);
        devices.back()["peak"] = peakJson(context, results, caps.api);
    }
    for (const CaseResult& result : results) {
        const ResultInRun of{context, results, result};
        result.isLimit ? limits.push_back(limitJson(of)) : cases.push_back(caseJson(of));
    }
    Json calibrations = Json::array();
    for (const Calibration& calibration : context.calibrations) {
        Json tried = Json::array();
        for (const auto& [id, median] : calibration.tried) tried.push_back({{"id", id}, {"median_ms", median}});
        calibrations.push_back({{"chosen", calibration.chosen}, {"tried", tried}});
    }
    Json unused = Json::array();
    for (const Unused& words : context.unused)
        unused.push_back({{"option", words.option}, {"words", words.words}, {"reason", words.reason}});
    const std::optional<double> floor = noiseFloor(results);
    return {{"schema", kResultsSchema},
            {"tool", {{"version", context.version}, {"revision", context.revision}, {"build_type", context.buildType}}},
            {"host", {{"os", context.os}, {"cpu", context.cpu}}},
            {"command", context.command.empty() ? Json(nullptr) : Json(context.command)},
            {"devices", devices},
            {"scene", sceneJson(context.sceneName, context.scene)},
            {"settings", settingsJson(context)},
            {"environment", environmentJson(context)},
            {"warnings", figureWarnings(context, results)},
            {"answers", answersJson(context, results)},
            {"baseline", context.baseline},
            {"unused", unused},
            {"calibrations", calibrations},
            {"noise_floor", floor ? Json(*floor) : Json(nullptr)},
            {"self_test", context.bench.selfTest ? selfTestJson(results) : Json(nullptr)},
            {"axes", axesJson()},
            {"limits", limits},
            {"cases", cases}};
}

const std::vector<DrawnFact>& drawnFacts() {
    static const std::vector<DrawnFact> facts = {
        {"scene", "name"},       {"scene", "vertices"},  {"scene", "triangles"},
        {"scene", "joints"},     {"settings", "copies"}, {"settings", "width"},
        {"settings", "height"},  {"settings", "camera"}, {"settings", "character_pixels"},
        {"settings", "geometry"}};
    return facts;
}

std::vector<std::string> drawnDifferences(const Json& a, const Json& b) {
    std::vector<std::string> words;
    for (const auto& [group, key] : drawnFacts()) {
        const Json inA = a.value(group, Json::object()), inB = b.value(group, Json::object());
        if (!inA.contains(key) || !inB.contains(key) || inA[key] == inB[key]) continue;
        std::string word = group == std::string("scene") ? "scene" : key;
        std::ranges::replace(word, '_', ' ');
        if (!std::ranges::contains(words, word)) words.push_back(word);
    }
    return words;
}

static void addMissing(Json& to, const Json& from) {
    for (const auto& [name, value] : from.items())
        if (!to.contains(name)) to[name] = value;
}

void completeResults(Json& results) {
    for (Json& device : results["devices"]) {
        if (device["route_api"].is_string()) addMissing(device, {{"routes", routesOf(device["route_api"])}});
        addMissing(device, {{"label", device["name"]}, {"uuid", nullptr}, {"pci", nullptr}});
    }
    // Axes that came after the file. Before there was a choice, joints of zero weights were read, and vertices were
    // written last.
    addMissing(results, {{"axes", Json::array()}});
    const auto lacks = [&](const Json& axis) {
        return std::ranges::none_of(results["axes"], [&](const Json& known) {
            return known.is_object() && known.value("name", Json(nullptr)) == axis["name"];
        });
    };
    Json added = Json::array();
    for (const Json& axis : axesJson())
        if (lacks(axis)) added.push_back(axis);
    if (added.empty()) return;
    const auto isAdded = [&](const char* name) {
        return std::ranges::any_of(added, [&](const Json& axis) { return axis["name"] == name; });
    };
    const bool loads = isAdded("zero_weights"), last = isAdded("vertex_writes");
    for (const Json& axis : added) results["axes"].push_back(axis);
    for (Json& row : results["cases"]) {
        addMissing(row, {{"options", Json::object()}});
        if (!row["id"].is_string() || !row["options"].is_object()) continue;
        const std::string id = row["id"];
        auto c = parseCaseId(id.substr(0, id.find("+again")));
        if (!c) continue;
        if (loads) c->zeroWeights = ZeroWeights::load;
        if (last && c->cull == Cull::compact) c->vertexWrites = VertexWrites::last;
        Json ofCase = Json::object();
        addAxes(ofCase, *c, true);
        addMissing(row, ofCase);
        addMissing(row["options"], optionsJson(*c));
    }
}

bool isSoftwareRoute(const Json& results, const std::string& route) {
    const Route* const row = findRoute(route);
    return row && std::ranges::any_of(results["devices"], [&](const Json& device) {
               return device["route_api"] == namesOf(row->api).key && device["software"];
           });
}

bool isSoftware(const Json& results, const Json& row) { return isSoftwareRoute(results, row["route"]); }

}  // namespace skinbench
