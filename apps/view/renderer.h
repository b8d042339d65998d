// What draws the pictures: a thread of its own that has the devices, so that the window never waits for them, and so
// that its OpenGL and a backend's never meet on one thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "apps/view/state.h"
#include "common/frame/image.h"
#include "common/meshlets/meshlets.h"

namespace skinbench::view {

// A point of a pane's picture, as shares of its width and height.
struct Pick {
    size_t pane = 0;
    glm::vec2 at{0};
};

// One frame of both cases.
struct Request {
    uint64_t number = 0;
    ViewState state;
    uint32_t width = 0, height = 0;  // of a picture
    bool accuracy = false;
    std::optional<Pick> pick;
};

// What one case drew.
struct Drawn {
    std::string id;
    std::string error;  // why there is no image; empty: there is one
    Image image;
    std::vector<std::pair<std::string, double>> passes;  // milliseconds
    MemoryBytes memory;                                  // of one copy
    std::optional<MeshletStats> meshlets;
    std::vector<LegendRow> legend;    // of View::culled, else empty
    std::string accuracy;             // in words; empty: not asked for
    std::vector<std::string> picked;  // lines; empty: not asked for, or nothing there
};

struct ClipInfo {
    std::string name;
    double duration = 0;
};

// The answer to a request.
struct Shown {
    uint64_t number = 0;
    double seconds = 0;
    std::string error;  // of the scene; the one before is drawn on
    Fault fault = Fault::input;
    std::string scene;  // that is drawn; empty: none
    SceneStats stats;
    std::vector<ClipInfo> clips;
    double duration = 0;        // of the chosen clip
    std::array<Case, 2> cases;  // those of the state, or those that were chosen for it
    std::array<Look, 2> look;   // before the camera moved
    std::array<Drawn, 2> pictures;
    std::optional<DifferenceImage> difference;
    std::vector<std::string> messages;  // of the validation, since the last answer
};

struct RendererOptions {
    std::string device;
    bool validation = false;
    void (*answered)() = [] {};  // called on the renderer's thread after each answer
};

class Renderer {
public:
    explicit Renderer(const RendererOptions& options);
    ~Renderer();

    // Replaces a request that has not begun.
    void post(Request request);

    // The latest answer; null before the first.
    std::shared_ptr<const Shown> latest() const;

    // Waits for the answer to a request, or to a later one.
    std::shared_ptr<const Shown> wait(uint64_t number) const;

    // What the devices can do; waits until they are listed, a second at the most.
    const CapsByApi& devices() const;

private:
    void work(const std::stop_token& stop, const RendererOptions& options);

    mutable std::mutex mutex_;
    mutable std::condition_variable_any changed_;
    std::optional<Request> next_;
    std::shared_ptr<const Shown> latest_;
    std::optional<CapsByApi> devices_;
    std::jthread thread_;
};

}  // namespace skinbench::view
