#include <algorithm>
#include <format>
#include <iostream>
#include <map>
#include <set>

#include "apps/apps.h"
#include "common/core/stats.h"

namespace skinbench {
namespace {

std::vector<MeshShape> shapesFor(const Case& which) {
    std::vector<MeshShape> shapes;
    for (JointSource joints : {JointSource::vertex, JointSource::staged})
        for (bool clamped : {false, true})
            for (bool ordered : {false, true})
                for (bool uniform : {false, true}) shapes.push_back({joints, clamped, ordered, uniform});
    // Shapes that the case cannot have on any device; what its device lacks is skipped when it is tried.
    std::erase_if(shapes, [&](const MeshShape& shape) {
        return (shape.joints == JointSource::staged && (sharesJointLists(which) || !feedsAttributes(*which.codec))) ||
               (shape.uniformPalette && which.submission == Submission::batched);
    });
    return shapes;
}

std::string baseId(Case which) {
    which.shape = {};
    return caseId(which);
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
    std::map<std::string, MeshShape> chosen;
    std::set<std::string> said;
    for (Case& which : cases) {
        const auto open = backends.find(which.route->api);
        const bool there = open != backends.end() && open->second.backend;
        if (which.route->dialect == MeshDialect::none || !which.variant->skins || !there) continue;
        if (open->second.backend->caps().software) {
            if (said.insert(which.route->name).second)
                warn(std::string(which.route->name) +
                     ": a software driver's times choose no shape; the given one stays");
            continue;
        }
        auto [entry, fresh] = chosen.try_emplace(baseId(which), which.shape);
        if (fresh) {
            std::vector<Case> candidates;
            for (const MeshShape& shape : shapesFor(which)) {
                candidates.push_back(which);
                candidates.back().shape = shape;
            }
            auto results = runBench(workload, candidates, backends, brief, {});
            if (!results) return std::unexpected(results.error());
            Calibration calibration;
            double fastest = 0;
            for (const CaseResult& result : *results) {
                if (result.status != CaseStatus::ok) continue;
                const double median = summarise(result.total).median;
                calibration.tried.emplace_back(result.id, median);
                if (calibration.chosen.empty() || median < fastest) {
                    calibration.chosen = result.id;
                    entry->second = result.which.shape;
                    fastest = median;
                }
            }
            if (!calibration.tried.empty()) {
                std::cerr << std::format("skinbench: auto: {}: fastest of {} shapes ({:.3f} ms)\n", calibration.chosen,
                                         calibration.tried.size(), fastest);
                calibrations.push_back(std::move(calibration));
            }
        }
        which.shape = entry->second;
    }
    // Lists of shapes that were crossed are one case now.
    std::set<std::string> known;
    std::erase_if(cases, [&](const Case& which) { return !known.insert(caseId(which)).second; });
    return calibrations;
}

}  // namespace skinbench
