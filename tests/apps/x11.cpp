#include "tests/apps/x11.h"

#include <X11/Xatom.h>
#include <X11/Xutil.h>

// GLFW/glfw3native.h has these, and asks for more headers of X11.
extern "C" Display* glfwGetX11Display();
extern "C" Window glfwGetX11Window(GLFWwindow* window);

namespace x11 {

Density::Density(int dots) : display_(XOpenDisplay(nullptr)) {
    if (!display_) return;
    if (const char* before = XResourceManagerString(static_cast<Display*>(display_))) before_ = before;
    set("Xft.dpi:\t" + std::to_string(dots) + "\n");
}

Density::~Density() {
    if (!display_) return;
    set(before_);
    XCloseDisplay(static_cast<Display*>(display_));
}

// As `xrdb` does.
void Density::set(const std::string& resources) {
    auto* display = static_cast<Display*>(display_);
    XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(resources.data()), static_cast<int>(resources.size()));
    XSync(display, False);
}

void setMinimised(GLFWwindow* window, bool minimised) {
    Display* display = glfwGetX11Display();
    const Window own = glfwGetX11Window(window);
    const Atom name = XInternAtom(display, "WM_STATE", False);
    const unsigned long state = minimised ? IconicState : NormalState;
    const unsigned long words[] = {state, None};
    XChangeProperty(display, own, name, name, 32, PropModeReplace, reinterpret_cast<const unsigned char*>(words), 2);
    minimised ? XUnmapWindow(display, own) : XMapWindow(display, own);
    XSync(display, False);
}

}  // namespace x11
