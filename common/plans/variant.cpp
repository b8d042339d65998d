#include "common/plans/variant.h"

#include <algorithm>
#include <format>

#include "common/scene/pose.h"

namespace skinbench {

uint64_t PaletteBlocks::stride() const {
    const uint64_t bytes = size * sizeof(PaletteEntry);
    return (bytes + kPaletteAlignment - 1) / kPaletteAlignment * kPaletteAlignment;
}

std::optional<PaletteBlocks> paletteBlocks(const Case& c, const PlanInput& input) {
    if (usesPartition(c)) {
        const PartitionPlan& plan = input.records->partition;
        PaletteBlocks blocks{plan.slots, {}};
        for (size_t command = 0; command < plan.commands.size(); ++command) {
            const std::vector<uint16_t> slots = slotsAfter(plan, command);
            blocks.joints.insert(blocks.joints.end(), slots.begin(), slots.end());
        }
        return blocks;
    }
    if (!c.shape.uniformPalette) return std::nullopt;
    PaletteBlocks blocks;
    blocks.size = static_cast<uint32_t>(input.scene->skeleton.joints.size());
    for (uint32_t joint = 0; joint < blocks.size; ++joint) blocks.joints.push_back(static_cast<uint16_t>(joint));
    return blocks;
}

static std::string mebibytes(uint64_t bytes) { return std::format("{:.1f} MiB", static_cast<double>(bytes) / 1048576); }

Result<FramePlan> makePlan(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    // Vertex, index and group numbers of all copies together are 32 bits, base vertices signed.
    const uint64_t largest = std::max<uint64_t>(input.encoded->vertexCount, input.scene->mesh.indices.size());
    if (largest * input.copies > INT32_MAX)
        return deviceError(
            std::format("{} copies of {} vertices and {} indices exceed 32-bit numbers; use fewer copies", input.copies,
                        input.encoded->vertexCount, input.scene->mesh.indices.size()));
    Result<FramePlan> plan = c.variant->plan(c, input, caps);
    if (!plan) return plan;
    if (c.route->api == Api::cpu) return plan;
    for (const Stream& stream : plan->streams) {
        const uint64_t bytes = stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas : stream.gpuBytes;
        const bool storage = stream.use & useStorage;
        const uint64_t most = storage ? std::min(caps.maxStorageBytes, caps.maxBufferBytes) : caps.maxBufferBytes;
        if (bytes > most)
            return deviceError(std::format("needs a {}buffer of {} for {} copies: {} allows {}; use fewer copies",
                                           storage ? "storage " : "", mebibytes(bytes), input.copies, caps.name,
                                           mebibytes(most)));
    }
    if (plan->paletteRange > caps.maxUniformBytes)
        return deviceError(std::format("needs a uniform block of {} bytes for {} joints: {} allows {}",
                                       plan->paletteRange, plan->paletteRange / sizeof(PaletteEntry), caps.name,
                                       caps.maxUniformBytes));
    if (!plan->paletteRange && plan->paletteBytes > caps.maxStorageBytes)
        return deviceError(std::format("needs a palette of {} for {} copies: {} allows {}; use fewer copies",
                                       mebibytes(plan->paletteBytes), input.copies, caps.name,
                                       mebibytes(caps.maxStorageBytes)));
    if (caps.deviceBytes && planBytes(*plan) > caps.deviceBytes)
        return deviceError(std::format("needs {} for {} copies: {} has {}; use fewer copies",
                                       mebibytes(planBytes(*plan)), input.copies, caps.name,
                                       mebibytes(caps.deviceBytes)));
    return plan;
}

MemoryBytes memoryOfOneCopy(const FramePlan& plan, uint32_t copies) {
    MemoryBytes memory;
    for (const Stream& stream : plan.streams) {
        const uint64_t bytes =
            stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas / copies : stream.gpuBytes / copies;
        switch (stream.slot) {
            case SLOT_VERTEX:
            case SLOT_TANGENT:
                memory.vertex += bytes;
                break;
            case SLOT_INDEX:
                memory.index += bytes;
                break;
            case SLOT_MESHLET:
            case SLOT_MESHLET_DATA:
                memory.meshlet += bytes;
                break;
            case SLOT_MESHLET_EXTRA:
                memory.additionalMeshlet += bytes;
                break;
            case SLOT_TUPLE:
                memory.tuple += bytes;
                break;
            case SLOT_SKINNED:
                memory.skinned += bytes;
                break;
            default:
                break;
        }
    }
    memory.palette = plan.paletteBytes / copies;
    return memory;
}

}  // namespace skinbench
