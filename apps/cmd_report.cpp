#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/file.h"

namespace skinbench {

int runReport(const std::vector<std::string>& files, const std::string& out) {
    if (auto right = checkSuffix(out, ".html"); !right) return reportError(right.error());
    std::vector<nlohmann::ordered_json> results;
    std::vector<std::string> names;
    for (const std::string& file : files) {
        auto loaded = loadResults(file);
        if (!loaded) return reportError(loaded.error());
        results.push_back(std::move(*loaded));
        names.push_back(std::filesystem::path(file).filename().string());
    }
    if (auto possible = checkOutput(out, files); !possible) return reportError(possible.error());
    auto written = writeWholeFile(out, reportHtml(results, names));
    return written ? kExitDone : reportError(written.error());
}

}  // namespace skinbench
