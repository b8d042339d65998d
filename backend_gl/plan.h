// A FramePlan as OpenGL objects.
#pragma once

#include <string>
#include <vector>

#include "backend_gl/memory.h"
#include "backend_gl/program.h"
#include "common/frame/backend.h"

namespace skinbench {

struct GlStream {
    uint32_t slot = 0;
    uint32_t use = 0;
    uint64_t bytes = 0;
    bool hostWritten = false;
    GlBuffer buffer;
};

struct GlProgram {
    LinkedProgram linked;
    GlVertexArray vertexArray;
};

struct GlPlan {
    std::string label;
    MeshDialect dialect = MeshDialect::none;
    uint32_t width = 0;
    uint32_t height = 0;
    uint64_t paletteBytes = 0;
    uint32_t paletteRange = 0;
    uint64_t bytes = 0;  // of all streams
    std::vector<GlStream> streams;
    std::vector<GlProgram> programs;
    std::vector<Pass> passes;
    bool draws = false;  // a pass that needs the targets

    const GlStream* hostWritten() const;
};

// What the plan asks for and the device cannot do, before anything is allocated.
Result<void> checkPlan(const FramePlan& plan, const DeviceCaps& caps);

// Compiles and uploads. What was allocated before a failure is freed again.
Result<GlPlan> makeGlPlan(const FramePlan& plan, ProgramCache& programs, Staging& staging);

// The targets of one size, shared by all plans of that size.
struct GlTargets {
    GlTexture color;
    GlTexture depth;
    GlFramebuffer framebuffer;
    PlanId renderedBy = 0;  // the plan that the image is of; 0: none
};

Result<GlTargets> makeTargets(uint32_t width, uint32_t height);

}  // namespace skinbench
