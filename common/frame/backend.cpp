#include "common/frame/backend.h"

#include <algorithm>
#include <cctype>

namespace skinbench {

const char* stageName(Stage stage) {
    switch (stage) {
        case Stage::vertex:
            return "vertex";
        case Stage::fragment:
            return "fragment";
        case Stage::compute:
            return "compute";
        case Stage::task:
            return "task";
        case Stage::mesh:
            return "mesh";
    }
    return "?";
}

uint64_t planBytes(const FramePlan& plan) {
    uint64_t total = 0;
    for (const Stream& stream : plan.streams)
        total += stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas : stream.gpuBytes;
    return total;
}

static std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

Result<size_t> pickDevice(const std::vector<DeviceCaps>& devices, const std::string& wanted) {
    if (devices.empty()) return deviceError("no device");
    if (wanted.empty()) {
        auto hardware = std::ranges::find(devices, false, &DeviceCaps::software);
        return hardware == devices.end() ? 0 : static_cast<size_t>(hardware - devices.begin());
    }
    if (std::ranges::all_of(wanted, [](unsigned char c) { return std::isdigit(c); }) && wanted.size() < 6) {
        size_t number = std::stoul(wanted);
        if (number < devices.size()) return number;
    }
    for (size_t i = 0; i < devices.size(); ++i)
        if (lower(devices[i].name).find(lower(wanted)) != std::string::npos) return i;
    std::string names;
    for (size_t i = 0; i < devices.size(); ++i)
        names += (i ? ", " : "") + std::to_string(i) + " (" + devices[i].name + ")";
    return deviceError("no device '" + wanted + "'; there is " + names);
}

}  // namespace skinbench
