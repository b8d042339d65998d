#include <algorithm>
#include <format>
#include <map>
#include <set>

#include "apps/apps.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

// Joints that a meshlet lists were nowhere the fastest, so they are not tried.
AxisWords shapeWords() {
    AxisWords words;
    for (const Axis& axis : axes())
        if (axis.shape) words[axis.name] = axis.words;
    std::erase(words["joints"], "meshlet");
    return words;
}

std::string baseId(Case c) {
    for (const Axis& axis : axes())
        if (axis.shape) SKINBENCH_ASSERT(axis.set(c, axis.usual).has_value());
    return caseId(c);
}

// What no device can run in another shape; what this one lacks is skipped when it is tried.
std::vector<Case> candidatesOf(const Case& c, const DeviceCaps& caps) {
    auto candidates = crossCases({c}, shapeWords());
    SKINBENCH_ASSERT(candidates.has_value());
    std::erase_if(*candidates, [&](const Case& candidate) { return unsupported(candidate, caps).has_value(); });
    return *candidates;
}

}  // namespace

Result<std::vector<Calibration>> calibrateShapes(Workload& workload, std::vector<Case>& cases, const Backends& backends,
                                                 const BenchSettings& settings) {
    BenchSettings brief = settings;
    brief.frames = 6;
    brief.rounds = 1;
    brief.precision = 0;
    brief.limits = false;
    brief.selfTest = false;
    std::vector<Calibration> calibrations;
    std::map<std::string, Case> chosen;  // by baseId
    std::set<std::string> said;
    for (Case& c : cases) {
        const auto open = backends.find(c.route->api);
        const bool there = open != backends.end() && open->second.backend;
        if (c.route->dialect == MeshDialect::none || !c.variant->skins || !there) continue;
        if (open->second.backend->caps().software) {
            if (said.insert(c.route->name).second)
                warn(std::string(c.route->name) + ": a software driver's times choose no shape; the given one stays");
            continue;
        }
        auto [entry, fresh] = chosen.try_emplace(baseId(c), c);
        if (fresh) {
            auto results = runBench(workload, candidatesOf(c, open->second.backend->caps()), backends, brief, {});
            SKINBENCH_TRY(results);
            Calibration calibration;
            double fastest = 0;
            for (const CaseResult& result : *results) {
                if (result.status != CaseStatus::ok || !result.figures) continue;
                const double median = result.figures->total.median;
                calibration.tried.emplace_back(result.id, median);
                if (calibration.chosen.empty() || median < fastest) {
                    calibration.chosen = result.id;
                    entry->second = result.theCase;
                    fastest = median;
                }
            }
            if (!calibration.tried.empty()) {
                say(std::format("auto: {}: fastest of {} ({:.3f} ms)", calibration.chosen,
                                counted(calibration.tried.size(), "shape"), fastest));
                calibrations.push_back(std::move(calibration));
            }
        }
        c = entry->second;
    }
    // Lists of shapes that were crossed are one case now.
    std::set<std::string> known;
    std::erase_if(cases, [&](const Case& c) { return !known.insert(caseId(c)).second; });
    return calibrations;
}

}  // namespace skinbench
