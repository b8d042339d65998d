// Pictures of some cases at one moment after the other, drawn by a thread of its own that has the devices: whoever asks
// need not wait for them, and its OpenGL and a backend's never meet on one thread. A request begins on all devices
// while the pictures of the one before it are still drawn and copied; where no other one is there, its pictures are
// waited for at once.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "apps/apps.h"
#include "common/frame/image.h"
#include "common/measure/drawing.h"

namespace skinbench {

// A point of a picture, as shares of its width and height.
struct Pick {
    size_t picture = 0;
    glm::vec2 at{0};
};

// One moment.
struct PictureRequest {
    uint64_t number = 0;
    std::string scene;
    std::vector<Case> cases;  // their routes are not null
    WorkloadSettings settings;
    glm::vec3 background{0.13f, 0.15f, 0.18f};
    uint32_t amplify = 0;   // of what the first two pictures differ by; 0: it is not drawn
    bool accuracy = false;  // verifies the pictures, too
    std::optional<Pick> pick;
};

// What one case drew, or what two of them differ by.
struct CasePicture {
    std::string id, title;
    std::optional<Error> error;  // why there is no image
    bool begun = false;          // and not finished
    Image image;
    double total = 0;                                    // milliseconds, of all passes
    std::vector<std::pair<std::string, double>> passes;  // milliseconds
    std::vector<LegendRow> legend;                       // of View::culled, else empty
    std::vector<std::string> facts;                      // lines on its memory and meshlets
    std::string fault;                                   // what is wrong with it, where it was verified
    std::vector<std::string> accuracy, picked;           // lines; empty: not asked for, or nothing there
};

struct SceneInfo {
    std::string name;  // empty: there is none
    std::string text;  // sceneText()
    std::vector<std::string> clips;
};

// The answer to a request.
struct Pictures {
    PictureRequest request;
    std::optional<Error> error;         // of the device, the scene or the clip that was asked for
    SceneInfo scene;                    // that is drawn: for want of another one that before, with its first clip
    double duration = 0;                // of the chosen clip
    Look look, overview;                // before they moved
    std::vector<CasePicture> all;       // one a case, and, if they were drawn, what the first two differ by
    std::string warning;                // viewWarning() of a request that verifies
    std::vector<std::string> messages;  // of the validation, since the last answer
};

struct PictureOptions {
    std::string device;
    bool validation = false;
    bool every = false;          // each request is drawn; else it replaces one that has not begun
    void (*answered)() = [] {};  // called on the thread after each answer
};

class PictureThread {
public:
    explicit PictureThread(const PictureOptions& options);
    ~PictureThread();

    void post(PictureRequest request);

    // Each answer once, in the order of the requests: the next one, or null where none is there and none is waited for.
    std::shared_ptr<const Pictures> take(bool waits = true);

    // Both APIs', or why there is none. Waits until the drivers have started.
    const Backends& backends() const;

private:
    void work(const std::stop_token& stop);

    const PictureOptions options_;
    mutable std::mutex mutex_;
    mutable std::condition_variable_any changed_;
    std::deque<PictureRequest> requests_;  // that have not begun
    std::deque<std::shared_ptr<const Pictures>> answers_;
    Backends backends_;  // empty until they have started
    std::jthread thread_;
};

}  // namespace skinbench
