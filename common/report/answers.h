// What the times of a run say: the fastest case, and which stage, API and extension wins.
//
// Rivals are timed cases that do the same task (sameWork), skin on the device's side of a graphics API, and skin every
// copy in every frame: neither `none` nor route `cpu` nor half-rate updates.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/report/compare.h"
#include "common/report/labels.h"
#include "common/report/report.h"

namespace skinbench {

// The times of the first case over those of the second. Ids are empty where there is no such case.
struct Answer {
    std::string work;           // what both draw: "full", "no-fragments, 8-influences"
    std::string question;       // "fastest", "next", "mesh against compute", "EXT against NV", "vk against gl", …
    std::string on;             // "Vulkan"; empty: not of one API
    std::string first, second;  // of "fastest" the second is its baseline, of "next" the fastest
    double median = 0;          // of the first, milliseconds a frame
    bool software = false;      // a software driver took part
    std::optional<TimeRatio> ratio;
};

// In the order in which they are printed, by work. Where a GPU was timed, software drivers are no rivals of it.
std::vector<Answer> answersOf(const RunContext& context, const std::vector<CaseResult>& results);

// What RunContext::baseline names: the fastest case of a variant that does the same work on the same API, or one case
// for all. Null: it has no time.
const CaseResult* baselineOf(const RunContext& context, const std::vector<CaseResult>& results,
                             const CaseResult& result);

// The values that tell the work of the case from that of others, the raster mode first: "discard, prepass".
std::string workOf(const Case& c);

nlohmann::ordered_json answersJson(const RunContext& context, const std::vector<CaseResult>& results);

// The answers of a result file as lines of at most `width` columns; 0: whole ids, and lines as long as they get.
std::string answersText(const nlohmann::ordered_json& results, const SharedParts& shared, size_t width);

}  // namespace skinbench
