// What a graphics driver tells of its device at one moment: clocks, temperature, power.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace skinbench {

// Empty where the driver does not tell.
struct DeviceState {
    std::string device;
    std::string uuid;  // as DeviceCaps::uuid
    std::string pci;   // as DeviceCaps::pci
    std::optional<double> smClockMhz;
    std::optional<double> memoryClockMhz;
    std::optional<double> temperatureC;
    std::optional<double> powerW;
    std::string powerState;  // "P0" is NVIDIA's highest
};

// All devices that NVIDIA's management library (NVML, loaded at run time) knows; none where it is not installed.
std::vector<DeviceState> readDeviceStates();

}  // namespace skinbench
