// The window: a thin shell around ViewState and Renderer. One frame of it reads the input, asks for pictures, draws
// what there is.
#pragma once

#include <chrono>

#include "apps/view/renderer.h"

struct GLFWwindow;

namespace skinbench::view {

struct ViewOptions {
    ViewState state;
    RendererOptions renderer;
    bool stepped = false;  // every frame waits for its pictures, and the clock goes on by 1/60 s
    std::string folder;    // of screenshots by key; empty: the current one
};

// What a pane has measured of late.
struct History {
    std::string id;
    std::vector<float> total;  // milliseconds, the latest last
    std::map<std::string, std::vector<double>> passes;
    std::string figures;  // in words
};

struct Rectangle {
    glm::vec2 at{0}, size{0};
};

struct Viewer {
    ViewState state;
    bool stepped = false, closing = false;
    std::string folder, saveTo;  // of screenshots by key; saveTo: the next one, once

    GLFWwindow* window = nullptr;
    std::array<uint32_t, 3> textures{};  // of A, B and the difference
    std::unique_ptr<Renderer> renderer;
    std::shared_ptr<const Shown> shown;  // what the textures hold

    uint64_t posted = 0;       // number of the latest request
    std::string postedFor;     // what it asked for
    bool askAccuracy = false;  // with the next request
    std::optional<Pick> askPick;
    glm::uvec2 size{0}, wanted{0};  // of a picture: as asked for, and as the panes now are
    std::chrono::steady_clock::time_point wantedSince, last, answered;
    double period = 0;  // seconds between answers of late

    bool shrunk = false;             // pictures are smaller than their panes, as the processor draws them
    Rectangle area;                  // where pictures are drawn, in window coordinates
    std::array<Rectangle, 2> panes;  // of A and B in it
    std::array<History, 2> history;
    std::array<std::string, 2> accuracy;  // as last asked for, with the case
    std::vector<std::string> picked, messages;
    std::string note;  // one line below the pictures: an error, or what was done
    float scale = 1;   // of fonts, by the monitor

    ~Viewer();
};

// One line where there is no display or no OpenGL for the window. One window at a time.
Result<std::unique_ptr<Viewer>> openView(const ViewOptions& options);

// False once the window is to close. `window` gets what the window shows.
bool drawFrame(Viewer& view, Image* window = nullptr);

// Files that were dropped on the window; the first one is loaded.
void dropFiles(Viewer& view, const std::vector<std::string>& paths);

// --- panel.cpp: what is drawn beside the pictures --------------------------------------------------------------

void drawPanel(Viewer& view);
void drawKeys(Viewer& view);

// Sizes, times and intervals of a new answer.
void remember(Viewer& view);

}  // namespace skinbench::view
