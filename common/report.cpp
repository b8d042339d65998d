#include "common/report.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <format>
#include <fstream>

#include <nlohmann/json.hpp>

#include "common/file.h"
#include "common/stats.h"
#include "common/version.h"

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

Json capsJson(const DeviceCaps& caps) {
    return {{"route_api", caps.api == Api::vulkan ? "vulkan" : "opengl"},
            {"name", caps.name},
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
            {"last_mesh_output_lost", caps.lastMeshOutputLost},
            {"mesh_depth_differs", caps.meshDepthDiffers},
            {"primitive_cull_ignored", caps.primitiveCullIgnored}};
}

static Json timesJson(const std::vector<double>& samples) {
    if (samples.empty()) return nullptr;
    const Summary s = summarise(samples);
    return {{"mean", s.mean}, {"median", s.median}, {"min", s.min}, {"max", s.max}, {"cv", s.cv}, {"samples", samples}};
}

static Json passesJson(const CaseResult& result) {
    if (result.total.empty()) return nullptr;
    Json passes = {{"skin", nullptr}, {"depth", nullptr}, {"draw", nullptr}};
    for (const auto& [label, samples] : result.passes) passes[label] = summarise(samples).median;
    return passes;
}

static Json memoryJson(const std::optional<MemoryBytes>& memory) {
    if (!memory) return nullptr;
    return {{"vertex", memory->vertex},   {"index", memory->index},
            {"meshlet", memory->meshlet}, {"additional_meshlet", memory->additionalMeshlet},
            {"tuple", memory->tuple},     {"palette", memory->palette},
            {"skinned", memory->skinned}, {"total", memory->total()}};
}

static Json accuracyJson(const CaseResult& result) {
    if (!result.accuracy) return nullptr;
    const Accuracy& accuracy = *result.accuracy;
    // JSON has no infinity, which stands for a value that was not finite.
    auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
    const bool image = !accuracy.imageReference.empty();
    return {{"max_position_error", finite(accuracy.error.position)},
            {"max_normal_error", finite(accuracy.error.normal)},
            {"tolerance", accuracy.tolerance},
            {"codec_position_error", finite(accuracy.codecError.position)},
            {"codec_normal_error", finite(accuracy.codecError.normal)},
            {"image_difference", image ? Json(accuracy.imageDifference) : Json(nullptr)},
            {"image_reference", image ? Json(accuracy.imageReference) : Json(nullptr)}};
}

static Json optionsJson(const Case& which) {
    Json options = {{"influences", std::to_string(which.influences)},
                    {"submission", which.submission == Submission::batched ? "batched" : "per-copy"},
                    {"back_faces", which.keepBackFaces ? "kept" : "culled"}};
    if (which.variant->fetches && which.route->dialect == MeshDialect::none)
        options["vertex_fetch"] = which.fetch == VertexFetch::pull ? "pull" : "attributes";
    if (which.variant == findVariant("compute")) options["compute"] = computeName(which.compute);
    if (usesPartition(which)) options["palette_slots"] = std::to_string(which.paletteSlots);
    if (which.builder) {
        options["meshlet_vertices"] = std::to_string(which.limits.vertices);
        options["meshlet_triangles"] = std::to_string(which.limits.triangles);
        options["group_size"] = std::to_string(which.groupSize);
        if (which.route->dialect == MeshDialect::nv) options["index_writes"] = which.packedWrites ? "packed" : "single";
        options["joints"] = jointSourceName(which.shape.joints);
        options["loads"] = which.shape.clampedLoads ? "clamped" : "guarded";
        options["records"] = which.shape.orderedRecords ? "ordered" : "indexed";
        options["palette"] = which.shape.uniformPalette ? "uniform" : "storage";
        if (which.cull != Cull::off) options["exchange"] = exchangeName(which.exchange);
        if (sharesJointLists(which)) {
            options["ci_grouping"] = ciGroupingName(which.common.grouping);
            if (which.common.grouping == CiGrouping::triangles) options["ci_key"] = ciKeyName(which.common.key);
            options["ci_min"] = std::to_string(which.common.minVertices);
            options["ci_vertices"] = which.common.fat ? "fat" : "slim";
        }
    }
    return options;
}

static const char* statusName(CaseStatus status) {
    switch (status) {
        case CaseStatus::ok:
            return "ok";
        case CaseStatus::skipped:
            return "skipped";
        case CaseStatus::failed:
            return "failed";
    }
    return "?";
}

static Json caseJson(const CaseResult& result) {
    const Case& which = result.which;
    const bool timed = result.status == CaseStatus::ok && !result.total.empty();
    return {{"id", result.id},
            {"route", which.route->name},
            {"variant", which.variant->name},
            {"codec", which.codec->name},
            {"builder", which.builder ? Json(which.builder->name) : Json(nullptr)},
            {"layout", which.layout ? Json(which.layout->name) : Json(nullptr)},
            {"cull", cullName(which.cull)},
            {"scenario", scenarioName(which.scenario)},
            {"raster", rasterName(which.raster)},
            {"options", optionsJson(which)},
            {"status", statusName(result.status)},
            {"reason", result.status == CaseStatus::ok ? Json(nullptr) : Json(result.reason)},
            {"gpu_ms", timed ? timesJson(result.total) : Json(nullptr)},
            {"passes_ms", timed ? passesJson(result) : Json(nullptr)},
            {"host_ms",
             timed ? Json{{"record", summarise(result.record).median}, {"submit", summarise(result.submit).median}}
                   : Json(nullptr)},
            {"limit_ms", nullptr},
            {"meshlets", which.builder && result.meshlets ? Json(result.meshlets) : Json(nullptr)},
            {"memory_bytes", memoryJson(result.memory)},
            {"accuracy", accuracyJson(result)}};
}

Json resultsJson(const RunContext& context, const std::vector<CaseResult>& results) {
    Json devices = Json::array(), cases = Json::array();
    for (const DeviceCaps& caps : context.devices) devices.push_back(capsJson(caps));
    for (const CaseResult& result : results) cases.push_back(caseJson(result));
    Json calibrations = Json::array();
    for (const Calibration& calibration : context.calibrations) {
        Json tried = Json::array();
        for (const auto& [id, median] : calibration.tried) tried.push_back({{"id", id}, {"median_ms", median}});
        calibrations.push_back({{"chosen", calibration.chosen}, {"tried", tried}});
    }
    const char* geometry[] = {"welded", "stored", "unwelded"};
    return {{"schema", kResultsSchema},
            {"tool", {{"version", context.version}, {"revision", context.revision}, {"build_type", context.buildType}}},
            {"host", {{"os", context.os}, {"cpu", context.cpu}}},
            {"devices", devices},
            {"scene",
             {{"name", context.sceneName},
              {"vertices", context.scene.vertices},
              {"triangles", context.scene.triangles},
              {"joints", context.scene.joints},
              {"unique_tuples", context.scene.uniqueTuples},
              {"mean_influences", context.scene.meanInfluences},
              {"max_influences", context.scene.maxInfluences}}},
            {"settings",
             {{"copies", context.workload.copies},
              {"frames", context.bench.frames},
              {"warmup", context.bench.warmup},
              {"width", context.workload.width},
              {"height", context.workload.height},
              {"pose", context.workload.animated ? "animated" : "frozen"},
              {"rounds", context.bench.rounds},
              {"seed", context.bench.seed},
              {"geometry", geometry[static_cast<int>(context.workload.prepare.geometry)]},
              {"cache_order", context.workload.prepare.cacheOrder}}},
            {"calibrations", calibrations},
            {"cases", cases}};
}

static std::string csvField(const Json& value) {
    if (value.is_null()) return "";
    std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string resultsCsv(const Json& results) {
    const std::vector<std::string> plain = {"id",       "route",  "variant", "codec",  "builder",  "layout",  "cull",
                                            "scenario", "raster", "status",  "reason", "limit_ms", "meshlets"};
    const std::vector<std::pair<std::string, std::vector<std::string>>> nested = {
        {"gpu_ms", {"mean", "median", "min", "max", "cv"}},
        {"passes_ms", {"skin", "depth", "draw"}},
        {"memory_bytes", {"vertex", "index", "meshlet", "additional_meshlet", "tuple", "palette", "skinned", "total"}},
        {"accuracy", {"max_position_error", "max_normal_error", "tolerance"}}};
    std::string text = "scene";
    for (const std::string& name : plain) text += "," + name;
    for (const auto& [group, names] : nested)
        for (const std::string& name : names) text += "," + group + "_" + name;
    text += "\n";
    for (const Json& row : results["cases"]) {
        text += csvField(results["scene"]["name"]);
        for (const std::string& name : plain) text += "," + csvField(row[name]);
        for (const auto& [group, names] : nested)
            for (const std::string& name : names)
                text += "," + (row[group].is_null() ? std::string() : csvField(row[group].value(name, Json(nullptr))));
        text += "\n";
    }
    return text;
}

// Whether the case's route is carried by a software driver.
static bool isSoftware(const Json& results, const Json& row) {
    const std::string route = row["route"];
    const std::string api = route.starts_with("vk") ? "vulkan" : route.starts_with("gl") ? "opengl" : "";
    return std::ranges::any_of(results["devices"],
                               [&](const Json& device) { return device["route_api"] == api && device["software"]; });
}

std::string resultsTable(const Json& results) {
    size_t width = 4;
    for (const Json& row : results["cases"]) width = std::max(width, row["id"].get<std::string>().size());
    std::string text = std::format("{:<{}}  {:>10}  {:>6}  {:>10}  {:>9}  {}\n", "case", width, "median ms", "cv %",
                                   "KiB / copy", "error", "status");
    bool software = false;
    for (const Json& row : results["cases"]) {
        auto number = [&](const char* group, const char* name, double scale, int digits) {
            if (row[group].is_null() || row[group][name].is_null()) return std::string("-");
            return std::format("{:.{}f}", row[group][name].get<double>() * scale, digits);
        };
        std::string error = "-";
        if (!row["accuracy"].is_null() && !row["accuracy"]["max_position_error"].is_null())
            error = std::format("{:.1e}", row["accuracy"]["max_position_error"].get<double>());
        const bool marked = isSoftware(results, row) && !row["gpu_ms"].is_null();
        software = software || marked;
        std::string status = row["status"];
        if (!row["reason"].is_null()) status += ": " + row["reason"].get<std::string>();
        text += std::format("{:<{}}  {:>9}{}  {:>6}  {:>10}  {:>9}  {}\n", row["id"].get<std::string>(), width,
                            number("gpu_ms", "median", 1, 3), marked ? "*" : " ", number("gpu_ms", "cv", 100, 2),
                            number("memory_bytes", "total", 1.0 / 1024, 1), error, status);
    }
    if (software) text += "* software driver: shows that the path works, not how fast a GPU is\n";
    return text;
}

// What a page reads; a file may come from another version of the program or from a person.
using NeededKeys = std::vector<std::pair<std::string, std::vector<const char*>>>;

static const NeededKeys kGroups = {
    {"tool", {"version", "revision"}},
    {"host", {"os", "cpu"}},
    {"scene", {"name", "vertices", "triangles", "joints", "unique_tuples", "mean_influences", "max_influences"}},
    {"settings", {"copies", "frames", "width", "height", "pose"}}};

static const NeededKeys kLists = {
    {"devices", {"route_api", "name", "driver", "software"}},
    {"cases",
     {"id", "route", "variant", "status", "reason", "raster", "gpu_ms", "passes_ms", "memory_bytes", "accuracy"}}};

static const NeededKeys kFigures = {{"gpu_ms", {"median", "min", "cv"}},
                                    {"passes_ms", {"skin", "draw"}},
                                    {"memory_bytes", {"total"}},
                                    {"accuracy", {"max_position_error"}}};

// The first key that is not there, else null.
static const char* lacks(const Json& object, const std::vector<const char*>& keys) {
    if (!object.is_object()) return keys.front();
    auto missing = std::ranges::find_if(keys, [&](const char* key) { return !object.contains(key); });
    return missing == keys.end() ? nullptr : *missing;
}

Result<Json> loadResults(const std::string& path) {
    auto text = readWholeFile(path);
    if (!text) return std::unexpected(text.error());
    Json json = Json::parse(*text, nullptr, false);
    if (json.is_discarded()) return inputError(path + ": is not JSON");
    if (!json.is_object() || !json.contains("schema") || json["schema"] != kResultsSchema)
        return inputError(path + ": is not a result file; its schema is not " + kResultsSchema);
    for (const auto& [group, keys] : kGroups) {
        if (!json.contains(group)) return inputError(path + ": is not a whole result file: '" + group + "' is missing");
        if (const char* key = lacks(json[group], keys))
            return inputError(path + ": is not a whole result file: '" + group + "' lacks '" + key + "'");
    }
    for (const auto& [list, keys] : kLists) {
        if (!json.contains(list) || !json[list].is_array())
            return inputError(path + ": is not a whole result file: the list '" + list + "' is missing");
        for (const Json& row : json[list])
            if (const char* key = lacks(row, keys))
                return inputError(path + ": an entry of '" + list + "' lacks the key '" + key + "'");
    }
    for (const Json& row : json["cases"])
        for (const auto& [group, keys] : kFigures)
            if (const char* key = row[group].is_null() ? nullptr : lacks(row[group], keys))
                return inputError(path + ": '" + group + "' of a case lacks the key '" + key + "'");
    return json;
}

}  // namespace skinbench
