// Headless OpenGL contexts through EGL, loaded at run time. No window system is touched unless everything else fails.
#pragma once

#include <glad/egl.h>
#include <glad/gl.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend_gl/mesh_ext.h"
#include "common/frame/backend.h"

namespace skinbench {

// One core-profile context of a device. Current on the thread that opened it last.
struct Context {
    // Never terminated: on NVIDIA's driver two displays may be one, and terminating one ends the contexts of the other.
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext handle = EGL_NO_CONTEXT;
    EGLSurface surface = EGL_NO_SURFACE;  // a 1x1 pbuffer where contexts cannot go without a surface
    DeviceCaps caps;
    DrawMeshTasksExt drawMeshTasksExt = nullptr;
    DrawMeshTasksIndirectExt drawMeshTasksIndirectExt = nullptr;
    std::vector<std::string> messages;  // of the debug output

    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context();

    Result<void> makeCurrent();
};

struct Display {
    EGLDisplay handle = EGL_NO_DISPLAY;
    std::string place;  // for messages: "EGL device 0 (/dev/dri/card0)"
};

Result<std::unique_ptr<Context>> openContext(const Display& display, bool debug);

// The devices of this process, found once: a context of each was there for a moment. An error without any says what
// every display answered.
struct GlDevices {
    std::vector<Display> displays;
    std::vector<DeviceCaps> caps;  // as many
};
const Result<GlDevices>& glDevices();

// EGL's device of a display, if it has one.
EGLDeviceEXT eglDeviceOf(EGLDisplay display);

// Of the current context, if it runs on one device alone: equal to what Vulkan calls that device's UUID.
std::optional<std::array<uint8_t, 16>> contextUuid();

// UUID, PCI address and vendor of the current context's device.
void fillIdentity(EGLDisplay display, DeviceCaps& caps);

// The file of the device's kernel driver, "/dev/dri/card0"; empty where EGL does not say.
std::string drmFile(EGLDeviceEXT device);

// Of the current context.
DeviceCaps queryCaps();
const char* glErrorName(GLenum error);

}  // namespace skinbench
