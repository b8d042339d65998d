#include "backend_gl/context.h"

#include <algorithm>
#include <cstdlib>
#include <format>
#include <map>
#include <string_view>
#include <utility>

#include "backend_gl/driver_faults.h"
#include "common/frame/devices.h"

namespace skinbench {

namespace {

bool hasWord(const char* words, std::string_view word) {
    std::string_view rest = words ? words : "";
    while (!rest.empty()) {
        size_t end = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, end) == word) return true;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return false;
}

const char* eglErrorName(EGLint error) {
    static const std::map<EGLint, const char*> names = {
        {EGL_SUCCESS, "no reason"},
        {EGL_NOT_INITIALIZED, "EGL_NOT_INITIALIZED"},
        {EGL_BAD_ACCESS, "EGL_BAD_ACCESS"},
        {EGL_BAD_ALLOC, "EGL_BAD_ALLOC"},
        {EGL_BAD_ATTRIBUTE, "EGL_BAD_ATTRIBUTE"},
        {EGL_BAD_CONFIG, "EGL_BAD_CONFIG"},
        {EGL_BAD_CONTEXT, "EGL_BAD_CONTEXT"},
        {EGL_BAD_MATCH, "EGL_BAD_MATCH"},
        {EGL_BAD_PARAMETER, "EGL_BAD_PARAMETER"},
        {EGL_CONTEXT_LOST, "EGL_CONTEXT_LOST"},
    };
    auto found = names.find(error);
    return found == names.end() ? "an unknown EGL error" : found->second;
}

// Which messages are about a fault in our use of OpenGL. Performance remarks are not, and what the shader compiler
// refuses and what the memory cannot hold are errors of prepare() and run() already.
bool isFault(GLenum source, GLenum type, GLenum severity, std::string_view text) {
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER && type == GL_DEBUG_TYPE_ERROR) return false;
    if (text.contains("GL_OUT_OF_MEMORY")) return false;
    bool kind = type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR ||
                type == GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR || type == GL_DEBUG_TYPE_PORTABILITY;
    return kind && (severity == GL_DEBUG_SEVERITY_HIGH || severity == GL_DEBUG_SEVERITY_MEDIUM);
}

void GLAD_API_PTR onDebugMessage(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei, const GLchar* text,
                                 const void* user) {
    if (!isFault(source, type, severity, text)) return;
    auto& messages = *static_cast<std::vector<std::string>*>(const_cast<void*>(user));
    std::string_view trimmed = text;
    while (!trimmed.empty() && (trimmed.back() == '\n' || trimmed.back() == ' ')) trimmed.remove_suffix(1);
    if (messages.size() < 1000) messages.push_back(std::format("OpenGL message {}: {}", id, trimmed));
}

// State that no pass changes. Row 0 of memory is the top row of the image, as the clip space of a plan points down
// already: LOWER_LEFT flips nothing. Seen with row 0 at the bottom, as OpenGL's window coordinates have it, the
// image is mirrored, so that counter-clockwise on the screen is clockwise there.
void setConstantState() {
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glFrontFace(GL_CW);
    glCullFace(GL_BACK);
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_DITHER);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
}

EGLContext createContext(EGLDisplay display, EGLConfig config, bool debug) {
    // Robust buffer access stays off: its bounds checks would be measured. The notification alone costs nothing.
    for (EGLint minor : {6, 5}) {
        for (bool notify : {true, false}) {
            std::vector<EGLint> attributes = {EGL_CONTEXT_MAJOR_VERSION,       4,
                                              EGL_CONTEXT_MINOR_VERSION,       minor,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
            if (debug) attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE});
            if (notify)
                attributes.insert(attributes.end(),
                                  {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
            attributes.push_back(EGL_NONE);
            EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
            if (context != EGL_NO_CONTEXT) return context;
        }
    }
    return EGL_NO_CONTEXT;
}

struct Attempt {
    std::unique_ptr<Context> context;  // null: refused
    Refusal refusal;
};

// How far a display came: what a later step refuses says more of the machine.
enum Step { stepInitialise, stepConfigure, stepContext, stepUse };

Attempt tryDisplay(const Display& display, bool debug) {
    auto refused = [&](Step step, const std::string& reason) {
        return Attempt{nullptr, {.place = display.place, .step = step, .reason = reason}};
    };
    EGLint major = 0, minor = 0;
    const EGLDisplay handle = display.handle;
    if (handle == EGL_NO_DISPLAY || !eglInitialize(handle, &major, &minor))
        return refused(stepInitialise, std::format("eglInitialize said {}", eglErrorName(eglGetError())));
    auto context = std::make_unique<Context>();
    context->display = handle;
    gladLoaderLoadEGL(handle);  // again: only a display tells the loader its EGL version

    const char* extensions = eglQueryString(handle, EGL_EXTENSIONS);
    bool surfaceless = hasWord(extensions, "EGL_KHR_surfaceless_context");
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!surfaceless || !hasWord(extensions, "EGL_KHR_no_config_context")) {
        const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                 surfaceless ? 0 : EGL_PBUFFER_BIT, EGL_NONE};
        EGLint count = 0;
        if (!eglChooseConfig(handle, wanted, &config, 1, &count) || count == 0)
            return refused(stepConfigure, "EGL has no configuration for desktop OpenGL");
    }
    if (!eglBindAPI(EGL_OPENGL_API)) return refused(stepConfigure, "EGL offers no desktop OpenGL");
    context->handle = createContext(handle, config, debug);
    if (context->handle == EGL_NO_CONTEXT)
        return refused(stepContext,
                       std::format("no core profile of version 4.5 or newer: {}", eglErrorName(eglGetError())));
    if (!surfaceless) {
        const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
        context->surface = eglCreatePbufferSurface(handle, config, size);
        if (context->surface == EGL_NO_SURFACE)
            return refused(stepUse, "EGL makes neither surfaceless contexts nor pbuffers");
    }
    if (auto current = context->makeCurrent(); !current) return refused(stepUse, current.error().text);
    if (gladLoadGL(eglGetProcAddress) == 0) return refused(stepUse, "the OpenGL functions could not be loaded");

    context->caps = queryCaps();
    fillIdentity(handle, context->caps);
    if (context->caps.ext.available) {
        context->drawMeshTasksExt = reinterpret_cast<DrawMeshTasksExt>(eglGetProcAddress("glDrawMeshTasksEXT"));
        context->drawMeshTasksIndirectExt =
            reinterpret_cast<DrawMeshTasksIndirectExt>(eglGetProcAddress("glDrawMeshTasksIndirectEXT"));
    }
    if (!context->drawMeshTasksExt || !context->drawMeshTasksIndirectExt) context->caps.ext = {};
    if (!glDrawMeshTasksNV) context->caps.nv = {};
    setConstantState();
    if (context->caps.ext.available) findMeshFaults(context->drawMeshTasksExt, context->caps);
    if (debug) {
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageCallback(onDebugMessage, &context->messages);
    }
    return {std::move(context), {}};
}

// Displays in the order of preference; a later kind is tried only when no display of an earlier one gave a context.
std::vector<std::vector<Display>> displayKinds(const char* clientExtensions) {
    std::vector<std::vector<Display>> kinds;
    bool platforms = hasWord(clientExtensions, "EGL_EXT_platform_base") && eglGetPlatformDisplayEXT;
    bool devices =
        hasWord(clientExtensions, "EGL_EXT_device_enumeration") || hasWord(clientExtensions, "EGL_EXT_device_base");
    if (platforms && devices && eglQueryDevicesEXT && hasWord(clientExtensions, "EGL_EXT_platform_device")) {
        EGLint count = 0;
        std::vector<EGLDeviceEXT> found;
        if (eglQueryDevicesEXT(0, nullptr, &count) && count > 0) {
            found.resize(static_cast<size_t>(count));
            if (!eglQueryDevicesEXT(count, found.data(), &count)) count = 0;
            found.resize(static_cast<size_t>(count));
        }
        auto& displays = kinds.emplace_back();
        for (EGLDeviceEXT device : found) {
            const std::string file = drmFile(device);
            displays.push_back({eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr),
                                std::format("EGL device {}{}", displays.size(), file.empty() ? "" : ": " + file)});
        }
    }
    if (platforms && hasWord(clientExtensions, "EGL_MESA_platform_surfaceless"))
        kinds.push_back({{eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
                          "the surfaceless platform"}});
    kinds.push_back({{eglGetDisplay(EGL_DEFAULT_DISPLAY), "the default display"}});
    return kinds;
}

Result<GlDevices> findDevices() {
#ifndef _WIN32
    setenv("EGL_LOG_LEVEL", "fatal", 0);  // Mesa reports devices it cannot drive on stderr
#endif
    if (!gladLoaderLoadEGL(EGL_NO_DISPLAY))
        return deviceError(
            "OpenGL: the EGL library (libEGL.so.1) cannot be loaded; install a graphics driver with EGL, "
            "such as Mesa's libegl1 or NVIDIA's");
    GlDevices found;
    std::vector<Refusal> refusals;
    for (const auto& displays : displayKinds(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS))) {
        for (const Display& display : displays) {
            Attempt attempt = tryDisplay(display, false);
            if (!attempt.context) {
                refusals.push_back(std::move(attempt.refusal));
                continue;
            }
            // A card whose driver is missing falls back to software. Equal names of hardware are equal cards.
            const DeviceCaps& caps = attempt.context->caps;
            if (caps.software && std::ranges::find(found.caps, caps.name, &DeviceCaps::name) != found.caps.end())
                continue;
            found.displays.push_back(display);
            found.caps.push_back(caps);
        }
        if (!found.caps.empty()) return found;
    }
    constexpr std::string_view kWay = "; update or install the graphics driver";
    constexpr size_t kMost = 340;  // of a message of 400 characters
    return deviceError(std::format("OpenGL: no device: {}{}", refusalText(std::move(refusals), kMost), kWay));
}

}  // namespace

Context::~Context() {
    if (display == EGL_NO_DISPLAY) return;
    if (handle != EGL_NO_CONTEXT) {
        eglBindAPI(EGL_OPENGL_API);
        if (eglGetCurrentContext() == handle) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display, handle);
    }
    if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
}

Result<void> Context::makeCurrent() {
    eglBindAPI(EGL_OPENGL_API);
    if (eglGetCurrentContext() == handle) return {};
    if (!eglMakeCurrent(display, surface, surface, handle))
        return deviceError(
            std::format("OpenGL: the context of '{}' cannot be used on this thread ({}); use a backend "
                        "on one thread only",
                        caps.name, eglErrorName(eglGetError())));
    return {};
}

Result<std::unique_ptr<Context>> openContext(const Display& display, bool debug) {
    Attempt attempt = tryDisplay(display, debug);
    if (attempt.context) return std::move(attempt.context);
    return deviceError(std::format("OpenGL: {} ({})", attempt.refusal.reason, attempt.refusal.place));
}

const Result<GlDevices>& glDevices() {
    static const Result<GlDevices> devices = findDevices();
    return devices;
}

}  // namespace skinbench
