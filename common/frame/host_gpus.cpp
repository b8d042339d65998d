#include "common/frame/host_gpus.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <format>
#include <fstream>

namespace skinbench {
namespace {
namespace fs = std::filesystem;

struct GpuVendor {
    uint32_t id;
    const char* name;
    const char* packages;  // of Debian, with the driver's Vulkan and OpenGL
};

constexpr GpuVendor kVendors[] = {
    {kVendorNvidia, "NVIDIA", "libnvidia-gl-*, or nvidia-vulkan-icd and libegl-nvidia0"},
    {kVendorAmd, "AMD", "mesa-vulkan-drivers and libgl1-mesa-dri"},
    {kVendorIntel, "Intel", "mesa-vulkan-drivers and libgl1-mesa-dri"},
};

const GpuVendor* findVendor(uint32_t id) {
    const auto vendor = std::ranges::find(kVendors, id, &GpuVendor::id);
    return vendor == std::end(kVendors) ? nullptr : vendor;
}

// The number of a file of /sys such as "0x030200"; 0 for what is none.
uint32_t numberIn(const fs::path& file) {
    std::ifstream stream(file);
    std::string text;
    stream >> text;
    if (!text.starts_with("0x")) return 0;
    uint32_t value = 0;
    std::from_chars(text.data() + 2, text.data() + text.size(), value, 16);
    return value;
}

constexpr uint32_t kDisplayClass = 0x03;

}  // namespace

std::vector<HostGpu> listHostGpus(const std::string& root) {
    std::vector<HostGpu> gpus;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(root + "/sys/bus/pci/devices", failed)) {
        HostGpu gpu{pciText(entry.path().filename().string()), numberIn(entry.path() / "vendor"), {}};
        const fs::path driver = fs::read_symlink(entry.path() / "driver", failed);
        gpu.driver = driver.filename();
        const bool handedOn = gpu.driver.empty() || gpu.driver == "vfio-pci" || gpu.driver == "pci-stub";
        if (numberIn(entry.path() / "class") >> 16 == kDisplayClass && findVendor(gpu.vendor) && !handedOn)
            gpus.push_back(gpu);
    }
    std::ranges::sort(gpus, {}, &HostGpu::pci);
    if (gpus.empty() && fs::exists(root + "/dev/nvidia0", failed)) gpus.push_back({"", kVendorNvidia, "nvidia"});
    return gpus;
}

std::vector<HostGpu> unusedGpus(const std::vector<HostGpu>& gpus, const Machine& machine) {
    std::vector<HostGpu> unused = gpus;
    for (const PhysicalDevice& device : machine.devices) {
        if (device.software) continue;
        const auto known = std::ranges::find(gpus, device.pci, &HostGpu::pci);
        const uint32_t vendor = device.vendor || known == gpus.end() ? device.vendor : known->vendor;
        std::erase_if(unused, [&](const HostGpu& gpu) { return gpu.vendor == vendor || !vendor; });
    }
    return unused;
}

std::string unusedText(const std::vector<HostGpu>& unused, bool inRoot) {
    if (unused.empty()) return "";
    const GpuVendor& vendor = *findVendor(unused.front().vendor);
    std::string text = std::format("this machine has a GPU that no driver here offers: {}", vendor.name);
    if (!unused.front().pci.empty()) text += " at PCI " + unused.front().pci;
    if (unused.size() > 1) text += std::format(" and {} more", unused.size() - 1);
    return text + (inRoot ? "; ./run --native … takes the host's compiler, packages and drivers"
                          : std::format("; install its driver's libraries for Vulkan and EGL (on Debian {})",
                                        vendor.packages));
}

}  // namespace skinbench
