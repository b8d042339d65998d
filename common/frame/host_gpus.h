// GPUs that the host has, whatever the drivers here know of them.
#pragma once

#include <string>
#include <vector>

#include "common/frame/devices.h"

namespace skinbench {

struct HostGpu {
    std::string pci;  // as PhysicalDevice::pci; empty: only its device file was seen
    uint32_t vendor = 0;
    std::string driver;  // of the kernel
};

// The display controllers of GPU vendors with a kernel driver of the host's own (not one that hands the card to a
// virtual machine), from /sys and /dev below `root`. Where /sys lists none, one for NVIDIA's device files.
std::vector<HostGpu> listHostGpus(const std::string& root = "/");

// Those of vendors that no hardware device of the machine is of. Where a driver offers one card of a vendor, the others
// are kept from this process (a scheduler hides their device files, but not their entries in /sys).
std::vector<HostGpu> unusedGpus(const std::vector<HostGpu>& gpus, const Machine& machine);

// A line that says so and what to do; empty without any. `inRoot`: in the root folder that tools/enter enters, whose
// drivers are not the host's.
std::string unusedText(const std::vector<HostGpu>& unused, bool inRoot);

}  // namespace skinbench
