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

static Result<Comparison> compare(const CompareOptions& options) {
    if (options.b.empty() && options.pair.empty())
        return inputError("compare needs a second file, B, or --pair AXIS for cases of one file");
    const auto a = loadResults(options.a);
    SKINBENCH_TRY(a);
    if (options.b.empty()) return comparePairs(*a, *a, options.pair);
    const auto b = loadResults(options.b);
    SKINBENCH_TRY(b);
    return options.pair.empty() ? compareResults(*a, *b) : comparePairs(*a, *b, options.pair);
}

int runCompare(const CompareOptions& options) {
    const auto comparison = compare(options);
    if (!comparison) return reportError(comparison.error());
    if (options.json) {
        nlohmann::ordered_json json = comparisonJson(*comparison);
        json["a_file"] = options.a;
        json["b_file"] = options.b.empty() ? options.a : options.b;
        std::cout << dumpJson(json) << "\n";
    } else {
        const std::string b = options.b.empty() ? "the same file" : terminalText(options.b);
        std::cout << "A: " << terminalText(options.a) << "\nB: " << b << "\n"
                  << comparisonText(*comparison, terminalWidth());
    }
    return options.failAbove ? statusOf(*comparison, options) : kExitDone;
}

}  // namespace skinbench
