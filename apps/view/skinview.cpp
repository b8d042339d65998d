// The program `skinview`: the words of its command line, its settings file, its loop.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "apps/command_line.h"
#include "apps/view/view.h"
#include "common/core/file.h"
#include "common/core/version.h"
#include "common/frame/image.h"

namespace skinbench::view {
namespace {

struct Words {
    std::string scene, caseId, case2Id, size, settings, screenshot, mode, device, clip;
    double seconds = -1;
    uint32_t frames = 0, copies = 0;
    bool validation = false, noWindow = false;
};

// Where settings are kept when no file is named; empty where there is no home.
std::string usualSettings() {
    const char* config = std::getenv("XDG_CONFIG_HOME");
    const char* home = std::getenv("HOME");
    if (config && *config) return std::string(config) + "/skinbench/view.json";
    return home && *home ? std::string(home) + "/.config/skinbench/view.json" : "";
}

// The settings of the file with the words on top. A run of a number of frames depends on nothing but its words.
Result<ViewState> stateOf(const Words& words) {
    ViewState state;
    const bool named = !words.settings.empty();
    const std::string path = named ? words.settings : words.frames ? "" : usualSettings();
    if (!path.empty() && (named || std::filesystem::exists(path))) {
        auto text = readWholeFile(path);
        auto read = text ? readSettings(state, *text) : std::unexpected(text.error());
        if (!read && named) return text ? errorAt(path, read.error()) : std::unexpected(text.error());
        if (!read) warn(path + ": " + read.error().text + "; the usual settings are taken");
        if (read) state = *read;
    }
    if (!words.scene.empty()) {
        if (words.scene != state.scene) state.clip.clear();
        state.scene = words.scene;
        state.camera = {};
    }
    for (const auto& [id, pane] : {std::pair(words.caseId, 0), std::pair(words.case2Id, 1)}) {
        if (id.empty()) continue;
        auto parsed = parseCaseId(id);
        SKINBENCH_TRY(parsed);
        state.cases[static_cast<size_t>(pane)] = *parsed;
    }
    // A is named and B is not: B is the same on the other API.
    if (!words.caseId.empty() && words.case2Id.empty()) state.cases[1] = {};
    if (!words.size.empty()) {
        auto size = parseSize(words.size);
        SKINBENCH_TRY(size);
        state.width = size->first;
        state.height = size->second;
    }
    if (!words.mode.empty())
        state.mode = static_cast<Mode>(std::ranges::find(modeNames(), words.mode) - modeNames().begin());
    if (!words.clip.empty()) state.clip = words.clip;
    if (words.seconds >= 0) state.seconds = words.seconds;
    if (words.copies) state.copies = words.copies;
    return state;
}

// One line for what ends the program or spoils a run that nobody watches.
std::optional<int> fault(const Shown* shown, bool watched) {
    if (!shown) return std::nullopt;
    if (shown->scene.empty() && !shown->error.empty()) return reportError({shown->fault, shown->error});
    if (!watched)
        for (const Drawn& picture : shown->pictures)
            if (!picture.error.empty()) return reportError({Fault::device, picture.id + ": " + picture.error});
    return std::nullopt;
}

// Frames and how long they took, the first one, which starts the drivers, apart.
struct Tally {
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    double first = 0, all = 0;  // seconds
    uint32_t drawn = 0;

    void add() {
        all = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (drawn++ == 0) first = all;
    }
    std::string text(const Image& image) const {
        const std::string begin =
            std::format("two pictures of {} x {}: the first frame after {:.2f} s", image.width, image.height, first);
        if (drawn < 2) return begin + "\n";
        return begin + std::format(", then {} more in {:.2f} s, {:.1f} a second\n", drawn - 1, all - first,
                                   (drawn - 1) / (all - first));
    }
};

// What there is to say and to write at the end.
int finish(const Words& words, const ViewState& state, const Image& screenshot,
           const std::vector<std::string>& messages) {
    if (screenshot.width)
        if (const auto saved = savePng(screenshot, words.screenshot); !saved) return reportError(saved.error());
    for (const std::string& message : messages) say(message);
    if (!messages.empty()) return kExitFailed;
    const std::string path = !words.settings.empty() ? words.settings : words.frames ? "" : usualSettings();
    if (!path.empty())
        if (const auto kept = writeWholeFile(path, settingsText(state)); !kept) return reportError(kept.error());
    return flushOutput();
}

// The pictures alone, each of the size that the window would have.
int runWithoutWindow(const Words& words, ViewState state) {
    Renderer renderer({.device = words.device, .validation = words.validation, .every = true});
    Tally tally;
    std::vector<std::string> messages;
    std::shared_ptr<const Shown> shown;
    for (uint32_t posted = 0; tally.drawn < words.frames && !interrupted();) {
        // The first answer says how long the clip is; then the renderer always has a frame to begin.
        const uint32_t ahead = shown ? tally.drawn + kFramesInFlight + 1 : 1;
        while (posted < std::min(ahead, words.frames)) {
            if (shown) stepClock(state, 1.0 / 60, shown->duration);
            renderer.post({++posted, state, state.width, state.height, false, {}});
        }
        shown = renderer.wait();
        tally.add();
        if (const auto ended = fault(shown.get(), false)) return *ended;
        messages.insert(messages.end(), shown->messages.begin(), shown->messages.end());
        state.cases = shown->cases;
    }
    if (!shown) return reportError({Fault::device, "interrupted before a frame was drawn"});
    const Image &a = shown->pictures[0].image, &b = shown->pictures[1].image;
    std::cout << tally.text(a);
    return finish(words, state, words.screenshot.empty() ? Image{} : sideBySide({a, b}), messages);
}

int run(const Words& words) {
    auto state = stateOf(words);
    if (!state) return reportError(state.error());
    if (!words.screenshot.empty())
        for (const auto& right :
             {checkSuffix(words.screenshot, ".png"), checkOutput(words.screenshot, {&words.scene, 1})})
            if (!right) return reportError(right.error());
    catchInterrupts();
    const bool watched = words.frames == 0;
    if (words.noWindow && watched)
        return reportError({Fault::input, "--no-window draws a number of frames; name it with --frames"});
    if (words.noWindow) return runWithoutWindow(words, *state);
    auto view = openView({*state, {.device = words.device, .validation = words.validation}, !watched, {}});
    if (!view) return reportError(view.error());
    Tally tally;
    Image last;
    while (!interrupted() && (watched || tally.drawn < words.frames)) {
        const bool isLast = tally.drawn + 1 == words.frames;
        if (!drawFrame(**view, isLast && !words.screenshot.empty() ? &last : nullptr)) break;
        tally.add();
        if (const auto ended = fault((*view)->shown.get(), watched)) return *ended;
    }
    if (!watched && (*view)->shown) std::cout << tally.text((*view)->shown->pictures[0].image);
    return finish(words, (*view)->state, last, (*view)->messages);
}

constexpr const char* kFooter =
    "KEYS\n"
    "    F1 in the window lists them. Tab: A or B; D: their difference; R, V, C: next route, variant, codec; Space: "
    "pause.\n"
    "\n"
    "EXIT STATUS\n"
    "    0 done, 1 no display, no driver, or with --frames a case that cannot be drawn, 2 bad arguments or input. What "
    "is\n"
    "    wrong is one line on standard error, or in the window once it is open.\n"
    "\n"
    "FILES\n"
    "    $XDG_CONFIG_HOME/skinbench/view.json, ~/.config/skinbench/view.json\n"
    "        what the window showed last\n"
    "\n"
    "EXAMPLES\n"
    "    skinview hero.glb --copies 50\n"
    "        a character of your own\n"
    "    skinview --case vk-ext/mesh/pc/meshopt/redirect --case2 vk/vertex/uc --mode difference\n"
    "        what a codec and a stage change in the picture\n"
    "\n"
    "SEE ALSO\n"
    "    skinbench --help";

int runProgram(int argc, char** argv) {
    nameProgram("skinview");
    CLI::App program{
        "Shows two cases of skinbench side by side: one camera, one clock, any routes, variants and codecs.",
        "skinview"};
    program.set_version_flag("--version", std::string(SKINBENCH_VERSION) + " (" + SKINBENCH_REVISION + ")");
    writeManual(program);
    Words words;
    program.add_option("scene", words.scene,
                       "a .gltf or .glb file, or builtin:NAME[:VERTICES] (default: builtin:biped)");
    program.add_option("--case", words.caseId, "case A: an id of a table, a result file or a report")->expected(1);
    program.add_option("--case2", words.case2Id, "case B (default: as A, on the other API)")->expected(1);
    program.add_option("--size", words.size, "WIDTHxHEIGHT of the window (default: 1280x720)");
    program.add_option("--mode", words.mode, "panes, wipe, one, difference")->check(oneOf(modeNames()));
    program.add_option("--copies", words.copies, "how many (default: 1)")->check(numberFrom(1u, 1'000'000u));
    program.add_option("--clip", words.clip, "name of the animation, or none (default: the first)");
    program.add_option("--time", words.seconds, "seconds into the animation")->check(numberFrom(0.0, 1e6));
    program.add_option("--settings", words.settings,
                       "JSON file that is read, and written at the end, instead of "
                       "skinbench/view.json in the folder of your settings");
    program
        .add_option("--frames", words.frames,
                    "draw that many frames, a sixtieth of a second apart, print how long they took, and end")
        ->check(numberFrom(1u, 1'000'000u));
    program
        .add_option("--screenshot", words.screenshot,
                    "PNG file of the window's last frame; without --frames of its first")
        ->each([&](const std::string&) { words.frames = words.frames ? words.frames : 1; });
    program.add_flag("--no-window", words.noWindow,
                     "with --frames: the pictures alone, each of --size, where there is no display");
    program.add_option("--device", words.device, "number, part of the name, UUID or PCI address, as probe shows them");
    program.add_flag("--validation", words.validation, "validation layers and debug output; a message is a failure");
    program.footer(kFooter);
    if (const auto ended = parseWords(program, argc, argv)) return *ended;
    return run(words);
}

}  // namespace
}  // namespace skinbench::view

int main(int argc, char** argv) { return skinbench::guarded(skinbench::view::runProgram, argc, argv); }
