// The program `skinview`: the words of its command line, its settings file, its loop.
#include <algorithm>
#include <filesystem>
#include <iostream>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "apps/command_line.h"
#include "apps/view/view.h"
#include "common/core/file.h"
#include "common/core/version.h"

namespace skinbench::view {
namespace {

struct Words {
    ViewState state;  // the settings, and what is named beside them
    PictureOptions pictures;
    std::string settings, screenshot;
    uint32_t frames = 0;  // 0: until the window is closed
    bool noWindow = false;
};

// Empty: none is read or written. A run of a number of frames depends on nothing but its words.
std::string settingsPath(const Words& words) {
    if (!words.settings.empty() || words.frames) return words.settings;
    return userFile("XDG_CONFIG_HOME", ".config", "view.json");
}

// A file that is not there yet is written at the end.
Result<ViewState> keptState(const Words& words) {
    const std::string path = settingsPath(words);
    std::error_code failed;
    if (path.empty() || !std::filesystem::exists(path, failed)) return ViewState();
    const auto read = readWholeFile(path).and_then([&](const std::string& text) -> Result<ViewState> {
        const auto state = readSettings({}, text);
        return state ? state : errorAt(path, state.error());
    });
    if (read || !words.settings.empty()) return read;
    warn(read.error().text + "; the usual settings are taken");
    return ViewState();
}

// One line for what ends the program or spoils a run that nobody watches.
std::optional<int> fault(const Pictures* shown, bool watched) {
    if (!shown) return std::nullopt;
    if (shown->scene.name.empty() && shown->error) return reportError(*shown->error);
    for (const CasePicture& picture : shown->all)
        if (!watched && picture.error)
            return reportError({picture.error->fault, picture.id + ": " + picture.error->text});
    return std::nullopt;
}

int run(const Words& words) {
    if (!words.screenshot.empty())
        for (const auto& right :
             {checkSuffix(words.screenshot, ".png"), checkOutput(words.screenshot, {&words.state.scene, 1})})
            if (!right) return reportError(right.error());
    if (!words.settings.empty())
        if (const auto possible = checkOutput(words.settings, {&words.state.scene, 1}); !possible)
            return reportError(possible.error());
    catchInterrupts();
    const bool watched = words.frames == 0;
    if (words.noWindow && watched)
        return reportError(
            {Fault::input, "--no-window draws a number of frames; name it with --frames, or one with --screenshot"});
    const auto opened = openView(words.state, words.pictures, !words.noWindow);
    if (!opened) return reportError(opened.error());
    Viewer& view = **opened;
    Image last;
    uint32_t drawn = 0;
    double first = 0, all = 0;  // seconds; the first frame starts the drivers
    for (const auto start = std::chrono::steady_clock::now(); !interrupted() && (watched || drawn < words.frames);) {
        const bool wanted = !words.screenshot.empty() && drawn + 1 == words.frames;
        if (!drawFrame(view, wanted ? &last : nullptr)) break;
        all = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (drawn++ == 0) first = all;
        if (const auto ended = fault(view.shown.get(), watched)) return *ended;
    }
    if (!watched && !view.shown) return reportError({Fault::device, "ended before a frame was drawn"});
    if (!watched) {
        const Image& image = view.shown->all[0].image;
        std::string text =
            std::format("two pictures of {} x {}: the first frame after {:.2f} s", image.width, image.height, first);
        if (drawn > 1)
            text += std::format(", then {} more in {:.2f} s, {:.1f} a second", drawn - 1, all - first,
                                (drawn - 1) / (all - first));
        std::cout << text << "\n";
    }
    if (last.width)
        if (const auto saved = savePng(last, words.screenshot); !saved) return reportError(saved.error());
    for (const std::string& message : view.messages) say(message);
    if (!view.messages.empty()) return kExitFailed;
    if (const std::string path = settingsPath(words); !path.empty())
        if (const auto kept = writeWholeFile(path, settingsText(view.state)); !kept) return reportError(kept.error());
    return flushOutput();
}

constexpr const char* kFooter = R"(KEYS
    F1 in the window lists them. Tab: A or B; D: their difference; R, V, C: next route, variant, codec; Space: pause.

EXIT STATUS
    0 done, 1 no display, no driver, or with --frames a case that cannot be drawn, 2 bad arguments or input. One line
    on standard error, or in the window once it is open, says what is wrong.

FILES
    $XDG_CONFIG_HOME/skinbench/view.json, ~/.config/skinbench/view.json
        what the window showed last

EXAMPLES
    skinview hero.glb --copies 50
        a character of your own
    skinview --case vk-ext/mesh/pc/meshopt/redirect --case2 vk/vertex/uc --mode difference
        what a codec and a stage change in the picture

SEE ALSO
    skinbench --help)";

// A word whose fault is that of a Result.
template <class Value>
Value valueOf(Result<Value> result) {
    if (!result) throw CLI::ValidationError(result.error().text);
    return std::move(*result);
}

void addWords(CLI::App& program, Words& words) {
    ViewState& state = words.state;
    using Word = const std::string&;
    program.add_option("scene", state.scene,
                       "a .gltf or .glb file, or builtin:NAME[:VERTICES] (default: builtin:biped)");
    program.add_option_function<std::string>(
        "--case",
        [&](Word id) {
            state.cases = {valueOf(parseCaseId(id)), Case()};
        },
        "case A, by its id in a table, a result file or a report");
    program.add_option_function<std::string>(
        "--case2", [&](Word id) { state.cases[1] = valueOf(parseCaseId(id)); },
        "case B (default: like A, on the other API)");
    program.add_option_function<std::string>(
        "--size", [&](Word size) { std::tie(state.width, state.height) = valueOf(parseSize(size)); },
        "WIDTHxHEIGHT of the window (default: 1280x720); a display with twice the usual density has twice as "
        "many pixels");
    program
        .add_option_function<std::string>(
            "--mode", [&](Word mode) { state.mode = modeOf(mode); }, "panes, wipe, one, difference")
        ->check(oneOf(modeNames()));
    program.add_option("--copies", state.copies, "number of characters (default: 1)")
        ->check(numberFrom(1u, 1'000'000u));
    program.add_option("--clip", state.clip, "name of the animation, or none (default: the first)");
    program.add_option("--time", state.seconds, "seconds into the animation")->check(numberFrom(0.0, 1e6));
    program.add_option("--settings", words.settings,
                       "JSON file of settings, read at the start, if it is there, and written at the end, instead of "
                       "skinbench/view.json in your settings folder");
    program
        .add_option("--frames", words.frames,
                    "draw this many frames, a sixtieth of a second apart, print how long they took, and end")
        ->check(numberFrom(1u, 1'000'000u));
    program.add_option("--screenshot", words.screenshot,
                       "PNG file for the window's last frame, or for its first one without --frames");
    program.add_flag("--no-window", words.noWindow,
                     "with --frames or --screenshot: draw only the pictures, each of --size, without a display");
    program.add_option("--device", words.pictures.device,
                       "number, part of the name, UUID or PCI address, as probe shows them");
    program.add_flag("--validation", words.pictures.validation,
                     "turn on validation layers and debug output; a message is a failure");
}

// The memory of a picture is used for the next one: what the system gets back it clears again, page after page.
void keepMemory() {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that there is
    mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
}

int runProgram(int argc, char** argv) {
    nameProgram("skinview");
    keepMemory();
    CLI::App program{
        "Shows two cases of skinbench side by side: one camera, one clock, any routes, variants and codecs.",
        "skinview"};
    program.set_version_flag("--version", std::string(SKINBENCH_VERSION) + " (" + SKINBENCH_REVISION + ")",
                             "the version");
    writeManual(program);
    program.footer(kFooter);
    Words words;
    addWords(program, words);
    if (const auto ended = parseWords(program, argc, argv)) return *ended;
    if (!words.screenshot.empty() && !words.frames) words.frames = 1;
    auto kept = keptState(words);
    if (!kept) return reportError(kept.error());
    // Another scene has other clips, and is looked at anew. The words, once more, are on top of the settings.
    if (program.count("scene")) kept->camera = kept->overview = {};
    if (program.count("scene") && kept->scene != words.state.scene) kept->clip.clear();
    words.state = *kept;
    parseWords(program, argc, argv);
    words.pictures.every = words.frames > 0;
    return run(words);
}

}  // namespace
}  // namespace skinbench::view

int main(int argc, char** argv) { return skinbench::guarded(skinbench::view::runProgram, argc, argv); }
