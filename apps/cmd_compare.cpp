#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/text.h"
#include "common/report/compare.h"

namespace skinbench {

// One line on standard error for each kind of what is worse than allowed.
static int statusOf(const Comparison& comparison, const CompareOptions& options) {
    const std::vector<std::string> worse = findWorse(comparison, *options.failAbove, options.allowMissing);
    for (const std::string& line : worse) reportError({Fault::device, line});
    return worse.empty() ? kExitDone : kExitFailed;
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
        std::cout << dumpJson(json) << "\n";
    } else {
        std::cout << "A: " << terminalText(options.a) << "\nB: " << terminalText(options.b) << "\n"
                  << comparisonText(*comparison);
    }
    return options.failAbove ? statusOf(*comparison, options) : kExitDone;
}

}  // namespace skinbench
