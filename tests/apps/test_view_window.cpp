// The window itself, on a display (tools/with_display): what it shows is compared with what `render` draws, and input
// is given to it as a person's would be. One window for all tests, as a driver's start costs more than a frame.
#include <fstream>
#include <set>
#include <thread>

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <stb_image.h>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "apps/view/view.h"
#include "common/measure/drawing.h"
#include "tests/apps/program_call.h"
#include "tests/cases.h"

using namespace skinbench;
using namespace skinbench::view;
using namespace program;
using Catch::Matchers::ContainsSubstring;

namespace {

bool underValidation() { return std::getenv("SKINBENCH_NO_VALIDATION") == nullptr; }

std::unique_ptr<Viewer>& openedView() {
    static std::unique_ptr<Viewer> view;
    if (view) return view;
    ViewOptions options;
    options.state.scene = "builtin:robot:2000";
    options.state.width = 640;
    options.state.height = 300;
    options.state.resolution = 0.5;
    options.renderer.validation = underValidation();
    options.stepped = true;
    options.folder = fixture::temporaryFolder().string();
    auto opened = openView(options);
    if (!opened) FAIL(opened.error().text);
    view = std::move(*opened);
    return view;
}

// The window as it was opened.
Viewer& freshView() {
    Viewer& view = *openedView();
    view.state = {.scene = "builtin:robot:2000", .playing = false, .width = 640, .height = 300, .resolution = 0.5};
    ImGui::GetIO().ConfigInputTrickleEventQueue = false;
    REQUIRE(drawFrame(view));
    if (!view.shown->error.empty()) FAIL(view.shown->error);
    for (const auto& [api, caps] : view.renderer->devices())
        if (!caps.missing.empty()) SKIP("no driver: " + caps.missing);
    return view;
}

const Drawn& drawnPicture(const Viewer& view, size_t pane) {
    const Drawn& picture = view.shown->pictures[pane];
    INFO(picture.id << ": " << picture.error);
    REQUIRE(picture.error.empty());
    REQUIRE(picture.image.width == view.size.x);
    return picture;
}

void press(Viewer& view, ImGuiKey key, bool shift = false) {
    ImGuiIO& io = ImGui::GetIO();
    if (shift) io.AddKeyEvent(ImGuiMod_Shift, true);
    io.AddKeyEvent(key, true);
    REQUIRE(drawFrame(view));
    io.AddKeyEvent(key, false);
    if (shift) io.AddKeyEvent(ImGuiMod_Shift, false);
    REQUIRE(drawFrame(view));
}

void drag(Viewer& view, glm::vec2 from, glm::vec2 to) {
    ImGuiIO& io = ImGui::GetIO();
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

TEST_CASE("both panes show what render draws at that moment", "[window]") {
    Viewer& view = freshView();
    view.state.playing = true;
    view.state.seconds = 0.3;
    for (int frame = 0; frame < 3; ++frame) REQUIRE(drawFrame(view));
    CHECK(view.shown->number == view.posted);
    CHECK(view.shown->seconds > 0.3);
    for (size_t pane = 0; pane < 2; ++pane) {
        const Drawn& picture = drawnPicture(view, pane);
        const std::string path = pathOf("pane.png");
        const Outcome drawn = call({"render", "builtin:robot:2000", "--case", picture.id, "--time",
                                    std::format("{}", view.shown->seconds), "--size",
                                    std::format("{}x{}", view.size.x, view.size.y), "-o", path});
        INFO(drawn.err);
        REQUIRE(drawn.status == 0);
        CHECK(compareImages(readPng(path), picture.image, 0).fraction == 0);
    }
    CHECK(view.shown->cases[0].route->api != view.shown->cases[1].route->api);
    // The pictures are of this frame: at another moment they are others.
    const auto before = view.shown;
    REQUIRE(drawFrame(view));
    for (size_t pane = 0; pane < 2; ++pane)
        CHECK(compareImages(before->pictures[pane].image, view.shown->pictures[pane].image, 0).fraction > 0.001);
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
    press(view, ImGuiKey_D);
    REQUIRE(view.shown->difference);
    CHECK(view.shown->difference->pixels == 0);
    CHECK(view.shown->difference->largest == 0);
    view.state.cases[1].view = View::meshlets;
    REQUIRE(drawFrame(view));
    CHECK(view.shown->difference->pixels > 500);
    CHECK(view.shown->difference->largest > 50);
    press(view, ImGuiKey_D);
    CHECK(view.state.mode == Mode::panes);
    CHECK(!view.shown->difference);
}

TEST_CASE("keys lead through every route and variant that a device can draw", "[window]") {
    Viewer& view = freshView();
    view.state.linked = false;
    const CapsByApi& devices = view.renderer->devices();
    std::set<std::string> routesWanted, variantsWanted, routesSeen, variantsSeen, seen;
    for (const Route& route : routes())
        for (const Variant& variant : variants())
            if (runsOn(variant, route) && !reasonAgainst(makeCase(route.name, variant.name), devices)) {
                routesWanted.insert(route.name);
                variantsWanted.insert(variant.name);
            }
    for (size_t route = 0; route < routes().size(); ++route) {
        for (size_t variant = 0; variant < variants().size(); ++variant) {
            const Drawn& picture = drawnPicture(view, 0);
            if (!seen.insert(picture.id).second) break;
            INFO(picture.id);
            CHECK(coveredFraction(picture.image) > 0.02);
            routesSeen.insert(view.shown->cases[0].route->name);
            variantsSeen.insert(view.shown->cases[0].variant->name);
            press(view, ImGuiKey_V);
        }
        press(view, ImGuiKey_R);
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
        CHECK(compareImages(before->pictures[pane].image, drawnPicture(view, pane).image, 0).fraction > 0.01);
    press(view, ImGuiKey_Home);
    CHECK(compareImages(before->pictures[0].image, drawnPicture(view, 0).image, 0).fraction == 0);
    // A click says what lies there: the middle of A's pane is the robot's body.
    const glm::vec2 body = view.panes[0].at + view.panes[0].size * 0.5f;
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
    REQUIRE(drawFrame(view));
    CHECK(coveredFraction(drawnPicture(view, 0).image) > 0.02);
    const std::vector<LegendRow>& legend = drawnPicture(view, 0).legend;
    REQUIRE(legend.size() == 4);
    CHECK_THAT(legend[0].text, ContainsSubstring("drawn: ") && ContainsSubstring(" triangles"));
    CHECK_THAT(legend[1].text, ContainsSubstring(" meshlets (0.0 %)"));  // the robot is in the view
    CHECK_THAT(legend[3].text, ContainsSubstring("back faces: ") && !ContainsSubstring("back faces: 0 "));
    CHECK(drawnPicture(view, 1).legend.empty());
}

TEST_CASE("a dropped file is shown, and a bad one leaves the scene as it is", "[window]") {
    Viewer& view = freshView();
    const std::string good = pathOf("tiny.glb"), bad = fixture::writeText("bad.glb", "no glTF at all");
    REQUIRE(saveGlb(tinyScene(), good));
    const Image robot = drawnPicture(view, 0).image;
    dropFiles(view, {bad});
    REQUIRE(drawFrame(view));
    CHECK_THAT(view.note, ContainsSubstring("bad.glb"));
    CHECK(view.shown->scene == "builtin:robot:2000");
    CHECK(view.state.scene == "builtin:robot:2000");
    REQUIRE(drawFrame(view));
    CHECK(compareImages(robot, drawnPicture(view, 0).image, 0).fraction == 0);
    dropFiles(view, {good, bad});
    REQUIRE(drawFrame(view));
    CHECK(view.shown->error.empty());
    CHECK(view.shown->scene == good);
    CHECK(compareImages(robot, drawnPicture(view, 0).image, 0).fraction > 0.01);
}

TEST_CASE("the window shrinks to a pixel and comes back", "[window]") {
    Viewer& view = freshView();
    const Image before = drawnPicture(view, 0).image;
    resize(view, 1, 1);
    CHECK(drawnPicture(view, 0).image.width == 1);
    resize(view, 640, 300);
    CHECK(compareImages(before, drawnPicture(view, 0).image, 0).fraction == 0);
}

TEST_CASE("the error of a frame is found when it is asked for, and a screenshot written", "[window]") {
    Viewer& view = freshView();
    press(view, ImGuiKey_E);
    for (const std::string& text : view.accuracy)
        CHECK_THAT(text, ContainsSubstring("of the diagonal (allowed: 2e-06)"));
    press(view, ImGuiKey_F12);
    REQUIRE(view.note.starts_with("written: "));
    CHECK(readPng(view.note.substr(9)).width == 640);
}

TEST_CASE("a case that its device cannot draw says why in its pane", "[window]") {
    Viewer& view = freshView();
    view.state.cases[1] = makeCase("cpu", "cpu");
    REQUIRE(drawFrame(view));
    CHECK(view.shown->pictures[1].error == "route cpu draws nothing");
    drawnPicture(view, 0);
}

TEST_CASE("requests that are on the way together have the pictures of their own moments", "[window]") {
    freshView();  // skips without drivers
    Renderer renderer({.validation = underValidation(), .every = true});
    const std::array<std::array<Case, 2>, 4> cases = {{{makeCase("vk", "compute"), makeCase("gl", "vertex")},
                                                       {makeCase("gl", "compute"), makeCase("gl", "vertex")},
                                                       {makeCase("vk", "cpu"), makeCase("vk", "compute")},
                                                       {makeCase("gl", "cpu"), makeCase("cpu", "cpu")}}};
    std::vector<Request> requests;
    for (const auto& pair : cases)
        for (const double seconds : {0.0, 0.2, 0.4}) {
            ViewState state{.scene = "builtin:robot:2000", .cases = pair, .mode = Mode::difference, .seconds = seconds};
            requests.push_back({requests.size() + 1, state, 96, 64, requests.size() == 4, Pick{1, {0.5f, 0.5f}}});
        }
    for (const Request& request : requests) renderer.post(request);
    std::vector<std::shared_ptr<const Shown>> together;
    while (together.size() < requests.size()) together.push_back(renderer.wait());
    for (size_t i = 0; i < requests.size(); ++i) {
        CAPTURE(i);
        renderer.post(requests[i]);
        const auto alone = renderer.wait();
        CHECK(together[i]->number == requests[i].number);
        CHECK(together[i]->seconds == requests[i].state.seconds);
        for (const std::string& message : together[i]->messages) FAIL_CHECK(message);
        CHECK(together[i]->difference.has_value() == (i < 9));
        for (size_t pane = 0; pane < 2; ++pane) {
            const Drawn &one = alone->pictures[pane], &other = together[i]->pictures[pane];
            CHECK(one.error == other.error);
            CHECK(one.image.rgba == other.image.rgba);
            CHECK(one.picked == other.picked);
            CHECK(one.accuracy.empty() == (i != 4));
            CHECK(one.passes.size() == other.passes.size());
            if (i % 3 && one.error.empty()) CHECK(one.image.rgba != together[i - 1]->pictures[pane].image.rgba);
        }
    }
}

TEST_CASE("a request that has not begun gives way to the next one, which asks for all that both did", "[window]") {
    freshView();
    Renderer renderer({});
    const ViewState state{.scene = "builtin:robot:2000"};
    renderer.post({1, state, 64, 48, true, {}});  // begins once the drivers have started
    renderer.post({2, state, 64, 48, false, Pick{0, {0.5f, 0.5f}}});
    renderer.post({3, state, 64, 48, false, {}});
    auto answer = renderer.wait();
    if (answer->number == 1) answer = renderer.wait();
    CHECK(answer->number == 3);
    CHECK_FALSE(answer->pictures[0].picked.empty());
    CHECK(renderer.take() == nullptr);
}

TEST_CASE("the window closes without a message of the validation", "[window]") {
    Viewer& view = freshView();
    ImGui::GetIO().AddKeyEvent(ImGuiKey_Q, true);
    CHECK(!drawFrame(view));
    CHECK(!drawFrame(view));
    for (const std::string& message : view.messages) FAIL_CHECK(message);
    openedView().reset();
}

TEST_CASE("the program draws, writes and keeps its settings; what is missing is one line", "[window]") {
    const auto run = [](const Words& words, const Words& environment = {}) {
        return finish(start(words, environment, "", SKINVIEW_PROGRAM));
    };
    const auto probe = fixture::json::parse(call({"probe", "--json"}).out, nullptr, false);
    REQUIRE(probe.is_object());
    if (probe["auto"]["route"] == "cpu") SKIP("no driver");
    const Outcome drawn =
        run({"builtin:robot:2000", "--size", "320x200", "--frames", "2", "--screenshot", "window.png", "--settings",
             fixture::writeText("view.json", R"({"schema": "skinview-settings/1", "copies": 3})")});
    INFO(drawn.err);
    CHECK(drawn.status == 0);
    CHECK(drawn.out.starts_with("two pictures of "));
    CHECK_THAT(drawn.out, ContainsSubstring(", then 1 more in "));
    const Outcome alone =
        run({"builtin:robot:2000", "--size", "64x48", "--frames", "2", "--no-window", "--screenshot", "two.png"},
            {"DISPLAY="});
    INFO(alone.err);
    CHECK(alone.status == 0);
    CHECK_THAT(alone.out, ContainsSubstring("of 64 x 48"));
    CHECK(readPng(pathOf("two.png")).width == 128);
    CHECK(readPng(pathOf("window.png")).width == 320);
    const auto kept = readSettings({}, readWholeFile(pathOf("view.json")).value_or(""));
    REQUIRE(kept);
    CHECK(kept->copies == 3);
    CHECK(kept->width == 320);
    const std::tuple<Words, Words, int, const char*> bad[] = {
        {{"--frames", "1"}, {"DISPLAY=", "WAYLAND_DISPLAY="}, 1, "no window can be opened: X11"},
        {{"--no-window"}, {}, 2, "name it with --frames"},
        {{"missing.glb", "--frames", "1"}, {}, 2, "missing.glb: there is no such file"},
        {{"--case", "vk/mesh/uc"}, {}, 2, "mesh does not exist on route vk"},
        {{"--settings", "none.json"}, {}, 2, "none.json: No such file or directory"},
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

// Not run by itself: view_tests "[memory]" prints what is resident while the window's cases change, and while the same
// plans are made and given back without a window.
TEST_CASE("a thousand changes of the case", "[.memory]") {
    const auto resident = [] {
        std::ifstream file("/proc/self/statm");
        size_t pages = 0;
        file >> pages >> pages;
        return pages * static_cast<size_t>(sysconf(_SC_PAGESIZE)) >> 10;
    };
    const char* const asked = std::getenv("SKINBENCH_CHANGES");
    const int changes = asked ? std::atoi(asked) : 1000;
    const std::array cases = {makeCase("vk-ext", "mesh"), makeCase("vk", "compute"), makeCase("gl", "vertex"),
                              makeCase("gl-ext", "mesh")};
    std::string window, loop;
    ViewState state{.scene = "builtin:robot:2000", .linked = false, .playing = false};
    {
        Renderer renderer({});
        for (int i = 0; i < changes; ++i) {
            state.cases = {cases[i % 4], cases[(i + 1) % 4]};
            renderer.post({static_cast<uint64_t>(i + 1), state, 160, 90, false, {}});
            REQUIRE(renderer.wait()->pictures[0].error.empty());
            if ((i + 1) % (changes / 5) == 0) window += std::format(" {}", resident());
        }
    }
    std::thread([&] {
        auto workload = openWorkload(state.scene, {.width = 160, .height = 90});
        auto devices = openDevices({cases[0].route, cases[2].route}, "", false);
        for (int i = 0; workload && devices && i < changes * 2; ++i) {
            const Case& c = cases[i % 4];
            auto planned = planCase(*workload, c, devices->byApi[c.route->api].backend, false);
            auto ready =
                planned ? prepareCase(std::move(*planned)) : Result<Prepared>(std::unexpected(planned.error()));
            if (ready) releaseCase(*ready);
            if ((i + 1) % (changes * 2 / 5) == 0) loop += std::format(" {}", resident());
        }
    }).join();
    WARN("KiB resident, renderer:" << window << "; prepare and release alone:" << loop);
}
