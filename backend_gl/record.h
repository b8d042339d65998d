// Commands of one frame of a plan, in the current context.
#pragma once

#include "backend_gl/context.h"
#include "backend_gl/plan.h"

namespace skinbench {

// Constants or palettes of all frames of a batch.
struct GlFrameBuffer {
    GlBuffer buffer;
    uint64_t capacity = 0;
    uint64_t stride = 0;  // of one frame
};

struct GlFrameData {
    GlFrameBuffer constants, palettes;
};

// What frames of any plan are recorded with.
struct GlRecorder {
    const Context& context;
    GLuint storageBindings = 0;
    LinkedProgram betweenMeshDraws;  // see driver_faults.h
};

struct GlFrameRecord {
    const GlRecorder& recorder;
    const GlPlan& plan;
    const GlFrameData& data;
    GLuint framebuffer = 0;  // 0: no pass draws
    size_t frame = 0;        // of what `data` holds
};

// All slots at once, so that nothing of an earlier plan stays bound.
void bindStreams(const GlRecorder& recorder, const GlPlan& plan);

// The frame's constants, and its palettes where a draw sees them all.
void bindFrame(const GlFrameRecord& record);

// The program and the state of a pass.
void beginPass(const GlFrameRecord& record, const Pass& pass, bool clear);

// The draws of a pass that has begun, each with its constants.
void issueDraws(const GlFrameRecord& record, const Pass& pass);

// Mesa's software driver puts a timestamp into its queue of tiles, and runs the geometry stages while the host records.
// So the queue is empty on both sides; a GPU is not waited for here.
void writeTimestamp(const Context& context, GLuint query);

// All passes as the mode has them, with two timestamps each, or two around them all; null: without.
void recordTimed(const GlFrameRecord& record, const GLuint* queries);
void recordOverlapped(const GlFrameRecord& record, const GLuint* queries);

// All passes, the first one too behind what it needs if it `waits`. Each clears in its turn, but for `cleared`.
void recordPasses(const GlFrameRecord& record, bool waits, const Pass* cleared);

// Milliseconds between the two of each of `pairs` pairs of timestamps.
std::vector<double> readTimes(const Context& context, const GLuint* queries, size_t pairs);

}  // namespace skinbench
