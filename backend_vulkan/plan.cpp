#include "backend_vulkan/plan.h"

#include <algorithm>
#include <cstring>
#include <format>

namespace skinbench::vulkan {

namespace {

uint64_t alignUp(uint64_t value, uint64_t alignment) { return (value + alignment - 1) / alignment * alignment; }

VkDescriptorType descriptorType(uint32_t use) {
    return use & useUniform ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

VkDescriptorType paletteType(const Plan& plan) {
    return plan.shape.paletteRange ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC
                                   : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC;
}

bool isBound(const Stream& stream) { return stream.use & (useStorage | useUniform); }

Result<void> allocateStream(Plan& plan, const Stream& source) {
    Device& device = plan.device;
    VkBufferUsageFlags usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (source.use & useStorage) usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    if (source.use & useUniform) usage |= VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    if (source.use & useAttributes) usage |= VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    if (source.use & useIndices) usage |= VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    if (source.use & useIndirect) usage |= VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    const uint64_t bytes = streamBytes(source);
    auto who = [&] {
        return std::format("{}: slot {} ({} MiB with all streams)", plan.shape.label, source.slot,
                           planBytes(plan.shape) >> 20);
    };
    for (size_t turn = 0; turn < 2; ++turn) {
        Buffer& buffer = plan.streams[turn].emplace_back();
        if (turn == 0 || source.inTurn)
            SKINBENCH_TRY(createBuffer(device, bytes, usage, Memory::device, buffer, who, plan.shape.passesAhead > 0));
        const VkBuffer seen = bufferOf(plan, plan.streams[turn].size() - 1, turn).handle;
        if (source.use & useIndices) plan.turns[turn].indexBuffer = seen;
        if (source.use & useIndirect) plan.turns[turn].commandBuffer = seen;
    }
    if (!source.hostWritten) return {};
    plan.hostWritten = plan.streams[0].size() - 1;
    return createBuffer(device, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Memory::upload, plan.hostStaging,
                        [&] { return plan.shape.label + ": the host's copy of the skinned vertices"; });
}

Result<void> fillStream(Device& device, const Buffer& target, const Stream& from) {
    if (!from.bytes || target.bytes != streamBytes(from)) SKINBENCH_TRY(fillZero(device, target));
    if (!from.bytes) return {};
    return upload(device, target, streamBytes(from),
                  [&](std::span<std::byte> chunk, uint64_t start) { copyReplicas(from, start, chunk); });
}

// All memory is taken before the first byte travels: a plan that does not fit fails at once.
Result<void> makeStreams(Plan& plan, const FramePlan& source) {
    for (const Stream& stream : source.streams) SKINBENCH_TRY(allocateStream(plan, stream));
    for (const std::vector<Buffer>& buffers : plan.streams)
        for (size_t i = 0; i < buffers.size(); ++i)
            if (buffers[i].handle) SKINBENCH_TRY(fillStream(plan.device, buffers[i], source.streams[i]));
    return {};
}

Result<void> makeLayout(Plan& plan, const FramePlan& source) {
    Device& device = plan.device;
    std::vector<VkDescriptorSetLayoutBinding> bindings{
        {SLOT_FRAME, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1, device.stages, nullptr},
        {SLOT_PALETTE, paletteType(plan), 1, device.stages, nullptr}};
    for (const Stream& stream : source.streams)
        if (isBound(stream)) bindings.push_back({stream.slot, descriptorType(stream.use), 1, device.stages, nullptr});
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set.bindingCount = static_cast<uint32_t>(bindings.size());
    set.pBindings = bindings.data();
    SKINBENCH_TRY(check(device, device.vk.vkCreateDescriptorSetLayout(device.handle, &set, nullptr, &plan.setLayout),
                        "create a descriptor layout"));
    const VkPushConstantRange constants{device.stages, 0, sizeof(Draw::constants)};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &plan.setLayout;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &constants;
    return check(device, device.vk.vkCreatePipelineLayout(device.handle, &layout, nullptr, &plan.layout),
                 "create a pipeline layout");
}

void writeDescriptor(const Plan& plan, size_t turn, uint32_t slot, VkDescriptorType type, VkBuffer buffer,
                     VkDeviceSize range) {
    const VkDescriptorBufferInfo info{buffer, 0, range};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = plan.turns[turn].descriptors;
    write.dstBinding = slot;
    write.descriptorCount = 1;
    write.descriptorType = type;
    write.pBufferInfo = &info;
    plan.device.vk.vkUpdateDescriptorSets(plan.device.handle, 1, &write, 0, nullptr);
}

Result<void> makeDescriptors(Plan& plan, const FramePlan& source) {
    Device& device = plan.device;
    constexpr uint32_t turns = std::tuple_size_v<decltype(plan.turns)>;
    const std::array<VkDescriptorPoolSize, 4> sizes{{{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, turns * 2},
                                                     {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC, turns},
                                                     {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, turns * SLOT_COUNT},
                                                     {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, turns * SLOT_COUNT}}};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.maxSets = turns;
    pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
    pool.pPoolSizes = sizes.data();
    SKINBENCH_TRY(check(device, device.vk.vkCreateDescriptorPool(device.handle, &pool, nullptr, &plan.descriptorPool),
                        "create a descriptor pool"));
    VkDescriptorSetAllocateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    set.descriptorPool = plan.descriptorPool;
    set.descriptorSetCount = 1;
    set.pSetLayouts = &plan.setLayout;
    for (size_t turn = 0; turn < turns; ++turn) {
        SKINBENCH_TRY(check(device,
                            device.vk.vkAllocateDescriptorSets(device.handle, &set, &plan.turns[turn].descriptors),
                            "create descriptors"));
        for (size_t i = 0; i < source.streams.size(); ++i)
            if (const Stream& stream = source.streams[i]; isBound(stream))
                writeDescriptor(plan, turn, stream.slot, descriptorType(stream.use), bufferOf(plan, i, turn).handle,
                                VK_WHOLE_SIZE);
    }
    return {};
}

Result<void> makePipelines(Plan& plan, VkPipelineCache cache, const FramePlan& source) {
    for (const Pass& pass : source.passes) {
        const Program& program = source.programs[pass.program];
        auto pipeline = makePipeline(plan.device, cache, plan.layout, program, pass.kind, pass.writeColor);
        if (!pipeline) return errorAt(plan.shape.label, pipeline.error());
        plan.pipelines.push_back(*pipeline);
        const bool fed = pass.kind == PassKind::drawIndexed && !program.attributes.empty();
        for (size_t turn = 0; turn < plan.turns.size(); ++turn)
            plan.turns[turn].vertexBuffers.push_back(
                fed ? bufferOf(plan, *streamOfSlot(source, program.attributeSlot), turn).handle : VK_NULL_HANDLE);
    }
    return {};
}

}  // namespace

Plan::~Plan() {
    for (std::vector<Buffer>& buffers : streams)
        for (Buffer& stream : buffers) destroy(device, stream);
    destroy(device, hostStaging);
    if (device.hung) return;
    for (VkPipeline pipeline : pipelines) device.vk.vkDestroyPipeline(device.handle, pipeline, nullptr);
    device.vk.vkDestroyPipelineLayout(device.handle, layout, nullptr);
    device.vk.vkDestroyDescriptorPool(device.handle, descriptorPool, nullptr);
    device.vk.vkDestroyDescriptorSetLayout(device.handle, setLayout, nullptr);
}

const Buffer& bufferOf(const Plan& plan, size_t number, size_t turn) {
    return plan.streams[plan.shape.streams[number].inTurn ? turn : 0][number];
}

uint64_t paletteRange(const Plan& plan) {
    if (plan.shape.paletteRange) return plan.shape.paletteRange;
    return std::max<uint64_t>(alignUp(plan.shape.paletteBytes, 4), 16);
}

Result<std::unique_ptr<Plan>> makePlanObjects(Device& device, VkPipelineCache cache, const FramePlan& source,
                                              std::shared_ptr<Target> target) {
    auto plan = std::make_unique<Plan>(device, source);
    plan->target = std::move(target);
    SKINBENCH_TRY(makeLayout(*plan, source));
    // Text before bytes: a shader that does not compile is said at once, not after a long upload.
    for (const Program& program : source.programs)
        for (const ShaderText& shader : program.stages)
            if (auto compiled = compileGlsl(shader, device.caps); !compiled)
                return errorAt(source.label, compiled.error());
    SKINBENCH_TRY(makeStreams(*plan, source));
    SKINBENCH_TRY(makeDescriptors(*plan, source));
    SKINBENCH_TRY(makePipelines(*plan, cache, source));
    return plan;
}

static Result<void> growFrameData(Device& device, FrameData& data, const Plan& plan, uint64_t bytes) {
    const bool shared = data.shared || plan.shape.passesAhead > 0;
    if (data.buffer.bytes >= bytes && data.buffer.handle && data.shared == shared) return {};
    const uint64_t limit = std::min<uint64_t>(device.caps.maxBufferBytes, UINT32_MAX);  // dynamic offsets: 32 bits
    if (bytes > limit)
        return deviceError(
            std::format("{}: the palettes of the batch have {} bytes, and {} takes at most {} in one buffer; "
                        "render fewer frames at once",
                        plan.shape.label, bytes, device.caps.name, limit));
    destroy(device, data.buffer);
    data.shared = shared;
    data.version = ++device.frameDataVersions;
    const VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (tryCreateBuffer(device, bytes, usage, Memory::deviceMapped, data.buffer, shared) == VK_SUCCESS) return {};
    return createBuffer(
        device, bytes, usage, data.otherwise, data.buffer,
        [&] { return plan.shape.label + ": the palettes of the batch"; }, shared);
}

static void pointDescriptors(const FrameData& data, Plan& plan) {
    if (plan.frameDataVersion == data.version) return;
    for (size_t turn = 0; turn < plan.turns.size(); ++turn) {
        writeDescriptor(plan, turn, SLOT_FRAME, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, data.buffer.handle,
                        sizeof(FrameConstants));
        writeDescriptor(plan, turn, SLOT_PALETTE, paletteType(plan), data.buffer.handle, paletteRange(plan));
    }
    plan.frameDataVersion = data.version;
}

Result<uint64_t> needFrames(Device& device, FrameData& data, Plan& plan, size_t frames) {
    const VkPhysicalDeviceLimits& limits = device.adapter.properties.limits;
    data.constantsStride = alignUp(sizeof(FrameConstants), limits.minUniformBufferOffsetAlignment);
    const uint64_t alignment =
        std::max({limits.minStorageBufferOffsetAlignment, limits.minUniformBufferOffsetAlignment, kPaletteAlignment});
    data.paletteStride = alignUp(std::max(paletteRange(plan), plan.shape.paletteBytes), alignment);
    data.paletteStart = alignUp(data.constantsStride * frames, alignment);
    const uint64_t bytes = data.paletteStart + data.paletteStride * frames;
    SKINBENCH_TRY(growFrameData(device, data, plan, bytes));
    pointDescriptors(data, plan);
    return bytes;
}

void writeFrame(const FrameData& data, size_t number, const FrameInput& frame, std::byte* out) {
    std::memcpy(out + data.constantsStride * number, &frame.constants, sizeof(FrameConstants));
    std::ranges::copy(frame.palette, out + data.paletteStart + data.paletteStride * number);
}

Result<void> uploadFrames(Device& device, FrameData& data, Plan& plan, std::span<const FrameInput> frames) {
    const auto bytes = needFrames(device, data, plan, frames.size());
    SKINBENCH_TRY(bytes);
    std::vector<std::byte> all(data.buffer.mapped ? 0 : *bytes);
    for (size_t i = 0; i < frames.size(); ++i)
        writeFrame(data, i, frames[i], data.buffer.mapped ? data.buffer.mapped : all.data());
    if (data.buffer.mapped) return flush(device, data.buffer);
    return upload(device, data.buffer, *bytes, [&](std::span<std::byte> chunk, uint64_t from) {
        std::memcpy(chunk.data(), all.data() + from, chunk.size());
    });
}

}  // namespace skinbench::vulkan
