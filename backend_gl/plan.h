// A FramePlan as OpenGL objects.
#pragma once

#include <string>
#include <vector>

#include "backend_gl/device_memory.h"
#include "backend_gl/program.h"
#include "common/frame/check_plan.h"

namespace skinbench {

struct GlProgram {
    LinkedProgram linked;
    GlVertexArray vertexArray;
};

struct GlPlan {
    FramePlan shape;
    std::vector<GlBuffer> streams;  // one for each of the shape's
    std::vector<GlProgram> programs;
};

// Compiles and uploads. What was allocated before a failure is freed again.
Result<GlPlan> makeGlPlan(const FramePlan& plan, ProgramCache& programs, Staging& staging, DeviceMemory& memory);

// The targets of one size, shared by all plans of that size.
struct GlTargets {
    GlTexture color;
    GlTexture depth;
    GlFramebuffer framebuffer;
    PlanId renderedBy = 0;  // the plan that the image is of; 0: none
};

Result<GlTargets> makeTargets(uint32_t width, uint32_t height);

}  // namespace skinbench
