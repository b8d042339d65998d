#include "backend_vulkan/plan.h"

#include <algorithm>
#include <bitset>
#include <cstring>
#include <format>

namespace skinbench::vulkan {

namespace {

uint64_t alignUp(uint64_t value, uint64_t alignment) { return (value + alignment - 1) / alignment * alignment; }

uint64_t streamBytes(const Stream& stream) {
    return stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas : stream.gpuBytes;
}

VkDescriptorType descriptorType(uint32_t use) {
    return use & useUniform ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

VkDescriptorType paletteType(const Plan& plan) {
    return plan.paletteRange ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC;
}

bool isBound(const Stream& stream) { return stream.use & (useStorage | useUniform); }

// Bytes `from` and on of all replicas, one behind the other.
void copyReplicas(const Stream& stream, std::span<std::byte> out, uint64_t from) {
    const std::vector<std::byte>& bytes = *stream.bytes;
    for (uint64_t done = 0; done < out.size();) {
        const uint64_t replica = (from + done) / bytes.size(), start = (from + done) % bytes.size();
        const uint64_t part = std::min<uint64_t>(bytes.size() - start, out.size() - done);
        std::memcpy(out.data() + done, bytes.data() + start, part);
        const uint32_t add = stream.replicaAdd * static_cast<uint32_t>(replica);
        for (uint64_t i = 0; add && i < part; i += sizeof add) {
            uint32_t word;
            std::memcpy(&word, bytes.data() + start + i, sizeof word);
            word += add;
            std::memcpy(out.data() + done + i, &word, sizeof word);
        }
        done += part;
    }
}

Result<void> allocateStream(Plan& plan, const Stream& source, uint64_t planTotal) {
    Device& device = plan.device;
    VkBufferUsageFlags usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (source.use & useStorage) usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    if (source.use & useUniform) usage |= VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    if (source.use & useAttributes) usage |= VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    if (source.use & useIndices) usage |= VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    const uint64_t bytes = streamBytes(source);
    StreamBuffer& stream = plan.streams.emplace_back(source.slot, Buffer{}, bytes);
    VkResult result = tryCreateBuffer(device, bytes, usage, Memory::device, stream.buffer);
    if (result == VK_ERROR_DEVICE_LOST) return check(device, result, "create a buffer");
    if (result != VK_SUCCESS) {
        const std::string who =
            std::format("{}: slot {} ({} MiB with all streams)", plan.label, source.slot, planTotal >> 20);
        return std::unexpected(memoryError(device, who, bytes, result));
    }
    if (source.use & useIndices) plan.indexBuffer = stream.buffer.handle;
    if (!source.hostWritten) return {};
    plan.hostWritten = plan.streams.size() - 1;
    result = tryCreateBuffer(device, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Memory::upload, plan.hostStaging);
    if (result == VK_SUCCESS) return {};
    return std::unexpected(
        memoryError(device, plan.label + ": the host's copy of the skinned vertices", bytes, result));
}

// All memory is taken before the first byte travels: a plan that does not fit fails at once.
Result<void> makeStreams(Plan& plan, const FramePlan& source) {
    for (const Stream& stream : source.streams) SKINBENCH_TRY(allocateStream(plan, stream, planBytes(source)));
    for (size_t i = 0; i < plan.streams.size(); ++i) {
        const StreamBuffer& target = plan.streams[i];
        const Stream& from = source.streams[i];
        if (!from.bytes || target.buffer.bytes != target.bytes) SKINBENCH_TRY(fillZero(plan.device, target.buffer));
        if (!from.bytes) continue;
        SKINBENCH_TRY(upload(plan.device, target.buffer, target.bytes,
                             [&](std::span<std::byte> chunk, uint64_t start) { copyReplicas(from, chunk, start); }));
    }
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

Result<void> makeDescriptors(Plan& plan, const FramePlan& source) {
    Device& device = plan.device;
    const std::array<VkDescriptorPoolSize, 4> sizes{{{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 2},
                                                     {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC, 1},
                                                     {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, SLOT_COUNT},
                                                     {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, SLOT_COUNT}}};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.maxSets = 1;
    pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
    pool.pPoolSizes = sizes.data();
    SKINBENCH_TRY(check(device, device.vk.vkCreateDescriptorPool(device.handle, &pool, nullptr, &plan.descriptorPool),
                        "create a descriptor pool"));
    VkDescriptorSetAllocateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    set.descriptorPool = plan.descriptorPool;
    set.descriptorSetCount = 1;
    set.pSetLayouts = &plan.setLayout;
    SKINBENCH_TRY(check(device, device.vk.vkAllocateDescriptorSets(device.handle, &set, &plan.descriptors),
                        "create descriptors"));
    for (size_t i = 0; i < source.streams.size(); ++i) {
        if (!isBound(source.streams[i])) continue;
        const VkDescriptorBufferInfo buffer{plan.streams[i].buffer.handle, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = plan.descriptors;
        write.dstBinding = source.streams[i].slot;
        write.descriptorCount = 1;
        write.descriptorType = descriptorType(source.streams[i].use);
        write.pBufferInfo = &buffer;
        device.vk.vkUpdateDescriptorSets(device.handle, 1, &write, 0, nullptr);
    }
    return {};
}

VkBuffer bufferOfSlot(const Plan& plan, uint32_t slot) {
    auto found = std::ranges::find(plan.streams, slot, &StreamBuffer::slot);
    return found == plan.streams.end() ? VK_NULL_HANDLE : found->buffer.handle;
}

Result<void> makePipelines(Plan& plan, VkPipelineCache cache, const FramePlan& source) {
    for (const Pass& pass : source.passes) {
        const Program& program = source.programs[pass.program];
        auto pipeline = makePipeline(plan.device, cache, plan.layout, program, pass.kind, pass.writeColor);
        if (!pipeline) return std::unexpected(Error{pipeline.error().fault, plan.label + ": " + pipeline.error().text});
        plan.pipelines.push_back(*pipeline);
        const bool fed = pass.kind == PassKind::drawIndexed && !program.attributes.empty();
        plan.vertexBuffers.push_back(fed ? bufferOfSlot(plan, program.attributeSlot) : VK_NULL_HANDLE);
    }
    return {};
}

// What makePlan must never hand over.
void assertWellFormed(const FramePlan& plan) {
    std::bitset<SLOT_COUNT> slots;
    uint32_t uses = 0, written = 0;
    for (const Stream& stream : plan.streams) {
        SKINBENCH_ASSERT(stream.slot > SLOT_PALETTE && stream.slot < SLOT_COUNT && !slots[stream.slot]);
        SKINBENCH_ASSERT(!stream.bytes || stream.replicaAdd == 0 || stream.bytes->size() % 4 == 0);
        slots.set(stream.slot);
        uses |= stream.use;
        written += stream.hostWritten;
    }
    SKINBENCH_ASSERT(written <= 1);
    for (const Pass& pass : plan.passes) {
        SKINBENCH_ASSERT(pass.program < plan.programs.size());
        const Program& program = plan.programs[pass.program];
        if (pass.kind != PassKind::drawIndexed) continue;
        SKINBENCH_ASSERT(uses & useIndices);
        SKINBENCH_ASSERT(program.attributes.empty() || slots[program.attributeSlot]);
    }
}

Result<void> checkBinding(const Device& device, const std::string& who, uint32_t use, uint64_t bytes) {
    const bool uniform = use & useUniform, storage = use & useStorage;
    uint64_t limit = device.caps.maxBufferBytes;
    if (uniform) limit = std::min(limit, device.caps.maxUniformBytes);
    if (storage) limit = std::min(limit, device.caps.maxStorageBytes);
    if (bytes <= limit) return {};
    return deviceError(
        std::format("{} has {} bytes, and {} takes at most {} bytes in one {}; take fewer copies or a "
                    "smaller scene",
                    who, bytes, device.caps.name, limit,
                    uniform   ? "uniform block"
                    : storage ? "storage block"
                              : "buffer"));
}

Result<void> checkPass(const Device& device, const FramePlan& plan, const Pass& pass) {
    const DeviceCaps& caps = device.caps;
    uint64_t limit = UINT32_MAX;
    if (pass.kind == PassKind::dispatch) limit = caps.maxComputeGroupCount;
    if (pass.kind == PassKind::drawMesh) {
        SKINBENCH_ASSERT(plan.dialect != MeshDialect::none);
        const MeshLimitsOfDevice& limits = meshLimits(caps, plan.dialect);
        if (!limits.available)
            return deviceError(std::format("{}: {} does not offer {}; choose another variant", plan.label, caps.name,
                                           plan.dialect == MeshDialect::nv ? VK_NV_MESH_SHADER_EXTENSION_NAME
                                                                           : VK_EXT_MESH_SHADER_EXTENSION_NAME));
        limit = limits.maxGroupCount;
        const bool task = std::ranges::any_of(plan.programs[pass.program].stages,
                                              [](const ShaderText& s) { return s.stage == Stage::task; });
        if (task && !(plan.dialect == MeshDialect::nv ? device.adapter.taskNv : device.adapter.taskExt))
            return deviceError(
                std::format("{}: {} does not offer task shaders; choose a variant without", plan.label, caps.name));
    }
    for (const Draw& draw : pass.draws)
        if (draw.count > limit)
            return deviceError(std::format("{}: pass '{}' has a draw of {} work groups, and {} takes at most {} in one",
                                           plan.label, pass.label, draw.count, caps.name, limit));
    return {};
}

}  // namespace

Plan::~Plan() {
    for (StreamBuffer& stream : streams) destroy(device, stream.buffer);
    destroy(device, hostStaging);
    if (device.hung) return;
    for (VkPipeline pipeline : pipelines) device.vk.vkDestroyPipeline(device.handle, pipeline, nullptr);
    device.vk.vkDestroyPipelineLayout(device.handle, layout, nullptr);
    device.vk.vkDestroyDescriptorPool(device.handle, descriptorPool, nullptr);
    device.vk.vkDestroyDescriptorSetLayout(device.handle, setLayout, nullptr);
}

uint64_t paletteRange(const Plan& plan) {
    if (plan.paletteRange) return plan.paletteRange;
    return std::max<uint64_t>(alignUp(plan.paletteBytes, 4), 16);
}

Result<void> checkPlan(const Device& device, const FramePlan& plan) {
    assertWellFormed(plan);
    const DeviceCaps& caps = device.caps;
    if (caps.timestampBits == 0)
        return deviceError(plan.label + ": " + caps.name +
                           " has no timestamps, so passes cannot be timed; choose another device");
    const uint32_t largest = std::min({device.adapter.properties.limits.maxFramebufferWidth,
                                       device.adapter.properties.limits.maxFramebufferHeight,
                                       device.adapter.properties.limits.maxImageDimension2D});
    if (plan.width == 0 || plan.height == 0 || plan.width > largest || plan.height > largest)
        return deviceError(std::format("{}: an image of {}x{} was asked for, and {} takes 1x1 to {}x{}", plan.label,
                                       plan.width, plan.height, caps.name, largest, largest));
    SKINBENCH_TRY(checkBinding(
        device, plan.label + ": the joint palette of one " + (plan.paletteRange ? "draw" : "frame"),
        plan.paletteRange ? useUniform : useStorage, plan.paletteRange ? plan.paletteRange : plan.paletteBytes));
    for (const Stream& stream : plan.streams)
        SKINBENCH_TRY(
            checkBinding(device, std::format("{}: slot {}", plan.label, stream.slot), stream.use, streamBytes(stream)));
    for (const Pass& pass : plan.passes) SKINBENCH_TRY(checkPass(device, plan, pass));
    return {};
}

Result<std::unique_ptr<Plan>> makePlanObjects(Device& device, VkPipelineCache cache, const FramePlan& source,
                                              std::shared_ptr<Target> target) {
    auto plan = std::make_unique<Plan>(device);
    plan->label = source.label;
    plan->dialect = source.dialect;
    plan->paletteBytes = source.paletteBytes;
    plan->paletteRange = source.paletteRange;
    plan->passes = source.passes;
    plan->target = std::move(target);
    SKINBENCH_TRY(makeLayout(*plan, source));
    // Text before bytes: a shader that does not compile is said at once, not after a long upload.
    for (const Program& program : source.programs)
        for (const ShaderText& shader : program.stages)
            if (auto compiled = compileGlsl(shader); !compiled)
                return std::unexpected(Error{compiled.error().fault, plan->label + ": " + compiled.error().text});
    SKINBENCH_TRY(makeStreams(*plan, source));
    SKINBENCH_TRY(makeDescriptors(*plan, source));
    SKINBENCH_TRY(makePipelines(*plan, cache, source));
    return plan;
}

static Result<void> growFrameData(Device& device, FrameData& data, const Plan& plan, uint64_t bytes) {
    if (data.buffer.bytes >= bytes && data.buffer.handle) return {};
    const uint64_t limit = std::min<uint64_t>(device.caps.maxBufferBytes, UINT32_MAX);  // dynamic offsets: 32 bits
    if (bytes > limit)
        return deviceError(
            std::format("{}: the palettes of the batch have {} bytes, and {} takes at most {} in one buffer; "
                        "render fewer frames at once",
                        plan.label, bytes, device.caps.name, limit));
    destroy(device, data.buffer);
    ++data.version;
    const VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    VkResult result = tryCreateBuffer(device, bytes, usage, Memory::deviceMapped, data.buffer);
    if (result != VK_SUCCESS && result != VK_ERROR_DEVICE_LOST)
        result = tryCreateBuffer(device, bytes, usage, Memory::device, data.buffer);
    if (result == VK_ERROR_DEVICE_LOST) return check(device, result, "create a buffer");
    if (result == VK_SUCCESS) return {};
    return std::unexpected(memoryError(device, plan.label + ": the palettes of the batch", bytes, result));
}

static void pointDescriptors(Device& device, const FrameData& data, Plan& plan) {
    if (plan.frameDataVersion == data.version) return;
    const VkDescriptorBufferInfo constants{data.buffer.handle, 0, sizeof(FrameConstants)};
    const VkDescriptorBufferInfo palette{data.buffer.handle, 0, paletteRange(plan)};
    std::array<VkWriteDescriptorSet, 2> writes{};
    for (VkWriteDescriptorSet& write : writes) {
        write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        write.dstSet = plan.descriptors;
        write.descriptorCount = 1;
    }
    writes[0].dstBinding = SLOT_FRAME;
    writes[0].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC;
    writes[0].pBufferInfo = &constants;
    writes[1].dstBinding = SLOT_PALETTE;
    writes[1].descriptorType = paletteType(plan);
    writes[1].pBufferInfo = &palette;
    device.vk.vkUpdateDescriptorSets(device.handle, 2, writes.data(), 0, nullptr);
    plan.frameDataVersion = data.version;
}

Result<void> uploadFrames(Device& device, FrameData& data, Plan& plan, std::span<const FrameInput> frames) {
    const VkPhysicalDeviceLimits& limits = device.adapter.properties.limits;
    data.constantsStride = alignUp(sizeof(FrameConstants), limits.minUniformBufferOffsetAlignment);
    // A range may reach past the last palette of a frame, but not past the buffer.
    const uint64_t alignment =
        std::max({limits.minStorageBufferOffsetAlignment, limits.minUniformBufferOffsetAlignment, kPaletteAlignment});
    data.paletteStride = alignUp(std::max(paletteRange(plan), plan.paletteBytes), alignment);
    data.paletteStart = alignUp(data.constantsStride * frames.size(), alignment);
    const uint64_t bytes = data.paletteStart + data.paletteStride * frames.size();
    SKINBENCH_TRY(growFrameData(device, data, plan, bytes));
    pointDescriptors(device, data, plan);

    auto write = [&](std::byte* out) {
        for (size_t i = 0; i < frames.size(); ++i) {
            SKINBENCH_ASSERT(frames[i].palette.size() == plan.paletteBytes);
            std::memcpy(out + data.constantsStride * i, &frames[i].constants, sizeof(FrameConstants));
            if (plan.paletteBytes)
                std::memcpy(out + data.paletteStart + data.paletteStride * i, frames[i].palette.data(),
                            plan.paletteBytes);
        }
    };
    if (data.buffer.mapped) {
        write(data.buffer.mapped);
        return flush(device, data.buffer);
    }
    std::vector<std::byte> all(bytes);
    write(all.data());
    return upload(device, data.buffer, bytes, [&](std::span<std::byte> chunk, uint64_t from) {
        std::memcpy(chunk.data(), all.data() + from, chunk.size());
    });
}

}  // namespace skinbench::vulkan
