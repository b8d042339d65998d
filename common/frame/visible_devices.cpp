#include "common/frame/visible_devices.h"

#include <algorithm>
#include <charconv>
#include <format>
#include <optional>

namespace skinbench {
namespace {

struct Variable {
    const char* name;
    bool cuda = false;    // of NVIDIA's devices alone, with UUIDs
    bool ofNode = false;  // counts all GPUs of the node, even those that the process cannot see
};

constexpr Variable kVariables[] = {{.name = "CUDA_VISIBLE_DEVICES", .cuda = true},
                                   {.name = "GPU_DEVICE_ORDINAL"},
                                   {.name = "SLURM_STEP_GPUS", .ofNode = true},
                                   {.name = "SLURM_JOB_GPUS", .ofNode = true}};

std::vector<std::string> wordsOf(const std::string& list) {
    std::vector<std::string> words;
    for (size_t start = 0; start <= list.size();) {
        const size_t end = std::min(list.find(',', start), list.size());
        std::string word = list.substr(start, end - start);
        word.erase(0, word.find_first_not_of(" \t"));
        word.erase(word.find_last_not_of(" \t") + 1);
        words.push_back(word);
        start = end + 1;
    }
    return words;
}

// The devices that numbers count: NVIDIA's, or all hardware where there is none, by PCI address; those without one
// behind the others, as the API lists them.
std::vector<size_t> countedDevices(const Machine& machine, bool nvidiaOnly) {
    std::vector<size_t> counted;
    for (bool nvidia : {true, false})
        for (size_t i = 0; i < machine.devices.size() && (nvidia || (counted.empty() && !nvidiaOnly)); ++i)
            if (!machine.devices[i].software && (!nvidia || machine.devices[i].vendor == kVendorNvidia))
                counted.push_back(i);
    std::ranges::stable_sort(counted, {}, [&](size_t i) {
        const std::string& pci = machine.devices[i].pci;
        return std::pair(pci.empty(), pci);
    });
    return counted;
}

// What a word of the list means among the counted devices; nothing for what CUDA ends its list at.
std::optional<size_t> meant(const Machine& machine, const std::vector<size_t>& counted, const std::string& word,
                            bool uuids) {
    if (uuids && word.starts_with("GPU-")) {
        std::string digits = word.substr(4);
        std::ranges::transform(digits, digits.begin(), [](unsigned char c) { return std::tolower(c); });
        std::optional<size_t> found;
        for (size_t i : counted) {
            if (!machine.devices[i].uuid.starts_with(digits) || digits.empty()) continue;
            if (found) return std::nullopt;
            found = i;
        }
        return found;
    }
    size_t number = 0;
    const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (failed != std::errc{} || end != word.data() + word.size() || number >= counted.size()) return std::nullopt;
    return counted[number];
}

// The devices of a list up to the first word that fits none.
std::vector<size_t> devicesOf(const Machine& machine, const Variable& variable, const std::vector<size_t>& counted,
                              const std::vector<std::string>& words) {
    if (variable.ofNode && counted.size() <= words.size()) return counted;
    std::vector<size_t> visible;
    for (const std::string& word : words) {
        const auto device = meant(machine, counted, word, variable.cuda);
        if (!device) break;
        if (std::ranges::find(visible, *device) == visible.end()) visible.push_back(*device);
    }
    return visible;
}

bool hasNumbers(const std::vector<std::string>& words) {
    return std::ranges::any_of(words, [](const std::string& word) { return !word.empty() && std::isdigit(word[0]); });
}

bool lacksOrder(const Machine& machine, const std::vector<size_t>& counted) {
    return counted.size() > 1 && std::ranges::any_of(counted, [&](size_t i) { return machine.devices[i].pci.empty(); });
}

void follow(Machine& machine, const Variable& variable, const std::string& value) {
    const std::string given = std::format("{}={}", variable.name, value);
    const std::vector<std::string> words = wordsOf(value);
    const std::vector<size_t> counted = countedDevices(machine, variable.cuda);
    if (counted.empty()) return;
    if (std::ranges::any_of(words, [](const std::string& word) { return word.starts_with("MIG-"); })) {
        machine.notes.push_back(given +
                                ": Vulkan and OpenGL do not say which MIG instance they run on, so it is not "
                                "followed; any device may be chosen");
        return;
    }
    const std::vector<size_t> visible = devicesOf(machine, variable, counted, words);
    if (visible.empty() && variable.ofNode) {
        machine.notes.push_back(given + " fits no device here, so it is not followed; any device may be chosen");
        return;
    }
    std::string hidden;
    for (size_t i : counted) {
        if (std::ranges::find(visible, i) != visible.end()) continue;
        machine.devices[i].hiddenBy = given;
        hidden += std::format("{}{} ({})", hidden.empty() ? "" : ", ", i, machine.devices[i].label);
    }
    if (!hidden.empty()) machine.notes.push_back(given + " hides " + hidden);
    if (hasNumbers(words) && lacksOrder(machine, counted) && !hidden.empty())
        machine.notes.push_back(given + ": not every device has a PCI address, so its numbers may mean others");
    machine.order = visible;
}

}  // namespace

const std::vector<std::string>& visibilityVariables() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const Variable& variable : kVariables) list.emplace_back(variable.name);
        return list;
    }();
    return names;
}

void hideDevices(Machine& machine, const Environment& environment) {
    for (const Variable& variable : kVariables)
        if (const auto value = environment.find(variable.name); value != environment.end()) {
            follow(machine, variable, value->second);
            break;
        }
    for (bool software : {false, true})
        for (size_t i = 0; i < machine.devices.size(); ++i)
            if (machine.devices[i].software == software && machine.devices[i].hiddenBy.empty() &&
                std::ranges::find(machine.order, i) == machine.order.end())
                machine.order.push_back(i);
}

}  // namespace skinbench
