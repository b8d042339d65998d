#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/file.h"

namespace skinbench {

// A folder of folders with result files, as --device all and array jobs make them, stands for all of these.
static std::vector<std::string> withFoldersBelow(const std::vector<std::string>& paths) {
    namespace fs = std::filesystem;
    std::vector<std::string> files;
    for (const std::string& path : paths) {
        std::error_code failed;
        std::vector<std::string> below;
        if (fs::is_directory(path, failed) && !fs::exists(resultsFileOf(path), failed))
            for (const fs::directory_entry& entry : fs::directory_iterator(path, failed))
                if (entry.is_directory(failed) && fs::exists(resultsFileOf(entry.path().string()), failed))
                    below.push_back(entry.path().string());
        std::ranges::sort(below);
        if (below.empty()) below = {path};
        files.insert(files.end(), below.begin(), below.end());
    }
    return files;
}

int runReport(const std::vector<std::string>& given, const std::string& out) {
    if (auto right = checkSuffix(out, ".html"); !right) return reportError(right.error());
    const std::vector<std::string> files = withFoldersBelow(given);
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
    if (!written) return reportError(written.error());
    say(out);
    return kExitDone;
}

}  // namespace skinbench
