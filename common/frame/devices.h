// Which of a machine's devices a run takes: one physical device for all APIs. Backends list what they see; everything
// else is decided here from those lists, without a driver.
//
// Two entries of two APIs are one physical device when their UUIDs are equal, else when their PCI addresses are, else
// when their names are and each API has one of that name; the software drivers of all APIs are the host's processor.
// UUIDs that two devices of one API share, as Mesa's software drivers do, count as none; so do, for matching, the
// addresses of two drivers for one card.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/frame/backend.h"

namespace skinbench {

inline constexpr uint32_t kVendorNvidia = 0x10de, kVendorAmd = 0x1002, kVendorIntel = 0x8086;  // of PCI

// "1a2b3c4d-0011-2233-4455-66778899aabb", as vulkaninfo prints it and nvidia-smi behind "GPU-". Empty for zeros.
std::string uuidText(const std::array<uint8_t, 16>& uuid);

// "0000:3b:00.0" of any common spelling (3B:00.0, 00000000:3b:00.0); empty for what is none.
std::string pciText(std::string_view address);
std::string pciText(uint32_t domain, uint32_t bus, uint32_t device, uint32_t function);

// What one API offers.
struct ApiDevices {
    Api api = Api::vulkan;
    std::vector<DeviceCaps> devices;
    std::string missing{};  // why there are none
};

struct PhysicalDevice {
    std::string name;                // the first API's
    std::vector<std::string> names;  // of all APIs
    std::string label;               // the name, and what tells it from the machine's other devices of that name
    std::string uuid, pci;           // empty: not known
    uint32_t vendor = 0;
    bool software = false;
    std::map<Api, size_t> entries;  // its number in the list of each API that has it
    std::map<Api, size_t> perhaps;  // of an API that may have it: nothing says whether this entry is it or another one
    std::string hiddenBy;           // "CUDA_VISIBLE_DEVICES=1": it may not be chosen; else empty
};

// Devices are numbered by their place in `devices`: those of the first API in its order, then what only others have.
struct Machine {
    std::vector<ApiDevices> apis;
    std::vector<PhysicalDevice> devices;
    std::vector<size_t> order;       // the devices that may be chosen, the first choice first: software last
    std::vector<std::string> notes;  // a line for each variable that hides a device or cannot be followed
};

// NAME to value of the variables that are set.
using Environment = std::map<std::string, std::string>;

// The variables that makeMachine() reads. The first one that is set is followed:
//  * CUDA_VISIBLE_DEVICES as CUDA does, for NVIDIA's devices: numbers, or the beginnings of UUIDs; what follows the
//    first word that fits no device is ignored, and so an empty value, -1 or NoDevFiles leave none;
//  * GPU_DEVICE_ORDINAL, SLURM_STEP_GPUS, SLURM_JOB_GPUS: numbers. Slurm's own two count the GPUs of the node; where it
//    lets a task see no more devices than were assigned, all of them are meant.
// Numbers count NVIDIA's devices, or all hardware where there is none, in the order of their PCI addresses. Software
// devices are never hidden.
const std::vector<std::string>& visibilityVariables();

// Completes the lists (PCI addresses are shared between entries of one UUID) and matches them.
Machine makeMachine(std::vector<ApiDevices> apis, const Environment& environment);

// The device that a word names: its number (digits alone are nothing else), a UUID or its beginning (eight digits or
// more, or behind "GPU-"), a PCI address, or a part of the name. A word that fits none or several, or one that is
// hidden, is an error that says which devices there are. Empty: of the devices that may be chosen, hardware before
// software, the first that every API of the machine has, so that runs on one API and runs on another take the same one;
// else the first that `needed` have; else the first. A machine without a device is an error that says why.
Result<size_t> pickDevice(const Machine& machine, const std::string& wanted, const std::vector<Api>& needed);

// "all": every hardware device that may be chosen, or the software ones where there is no other. One that an earlier
// device perhaps is comes with that one.
std::vector<size_t> allDevices(const Machine& machine);

// A device's entry in an API's list. `note` is not empty where the entry is only perhaps the device. The error says
// why the API has none.
struct Entry {
    size_t number = 0;
    std::string note{};
};
Result<Entry> entryOf(const Machine& machine, size_t device, Api api);

// "1: NVIDIA H200, UUID 1a2b3c4d-…, PCI 0000:3b:00.0", what is known of it.
std::string describeDevice(const Machine& machine, size_t device);

// A short name of a folder for the device's results: "1-nvidia-h200".
std::string deviceFolder(const Machine& machine, size_t device);

// The caps of an entry with the machine's identity of the device.
DeviceCaps capsOf(const Machine& machine, size_t device, const DeviceCaps& entry);

// --- why an API gave no device ------------------------------------------------------------------------------------

struct Refusal {
    std::string place;  // "EGL device 0"
    int step = 0;       // how far it came; who came farther tells more
    std::string reason;
};

// "REASON (PLACE, PLACE); REASON (PLACE)", those that came farthest first, at most `most` characters; what does not fit
// is counted.
std::string refusalText(std::vector<Refusal> refusals, size_t most);

}  // namespace skinbench
