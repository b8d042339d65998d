#include "backend_gl/record.h"

#include <algorithm>

namespace skinbench {

void bindStreams(const GlRecorder& recorder, const GlPlan& plan) {
    std::array<GLuint, SLOT_COUNT> storage{}, uniform{};
    GLuint commands = 0;
    for (size_t i = 0; i < plan.streams.size(); ++i) {
        const Stream& stream = plan.shape.streams[i];
        if (stream.use & useStorage) storage[stream.slot] = plan.streams[i].id();
        if (stream.use & useUniform) uniform[stream.slot] = plan.streams[i].id();
        if (stream.use & useIndirect) commands = plan.streams[i].id();
    }
    for (GLenum target : {GL_DRAW_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER}) glBindBuffer(target, commands);
    auto count = static_cast<GLsizei>(std::min<GLuint>(SLOT_COUNT, recorder.storageBindings));
    glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, count, storage.data());
    glBindBuffersBase(GL_UNIFORM_BUFFER, 0, SLOT_COUNT, uniform.data());
}

void bindFrame(const GlFrameRecord& record) {
    const FramePlan& shape = record.plan.shape;
    const GlFrameBuffer &constants = record.data.constants, &palettes = record.data.palettes;
    glBindBufferRange(GL_UNIFORM_BUFFER, SLOT_FRAME, constants.buffer.id(),
                      static_cast<GLintptr>(record.frame * constants.stride), sizeof(FrameConstants));
    if (shape.paletteBytes > 0 && shape.paletteRange == 0)
        glBindBufferRange(GL_SHADER_STORAGE_BUFFER, SLOT_PALETTE, palettes.buffer.id(),
                          static_cast<GLintptr>(record.frame * palettes.stride),
                          static_cast<GLsizeiptr>(shape.paletteBytes));
}

static void applyRaster(const Pass& pass) {
    bool keep = pass.depth == DepthTest::equalKeep;
    bool never = pass.raster == RasterMode::noFragments;
    glDepthFunc(never ? GL_NEVER : keep ? GL_EQUAL : GL_LESS);
    glDepthMask(!never && !keep);
    glColorMask(pass.writeColor, pass.writeColor, pass.writeColor, pass.writeColor);
    (pass.cullBackFaces ? glEnable : glDisable)(GL_CULL_FACE);
    (pass.raster == RasterMode::discard ? glEnable : glDisable)(GL_RASTERIZER_DISCARD);
}

// Masks and rasteriser discard hold for clears too.
static void clearTargets(GLuint framebuffer, const std::array<float, 4>& background) {
    glDisable(GL_RASTERIZER_DISCARD);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const GLfloat depth = 1;
    glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, background.data());
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &depth);
}

static GLintptr placeOf(uint32_t command) { return static_cast<GLintptr>(command) * GLintptr{sizeof(DrawCommand)}; }

static void drawMesh(const GlFrameRecord& record, const LinkedProgram& program, const Draw& draw) {
    const Context& context = record.recorder.context;
    const LinkedProgram& between = record.recorder.betweenMeshDraws;
    if (record.plan.shape.dialect == MeshDialect::nv) {
        if (draw.command)
            glDrawMeshTasksIndirectNV(placeOf(*draw.command));
        else
            glDrawMeshTasksNV(0, draw.count);
        return;
    }
    if (between.id && program.constants >= 0) {
        glUseProgram(between.id);
        context.drawMeshTasksExt(0, 1, 1);
        glUseProgram(program.id);
    }
    if (draw.command)
        context.drawMeshTasksIndirectExt(placeOf(*draw.command));
    else
        context.drawMeshTasksExt(draw.count, 1, 1);
}

void issueDraws(const GlFrameRecord& record, const Pass& pass) {
    const GlPlan& plan = record.plan;
    const GlFrameBuffer& palettes = record.data.palettes;
    const LinkedProgram& program = plan.programs[pass.program].linked;
    for (const Draw& draw : pass.draws) {
        if (plan.shape.paletteRange)
            glBindBufferRange(GL_UNIFORM_BUFFER, SLOT_PALETTE, palettes.buffer.id(),
                              static_cast<GLintptr>(record.frame * palettes.stride + draw.paletteOffset),
                              plan.shape.paletteRange);
        if (program.constants >= 0) glUniform4uiv(program.constants, 1, draw.constants.data());
        switch (pass.kind) {
            case PassKind::dispatch:
                if (draw.command)
                    glDispatchComputeIndirect(placeOf(*draw.command));
                else
                    glDispatchCompute(draw.count, 1, 1);
                break;
            case PassKind::drawIndexed:
                if (draw.command)
                    glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                                           reinterpret_cast<const void*>(placeOf(*draw.command)));
                else
                    glDrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(draw.count), GL_UNSIGNED_INT,
                                             reinterpret_cast<const void*>(uintptr_t{draw.firstIndex} * 4),
                                             draw.baseVertex);
                break;
            case PassKind::drawMesh:
                drawMesh(record, program, draw);
                break;
        }
    }
}

void beginPass(const GlFrameRecord& record, const Pass& pass, bool clear) {
    const GlPlan& plan = record.plan;
    const GlProgram& program = plan.programs[pass.program];
    if (pass.kind != PassKind::dispatch) {
        glBindFramebuffer(GL_FRAMEBUFFER, record.framebuffer);
        glViewport(0, 0, static_cast<GLsizei>(plan.shape.width), static_cast<GLsizei>(plan.shape.height));
        if (clear) clearTargets(record.framebuffer, plan.shape.background);
        applyRaster(pass);
        glBindVertexArray(program.vertexArray.id());
    }
    glUseProgram(program.linked.id);
}

void writeTimestamp(const Context& context, GLuint query) {
    if (context.caps.software) glFinish();
    glQueryCounter(query, GL_TIMESTAMP);
    if (context.caps.software) glFinish();
}

// OpenGL has no execution barrier. What stands for it: a timestamp is taken "after all previous commands … have been
// fully realized" (OpenGL 4.6, 4.3), and glMemoryBarrier makes later commands wait for shader writes, which drivers
// do by draining the pipeline. So the first timestamp follows the clear and the pass before, and the second one the
// last pixel. What remains is that the head of a pass may overlap the tail of a pass whose results it does not use:
// then its interval starts late, at the end of that tail.
static void recordPass(const GlFrameRecord& record, const Pass& pass, const GLuint* queries) {
    beginPass(record, pass, pass.clear);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    if (queries) writeTimestamp(record.recorder.context, queries[0]);
    issueDraws(record, pass);
    if (queries) writeTimestamp(record.recorder.context, queries[1]);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

void recordTimed(const GlFrameRecord& record, const GLuint* queries) {
    bindFrame(record);
    const std::vector<Pass>& passes = record.plan.shape.passes;
    for (size_t i = 0; i < passes.size(); ++i) recordPass(record, passes[i], queries ? &queries[i * 2] : nullptr);
}

void recordPasses(const GlFrameRecord& record, bool waits, const Pass* cleared) {
    for (const Pass& pass : record.plan.shape.passes) {
        if (waits)
            glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                            GL_ELEMENT_ARRAY_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
        beginPass(record, pass, pass.clear && &pass != cleared);
        issueDraws(record, pass);
        waits = true;
    }
}

void recordOverlapped(const GlFrameRecord& record, const GLuint* queries) {
    bindFrame(record);
    const Pass* const first = firstDrawing(record.plan.shape);
    if (first && first->clear) beginPass(record, *first, true);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    if (queries) writeTimestamp(record.recorder.context, queries[0]);
    recordPasses(record, false, first);
    if (queries) writeTimestamp(record.recorder.context, queries[1]);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

std::vector<double> readTimes(const Context& context, const GLuint* queries, size_t pairs) {
    const uint32_t bits = context.caps.timestampBits;
    const uint64_t mask = bits >= 64 ? UINT64_MAX : (uint64_t{1} << bits) - 1;
    std::vector<double> times;
    for (size_t i = 0; i < pairs; ++i) {
        GLuint64 begin = 0, end = 0;
        glGetQueryObjectui64v(queries[i * 2], GL_QUERY_RESULT, &begin);
        glGetQueryObjectui64v(queries[i * 2 + 1], GL_QUERY_RESULT, &end);
        times.push_back(static_cast<double>((end - begin) & mask) * 1e-6);
    }
    return times;
}

}  // namespace skinbench
