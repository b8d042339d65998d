// What keys do. The list of F1 is this table.
#include <algorithm>

#include "apps/view/state.h"

namespace skinbench::view {
namespace {

constexpr double kStep = 1.0 / 60;

KeyAction toggles(bool ViewState::*flag) {
    return [flag](ViewState& s, const CapsByApi&, bool) { s.*flag = !(s.*flag); };
}

// The mode, or side by side where it is shown already.
KeyAction shows(Mode mode) {
    return [mode](ViewState& s, const CapsByApi&, bool) { s.mode = s.mode == mode ? Mode::panes : mode; };
}

KeyAction changes(size_t pane) {
    return [pane](ViewState& s, const CapsByApi&, bool) { s.active = pane; };
}

KeyAction next(const char* axis) {
    return [axis](ViewState& s, const CapsByApi& d, bool shift) { chooseNext(s, s.active, d, axis, shift ? -1 : 1); };
}

KeyAction steps(double seconds) {
    return [seconds](ViewState& s, const CapsByApi&, bool) {
        s.playing = false;
        s.seconds = std::max(0.0, s.seconds + seconds);
    };
}

void flip(ViewState& s, const CapsByApi&, bool) {
    s.shown = s.mode == Mode::one ? 1 - s.shown : 0;
    s.mode = Mode::one;
}

void swap(ViewState& s, const CapsByApi&, bool) { std::swap(s.cases[0], s.cases[1]); }
void resetCamera(ViewState& s, const CapsByApi&, bool) { s.camera = {}; }
void more(ViewState& s, const CapsByApi&, bool) { s.copies = std::min(1000u, s.copies * 2); }
void fewer(ViewState& s, const CapsByApi&, bool) { s.copies = std::max(1u, s.copies / 2); }
void nothing(ViewState&, const CapsByApi&, bool) {}

}  // namespace

const std::vector<KeyRow>& keyRows() {
    static const std::vector<KeyRow> rows = {
        {"Tab", "Tab", "A or B, one in place of the other", flip},
        {"D", "D", "the difference, amplified; again: side by side", shows(Mode::difference)},
        {"W", "W", "wipe: A left of the splitter, B right of it; again: side by side", shows(Mode::wipe)},
        {"1", "1", "keys change A", changes(0)},
        {"2", "2", "keys change B", changes(1)},
        {"L", "L", "link A and B: what is chosen holds for both", toggles(&ViewState::linked)},
        {"X", "X", "swap A and B", swap},
        {"R", "R", "next route (with Shift: the one before)", next("route")},
        {"V", "V", "next variant", next("variant")},
        {"C", "C", "next codec", next("codec")},
        {"B", "B", "next meshlet builder", next("builder")},
        {"N", "N", "next view: shaded, meshlets, weights, ...", next("view")},
        {"Space", "Space", "pause, go on", toggles(&ViewState::playing)},
        {"Period", ".", "one frame on", steps(kStep)},
        {"Comma", ",", "one frame back", steps(-kStep)},
        {"Home", "Home", "the camera as it was", resetCamera},
        {"F", "F", "fly: dragging turns the eye; again: orbit", toggles(&ViewState::fly)},
        {"Equal", "+", "twice the copies", more},
        {"Minus", "-", "half the copies", fewer},
        {"T", "T", "light or dark", toggles(&ViewState::dark)},
        {"P", "P", "show or hide the panel", toggles(&ViewState::panel)},
        {"E", "E", "error of this frame against the CPU reference, and its counters", nothing, Ask::accuracy},
        {"K", "K", "copy the skinbench bench line that measures this", nothing, Ask::command},
        {"F12", "F12", "write the window to a PNG file", nothing, Ask::screenshot},
        {"F1", "F1", "this list", toggles(&ViewState::keys)},
        {"Q", "Q", "close", nothing, Ask::close},
    };
    return rows;
}

Ask pressKey(ViewState& state, const CapsByApi& devices, const KeyPress& press) {
    const auto row = std::ranges::find_if(keyRows(), [&](const KeyRow& key) { return press.key == key.key; });
    if (row == keyRows().end()) return Ask::nothing;
    row->act(state, devices, press.shift);
    return row->ask;
}

}  // namespace skinbench::view
