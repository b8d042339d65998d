// What draws the pictures: a thread of its own that has the devices, so that the window never waits for them, and so
// that its OpenGL and a backend's never meet on one thread. A request begins on the devices of both panes while the
// pictures of the one before it are still drawn and copied; where no other one is there, its pictures are waited for at
// once.
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
    std::string wanted;  // the scene that was asked for
    std::string error;   // of it; the one before is drawn on
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
    bool every = false;          // each request is drawn; else it replaces one that has not begun
    void (*answered)() = [] {};  // called on the renderer's thread after each answer
};

class Renderer {
public:
    explicit Renderer(const RendererOptions& options);
    ~Renderer();

    void post(Request request);

    // Each answer once, in the order of the requests: what is there, or null, and what is waited for.
    std::shared_ptr<const Shown> take();
    std::shared_ptr<const Shown> wait();

    // What the devices can do; waits until they are listed, a second at the most.
    const CapsByApi& devices() const;

private:
    void work(const std::stop_token& stop);

    const RendererOptions options_;
    mutable std::mutex mutex_;
    mutable std::condition_variable_any changed_;
    std::deque<Request> requests_;  // that have not begun
    std::deque<std::shared_ptr<const Shown>> answers_;
    std::optional<CapsByApi> devices_;
    std::jthread thread_;
};

}  // namespace skinbench::view
