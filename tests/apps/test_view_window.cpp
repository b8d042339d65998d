// The window itself, on a display (tools/with_display): what it shows is compared with what `render` draws, and input
// is given to it as a person's would be. One window for all tests, as a driver's start costs more than a frame.
#include <set>

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <stb_image.h>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <catch2/reporters/catch_reporter_event_listener.hpp>
#include <catch2/reporters/catch_reporter_registrars.hpp>

#include "apps/view/view.h"
#include "tests/apps/program_call.h"
#include "tests/apps/x11.h"
#include "tests/cases.h"
#include "tests/drivers.h"

using namespace skinbench;
using namespace skinbench::view;
using namespace program;
using Catch::Matchers::ContainsSubstring;

namespace {

std::unique_ptr<Viewer> windowOfTests;

Viewer& openedView() {
    if (windowOfTests) return *windowOfTests;
    const ViewState state{.scene = "builtin:robot:2000", .width = 640, .height = 300, .resolution = 0.5};
    auto opened = openView(state, {.validation = underValidation(), .every = true});
    if (!opened) FAIL(opened.error().text);
    windowOfTests = std::move(*opened);
    windowOfTests->folder = fixture::temporaryFolder().string() + "/";
    return *windowOfTests;
}

// Closes the window before anything of the program ends that it, its thread and the drivers use.
struct WindowCloser : Catch::EventListenerBase {
    using EventListenerBase::EventListenerBase;
    void testRunEnded(const Catch::TestRunStats&) override { windowOfTests.reset(); }
};
CATCH_REGISTER_LISTENER(WindowCloser)

// The window as it was opened.
Viewer& freshView() {
    Viewer& view = openedView();
    view.state = {.scene = "builtin:robot:2000", .playing = false, .width = 640, .height = 300, .resolution = 0.5};
    ImGui::GetIO().ConfigInputTrickleEventQueue = false;
    REQUIRE(drawFrame(view));
    if (view.shown->error) FAIL(view.shown->error->text);
    for (const auto& [api, open] : view.thread->backends())
        if (!open.backend) SKIP("no driver: " + open.missing);
    return view;
}

const CasePicture& drawnPicture(const Viewer& view, size_t pane) {
    const CasePicture& picture = view.shown->all[pane];
    INFO(picture.id << ": " << (picture.error ? picture.error->text : ""));
    REQUIRE(!picture.error);
    REQUIRE(picture.image.width == view.size.x);
    return picture;
}

void pressKey(Viewer& view, ImGuiKey key, bool shift = false) {
    ImGuiIO& io = ImGui::GetIO();
    if (shift) io.AddKeyEvent(ImGuiMod_Shift, true);
    io.AddKeyEvent(key, true);
    REQUIRE(drawFrame(view));
    io.AddKeyEvent(key, false);
    if (shift) io.AddKeyEvent(ImGuiMod_Shift, false);
    REQUIRE(drawFrame(view));
}

void drag(Viewer& view, glm::vec2 from, glm::vec2 to, bool shift = false) {
    ImGuiIO& io = ImGui::GetIO();
    io.AddKeyEvent(ImGuiMod_Shift, shift);
    for (const auto& [at, down] :
         {std::pair(from, false), {from, true}, {(from + to) * 0.5f, true}, {to, true}, {to, false}}) {
        // Where the window has the focus, it asks for the pointer, whose own events come first.
        double x = 0, y = 0;
        glfwSetCursorPos(view.window, at.x, at.y);
        glfwGetCursorPos(view.window, &x, &y);
        glfwPollEvents();
        io.AddMousePosEvent(at.x, at.y);
        io.AddMouseButtonEvent(0, down);
        REQUIRE(drawFrame(view));
    }
    io.AddKeyEvent(ImGuiMod_Shift, false);
    REQUIRE(drawFrame(view));
}

Image readPng(const std::string& path) {
    int width = 0, height = 0, channels = 0;
    uint8_t* pixels = stbi_load(path.c_str(), &width, &height, &channels, 4);
    REQUIRE(pixels);
    Image image{
        static_cast<uint32_t>(width), static_cast<uint32_t>(height), {pixels, pixels + size_t(width) * height * 4}};
    stbi_image_free(pixels);
    return image;
}

void resize(Viewer& view, int width, int height) {
    glfwSetWindowSize(view.window, width, height);
    for (int tries = 0; tries < 100; ++tries) {
        REQUIRE(drawFrame(view));
        int w = 0, h = 0;
        glfwGetFramebufferSize(view.window, &w, &h);
        if (w == width && h == height) break;
    }
    REQUIRE(drawFrame(view));
    CHECK(ImGui::GetIO().DisplaySize.x == static_cast<float>(width));
}

}  // namespace

PictureThread& threadOfWindow() { return *freshView().thread; }

TEST_CASE("both panes show what render draws at that moment", "[window]") {
    Viewer& view = freshView();
    view.state.playing = true;
    view.state.seconds = 0.3;
    for (int frame = 0; frame < 3; ++frame) REQUIRE(drawFrame(view));
    CHECK(view.shown->request.number == view.posted);
    CHECK(view.shown->request.settings.seconds > 0.3);
    const CasePicture &a = drawnPicture(view, 0), &b = drawnPicture(view, 1);
    const Outcome drawn = call({"render", "builtin:robot:2000", "--case", a.id, "--case", b.id, "--time",
                                std::format("{}", view.shown->request.settings.seconds), "--size",
                                std::format("{}x{}", view.size.x, view.size.y), "-o", pathOf("panes.png")});
    INFO(drawn.err);
    REQUIRE(drawn.status == 0);
    CHECK(compareImages(readPng(pathOf("panes.png")), sideBySide({a.image, b.image}), 0).fraction == 0);
    CHECK(view.shown->request.cases[0].route->api != view.shown->request.cases[1].route->api);
    // The pictures are of this frame: at another moment they are others.
    const auto before = view.shown;
    REQUIRE(drawFrame(view));
    for (size_t pane = 0; pane < 2; ++pane)
        CHECK(compareImages(before->all[pane].image, view.shown->all[pane].image, 0).fraction > 0.001);
}

TEST_CASE("the window has the picture's very pixels", "[window]") {
    Viewer& view = freshView();
    view.state.mode = Mode::one;
    view.state.resolution = 1;
    for (size_t pane = 0; pane < 2; ++pane) {
        view.state.shown = pane;
        REQUIRE(drawFrame(view));
        Image window;
        REQUIRE(drawFrame(view, &window));
        const Image& image = drawnPicture(view, pane).image;
        REQUIRE(image.width == static_cast<uint32_t>(view.area.size.x));
        size_t different = 0;
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x) {
                const size_t at = ((y + static_cast<size_t>(view.area.at.y)) * window.width + x) * 4;
                different += std::memcmp(&window.rgba[at], &image.rgba[(size_t{y} * image.width + x) * 4], 4) != 0;
            }
        CHECK(different == 0);
    }
}

TEST_CASE("a case does not differ from itself, and another one does", "[window]") {
    Viewer& view = freshView();
    view.state.cases[1] = view.state.cases[0];
    pressKey(view, ImGuiKey_D);
    REQUIRE(view.shown->all.size() == 3);
    CHECK_THAT(view.shown->all[2].title, ContainsSubstring(": 0 of ") && ContainsSubstring("by 0 of 255"));
    view.state.cases[1].view = View::meshlets;
    REQUIRE(drawFrame(view));
    const DifferenceImage found = differenceImage(drawnPicture(view, 0).image, drawnPicture(view, 1).image, 16);
    CHECK(found.pixels > 500);
    CHECK(found.largest > 50);
    CHECK(found.image.rgba == view.shown->all[2].image.rgba);
    CHECK_THAT(view.shown->all[2].title, ContainsSubstring(std::format("x 16: {} of ", found.pixels)));
    pressKey(view, ImGuiKey_D);
    CHECK(view.state.mode == Mode::panes);
    CHECK(view.shown->all.size() == 2);
}

TEST_CASE("keys lead through every route and variant that a device can draw", "[window]") {
    Viewer& view = freshView();
    view.state.linked = false;
    const Backends& backends = view.thread->backends();
    std::set<std::string> routesWanted, variantsWanted, routesSeen, variantsSeen, seen;
    for (const Route& route : routes())
        for (const Variant& variant : variants())
            if (runsOn(variant, route) && !reasonAgainst(makeCase(route.name, variant.name), backends)) {
                routesWanted.insert(route.name);
                variantsWanted.insert(variant.name);
            }
    for (size_t route = 0; route < routes().size(); ++route) {
        for (size_t variant = 0; variant < variants().size(); ++variant) {
            const CasePicture& picture = drawnPicture(view, 0);
            if (!seen.insert(picture.id).second) break;
            INFO(picture.id);
            CHECK(coveredFraction(picture.image) > 0.02);
            routesSeen.insert(view.shown->request.cases[0].route->name);
            variantsSeen.insert(view.shown->request.cases[0].variant->name);
            pressKey(view, ImGuiKey_V);
        }
        pressKey(view, ImGuiKey_R);
    }
    CHECK(routesSeen == routesWanted);
    CHECK(variantsSeen == variantsWanted);
    CHECK(seen.size() > 4);
}

TEST_CASE("the pointer moves the splitter and turns the camera of both panes", "[window]") {
    Viewer& view = freshView();
    const glm::vec2 middle = view.area.at + view.area.size * 0.5f;
    drag(view, middle, {middle.x * 1.5f, middle.y});
    CHECK(std::abs(view.state.splitter - 0.75f) < 0.02f);
    CHECK(view.state.camera == CameraMove{});
    const auto before = view.shown;
    drag(view, {30, middle.y}, {90, middle.y});
    CHECK(view.state.camera.turn < -10);
    for (size_t pane = 0; pane < 2; ++pane)
        CHECK(compareImages(before->all[pane].image, drawnPicture(view, pane).image, 0).fraction > 0.01);
    pressKey(view, ImGuiKey_Home);
    CHECK(compareImages(before->all[0].image, drawnPicture(view, 0).image, 0).fraction == 0);
    // A click says what lies there: the middle of A's pane is the robot's body.
    const glm::vec2 body = view.area.at + view.area.size * glm::vec2(view.state.splitter / 2, 0.5f);
    drag(view, body, body);
    REQUIRE(view.picked.size() > 4);
    CHECK_THAT(view.picked[1], ContainsSubstring("meshlet "));
    view.state.cases[0].clusterCull = ClusterCull::list;
    REQUIRE(drawFrame(view));
    drag(view, body, body);
    CHECK_THAT(view.picked[2], ContainsSubstring("drawn"));
}

TEST_CASE("the view of culling has a legend with counts, and other views have none", "[window]") {
    Viewer& view = freshView();
    view.state.linked = false;
    view.state.cases[0].clusterCull = ClusterCull::list;
    view.state.cases[0].cull = Cull::compact;
    view.state.cases[0].view = View::culled;
    view.state.resolution = 0.25;
    REQUIRE(drawFrame(view));
    CHECK(coveredFraction(drawnPicture(view, 0).image) > 0.02);
    const std::vector<LegendRow>& legend = drawnPicture(view, 0).legend;
    REQUIRE(legend.size() == 4);
    CHECK_THAT(legend[0].text, ContainsSubstring("drawn: ") && ContainsSubstring(" triangles"));
    CHECK_THAT(legend[1].text, ContainsSubstring(" meshlets (0.0 %)"));  // the robot is in the view
    CHECK_THAT(legend[3].text, ContainsSubstring("back faces: ") && !ContainsSubstring("back faces: 0 "));
    CHECK(drawnPicture(view, 1).legend.empty());
    // Drags there turn what is seen of it alone, with Shift the camera of the tests.
    const std::string drawn = legend[0].text;
    const glm::vec2 from = view.area.at + view.area.size * glm::vec2(0.1f, 0.5f), by(60, 0);
    const Image before = drawnPicture(view, 0).image, other = drawnPicture(view, 1).image;
    drag(view, from, from + by);
    CHECK(view.state.overview.turn < -10);
    CHECK(view.state.camera == CameraMove{});
    CHECK(compareImages(before, drawnPicture(view, 0).image, 0).fraction > 0.01);
    CHECK(compareImages(other, drawnPicture(view, 1).image, 0).fraction == 0);
    CHECK(drawnPicture(view, 0).legend[0].text == drawn);
    const CameraMove overview = view.state.overview;
    drag(view, from, from + by, true);
    CHECK(view.state.overview == overview);
    CHECK(view.state.camera.turn < -10);
    CHECK(drawnPicture(view, 0).legend[0].text != drawn);
    pressKey(view, ImGuiKey_Home);
    CHECK(compareImages(before, drawnPicture(view, 0).image, 0).fraction == 0);
}

TEST_CASE("a dropped file is shown, and a bad one leaves the scene as it is", "[window]") {
    Viewer& view = freshView();
    const std::string good = pathOf("tiny.glb"), bad = fixture::writeText("bad.glb", "no glTF at all");
    REQUIRE(saveGlb(tinyScene(), good));
    const Image robot = drawnPicture(view, 0).image;
    dropFiles(view, {bad});
    REQUIRE(drawFrame(view));
    CHECK_THAT(view.note, ContainsSubstring("bad.glb"));
    CHECK(view.shown->scene.name == "builtin:robot:2000");
    CHECK(view.state.scene == "builtin:robot:2000");
    REQUIRE(drawFrame(view));
    CHECK(compareImages(robot, drawnPicture(view, 0).image, 0).fraction == 0);
    dropFiles(view, {good, bad});
    REQUIRE(drawFrame(view));
    CHECK(!view.shown->error);
    CHECK(view.shown->scene.name == good);
    CHECK(compareImages(robot, drawnPicture(view, 0).image, 0).fraction > 0.01);
}

TEST_CASE("a clip that the scene lacks is named, and the first one is drawn", "[window]") {
    Viewer& view = freshView();
    const Image first = drawnPicture(view, 0).image;
    view.state.clip = "Swim";
    REQUIRE(drawFrame(view));
    CHECK_THAT(view.note, ContainsSubstring("no clip 'Swim'; there is "));
    CHECK(compareImages(first, drawnPicture(view, 0).image, 0).fraction == 0);
    CHECK(view.state.clip.empty());
    CHECK(view.state.scene == "builtin:robot:2000");
}

TEST_CASE("the window shrinks to a pixel and comes back", "[window]") {
    Viewer& view = freshView();
    const Image before = drawnPicture(view, 0).image;
    resize(view, 1, 1);
    CHECK(drawnPicture(view, 0).image.width == 1);
    resize(view, 640, 300);
    CHECK(compareImages(before, drawnPicture(view, 0).image, 0).fraction == 0);
}

TEST_CASE("a minimised window asks for nothing, its clock rests, and it comes back", "[window]") {
    Viewer& view = freshView();
    if (glfwGetPlatform() != GLFW_PLATFORM_X11) SKIP("only X11 has a window that a test can minimise");
    view.state.playing = true;
    view.stepped = false;
    x11::setMinimised(view.window, true);
    glfwPollEvents();
    const uint64_t posted = view.posted;
    const double seconds = view.state.seconds;
    for (int frame = 0; frame < 2; ++frame) REQUIRE(drawFrame(view));
    CHECK(view.posted == posted);
    CHECK(view.state.seconds == seconds);
    x11::setMinimised(view.window, false);
    for (int frame = 0; frame < 3; ++frame) REQUIRE(drawFrame(view));
    CHECK(view.posted > posted);
    CHECK(view.state.seconds > seconds);
    CHECK(view.state.seconds < seconds + 1);
    view.state.playing = false;
    while (view.shown->request.number < view.posted) REQUIRE(drawFrame(view));
    view.stepped = true;
}

TEST_CASE("the error of a frame is found when it is asked for, and a screenshot written", "[window]") {
    Viewer& view = freshView();
    pressKey(view, ImGuiKey_E);
    for (const History& history : view.history) {
        REQUIRE(history.accuracy.size() == 2);
        CHECK_THAT(history.accuracy[0],
                   ContainsSubstring("accuracy: max_position_error ") && ContainsSubstring(", tolerance 2e-06"));
    }
    pressKey(view, ImGuiKey_F12);
    REQUIRE(view.note.starts_with("written: "));
    CHECK(readPng(view.note.substr(9)).width == 640);
}

TEST_CASE("a case that its device cannot draw says why in its pane", "[window]") {
    Viewer& view = freshView();
    view.state.cases[1] = makeCase("cpu", "cpu");
    REQUIRE(drawFrame(view));
    REQUIRE(view.shown->all[1].error);
    CHECK(view.shown->all[1].error->text == "route cpu draws nothing");
    drawnPicture(view, 0);
}

TEST_CASE("the window closes without a message of the validation", "[window]") {
    Viewer& view = freshView();
    ImGui::GetIO().AddKeyEvent(ImGuiKey_Q, true);
    CHECK(!drawFrame(view));
    CHECK(!drawFrame(view));
    for (const std::string& message : view.messages) FAIL_CHECK(message);
}

TEST_CASE("fonts, panes, the splitter and the pointer follow the density of the display", "[window]") {
    if (const char* wayland = std::getenv("WAYLAND_DISPLAY"); wayland && *wayland)
        SKIP("only X11 has a density that a test can set");
    const x11::Density twice(192);
    windowOfTests.reset();
    Viewer& view = freshView();
    CHECK(ImGui::GetIO().DisplaySize.x == 1280);
    CHECK(view.state.width == 640);  // as it was asked for, so that the next window is no larger
    CHECK(view.scale == 2);
    CHECK(ImGui::GetIO().Fonts->Fonts[0]->FontSize == 26);
    CHECK(view.area.at.y == 38);
    const glm::vec2 body = view.area.at + view.area.size * glm::vec2(0.25f, 0.5f);
    CHECK(drawnPicture(view, 0).image.width == static_cast<uint32_t>(view.area.size.x / 4));  // resolution 0.5 of half
    drag(view, body, body);
    CHECK(view.picked.size() > 4);
    const glm::vec2 middle = view.area.at + view.area.size * 0.5f;
    drag(view, middle + glm::vec2(7, 0), {middle.x * 1.5f, middle.y});
    CHECK(std::abs(view.state.splitter - 0.75f) < 0.02f);
    windowOfTests.reset();
}

TEST_CASE("the program draws, writes and keeps its settings; what is missing is one line", "[window]") {
    const auto run = [](const Words& words, const Words& environment = {}) {
        return finish(start(words, environment, "", SKINVIEW_PROGRAM));
    };
    for (const ApiDevices& api : thisMachine().apis)
        if (api.devices.empty()) SKIP("no driver: " + api.missing);
    const Outcome drawn =
        run({"builtin:robot:2000", "--size", "320x200", "--frames", "2", "--screenshot", "window.png", "--settings",
             fixture::writeText("view.json", R"({"schema": "skinview-settings/1", "copies": 3})")});
    INFO(drawn.err);
    CHECK(drawn.status == 0);
    CHECK(drawn.out.starts_with("two pictures of "));
    CHECK_THAT(drawn.out, ContainsSubstring(", then 1 more in "));
    const Outcome alone = run({"builtin:robot:2000", "--size", "64x48", "--frames", "2", "--no-window", "--screenshot",
                               "two.png", "--settings", "new/view.json"},
                              {"DISPLAY="});
    INFO(alone.err);
    CHECK(alone.status == 0);
    CHECK_THAT(alone.out, ContainsSubstring("of 64 x 48"));
    CHECK(readPng(pathOf("two.png")).width == 128);
    CHECK(readPng(pathOf("window.png")).width == 320);
    const auto begun = readSettings({}, readWholeFile(pathOf("new/view.json")).value_or(""));
    REQUIRE(begun);
    CHECK(begun->width == 64);
    const auto kept = readSettings({}, readWholeFile(pathOf("view.json")).value_or(""));
    REQUIRE(kept);
    CHECK(kept->copies == 3);
    CHECK(kept->width == 320);
    const Words noDrivers = {"VK_DRIVER_FILES=none",
                             "__EGL_VENDOR_LIBRARY_FILENAMES=none"};  // which take time to start
    const std::tuple<Words, Words, int, const char*> bad[] = {
        {{"--frames", "1"}, {"DISPLAY=", "WAYLAND_DISPLAY="}, 1, "no window can be opened: X11"},
        {{"--no-window"}, {}, 2, "name it with --frames"},
        {{"missing.glb", "--frames", "1", "--no-window"}, noDrivers, 2, "missing.glb: there is no such file"},
        {{"--case", "vk/mesh/uc"}, {}, 2, "mesh does not exist on route vk"},
        {{"--settings", fixture::writeText("odd.json", "{}")}, {}, 2, "odd.json: no settings of skinview"},
        {{"--settings", "odd.json/view.json"}, {}, 2, "odd.json/view.json: "},
        {{"--settings", ""}, {}, 2, "--settings: the value is empty; see skinview --help"},
        {{"--mode", "odd"}, {}, 2, "--mode: no 'odd'; there is panes, wipe, one, difference; see skinview --help"},
        {{"--screenshot", "x.jpg"}, {}, 2, "x.jpg"},
    };
    for (const auto& [words, environment, status, part] : bad) {
        const Outcome refused = run(words, environment);
        INFO(part << "\n" << refused.err);
        CHECK(refused.status == status);
        CHECK(linesOf(refused.err).size() == 1);
        CHECK(refused.err.starts_with("skinview: "));
        CHECK_THAT(refused.err, ContainsSubstring(part));
    }
}
