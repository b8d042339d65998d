#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/file.h"

namespace skinbench {

int runReport(const std::vector<std::string>& files, const std::string& out) {
    if (auto right = checkSuffix(out, ".html"); !right) return reportError(right.error());
    std::vector<nlohmann::ordered_json> results;
    std::vector<std::string> inputs;
    for (const std::string& file : files) {
        auto loaded = loadResults(file);
        if (!loaded) return reportError(loaded.error());
        results.push_back(std::move(*loaded));
        inputs.push_back(resultsFileOf(file));
    }
    if (auto possible = checkOutput(out, inputs); !possible) return reportError(possible.error());
    auto written = writeWholeFile(out, reportHtml(results, files));
    return written ? kExitDone : reportError(written.error());
}

}  // namespace skinbench
