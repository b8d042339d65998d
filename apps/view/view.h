// The window: a thin shell around ViewState and PictureThread. One frame of it reads the input, asks for pictures,
// draws what there is.
#pragma once

#include <chrono>

#include "apps/view/state.h"

struct GLFWwindow;

namespace skinbench::view {

// What a pane has measured of late, in milliseconds, the latest last.
struct History {
    std::string id;
    std::vector<float> total;
    std::map<std::string, std::vector<double>> passes;
    std::string figures;                // of `total`, in words
    std::vector<std::string> accuracy;  // as last asked for
};

struct Rectangle {
    glm::vec2 at{0}, size{0};
};

struct Viewer {
    ViewState state;
    bool stepped = false;  // every frame waits for its pictures, and the clock goes on by 1/60 s
    bool closing = false;
    std::string folder, saveTo;  // of screenshots by key, "" or "FOLDER/"; saveTo: the next one, once

    GLFWwindow* window = nullptr;        // none: pictures are drawn alone
    std::array<uint32_t, 3> textures{};  // of A, B and the difference
    std::unique_ptr<PictureThread> thread;
    std::shared_ptr<const Pictures> shown;  // what the textures hold

    uint64_t posted = 0;       // number of the latest request
    std::string postedFor;     // what it asked for
    bool askAccuracy = false;  // with the next request
    std::optional<Pick> askPick;
    glm::uvec2 size{0}, wanted{0};  // of a picture: as asked for, and as the panes now are
    std::chrono::steady_clock::time_point wantedSince, last, answered;
    double period = 0;  // seconds between answers of late

    std::tuple<bool, float, float> style;  // what fonts and sizes were made for: setStyle()
    float density = 1;                     // pixels a pixel of a usual display
    float scale = 1;                       // window coordinates a pixel of a usual display
    bool splitting = false;                // the splitter is dragged
    bool shrunk = false;                   // pictures are smaller than their panes, as the processor draws them
    Rectangle area;                        // where pictures are drawn, in window coordinates
    std::array<History, 2> history;
    std::vector<std::string> picked, messages;
    std::string note;  // one line below the pictures: an error, or what was done

    ~Viewer();
};

// With PictureOptions::every a stepped one. One line where there is no display or no OpenGL for the window. One window
// at a time, which is closed before main() ends.
Result<std::unique_ptr<Viewer>> openView(const ViewState& state, const PictureOptions& options, bool withWindow = true);

// False once the window is to close. `image` gets what it shows.
bool drawFrame(Viewer& view, Image* image = nullptr);

// Files that were dropped on the window; the first one is loaded.
void dropFiles(Viewer& view, const std::vector<std::string>& paths);

// As if the key was pressed.
void press(Viewer& view, std::string_view key, bool shift = false);

// --- panel.cpp: what is drawn beside the pictures --------------------------------------------------------------

void drawPanel(Viewer& view);
void drawKeys(Viewer& view);

// Sizes, times and intervals of a new answer.
void remember(Viewer& view);

}  // namespace skinbench::view
