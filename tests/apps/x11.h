// What a desktop and a window manager tell windows on X11, for tests that have neither.
#pragma once

#include <string>

struct GLFWwindow;

namespace x11 {

// The display's dots an inch, for windows that are opened while it lives; 96 are usual.
class Density {
public:
    explicit Density(int dots);
    ~Density();

private:
    void set(const std::string& resources);

    void* display_ = nullptr;  // a display without a client forgets what was set
    std::string before_;
};

// Minimises the window, or brings it back.
void setMinimised(GLFWwindow* window, bool minimised);

}  // namespace x11
