// GPUs of the host, over invented folders.
#include <filesystem>
#include <fstream>

#include <catch2/catch_test_macros.hpp>

#include "common/frame/host_gpus.h"
#include "tests/cases.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
namespace fs = std::filesystem;

namespace {

struct Host {
    fs::path root;

    explicit Host(const std::string& name) : root(fixture::temporaryFolder() / name) {
        fs::remove_all(root);
        fs::create_directories(root / "sys/bus/pci/drivers");
        fs::create_directories(root / "dev");
    }
    void add(const std::string& address, const std::string& kind, const std::string& vendor,
             const std::string& driver) const {
        const fs::path folder = root / "sys/bus/pci/devices" / address;
        fs::create_directories(folder);
        std::ofstream(folder / "class") << kind << "\n";
        std::ofstream(folder / "vendor") << vendor << "\n";
        if (!driver.empty()) fs::create_directory_symlink("../../../../bus/pci/drivers/" + driver, folder / "driver");
    }
    std::vector<HostGpu> gpus() const { return listHostGpus(root.string()); }
};

Machine machineOf(std::vector<DeviceCaps> devices) { return makeMachine({{Api::vulkan, std::move(devices)}}, {}); }

DeviceCaps device(const std::string& pci, uint32_t vendor, bool software = false) {
    DeviceCaps caps = generousCaps(Api::vulkan);
    caps.pci = pci;
    caps.vendor = vendor;
    caps.software = software;
    return caps;
}

}  // namespace

TEST_CASE("the host's GPUs are its display controllers with a driver of the host's own") {
    const Host host("host");
    host.add("0000:3b:00.0", "0x030200", "0x10de", "nvidia");
    host.add("0000:00:02.0", "0x030000", "0x8086", "i915");
    host.add("0000:3c:00.0", "0x030200", "0x10de", "vfio-pci");
    host.add("0000:3d:00.0", "0x030000", "0x1002", "");
    host.add("0000:04:00.0", "0x030000", "0x1a03", "ast");  // a board controller's
    host.add("0000:05:00.0", "0x020000", "0x8086", "e1000");
    const std::vector<HostGpu> gpus = host.gpus();
    REQUIRE(gpus.size() == 2);
    CHECK(gpus[0].pci == "0000:00:02.0");
    CHECK(gpus[1].pci == "0000:3b:00.0");
    CHECK(gpus[1].vendor == kVendorNvidia);
    CHECK(gpus[1].driver == "nvidia");
}

TEST_CASE("device files of NVIDIA stand in where /sys lists nothing") {
    const Host host("container");
    CHECK(host.gpus().empty());
    CHECK(listHostGpus((host.root / "none").string()).empty());
    std::ofstream(host.root / "dev/nvidia0") << "";
    REQUIRE(host.gpus().size() == 1);
    CHECK(unusedGpus(host.gpus(), machineOf({device("0000:3b:00.0", kVendorNvidia)})).empty());
    CHECK(unusedGpus(host.gpus(), machineOf({device("", 0, true)})).size() == 1);
}

TEST_CASE("a GPU that no device stands for is said with the way to use it") {
    const std::vector<HostGpu> gpus = {{"0000:3b:00.0", kVendorNvidia, "nvidia"},
                                       {"0000:3c:00.0", kVendorNvidia, "nvidia"}};
    const Machine processor = machineOf({device("", 0, true)});
    CHECK(unusedGpus(gpus, processor).size() == 2);
    CHECK(unusedGpus(gpus, machineOf({device("0000:3c:00.0", kVendorNvidia)})).empty());
    CHECK(unusedGpus(gpus, machineOf({device("0000:3c:00.0", 0)})).empty());
    CHECK(unusedGpus(gpus, machineOf({device("", kVendorNvidia)})).empty());
    CHECK(unusedGpus(gpus, machineOf({device("", 0)})).empty());
    CHECK(unusedGpus(gpus, machineOf({device("", kVendorAmd)})).size() == 2);
    CHECK(unusedText({}, true) == "");
    CHECK(unusedText(gpus, true) ==
          "this machine has a GPU that no driver here offers: NVIDIA at PCI 0000:3b:00.0 and 1 more; ./run --native … "
          "takes the host's compiler, packages and drivers");
    CHECK(
        unusedText({gpus[0]}, false) ==
        "this machine has a GPU that no driver here offers: NVIDIA at PCI 0000:3b:00.0; install its driver's libraries "
        "for Vulkan and EGL (on Debian libnvidia-gl-*, or nvidia-vulkan-icd and libegl-nvidia0)");
}
