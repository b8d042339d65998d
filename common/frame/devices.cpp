#include "common/frame/devices.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <format>
#include <optional>

#include "common/core/text.h"
#include "common/frame/visible_devices.h"

namespace skinbench {
namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
    return result;
}

bool isDigits(std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c); });
}

bool isHex(std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isxdigit(c); });
}

// --- matching ----------------------------------------------------------------------------------------------------

using Field = std::string DeviceCaps::*;

bool isUnique(const std::vector<DeviceCaps>& devices, Field field, const std::string& value) {
    return !value.empty() && std::ranges::count(devices, value, field) == 1;
}

void dropSharedUuids(std::vector<DeviceCaps>& devices) {
    const std::vector<DeviceCaps> before = devices;
    for (DeviceCaps& caps : devices)
        if (!isUnique(before, &DeviceCaps::uuid, caps.uuid)) caps.uuid = "";
}

// An entry without a PCI address gets that of the same UUID in another list.
void sharePci(std::vector<ApiDevices>& apis) {
    std::map<std::string, std::string> known;
    for (const ApiDevices& api : apis)
        for (const DeviceCaps& caps : api.devices)
            if (!caps.uuid.empty() && !caps.pci.empty()) known.try_emplace(caps.uuid, caps.pci);
    for (ApiDevices& api : apis)
        for (DeviceCaps& caps : api.devices)
            if (const auto pci = known.find(caps.uuid); caps.pci.empty() && pci != known.end()) caps.pci = pci->second;
}

// Mesa appends the driver in brackets, which differs between the APIs.
std::string_view plainName(std::string_view name) { return name.substr(0, name.find(" (")); }

bool differ(const std::string& a, const std::string& b) { return !a.empty() && !b.empty() && a != b; }

bool isOther(const PhysicalDevice& device, const DeviceCaps& caps) {
    return device.software != caps.software || differ(device.uuid, caps.uuid) || differ(device.pci, caps.pci) ||
           (device.vendor && caps.vendor && device.vendor != caps.vendor);
}

bool isOnlyOfItsName(const std::vector<DeviceCaps>& devices, const DeviceCaps& caps) {
    return std::ranges::count_if(
               devices, [&](const DeviceCaps& other) { return plainName(other.name) == plainName(caps.name); }) == 1;
}

// Whether two entries of two APIs are surely one device.
bool isSame(const ApiDevices& apiA, const DeviceCaps& a, const ApiDevices& apiB, const DeviceCaps& b) {
    if (a.software != b.software) return false;
    if (!a.uuid.empty() && a.uuid == b.uuid) return true;
    if (differ(a.pci, b.pci)) return false;
    if (isUnique(apiA.devices, &DeviceCaps::pci, a.pci) && isUnique(apiB.devices, &DeviceCaps::pci, b.pci)) return true;
    if (differ(a.uuid, b.uuid)) return false;
    const auto isSoftware = [](const DeviceCaps& caps) { return caps.software; };
    if (a.software && std::ranges::count_if(apiA.devices, isSoftware) == 1 &&
        std::ranges::count_if(apiB.devices, isSoftware) == 1)
        return true;
    return plainName(a.name) == plainName(b.name) && isOnlyOfItsName(apiA.devices, a) &&
           isOnlyOfItsName(apiB.devices, b);
}

void addEntry(PhysicalDevice& device, const DeviceCaps& caps, size_t number) {
    if (device.names.empty()) {
        device.name = caps.name;
        device.software = caps.software;
    }
    device.names.push_back(caps.name);
    device.entries[caps.api] = number;
    if (device.uuid.empty()) device.uuid = caps.uuid;
    if (device.pci.empty()) device.pci = caps.pci;
    if (!device.vendor) device.vendor = caps.vendor;
}

// The device so far whose entry in an earlier list is surely this one.
PhysicalDevice* findSame(Machine& machine, const ApiDevices& api, const DeviceCaps& caps) {
    for (PhysicalDevice& device : machine.devices) {
        if (device.entries.contains(api.api)) continue;
        for (const ApiDevices& other : machine.apis)
            if (const auto entry = device.entries.find(other.api);
                entry != device.entries.end() && isSame(other, other.devices[entry->second], api, caps))
                return &device;
    }
    return nullptr;
}

// The n-th device that an API lacks gets the API's n-th entry that no such device has; one of its name before others.
void guessEntries(Machine& machine) {
    for (const ApiDevices& api : machine.apis) {
        std::vector<size_t> taken;
        for (PhysicalDevice& device : machine.devices) {
            if (device.entries.contains(api.api)) continue;
            std::optional<size_t> guess;
            for (const bool sameName : {true, false})
                for (const PhysicalDevice& other : machine.devices) {
                    const auto entry = other.entries.find(api.api);
                    if (entry == other.entries.end() || other.entries.size() > 1 || guess) continue;
                    const DeviceCaps& caps = api.devices[entry->second];
                    const bool named = plainName(caps.name) == plainName(device.name);
                    if (named == sameName && !isOther(device, caps) &&
                        std::ranges::find(taken, entry->second) == taken.end())
                        guess = entry->second;
                }
            if (!guess) continue;
            device.perhaps[api.api] = *guess;
            taken.push_back(*guess);
        }
    }
}

void labelDevices(std::vector<PhysicalDevice>& devices) {
    for (size_t i = 0; i < devices.size(); ++i) {
        const bool alone = std::ranges::count(devices, devices[i].name, &PhysicalDevice::name) == 1;
        devices[i].label = devices[i].name;
        if (!alone)
            devices[i].label +=
                devices[i].pci.empty() ? std::format(" (device {})", i) : std::format(" ({})", devices[i].pci);
    }
}

// --- picking -----------------------------------------------------------------------------------------------------

enum class Detail { all, shortUuid, noName };

std::string listed(const Machine& machine, const std::vector<size_t>& devices, Detail detail) {
    std::string text;
    for (size_t i : devices) {
        const PhysicalDevice& device = machine.devices[i];
        std::vector<std::string> facts;
        if (detail != Detail::noName) facts.push_back(device.name);
        if (!device.uuid.empty())
            facts.push_back("UUID " + (detail == Detail::all ? device.uuid : device.uuid.substr(0, 8) + "…"));
        if (!device.pci.empty()) facts.push_back("PCI " + device.pci);
        if (facts.empty()) facts.push_back(device.name);
        std::string joined;
        for (const std::string& fact : facts) joined += (joined.empty() ? "" : ", ") + fact;
        text += std::format("{}{} ({})", text.empty() ? "" : ", ", i, joined);
    }
    return text;
}

// As much of each device as one line of a message holds.
std::string listed(const Machine& machine, const std::vector<size_t>& devices) {
    constexpr size_t kMost = 300;
    std::string text;
    for (Detail detail : {Detail::all, Detail::shortUuid, Detail::noName}) {
        text = listed(machine, devices, detail);
        if (text.size() <= kMost) break;
    }
    return text;
}

std::vector<size_t> numbersOf(const Machine& machine) {
    std::vector<size_t> all(machine.devices.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
}

std::string missingText(const Machine& machine) {
    std::string text;
    for (const ApiDevices& api : machine.apis)
        if (!api.missing.empty()) text += (text.empty() ? "" : "; ") + api.missing;
    return text.empty() ? "no device" : text;
}

std::unexpected<Error> noDevice(const Machine& machine, const std::string& wanted) {
    return deviceError("no device '" + wanted + "'; there is " + listed(machine, numbersOf(machine)));
}

// The digits of a word that can only be a UUID or its beginning; empty for others.
std::string uuidDigits(std::string_view word) {
    std::string text = lower(word);
    const bool marked = text.starts_with("gpu-");
    if (marked) text.erase(0, 4);
    std::string digits = text;
    std::erase(digits, '-');
    if (!isHex(digits) || digits.size() > 32) return "";
    return marked || (digits.size() >= 8 && !isDigits(word)) ? digits : "";
}

bool startsWithDigits(const PhysicalDevice& device, const std::string& digits) {
    std::string own = device.uuid;
    std::erase(own, '-');
    return !own.empty() && own.starts_with(digits);
}

// All devices that a word fits, by the first of its meanings that fits any.
std::vector<size_t> fitting(const Machine& machine, const std::string& word) {
    std::vector<size_t> found;
    auto add = [&](const auto& fits) {
        for (size_t i = 0; i < machine.devices.size(); ++i)
            if (fits(machine.devices[i])) found.push_back(i);
    };
    const std::string pci = pciText(word), digits = uuidDigits(word), part = lower(word);
    if (!pci.empty()) {
        add([&](const PhysicalDevice& device) { return device.pci == pci; });
        return found;
    }
    if (!digits.empty()) add([&](const PhysicalDevice& device) { return startsWithDigits(device, digits); });
    auto named = [&](const auto& same) {
        add([&](const PhysicalDevice& device) {
            return std::ranges::any_of(device.names, [&](const auto& name) { return same(lower(name)); });
        });
    };
    if (found.empty()) named([&](const std::string& name) { return name == part; });
    if (found.empty()) named([&](const std::string& name) { return name.contains(part); });
    return found;
}

Result<size_t> numberedDevice(const Machine& machine, const std::string& wanted) {
    size_t number = 0;
    const auto [end, failed] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (failed != std::errc{} || number >= machine.devices.size()) return noDevice(machine, wanted);
    return number;
}

size_t usualDevice(const Machine& machine, const std::vector<Api>& needed) {
    std::vector<Api> all;
    for (const ApiDevices& api : machine.apis)
        if (!api.devices.empty()) all.push_back(api.api);
    auto has = [&](size_t i, const std::vector<Api>& apis, bool surely) {
        const PhysicalDevice& device = machine.devices[i];
        return std::ranges::all_of(
            apis, [&](Api api) { return device.entries.contains(api) || (!surely && device.perhaps.contains(api)); });
    };
    for (bool software : {false, true})
        for (const std::vector<Api>& apis : {all, needed, {}})
            for (bool surely : {true, false})
                for (size_t i : machine.order)
                    if (machine.devices[i].software == software && has(i, apis, surely)) return i;
    SKINBENCH_ASSERT(!"a device that may be chosen");
    return 0;
}

// Whether the first takes the second's entry as perhaps its own.
bool isPerhaps(const Machine& machine, size_t first, size_t second) {
    const auto& perhaps = machine.devices[first].perhaps;
    return std::ranges::any_of(machine.devices[second].entries, [&](const auto& entry) {
        const auto guess = perhaps.find(entry.first);
        return guess != perhaps.end() && guess->second == entry.second;
    });
}

}  // namespace

std::string uuidText(const std::array<uint8_t, 16>& uuid) {
    if (std::ranges::all_of(uuid, [](uint8_t byte) { return byte == 0; })) return "";
    std::string text;
    for (size_t i = 0; i < uuid.size(); ++i)
        text += std::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", uuid[i]);
    return text;
}

std::string pciText(uint32_t domain, uint32_t bus, uint32_t device, uint32_t function) {
    return std::format("{:04x}:{:02x}:{:02x}.{:x}", domain, bus, device, function);
}

std::string pciText(std::string_view address) {
    std::array<uint32_t, 4> numbers{};  // domain, bus, device, function
    constexpr std::array<uint32_t, 4> kMost = {UINT32_MAX, 0xff, 0x1f, 7};
    const size_t first = std::ranges::count(address, ':') == 1 ? 1 : 0;
    for (size_t i = first; i < numbers.size(); ++i) {
        const size_t end = i == 3 ? address.size() : address.find(i == 2 ? '.' : ':');
        if (end == std::string_view::npos || end > 8 || !isHex(address.substr(0, end))) return "";
        std::from_chars(address.data(), address.data() + end, numbers[i], 16);
        if (numbers[i] > kMost[i]) return "";
        address.remove_prefix(std::min(end + 1, address.size()));
    }
    return pciText(numbers[0], numbers[1], numbers[2], numbers[3]);
}

Machine makeMachine(std::vector<ApiDevices> apis, const Environment& environment) {
    Machine machine;
    for (ApiDevices& api : apis) dropSharedUuids(api.devices);
    sharePci(apis);
    machine.apis = std::move(apis);
    for (const ApiDevices& api : machine.apis)
        for (size_t i = 0; i < api.devices.size(); ++i) {
            PhysicalDevice* same = findSame(machine, api, api.devices[i]);
            if (!same) same = &machine.devices.emplace_back();
            addEntry(*same, api.devices[i], i);
        }
    guessEntries(machine);
    labelDevices(machine.devices);
    hideDevices(machine, environment);
    return machine;
}

Result<size_t> pickDevice(const Machine& machine, const std::string& wanted, const std::vector<Api>& needed) {
    if (machine.devices.empty()) return deviceError(missingText(machine));
    if (wanted.empty() && machine.order.empty())
        return deviceError("every device is hidden by " + machine.devices.front().hiddenBy);
    if (wanted.empty()) return usualDevice(machine, needed);
    std::vector<size_t> found;
    if (isDigits(wanted)) {
        auto number = numberedDevice(machine, wanted);
        SKINBENCH_TRY(number);
        found = {*number};
    } else if (lower(wanted).starts_with("mig-")) {
        return deviceError("--device " + wanted +
                           ": Vulkan and OpenGL do not say which MIG instance they run on; name the GPU");
    } else {
        found = fitting(machine, wanted);
    }
    if (found.empty()) return noDevice(machine, wanted);
    std::vector<size_t> open;
    for (size_t i : found)
        if (machine.devices[i].hiddenBy.empty()) open.push_back(i);
    if (open.empty())
        return deviceError(
            std::format("device {} is hidden by {}", listed(machine, found), machine.devices[found.front()].hiddenBy));
    if (open.size() > 1)
        return deviceError(std::format("'{}' fits {} devices, so name one by its number, UUID or PCI address: {}",
                                       wanted, open.size(), listed(machine, open)));
    return open.front();
}

std::vector<size_t> allDevices(const Machine& machine) {
    std::vector<size_t> all = machine.order;
    const auto isHardware = [&](size_t i) { return !machine.devices[i].software; };
    if (std::ranges::any_of(all, isHardware)) std::erase_if(all, [&](size_t i) { return !isHardware(i); });
    std::vector<size_t> once;
    for (size_t i : all)
        if (std::ranges::none_of(once, [&](size_t earlier) { return isPerhaps(machine, earlier, i); }))
            once.push_back(i);
    return once;
}

Result<Entry> entryOf(const Machine& machine, size_t number, Api wanted) {
    const PhysicalDevice& device = machine.devices[number];
    const auto api = std::ranges::find(machine.apis, wanted, &ApiDevices::api);
    SKINBENCH_ASSERT(api != machine.apis.end());
    if (const auto entry = device.entries.find(wanted); entry != device.entries.end()) return Entry{entry->second};
    if (const auto entry = device.perhaps.find(wanted); entry != device.perhaps.end())
        return Entry{entry->second,
                     std::format("whether {}'s {} is the same device as {} cannot be told: no UUID or PCI address that "
                                 "both give",
                                 namesOf(wanted).name, api->devices[entry->second].name, device.label)};
    if (api->devices.empty()) return deviceError(api->missing);
    std::string others;
    for (size_t i = 0; i < machine.devices.size(); ++i)
        if (machine.devices[i].entries.contains(wanted))
            others += std::format("{}{} ({})", others.empty() ? "" : ", ", i, machine.devices[i].label);
    return deviceError(std::format("{} does not offer {}, only {}", namesOf(wanted).name, device.label, others));
}

std::string describeDevice(const Machine& machine, size_t number) {
    const PhysicalDevice& device = machine.devices[number];
    std::string text = std::format("{}: {}", number, device.name);
    if (!device.uuid.empty()) text += ", UUID " + device.uuid;
    if (!device.pci.empty()) text += ", PCI " + device.pci;
    return text;
}

std::string deviceFolder(const Machine& machine, size_t number) {
    constexpr size_t kMost = 32;
    std::string folder = std::to_string(number);
    bool gap = true;
    for (unsigned char c : plainName(machine.devices[number].name)) {
        const bool plain = c < 128 && std::isalnum(c);
        if (plain && folder.size() < kMost) folder += (gap ? "-" : "") + std::string(1, std::tolower(c));
        gap = !plain;
    }
    return folder;
}

DeviceCaps capsOf(const Machine& machine, size_t number, const DeviceCaps& entry) {
    const PhysicalDevice& device = machine.devices[number];
    DeviceCaps caps = entry;
    caps.uuid = device.uuid;
    caps.pci = device.pci;
    caps.number = number;
    caps.label = device.label;
    return caps;
}

std::string refusalText(std::vector<Refusal> refusals, size_t most) {
    std::ranges::stable_sort(refusals, std::greater{}, &Refusal::step);
    std::vector<std::pair<std::string, std::string>> reasons;  // with their places
    for (const Refusal& refusal : refusals) {
        auto known = std::ranges::find(reasons, refusal.reason, &std::pair<std::string, std::string>::first);
        if (known == reasons.end())
            reasons.emplace_back(refusal.reason, refusal.place);
        else
            known->second += ", " + refusal.place;
    }
    constexpr size_t kSaved = 12;  // for "; 99 more"
    std::string text;
    for (size_t i = 0; i < reasons.size(); ++i) {
        std::string next = std::format("{}{} ({})", i ? "; " : "", reasons[i].first, reasons[i].second);
        if (i == 0 && next.size() + kSaved > most) next = terminalText(next, most - kSaved);
        if (text.size() + next.size() + kSaved > most) return text + std::format("; {} more", reasons.size() - i);
        text += next;
    }
    return text;
}

}  // namespace skinbench
