#include "common/frame/backend.h"

#include <algorithm>
#include <cstring>
#include <format>

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

uint64_t memoryOf(const Stream& stream) { return streamBytes(stream) * (stream.inTurn ? 2 : 1); }

uint64_t planBytes(const FramePlan& plan) {
    uint64_t total = 0;
    for (const Stream& stream : plan.streams) total += memoryOf(stream);
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

Result<size_t> deviceNumber(const std::vector<DeviceCaps>& devices, std::optional<size_t> number) {
    if (number && *number >= devices.size())
        return deviceError(
            std::format("{}: no device {} among {}", namesOf(devices.front().api).name, *number, devices.size()));
    if (number) return *number;
    const auto hardware = std::ranges::find(devices, false, &DeviceCaps::software);
    return hardware == devices.end() ? 0 : static_cast<size_t>(hardware - devices.begin());
}

}  // namespace skinbench
