// Headless OpenGL contexts through EGL, loaded at run time. No window system is touched unless everything else fails.
#pragma once

#include <glad/egl.h>
#include <glad/gl.h>

#include <memory>
#include <string>
#include <vector>

#include "backend_gl/mesh_ext.h"
#include "common/frame/backend.h"

namespace skinbench {

// One core-profile context of a device. Current on the opening thread when openContexts returns it last.
struct Context {
    // Never terminated: on NVIDIA's driver two displays may be one, and terminating one ends the contexts of the other.
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext handle = EGL_NO_CONTEXT;
    EGLSurface surface = EGL_NO_SURFACE;  // a 1x1 pbuffer where contexts cannot go without a surface
    DeviceCaps caps;
    DrawMeshTasksExt drawMeshTasksExt = nullptr;
    std::vector<std::string> messages;  // of the debug output

    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context();

    Result<void> makeCurrent();
};

struct Contexts {
    std::vector<std::unique_ptr<Context>> list;
    std::string refusal;  // why the last device that gave no context gave none
};

// One context a device. Fails only without EGL itself.
Result<Contexts> openContexts(bool debug);

// Of the current context.
DeviceCaps queryCaps();
const char* glErrorName(GLenum error);

}  // namespace skinbench
