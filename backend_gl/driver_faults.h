// Faults of drivers that offer GL_EXT_mesh_shader, found by tiny draws in the current context and not by name.
#pragma once

#include "backend_gl/memory.h"
#include "backend_gl/mesh_ext.h"
#include "backend_gl/program.h"
#include "common/frame/backend.h"

namespace skinbench {

// Mesa 26.1 uploads a mesh or task stage's uniforms only when a draw uses another mesh program than the one before:
// later values of drawConstants never arrive. Drawing no work groups with some other program makes it upload them.
// If the context has the fault, LinkedProgram is what to draw in between; else its id is 0. The program lives in the
// cache.
Result<LinkedProgram> findStaleConstants(DrawMeshTasksExt drawMeshTasksExt, ProgramCache& programs, Staging& staging);

// DeviceCaps::lastMeshOutputLost and primitiveCullIgnored: Mesa 26.1's llvmpipe has both. Neither is set where the test
// draw fails; findStaleConstants says why mesh shaders do not work then. Leaves no error and no binding behind.
void findMeshFaults(DrawMeshTasksExt drawMeshTasksExt, DeviceCaps& caps);

}  // namespace skinbench
