// What keys do. The list of F1 is this table.
#include <algorithm>

#include "apps/view/state.h"

namespace skinbench::view {
namespace {

using Action = decltype(KeyRow::act);

Action toggles(bool ViewState::*flag) {
    return [flag](ViewState& s) { s.*flag = !(s.*flag); };
}

// The mode, or side by side where it is shown already.
Action shows(Mode mode) {
    return [mode](ViewState& s) { s.mode = s.mode == mode ? Mode::panes : mode; };
}

Action steps(double seconds) {
    return [seconds](ViewState& s) {
        s.playing = false;
        s.seconds = std::max(0.0, s.seconds + seconds);
    };
}

void flip(ViewState& s) {
    s.shown = s.mode == Mode::one ? 1 - s.shown : 0;
    s.mode = Mode::one;
}

}  // namespace

const std::vector<KeyRow>& keyRows() {
    static const std::vector<KeyRow> rows = {
        {"Tab", "Tab", "A or B, one in place of the other", flip},
        {"D", "D", "the difference, amplified; again: side by side", shows(Mode::difference)},
        {"W", "W", "wipe: A left of the splitter, B right of it; again: side by side", shows(Mode::wipe)},
        {"1", "1", "keys change A", [](ViewState& s) { s.active = 0; }},
        {"2", "2", "keys change B", [](ViewState& s) { s.active = 1; }},
        {"L", "L", "link A and B: what is chosen holds for both", toggles(&ViewState::linked)},
        {"X", "X", "swap A and B", [](ViewState& s) { std::swap(s.cases[0], s.cases[1]); }},
        {"R", "R", "next route (with Shift: the one before)", {}, "route"},
        {"V", "V", "next variant", {}, "variant"},
        {"C", "C", "next codec", {}, "codec"},
        {"B", "B", "next meshlet builder", {}, "builder"},
        {"N", "N", "next view: shaded, meshlets, weights, ...", {}, "view"},
        {"Space", "Space", "pause, go on", toggles(&ViewState::playing)},
        {"Period", ".", "one frame on", steps(1.0 / 60)},
        {"Comma", ",", "one frame back", steps(-1.0 / 60)},
        {"Home", "Home", "the cameras as they were", [](ViewState& s) { s.camera = s.overview = {}; }},
        {"F", "F", "fly: dragging turns the eye; again: orbit", toggles(&ViewState::fly)},
        {"Equal", "+", "twice the copies", [](ViewState& s) { s.copies = std::min(1000u, s.copies * 2); }},
        {"Minus", "-", "half the copies", [](ViewState& s) { s.copies = std::max(1u, s.copies / 2); }},
        {"T", "T", "light or dark", toggles(&ViewState::dark)},
        {"P", "P", "show or hide the panel", toggles(&ViewState::panel)},
        {"E", "E", "error of this frame against the CPU reference, and its counters", {}, "", Ask::accuracy},
        {"K", "K", "copy the skinbench bench line that measures this", {}, "", Ask::command},
        {"F12", "F12", "write the window to a PNG file", {}, "", Ask::screenshot},
        {"F1", "F1", "this list", toggles(&ViewState::keys)},
        {"Q", "Q", "close", {}, "", Ask::close},
        {"", "drag", "orbit; right button: move; wheel: nearer, farther"},
        {"", "Shift", "while the view culled is dragged: the camera of its tests, not the one aside"},
        {"", "click", "what lies there: meshlet and vertex"},
        {"", "arrows", "move; Page Up and Page Down: up and down"},
        {"", "drop", "a .glb or .gltf file on the window"},
    };
    return rows;
}

Ask pressKey(ViewState& state, const Backends& backends, std::string_view key, bool shift) {
    const auto row = std::ranges::find(keyRows(), key, &KeyRow::key);
    if (row == keyRows().end()) return Ask::nothing;
    if (row->act) row->act(state);
    if (*row->axis) chooseNext(state, backends, row->axis, shift ? -1 : 1);
    return row->ask;
}

}  // namespace skinbench::view
