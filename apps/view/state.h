// What the window shows, as plain data. Settings are kept as JSON, keys and controls change it, pictures follow from
// it; nothing here knows a window.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "apps/apps.h"
#include "common/cases/choices.h"

namespace skinbench::view {

// panes:      both whole pictures, side by side.
// wipe:       one picture, A left of the splitter and B right of it.
// one:        A or B.
// difference: |A - B|, amplified.
enum class Mode { panes, wipe, one, difference };
const std::vector<std::string>& modeNames();  // in the order of the enumeration

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
    bool fly = false;  // dragging turns the eye, not the scene
    CameraMove camera;
    glm::vec3 background{0.13f, 0.15f, 0.18f};
    uint32_t width = 1280, height = 720;  // of the window
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

// The devices' caps by API, and why an API has none.
struct ApiCaps {
    DeviceCaps caps;
    std::string missing;
};
using CapsByApi = std::map<Api, ApiCaps>;

// Why a device cannot draw the case, or nothing.
std::optional<std::string> reasonAgainst(const Case& c, const CapsByApi& devices);

struct ControlChoice {
    std::string word;
    Case then;
    std::optional<std::string> reason;  // against it
};

// What one axis offers a case. Without choices any text that the axis takes.
struct Control {
    const Axis* axis = nullptr;
    std::string value;
    std::vector<ControlChoice> choices;
    bool joined = false;  // several words together, joined with +
};

// Of every axis that means something to the case.
std::vector<Control> controlsOf(const Case& c, const CapsByApi& devices);

// What the choice makes of both cases: with ViewState::linked the other one follows where it can.
void choose(ViewState& state, size_t pane, const Axis& axis, const std::string& word);

// The next or previous value of an axis that a device can draw.
void chooseNext(ViewState& state, size_t pane, const CapsByApi& devices, std::string_view axis, int step);

// A: the route that `auto` takes. B: the same variant on the other API, or the next best thing that it has.
void chooseCases(ViewState& state, const CapsByApi& devices);

// The line that measures what is on the screen.
std::string benchCommand(const ViewState& state);

// --- keys (keys.cpp) -------------------------------------------------------------------------------------------

// What a key asks of the window itself.
enum class Ask { nothing, screenshot, accuracy, command, close };

struct KeyPress {
    std::string_view key;  // "A", "F1", "Space", "Tab", "LeftArrow", "Equal", as Dear ImGui calls them
    bool shift = false;
};

using KeyAction = std::function<void(ViewState& state, const CapsByApi& devices, bool shift)>;

struct KeyRow {
    const char* key;
    const char* shown;  // in the list of keys
    const char* what;
    KeyAction act;
    Ask ask = Ask::nothing;
};
const std::vector<KeyRow>& keyRows();

Ask pressKey(ViewState& state, const CapsByApi& devices, const KeyPress& press);

}  // namespace skinbench::view
