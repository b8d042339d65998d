// What the window shows, as plain data. Settings are kept as JSON, keys and controls change it, pictures follow from
// it; nothing here knows a window.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "apps/picture_thread.h"

namespace skinbench::view {

// panes:      both whole pictures, side by side.
// wipe:       one picture, A left of the splitter and B right of it.
// one:        A or B.
// difference: |A - B|, amplified.
enum class Mode { panes, wipe, one, difference };
const std::vector<std::string>& modeNames();  // in the order of the enumeration
Mode modeOf(const std::string& name);         // that is one of them

struct ViewState {
    std::string scene = "builtin:biped";
    std::array<Case, 2> cases;  // A and B; a null route is chosen from the devices
    size_t active = 0;          // the one that keys change
    bool linked = true;         // what is chosen for one of them, but for its route, holds for both
    Mode mode = Mode::panes;
    size_t shown = 0;       // of Mode::one
    float splitter = 0.5f;  // share of the width that is A's
    uint32_t amplify = 16;  // of Mode::difference
    std::string clip;       // as --clip
    double seconds = 0;     // into the clip
    bool playing = true;    // the clock runs
    double speed = 1;       // clip seconds a second
    uint32_t copies = 1;
    bool fly = false;             // dragging turns the eye, not the scene
    CameraMove camera, overview;  // overview: of View::culled
    glm::vec3 background{0.13f, 0.15f, 0.18f};
    uint32_t width = 1280, height = 720;  // of the window, on a display of the usual density
    double resolution = 0;                // pixels of a picture over those of its pane, each way; 0: by device
    bool dark = true, panel = true, keys = false;
};

// All of it but `keys` and `shown`, as {"schema": "skinview-settings/1", …}.
std::string settingsText(const ViewState& state);

// What the text names; the rest stays. A value of the wrong kind or out of range is an input error that names its key,
// and changes nothing.
Result<ViewState> readSettings(ViewState state, const std::string& text);

// Lets `passed` seconds go by, round a clip of that duration.
void stepClock(ViewState& state, double passed, double duration);

// --- choices (choices.cpp): the table of axes as controls ------------------------------------------------------

// The axes that mean something to the case.
std::vector<const Axis*> controlsOf(const Case& c);

// The case with that word chosen, or, where several go together, taken in or out.
Result<Case> chosen(const Case& c, const Axis& axis, const std::string& word);

// Makes the choice for the active case; with ViewState::linked the other one follows where it can.
void choose(ViewState& state, const Axis& axis, const std::string& word);

// Where the two are linked and still differ in an axis that both have: in which, and why where a route lacks the other
// one's variant. Else empty.
std::string linkText(const ViewState& state);

// The next or previous value of an axis that a backend can draw.
void chooseNext(ViewState& state, const Backends& backends, std::string_view axis, int step);

// Where a route is null. A: the route that `auto` takes. B: the same on the other API, or the next best thing there.
void chooseCases(ViewState& state, const Backends& backends);

// Pictures of that size of what the state shows.
PictureRequest requestOf(const ViewState& state, uint64_t number, uint32_t width, uint32_t height);

// The line that measures what is on the screen.
std::string benchCommand(const ViewState& state);

// --- keys (keys.cpp) -------------------------------------------------------------------------------------------

// What a key asks of the window itself.
enum class Ask { nothing, screenshot, accuracy, command, close };

struct KeyRow {
    const char* key;    // "A", "F1", "Space", "Tab", "Equal", as Dear ImGui calls them; empty: it is none
    const char* shown;  // in the list of keys
    const char* what;
    std::function<void(ViewState&)> act;
    const char* axis = "";  // whose next value it chooses, with Shift the one before
    Ask ask = Ask::nothing;
};
const std::vector<KeyRow>& keyRows();

Ask pressKey(ViewState& state, const Backends& backends, std::string_view key, bool shift = false);

}  // namespace skinbench::view
