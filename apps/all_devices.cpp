#include <algorithm>
#include <filesystem>

#include "apps/apps.h"

namespace skinbench {

int runOnAllDevices(const RunOptions& options, int (*runOn)(const RunOptions& options)) {
    if (options.json)
        return reportError(
            {Fault::input, "--json prints one file, and --device all makes one of each device in --out"});
    const Machine& machine = thisMachine();
    const std::vector<size_t> devices = allDevices(machine);
    if (devices.empty()) return reportError(pickDevice(machine, "", {}).error());
    std::vector<std::string> files;
    int status = kExitDone;
    for (size_t device : devices) {
        if (interrupted()) break;
        RunOptions one = options;
        one.selectors.device = std::to_string(device);
        if (!options.out.empty()) one.out = options.out + "/" + deviceFolder(machine, device);
        say("device " + describeDevice(machine, device));
        const int ended = runOn(one);
        status = std::max(status, ended);
        if (ended == kExitBadInput) break;
        const std::string file = one.out + "/results.json";
        std::error_code failed;
        if (!options.out.empty() && std::filesystem::exists(file, failed)) files.push_back(file);
    }
    if (files.size() < 2) return status;
    return std::max(status, runReport(files, options.out + "/report.html"));
}

}  // namespace skinbench
