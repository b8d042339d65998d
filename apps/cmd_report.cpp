#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/file.h"

namespace skinbench {

int runReport(const std::vector<std::string>& files, const std::string& out) {
    std::vector<nlohmann::ordered_json> results;
    for (const std::string& file : files) {
        auto loaded = loadResults(file);
        if (!loaded) return reportError(loaded.error());
        results.push_back(std::move(*loaded));
    }
    std::string page;
    try {
        page = reportHtml(results);
    } catch (const nlohmann::json::exception& error) {
        return reportError(
            {Fault::input, "a result file holds a value of the wrong kind: " + std::string(error.what())});
    }
    auto written = writeWholeFile(out, page);
    return written ? kExitDone : reportError(written.error());
}

}  // namespace skinbench
