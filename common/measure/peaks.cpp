#include "common/measure/peaks.h"

#include <algorithm>

namespace skinbench {

constexpr uint32_t kGroupBytes = COPY_GROUP * 16;
constexpr uint32_t kMostGroups = 32768;
constexpr size_t kFrames = 8;

Result<double> measureCopyBandwidth(Backend& backend, const ShaderLibrary& shaders) {
    const DeviceCaps& caps = backend.caps();
    const uint64_t wanted = caps.software ? uint64_t{16} << 20 : uint64_t{256} << 20;
    const uint64_t bytes = std::min(wanted, caps.maxStorageBytes / kGroupBytes * kGroupBytes);
    Result<ShaderText> text =
        shaderText(shaders, {"copy.glsl", Stage::compute, caps.api, MeshDialect::none, false, {}});
    SKINBENCH_TRY(text);
    FramePlan plan;
    plan.label = "copy bandwidth";
    plan.programs.push_back({.label = "copy", .stages = {std::move(*text)}});
    plan.streams = {{.slot = SLOT_VERTEX, .gpuBytes = bytes}, {.slot = SLOT_SKINNED, .gpuBytes = bytes}};
    Pass pass{.label = "copy", .kind = PassKind::dispatch};
    const auto groups = static_cast<uint32_t>(bytes / kGroupBytes);
    const uint32_t most = std::clamp(caps.maxComputeGroupCount, 1u, kMostGroups);
    for (uint32_t first = 0; first < groups; first += most)
        pass.draws.push_back({.count = std::min(most, groups - first), .constants = {0, first, 0, 0}});
    plan.passes.push_back(std::move(pass));
    auto id = backend.prepare(plan);
    SKINBENCH_TRY(id);
    auto timings = backend.run(*id, std::vector<FrameInput>(kFrames));
    backend.release(*id);
    SKINBENCH_TRY(timings);
    double fastest = timings->front().passes.front();
    for (const Timing& timing : *timings) fastest = std::min(fastest, timing.passes.front());
    if (fastest <= 0) return deviceError(caps.name + ": its timestamps do not count, so no bandwidth follows");
    return 2 * static_cast<double>(bytes) / (fastest * 1e-3);
}

}  // namespace skinbench
