#include "backend_gl/plan.h"

#include <array>
#include <format>

namespace skinbench {

namespace {

// In the order of AttributeFormat.
constexpr std::array<GLint, 4> kComponents = {2, 3, 4, 4};

GlVertexArray makeVertexArray(const Program& program, const GlPlan& plan) {
    GLuint id = 0;
    glCreateVertexArrays(1, &id);
    for (size_t i = 0; i < plan.streams.size(); ++i) {
        const Stream& stream = plan.shape.streams[i];
        if (stream.use & useIndices) glVertexArrayElementBuffer(id, plan.streams[i].id());
        if (!program.attributes.empty() && stream.slot == program.attributeSlot)
            glVertexArrayVertexBuffer(id, 0, plan.streams[i].id(), 0, static_cast<GLsizei>(program.attributeStride));
    }
    for (const VertexAttribute& attribute : program.attributes) {
        const GLint components = kComponents[static_cast<size_t>(attribute.format)];
        glEnableVertexArrayAttrib(id, attribute.location);
        if (attribute.format == AttributeFormat::uint4)
            glVertexArrayAttribIFormat(id, attribute.location, components, GL_UNSIGNED_INT, attribute.offset);
        else
            glVertexArrayAttribFormat(id, attribute.location, components, GL_FLOAT, GL_FALSE, attribute.offset);
        glVertexArrayAttribBinding(id, attribute.location, 0);
    }
    return GlVertexArray(id);
}

}  // namespace

Result<GlPlan> makeGlPlan(const FramePlan& plan, ProgramCache& programs, Staging& staging, DeviceMemory& memory) {
    GlPlan made;
    made.shape = planShape(plan);
    std::vector<LinkedProgram> linked;
    for (const Program& program : plan.programs) {
        auto result = programs.get(program);
        if (!result) return errorAt(plan.label, result.error());
        linked.push_back(*result);
    }
    for (const Stream& stream : plan.streams) {
        uint64_t bytes = streamBytes(stream);
        auto buffer = memory.make(bytes, std::format("{}: slot {}", plan.label, stream.slot));
        SKINBENCH_TRY(buffer);
        if (stream.bytes)
            staging.write(*buffer, 0, bytes,
                          [&](uint64_t at, std::span<std::byte> out) { copyReplicas(stream, at, out); });
        else
            clearBuffer(*buffer, bytes);
        made.streams.push_back(std::move(*buffer));
    }
    for (size_t i = 0; i < linked.size(); ++i)
        made.programs.push_back({linked[i], makeVertexArray(plan.programs[i], made)});
    staging.finish();
    SKINBENCH_TRY(checkGl(plan.label, planBytes(plan)));
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
