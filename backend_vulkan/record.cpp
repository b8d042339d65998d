#include "backend_vulkan/record.h"

namespace skinbench::vulkan {

void bindFrame(const FrameRecord& record, uint64_t paletteOffset) {
    const std::array offsets{
        static_cast<uint32_t>(record.data.constantsStride * record.frame),
        static_cast<uint32_t>(record.data.paletteStart + record.data.paletteStride * record.frame + paletteOffset)};
    for (VkPipelineBindPoint point : {VK_PIPELINE_BIND_POINT_GRAPHICS, VK_PIPELINE_BIND_POINT_COMPUTE}) {
        if (record.secondQueue && point == VK_PIPELINE_BIND_POINT_GRAPHICS) continue;
        record.plan.device.vk.vkCmdBindDescriptorSets(record.commands, point, record.plan.layout, 0, 1,
                                                      &record.bound().descriptors, 2, offsets.data());
    }
}

void bindPass(const FrameRecord& record, size_t number) {
    const VolkDeviceTable& vk = record.plan.device.vk;
    const Pass& pass = record.plan.shape.passes[number];
    if (pass.kind == PassKind::dispatch) {
        vk.vkCmdBindPipeline(record.commands, VK_PIPELINE_BIND_POINT_COMPUTE, record.plan.pipelines[number]);
        return;
    }
    vk.vkCmdBindPipeline(record.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, record.plan.pipelines[number]);
    const VkExtent2D size = record.plan.target->size;
    const VkViewport viewport{0, 0, static_cast<float>(size.width), static_cast<float>(size.height), 0, 1};
    const VkRect2D scissor{{0, 0}, size};
    vk.vkCmdSetViewport(record.commands, 0, 1, &viewport);
    vk.vkCmdSetScissor(record.commands, 0, 1, &scissor);
    vk.vkCmdSetCullMode(record.commands, pass.cullBackFaces ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE);
    vk.vkCmdSetRasterizerDiscardEnable(record.commands, pass.raster == RasterMode::discard);
    const bool keep = pass.depth == DepthTest::equalKeep, never = pass.raster == RasterMode::noFragments;
    vk.vkCmdSetDepthCompareOp(record.commands, never  ? VK_COMPARE_OP_NEVER
                                               : keep ? VK_COMPARE_OP_EQUAL
                                                      : VK_COMPARE_OP_LESS);
    vk.vkCmdSetDepthWriteEnable(record.commands, !never && !keep);
    if (pass.kind != PassKind::drawIndexed) return;
    const VkDeviceSize start = 0;
    if (record.bound().vertexBuffers[number])
        vk.vkCmdBindVertexBuffers(record.commands, 0, 1, &record.bound().vertexBuffers[number], &start);
    vk.vkCmdBindIndexBuffer(record.commands, record.bound().indexBuffer, 0, VK_INDEX_TYPE_UINT32);
}

void clearTarget(const FrameRecord& record) {
    beginRendering(record.commands, *record.plan.target, VK_ATTACHMENT_LOAD_OP_CLEAR, record.plan.shape.background);
    record.plan.device.vk.vkCmdEndRendering(record.commands);
}

static void recordIndirect(const FrameRecord& record, PassKind kind, uint32_t command) {
    const VolkDeviceTable& vk = record.plan.device.vk;
    const VkDeviceSize offset = VkDeviceSize{command} * sizeof(DrawCommand);
    if (kind == PassKind::dispatch)
        vk.vkCmdDispatchIndirect(record.commands, record.bound().commandBuffer, offset);
    else if (kind == PassKind::drawIndexed)
        vk.vkCmdDrawIndexedIndirect(record.commands, record.bound().commandBuffer, offset, 1, sizeof(DrawCommand));
    else if (record.plan.shape.dialect == MeshDialect::nv)
        vk.vkCmdDrawMeshTasksIndirectNV(record.commands, record.bound().commandBuffer, offset, 1, sizeof(DrawCommand));
    else
        vk.vkCmdDrawMeshTasksIndirectEXT(record.commands, record.bound().commandBuffer, offset, 1, sizeof(DrawCommand));
}

void recordDraws(const FrameRecord& record, const Pass& pass, VkAttachmentLoadOp load) {
    const VolkDeviceTable& vk = record.plan.device.vk;
    const bool draws = pass.kind != PassKind::dispatch;
    if (draws) beginRendering(record.commands, *record.plan.target, load, record.plan.shape.background);
    for (const Draw& draw : pass.draws) {
        if (record.plan.shape.paletteRange) bindFrame(record, draw.paletteOffset);
        vk.vkCmdPushConstants(record.commands, record.plan.layout, record.plan.device.stages, 0, sizeof draw.constants,
                              draw.constants.data());
        if (draw.command)
            recordIndirect(record, pass.kind, *draw.command);
        else if (pass.kind == PassKind::dispatch)
            vk.vkCmdDispatch(record.commands, draw.count, 1, 1);
        else if (pass.kind == PassKind::drawIndexed)
            vk.vkCmdDrawIndexed(record.commands, draw.count, 1, draw.firstIndex, draw.baseVertex, 0);
        else if (record.plan.shape.dialect == MeshDialect::nv)
            vk.vkCmdDrawMeshTasksNV(record.commands, draw.count, 0);
        else
            vk.vkCmdDrawMeshTasksEXT(record.commands, draw.count, 1, 1);
    }
    if (draws) vk.vkCmdEndRendering(record.commands);
}

const Pass* recordPasses(const FrameRecord& record, size_t from, size_t to, const Pass* before, const Pass* cleared) {
    for (size_t number = from; number < to; ++number) {
        const Pass& pass = record.plan.shape.passes[number];
        if (before) narrowBarrier(record.plan.device, record.commands, before->kind == PassKind::dispatch);
        bindPass(record, number);
        const bool clears = pass.clear && &pass != cleared;
        recordDraws(record, pass, clears ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD);
        before = &pass;
    }
    return before;
}

void recordPass(const FrameRecord& record, size_t number, const std::function<void(uint32_t end)>& measure) {
    const Device& device = record.plan.device;
    const Pass& pass = record.plan.shape.passes[number];
    if (pass.kind != PassKind::dispatch && pass.clear) clearTarget(record);
    bindPass(record, number);
    fullBarrier(device, record.commands);
    measure(0);
    recordDraws(record, pass);
    measure(1);
    fullBarrier(device, record.commands);
}

void recordTimed(const FrameRecord& record, VkQueryPool pool, uint32_t first) {
    for (uint32_t pass = 0; pass < record.plan.shape.passes.size(); ++pass)
        recordPass(record, pass, [&](uint32_t end) {
            writeTimestamp(record.plan.device, record.commands, pool, first + pass * 2 + end);
        });
}

void writeTimestamp(const Device& device, VkCommandBuffer commands, VkQueryPool pool, uint32_t query) {
    if (device.caps.software) fullBarrier(device, commands);
    device.vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool, query);
    if (device.caps.software) fullBarrier(device, commands);
}

void narrowBarrier(const Device& device, VkCommandBuffer commands, bool afterDispatch) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT |
                           VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT |
                           VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
                            VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT |
                            VK_ACCESS_2_INDEX_READ_BIT;
    if (!afterDispatch) {
        const VkPipelineStageFlags2 tests =
            VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
        barrier.srcStageMask =
            VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT | tests | VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
        barrier.srcAccessMask |=
            VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
        barrier.dstStageMask |= tests | VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
        barrier.dstAccessMask |= VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                 VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                                 VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
    }
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &barrier;
    device.vk.vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace skinbench::vulkan
