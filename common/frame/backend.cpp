#include "common/frame/backend.h"

#include <algorithm>
#include <cctype>
#include <cstring>

namespace skinbench {

const ApiNames& namesOf(Api api) {
    static constexpr ApiNames rows[] = {{"Vulkan", "vulkan", "VK"}, {"OpenGL", "opengl", "GL"}, {"CPU", "cpu", ""}};
    return rows[static_cast<size_t>(api)];
}

const char* stageName(Stage stage) {
    constexpr std::array names = {"vertex", "fragment", "compute", "task", "mesh"};
    return names[static_cast<size_t>(stage)];
}

bool hasStage(const Program& program, Stage stage) {
    return std::ranges::find(program.stages, stage, &ShaderText::stage) != program.stages.end();
}

uint64_t streamBytes(const Stream& stream) {
    return stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas : stream.gpuBytes;
}

uint64_t planBytes(const FramePlan& plan) {
    uint64_t total = 0;
    for (const Stream& stream : plan.streams) total += streamBytes(stream);
    return total;
}

void copyReplicas(const Stream& stream, uint64_t from, std::span<std::byte> out) {
    const std::vector<std::byte>& bytes = *stream.bytes;
    while (!out.empty()) {
        const uint64_t replica = from / bytes.size(), start = from % bytes.size();
        const size_t count = std::min<uint64_t>(bytes.size() - start, out.size());
        std::memcpy(out.data(), bytes.data() + start, count);
        const uint32_t add = stream.replicaAdd * static_cast<uint32_t>(replica);
        for (size_t i = 0; add && i < count; i += sizeof add) {
            uint32_t word;
            std::memcpy(&word, &out[i], sizeof word);
            word += add;
            std::memcpy(&out[i], &word, sizeof word);
        }
        from += count;
        out = out.subspan(count);
    }
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
