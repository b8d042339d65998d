#include <algorithm>
#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/report/compare.h"

namespace skinbench {

// One line on standard error for what is worse than allowed.
static int statusOf(const Comparison& comparison, double percent) {
    auto worse = [&](const ComparedCase& compared) { return isWorse(compared, percent); };
    const auto count = std::ranges::count_if(comparison.cases, worse);
    if (count == 0) return kExitDone;
    const ComparedCase& first = *std::ranges::find_if(comparison.cases, worse);
    const std::string what = first.change == Change::broken ? "is ok in A and " + first.b.status + " in B"
                                                            : std::format("takes {:.4f} of A", *first.ratio);
    return reportError({Fault::device, std::format("{} of {} cases {} more than {} % slower or no longer ok; the "
                                                   "first, {}, {}",
                                                   count, comparison.cases.size(), count == 1 ? "is" : "are", percent,
                                                   first.id, what)});
}

int runCompare(const CompareOptions& options) {
    auto a = loadResults(options.a), b = loadResults(options.b);
    if (!a) return reportError(a.error());
    if (!b) return reportError(b.error());
    auto comparison = compareResults(*a, *b);
    if (!comparison) return reportError(comparison.error());
    if (options.json) {
        nlohmann::ordered_json json = comparisonJson(*comparison);
        json["a_file"] = options.a;
        json["b_file"] = options.b;
        std::cout << json.dump(1) << "\n";
    } else {
        std::cout << "A: " << options.a << "\nB: " << options.b << "\n" << comparisonText(*comparison);
    }
    return options.failAbove ? statusOf(*comparison, *options.failAbove) : kExitDone;
}

}  // namespace skinbench
