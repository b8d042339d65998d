#include "common/plans/plan.h"

#include <algorithm>
#include <format>
#include <map>

#include "common/frame/check_plan.h"
#include "common/plans/plan_parts.h"
#include "common/scene/pose.h"

namespace skinbench {

// std140: whole elements of 16 bytes.
uint32_t PaletteBlocks::bytes() const { return (size * bytesOfJoint + 15) / 16 * 16; }

uint64_t PaletteBlocks::stride() const {
    return (bytes() + kPaletteAlignment - 1) / kPaletteAlignment * kPaletteAlignment;
}

std::optional<PaletteBlocks> paletteBlocks(const Case& c, const PlanInput& input) {
    if (usesPartition(c)) {
        const PartitionPlan& plan = input.records->partition;
        PaletteBlocks blocks{plan.slots, {}, input.palette.bytesOfJoint()};
        for (size_t command = 0; command < plan.commands.size(); ++command) {
            const std::vector<uint16_t> slots = slotsAfter(plan, command);
            blocks.joints.insert(blocks.joints.end(), slots.begin(), slots.end());
        }
        return blocks;
    }
    if (!c.shape.uniformPalette) return std::nullopt;
    PaletteBlocks blocks;
    blocks.bytesOfJoint = input.palette.bytesOfJoint();
    blocks.size = static_cast<uint32_t>(input.scene->skeleton.joints.size());
    for (uint32_t joint = 0; joint < blocks.size; ++joint) blocks.joints.push_back(static_cast<uint16_t>(joint));
    return blocks;
}

Result<FramePlan> makePlan(const Case& c, const PlanInput& input, const DeviceCaps& caps) {
    // Vertex, index and group numbers of all copies together are 32 bits, base vertices signed.
    const uint64_t largest = std::max<uint64_t>(input.encoded->vertexCount, input.scene->mesh.indices.size());
    if (largest * input.copies > INT32_MAX)
        return deviceError(
            std::format("{} copies of {} vertices and {} indices exceed 32-bit numbers; use fewer copies", input.copies,
                        input.encoded->vertexCount, input.scene->mesh.indices.size()));
    Result<FramePlan> plan = c.variant->plan(c, input, caps);
    if (!plan) return plan;
    if (c.queues == Queues::async) runAhead(*plan, c);
    const auto right = c.route->api == Api::cpu ? Result<void>() : checkPlan(*plan, caps);
    if (right) return plan;
    return right.error().fault == Fault::input ? programError(right.error().text) : std::unexpected(right.error());
}

MemoryBytes memoryOfOneCopy(const FramePlan& plan, uint32_t copies) {
    static const std::map<uint32_t, uint64_t MemoryBytes::*> kinds = {
        {SLOT_VERTEX, &MemoryBytes::vertex},
        {SLOT_TANGENT, &MemoryBytes::vertex},
        {SLOT_INDEX, &MemoryBytes::index},
        {SLOT_VISIBLE, &MemoryBytes::index},
        {SLOT_COMMAND, &MemoryBytes::index},
        {SLOT_MESHLET, &MemoryBytes::meshlet},
        {SLOT_MESHLET_DATA, &MemoryBytes::meshlet},
        {SLOT_MESHLET_EXTRA, &MemoryBytes::additionalMeshlet},
        {SLOT_TUPLE, &MemoryBytes::tuple},
        {SLOT_SKINNED_TANGENT, &MemoryBytes::skinned},
        {SLOT_SKINNED, &MemoryBytes::skinned},
        {SLOT_CLUSTER, &MemoryBytes::additionalMeshlet},
        {SLOT_CLUSTER_PART, &MemoryBytes::additionalMeshlet},
        {SLOT_CLUSTER_LIST, &MemoryBytes::additionalMeshlet},
        {SLOT_INSTANCE, &MemoryBytes::additionalMeshlet},
    };
    MemoryBytes memory;
    for (const Stream& stream : plan.streams)
        if (auto kind = kinds.find(stream.slot); kind != kinds.end()) memory.*kind->second += memoryOf(stream) / copies;
    memory.palette = plan.paletteBytes / copies;
    return memory;
}

}  // namespace skinbench
