#include "backend_gl/plan.h"

#include <algorithm>
#include <format>

namespace skinbench {

namespace {

uint64_t streamBytes(const Stream& stream) {
    return stream.bytes ? uint64_t{stream.bytes->size()} * stream.replicas : stream.gpuBytes;
}

// Bytes [at, at + out.size()) of all replicas in a row.
void fillReplicas(const Stream& stream, uint64_t at, std::span<std::byte> out) {
    const std::vector<std::byte>& bytes = *stream.bytes;
    while (!out.empty()) {
        uint64_t replica = at / bytes.size();
        uint64_t local = at % bytes.size();
        size_t count = std::min<uint64_t>(bytes.size() - local, out.size());
        auto add = static_cast<uint32_t>(replica * stream.replicaAdd);
        if (add == 0) {
            std::memcpy(out.data(), bytes.data() + local, count);
        } else {
            for (size_t i = 0; i < count; i += 4) {
                uint32_t word;
                std::memcpy(&word, bytes.data() + local + i, 4);
                word += add;
                std::memcpy(out.data() + i, &word, 4);
            }
        }
        at += count;
        out = out.subspan(count);
    }
}

Result<void> checkStream(const FramePlan& plan, const Stream& stream, const DeviceCaps& caps) {
    auto place = [&] { return std::format("{}: stream {}", plan.label, stream.slot); };
    uint64_t bytes = streamBytes(stream);
    if (stream.slot >= SLOT_COUNT || stream.slot == SLOT_FRAME || stream.slot == SLOT_PALETTE)
        return inputError(place() + " is not a slot that a stream may have");
    if (stream.replicaAdd != 0 && stream.bytes && stream.bytes->size() % 4 != 0)
        return inputError(place() + " adds to 32-bit words but is not made of them");
    if ((stream.use & useStorage) && bytes > caps.maxStorageBytes)
        return deviceError(
            std::format("{} has {} bytes but a storage block of this device holds at most {} bytes; use "
                        "fewer copies",
                        place(), bytes, caps.maxStorageBytes));
    if ((stream.use & useUniform) && bytes > caps.maxUniformBytes)
        return deviceError(
            std::format("{} has {} bytes but a uniform block of this device holds at most {} bytes; use a "
                        "storage block",
                        place(), bytes, caps.maxUniformBytes));
    return {};
}

Result<void> checkPass(const FramePlan& plan, const Pass& pass, const DeviceCaps& caps) {
    auto place = [&] { return std::format("{}: pass {}", plan.label, pass.label); };
    if (pass.program >= plan.programs.size())
        return inputError(std::format("{} names program {} of {}", place(), pass.program, plan.programs.size()));
    bool indexed = std::ranges::any_of(plan.streams, [](const Stream& s) { return (s.use & useIndices) != 0; });
    if (pass.kind == PassKind::drawIndexed && !indexed)
        return inputError(place() + " draws indices but no stream holds any");
    uint32_t limit = UINT32_MAX;
    if (pass.kind == PassKind::dispatch) limit = caps.maxComputeGroupCount;
    if (pass.kind == PassKind::drawMesh) {
        const char* name = plan.dialect == MeshDialect::nv ? "GL_NV_mesh_shader" : "GL_EXT_mesh_shader";
        if (plan.dialect == MeshDialect::none) return inputError(place() + " draws meshlets in no dialect");
        if (!meshLimits(caps, plan.dialect).available)
            return deviceError(std::format("{} needs {}, which {} does not offer in OpenGL", place(), name, caps.name));
        limit = meshLimits(caps, plan.dialect).maxGroupCount;
    }
    for (const Draw& draw : pass.draws)
        if (draw.count > limit)
            return deviceError(
                std::format("{} wants {} work groups at once but this device runs at most {}; split the "
                            "draw",
                            place(), draw.count, limit));
    return {};
}

struct AttributeShape {
    GLint components;
    bool integers;
};

AttributeShape attributeShape(AttributeFormat format) {
    switch (format) {
        case AttributeFormat::float2:
            return {2, false};
        case AttributeFormat::float3:
            return {3, false};
        case AttributeFormat::float4:
            return {4, false};
        case AttributeFormat::uint4:
            return {4, true};
    }
    return {4, false};
}

GlVertexArray makeVertexArray(const Program& program, const GlPlan& plan) {
    GLuint id = 0;
    glCreateVertexArrays(1, &id);
    for (const GlStream& stream : plan.streams) {
        if (stream.use & useIndices) glVertexArrayElementBuffer(id, stream.buffer.id());
        if (!program.attributes.empty() && stream.slot == program.attributeSlot)
            glVertexArrayVertexBuffer(id, 0, stream.buffer.id(), 0, static_cast<GLsizei>(program.attributeStride));
    }
    for (const VertexAttribute& attribute : program.attributes) {
        AttributeShape shape = attributeShape(attribute.format);
        glEnableVertexArrayAttrib(id, attribute.location);
        if (shape.integers)
            glVertexArrayAttribIFormat(id, attribute.location, shape.components, GL_UNSIGNED_INT, attribute.offset);
        else
            glVertexArrayAttribFormat(id, attribute.location, shape.components, GL_FLOAT, GL_FALSE, attribute.offset);
        glVertexArrayAttribBinding(id, attribute.location, 0);
    }
    return GlVertexArray(id);
}

}  // namespace

const GlStream* GlPlan::hostWritten() const {
    auto found = std::ranges::find(streams, true, &GlStream::hostWritten);
    return found == streams.end() ? nullptr : &*found;
}

Result<void> checkPlan(const FramePlan& plan, const DeviceCaps& caps) {
    if (plan.paletteRange > caps.maxUniformBytes)
        return deviceError(
            std::format("{}: the palette of one draw has {} bytes but a uniform block of this device holds at most {} "
                        "bytes; use a storage block",
                        plan.label, plan.paletteRange, caps.maxUniformBytes));
    if (plan.paletteRange == 0 && plan.paletteBytes > caps.maxStorageBytes)
        return deviceError(
            std::format("{}: the palettes of one frame have {} bytes but a storage block of this device "
                        "holds at most {} bytes; use fewer copies",
                        plan.label, plan.paletteBytes, caps.maxStorageBytes));
    GLint largest = 0, bindings = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    glGetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &bindings);
    auto limit = static_cast<uint32_t>(std::max(largest, 0));
    if (plan.width == 0 || plan.height == 0 || plan.width > limit || plan.height > limit)
        return inputError(std::format("{}: an image of {} x {} pixels; this device draws 1 x 1 to {} x {}", plan.label,
                                      plan.width, plan.height, limit, limit));
    uint32_t slots = 0;
    for (const Stream& stream : plan.streams) {
        if (auto checked = checkStream(plan, stream, caps); !checked) return checked;
        if (slots & (1u << stream.slot))
            return inputError(std::format("{}: stream {} is there twice", plan.label, stream.slot));
        slots |= 1u << stream.slot;
        if ((stream.use & useStorage) && stream.slot >= static_cast<uint32_t>(std::max(bindings, 0)))
            return deviceError(std::format("{}: stream {} needs more than the {} storage bindings of this device",
                                           plan.label, stream.slot, bindings));
    }
    for (const Program& program : plan.programs)
        if (!program.attributes.empty() && !(slots & (1u << program.attributeSlot)))
            return inputError(std::format("{}: program {} takes its attributes from stream {}, which is not there",
                                          plan.label, program.label, program.attributeSlot));
    for (const Pass& pass : plan.passes)
        if (auto checked = checkPass(plan, pass, caps); !checked) return checked;
    return {};
}

Result<GlPlan> makeGlPlan(const FramePlan& plan, ProgramCache& programs, Staging& staging) {
    GlPlan made;
    made.label = plan.label;
    made.dialect = plan.dialect;
    made.width = plan.width;
    made.height = plan.height;
    made.paletteBytes = plan.paletteBytes;
    made.paletteRange = plan.paletteRange;
    made.bytes = planBytes(plan);
    made.passes = plan.passes;
    made.draws = std::ranges::any_of(plan.passes, [](const Pass& p) { return p.kind != PassKind::dispatch; });
    std::vector<LinkedProgram> linked;
    for (const Program& program : plan.programs) {
        auto result = programs.get(program);
        if (!result) return std::unexpected(Error{result.error().fault, plan.label + ": " + result.error().text});
        linked.push_back(*result);
    }
    for (const Stream& stream : plan.streams) {
        uint64_t bytes = streamBytes(stream);
        auto buffer = makeBuffer(bytes, std::format("{}: stream {}", plan.label, stream.slot));
        SKINBENCH_TRY(buffer);
        if (stream.bytes)
            staging.write(*buffer, 0, bytes,
                          [&](uint64_t at, std::span<std::byte> out) { fillReplicas(stream, at, out); });
        else
            clearBuffer(*buffer, bytes);
        made.streams.push_back({stream.slot, stream.use, bytes, stream.hostWritten, std::move(*buffer)});
    }
    for (size_t i = 0; i < linked.size(); ++i)
        made.programs.push_back({linked[i], makeVertexArray(plan.programs[i], made)});
    staging.finish();
    SKINBENCH_TRY(checkGl(plan.label, made.bytes));
    return made;
}

Result<GlTargets> makeTargets(uint32_t width, uint32_t height) {
    auto w = static_cast<GLsizei>(width), h = static_cast<GLsizei>(height);
    auto makeTexture = [&](GLenum format) {
        GLuint id = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &id);
        glTextureStorage2D(id, 1, format, w, h);
        return GlTexture(id);
    };
    GlTargets targets;
    targets.color = makeTexture(GL_RGBA8);
    targets.depth = makeTexture(GL_DEPTH_COMPONENT32F);
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    targets.framebuffer = GlFramebuffer(id);
    glNamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, targets.color.id(), 0);
    glNamedFramebufferTexture(id, GL_DEPTH_ATTACHMENT, targets.depth.id(), 0);
    std::string what = std::format("OpenGL: an image of {} x {} pixels", width, height);
    SKINBENCH_TRY(checkGl(what, uint64_t{width} * height * 8));
    if (glCheckNamedFramebufferStatus(id, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return deviceError(what + " is no complete framebuffer; use a smaller one");
    return targets;
}

}  // namespace skinbench
