#include "common/measure/device_state.h"

#include <dlfcn.h>

#include <array>
#include <format>
#include <string_view>

#include "common/frame/devices.h"

namespace skinbench {
namespace {

using NvmlDevice = void*;
constexpr int kNvmlSuccess = 0;
constexpr int kClockSm = 1, kClockMemory = 2;
constexpr int kSensorGpu = 0;
constexpr int kStates = 16;  // P0 to P15; above: unknown

struct NvmlPci {
    char shortAddress[16];
    unsigned domain, bus, device, deviceId, subsystemId;
    char address[32];
};

// The few entry points of libnvidia-ml.so.1 that are called; its interface is stable since version 1.
struct Nvml {
    void* library = nullptr;
    int (*init)() = nullptr;
    int (*shutdown)() = nullptr;
    int (*count)(unsigned*) = nullptr;
    int (*handle)(unsigned, NvmlDevice*) = nullptr;
    int (*name)(NvmlDevice, char*, unsigned) = nullptr;
    int (*clock)(NvmlDevice, int, unsigned*) = nullptr;
    int (*temperature)(NvmlDevice, int, unsigned*) = nullptr;
    int (*power)(NvmlDevice, unsigned*) = nullptr;
    int (*state)(NvmlDevice, int*) = nullptr;
    int (*uuid)(NvmlDevice, char*, unsigned) = nullptr;  // this and the next may be missing
    int (*pci)(NvmlDevice, NvmlPci*) = nullptr;
};

template <class Function>
bool find(void* library, const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library, name));
    return function != nullptr;
}

// Stays loaded for the life of the process; a null library where anything is missing.
const Nvml& nvml() {
    static const Nvml loaded = [] {
        Nvml n;
        void* library = dlopen("libnvidia-ml.so.1", RTLD_NOW | RTLD_LOCAL);
        if (!library) return n;
        const bool whole = find(library, "nvmlInit_v2", n.init) && find(library, "nvmlShutdown", n.shutdown) &&
                           find(library, "nvmlDeviceGetCount_v2", n.count) &&
                           find(library, "nvmlDeviceGetHandleByIndex_v2", n.handle) &&
                           find(library, "nvmlDeviceGetName", n.name) &&
                           find(library, "nvmlDeviceGetClockInfo", n.clock) &&
                           find(library, "nvmlDeviceGetTemperature", n.temperature) &&
                           find(library, "nvmlDeviceGetPowerUsage", n.power) &&
                           find(library, "nvmlDeviceGetPerformanceState", n.state);
        find(library, "nvmlDeviceGetUUID", n.uuid);
        find(library, "nvmlDeviceGetPciInfo_v3", n.pci);
        if (whole) n.library = library;
        return n;
    }();
    return loaded;
}

DeviceState stateOf(const Nvml& n, NvmlDevice device) {
    DeviceState state;
    std::array<char, 96> name{};
    if (n.name(device, name.data(), static_cast<unsigned>(name.size())) == kNvmlSuccess) state.device = name.data();
    std::array<char, 96> uuid{};
    if (n.uuid && n.uuid(device, uuid.data(), static_cast<unsigned>(uuid.size())) == kNvmlSuccess)
        if (std::string_view(uuid.data()).starts_with("GPU-")) state.uuid = uuid.data() + 4;
    NvmlPci pci{};
    if (n.pci && n.pci(device, &pci) == kNvmlSuccess) state.pci = pciText(pci.domain, pci.bus, pci.device, 0);
    unsigned value = 0;
    if (n.clock(device, kClockSm, &value) == kNvmlSuccess) state.smClockMhz = value;
    if (n.clock(device, kClockMemory, &value) == kNvmlSuccess) state.memoryClockMhz = value;
    if (n.temperature(device, kSensorGpu, &value) == kNvmlSuccess) state.temperatureC = value;
    if (n.power(device, &value) == kNvmlSuccess) state.powerW = value / 1000.0;
    int level = kStates;
    if (n.state(device, &level) == kNvmlSuccess && level < kStates) state.powerState = std::format("P{}", level);
    return state;
}

}  // namespace

std::vector<DeviceState> readDeviceStates() {
    std::vector<DeviceState> states;
    const Nvml& n = nvml();
    if (!n.library || n.init() != kNvmlSuccess) return states;
    unsigned count = 0;
    if (n.count(&count) != kNvmlSuccess) count = 0;
    for (unsigned i = 0; i < count; ++i) {
        NvmlDevice device = nullptr;
        if (n.handle(i, &device) == kNvmlSuccess) states.push_back(stateOf(n, device));
    }
    n.shutdown();
    return states;
}

}  // namespace skinbench
