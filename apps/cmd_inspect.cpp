#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/text.h"
#include "common/report/inspect.h"

namespace skinbench {
namespace {

// The axes' own rules read the options: every case is one key.
Result<InspectSettings> inspectSettings(AxisWords words) {
    words["route"] = {"vk-ext"};
    words["variant"] = {"mesh-ci"};
    words["builder"] = {builders().front().name};
    words["ci_grouping"] = {ciGroupingName(CiGrouping::triangles)};
    InspectSettings settings;
    if (words["ci_key"].empty())
        for (CiKey key : settings.keys) words["ci_key"].push_back(ciKeyName(key));
    auto cases = crossCases(words);
    SKINBENCH_TRY(cases);
    settings.limits = cases->front().limits;
    settings.influences = cases->front().influences;
    settings.minVertices = cases->front().ci.minVertices;
    settings.keys.clear();
    for (const Case& c : *cases) settings.keys.push_back(c.ci.key);
    return settings;
}

std::string cutName(const MeshletRow& row) {
    if (!row.grouping) return "plain";
    return ciGroupingName(*row.grouping) + (row.key ? std::string("/") + ciKeyName(*row.key) : std::string());
}

void printScene(const Inspection& inspection) {
    std::cout << terminalText(inspection.scene) << ": " << sceneText(inspection.stats) << "\n";
}

void printMeshlets(const Inspection& inspection) {
    std::cout << std::format(
        "\nmeshlets of at most {} vertices and {} triangles; common: one list of at most {} joints, "
        "{} a group or more\n",
        inspection.settings.limits.vertices, inspection.settings.limits.triangles, inspection.settings.influences,
        counted(inspection.settings.minVertices, "vertex", "vertices"));
    std::cout
        << "geometry order  builder cut               meshlets vertices triangles  v fill  t fill  reuse  tuples  "
           "joints most  common   records remainder\n";
    for (const MeshletRow& row : inspection.meshlets) {
        const MeshletStats& stats = row.stats;
        std::cout << std::format(
            "{:<8} {:<6} {:<7} {:<17} {:>8} {:>8.1f} {:>9.1f} {:>6.1f}% {:>6.1f}% {:>6.3f} {:>7.2f} {:>7.2f} {:>4}",
            geometryName(row.geometry), row.cacheOrder ? "cache" : "file", row.builder->name, cutName(row),
            stats.meshlets, stats.meanVertices, stats.meanTriangles, stats.vertexFill * 100, stats.triangleFill * 100,
            stats.vertexReuse, stats.meanUniqueTuples, row.joints.mean, row.joints.largest);
        std::cout << (row.grouping
                          ? std::format(" {:>7} {:>9} {:>9}\n", row.commonMeshlets, row.records, row.remainderTriangles)
                          : "\n");
    }
}

void printAttributes(const AttributeErrors& errors) {
    std::cout << "\nquantised attributes       mean error  largest error\n";
    auto line = [](const std::string& name, const ErrorFigure& figure) {
        std::cout << std::format("{:<26} {:>10.3e} {:>14.3e}\n", name, figure.mean, figure.max);
    };
    for (const auto& [bits, figure] : errors.position) line(std::format("position, {} bits", bits), figure);
    line("uv, 16 bits", errors.uv);
    line("normal, Euclidean 10 bits", errors.euclidean);
    line("normal, spherical 16 bits", errors.spherical);
    line("normal, octahedral 16 bits", errors.octahedral);
}

void printCodecs(const Inspection& inspection) {
    std::cout << "\nbytes of one copy; blend: bytes a vertex for joints and weights, with copied vertices\n"
                 "geometry builder codec      vertices  vertex buf  index buf";
    for (const MeshletLayout& layout : meshletLayouts()) std::cout << std::format(" {:>10}", layout.name);
    std::cout << "  extra buf  tuple buf  blend  mean weight error  largest  encode ms\n";
    for (const CodecRow& row : inspection.codecs) {
        std::cout << std::format("{:<8} {:<7} {:<10}", geometryName(row.geometry), row.builder->name, row.codec->name);
        if (!row.reason.empty()) {
            std::cout << " " << terminalText(row.reason) << "\n";
            continue;
        }
        auto bytes = [](const std::optional<uint64_t>& count) { return count ? std::to_string(*count) : "-"; };
        std::cout << std::format(" {:>8} {:>11} {:>10}", row.vertices, row.vertexBytes, bytes(row.indexBytes));
        for (const MeshletLayout& layout : meshletLayouts())
            std::cout << std::format(" {:>10}", row.descriptorBytes.at(layout.name) + row.dataBytes.at(layout.name));
        std::cout << std::format(" {:>10} {:>10}", bytes(row.meshletExtraBytes), bytes(row.tupleBytes));
        std::cout << std::format(" {:>6.2f} {:>18.3e} {:>8.1e} {:>10.1f}\n", row.blendBytesPerVertex,
                                 row.errors.weight.mean, row.errors.weight.max, row.encodeMs);
    }
    for (const EncodeTotal& total : encodeTotals(inspection.codecs))
        std::cout << std::format("{:<8} {:<7} encode all: {} in {:.1f} ms\n", geometryName(total.geometry),
                                 total.builder->name, counted(total.codecs, "codec"), total.encodeMs);
}

}  // namespace

int runInspect(const InspectOptions& options) {
    auto settings = inspectSettings(options.selectors.words);
    if (!settings) return reportError(settings.error());
    settings->all = options.all;
    auto stored = loadScene(options.selectors.scene);
    if (!stored) return reportError(stored.error());
    auto inspection = inspectScene(*stored, *settings);
    if (!inspection) return reportError(inspection.error());
    for (const std::string& warning : inspection->warnings) warn(inspection->scene + ": " + warning);
    if (options.json) {
        std::cout << dumpJson(inspectJson(*inspection)) << "\n";
        return kExitDone;
    }
    printScene(*inspection);
    printMeshlets(*inspection);
    printAttributes(inspection->attributes);
    printCodecs(*inspection);
    return kExitDone;
}

}  // namespace skinbench
