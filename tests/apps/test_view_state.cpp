// What the window shows, without a window: settings, clock, keys, controls, the choice of cases.
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "apps/view/state.h"
#include "common/cases/choices.h"
#include "tests/cases.h"

using namespace skinbench;
using namespace skinbench::view;
using Catch::Matchers::ContainsSubstring;

namespace {

// Backends that draw nothing, and what they can do.
struct BothApis {
    DeviceCaps vulkan = generousCaps(Api::vulkan), opengl = generousCaps(Api::opengl);
    std::string missing;  // OpenGL
    std::vector<std::unique_ptr<Backend>> owned{};

    Backends open() {
        owned.push_back(openNull(vulkan));
        owned.push_back(openNull(opengl));
        return {{Api::vulkan, {owned[owned.size() - 2].get(), ""}},
                {Api::opengl, {missing.empty() ? owned.back().get() : nullptr, missing}}};
    }
};

const Backends& bothApis() {
    static BothApis all;
    static const Backends backends = all.open();
    return backends;
}

ViewState twoCases(const char* a = "vk-ext", const char* b = "gl-ext") {
    ViewState state;
    state.cases = {makeCase(a, "mesh"), makeCase(b, "mesh")};
    return state;
}

// Why the device cannot draw what the word makes of the case.
std::optional<std::string> reasonOf(const Case& c, const Backends& backends, const char* axis, const char* word) {
    const auto then = chosen(c, *findAxis(axis), word);
    REQUIRE(then);
    return reasonAgainst(*then, backends);
}

}  // namespace

TEST_CASE("settings come back as they were kept") {
    ViewState state = twoCases();
    state.scene = "a \"scene\".glb";
    state.cases[1].view = View::meshlets;
    state.active = 1;
    state.linked = false;
    state.mode = Mode::difference;
    state.splitter = 0.3f;
    state.amplify = 9;
    state.clip = "Walk";
    state.seconds = 1.0 / 3;
    state.playing = false;
    state.speed = 0.25;
    state.copies = 30;
    state.fly = true;
    state.camera = {-20.5f, 12, 0.7f, {1, 2, -3}};
    state.overview = {10, -5, 1.5f, {0, 0, 1}};
    state.background = {0.1f, 0.2f, 0.3f};
    state.width = 801;
    state.height = 402;
    state.resolution = 0.5;
    state.dark = false;
    state.panel = false;
    const auto back = readSettings({}, settingsText(state));
    REQUIRE(back);
    CHECK(settingsText(*back) == settingsText(state));
    CHECK(settingsText(*back) != settingsText(ViewState{}));
    CHECK(back->seconds == state.seconds);
    CHECK(back->camera == state.camera);
    CHECK(back->overview == state.overview);
    CHECK(caseId(back->cases[1]) == "gl-ext/mesh/uc/meshopt/redirect+view-meshlets");
    // What a text does not name stays.
    const auto half = readSettings(state, R"({"schema": "skinview-settings/1", "copies": 5, "unknown": [1]})");
    REQUIRE(half);
    CHECK(half->copies == 5);
    CHECK(half->clip == "Walk");
}

TEST_CASE("settings that cannot be are refused by the name of their key") {
    const std::pair<const char*, const char*> bad[] = {
        {"", "JSON"},
        {"[]", "no settings of skinview"},
        {R"({"copies": 2})", "no settings of skinview"},
        {R"("copies": 0)", "'copies' is no number from 1 to 1e+06"},
        {R"("copies": 1.5)", "'copies' is no whole number from 1"},
        {R"("copies": "many")", "'copies' is no"},
        {R"("splitter": 1e9)", "'splitter' is no number from 0 to 1"},
        {R"("linked": 1)", "'linked' is no true or false"},
        {R"("scene": 1)", "'scene' is no text"},
        {R"("mode": "sideways")", "'mode' is none of panes"},
        {R"("case": 1)", "'case' is no case: "},
        {R"("case2": "vk/mesh/uc")", "'case2' is no case: no case has the id 'vk/mesh/uc': mesh does not exist"},
    };
    for (const auto& [text, reason] : bad) {
        const std::string whole =
            *text == '"' ? std::string(R"({"schema": "skinview-settings/1", )") + text + "}" : std::string(text);
        INFO(whole);
        const auto read = readSettings({}, whole);
        REQUIRE(!read);
        CHECK(read.error().fault == Fault::input);
        if (std::string_view(reason) != "JSON") CHECK_THAT(read.error().text, ContainsSubstring(reason));
    }
}

TEST_CASE("the clock goes round the clip, both ways, and rests where there is none") {
    ViewState state;
    state.seconds = 1.9;
    stepClock(state, 0.2, 2);
    CHECK(std::abs(state.seconds - 0.1) < 1e-12);
    state.speed = -2;
    stepClock(state, 0.1, 2);
    CHECK(std::abs(state.seconds - 1.9) < 1e-12);
    stepClock(state, 0.1, 0);
    CHECK(state.seconds == 0);
}

TEST_CASE("cameras: not moved is the usual one, flying keeps the eye, orbiting the target") {
    const Framing framing{{{-1, 0, -1}, {1, 2, 1}}, 1, 640, 360, kUsualYaw};
    const Look usual = lookOf(framing);
    CHECK(movedLook(usual, {}).eye == usual.eye);
    CHECK(movedLook(usual, {}).farthest == usual.farthest);
    const float distance = glm::distance(usual.eye, usual.target);
    const Look turned = movedLook(usual, dragged({}, usual, {0.3f, 0.1f}, false));
    CHECK(turned.target == usual.target);
    CHECK(std::abs(glm::distance(turned.eye, turned.target) - distance) < 1e-4f * distance);
    CHECK(glm::distance(turned.eye, usual.eye) > 0.3f * distance);
    const Look flown = movedLook(usual, dragged({}, usual, {0.3f, 0.1f}, true));
    CHECK(glm::distance(flown.eye, usual.eye) < 1e-3f * distance);
    CHECK(glm::distance(flown.target, usual.target) > 0.3f * distance);
    const Look nearer = movedLook(usual, {.zoom = 0.5f});
    CHECK(std::abs(glm::distance(nearer.eye, usual.target) - distance / 2) < 1e-4f * distance);
    const Look ahead = movedLook(usual, gone({}, usual, {0, 0, 0.25f}));
    CHECK(std::abs(glm::distance(ahead.eye, usual.eye) - distance / 4) < 1e-3f * distance);
    // From straight above there is still an up.
    CHECK(std::isfinite(frameConstants(framing, 0, {.pitch = 89}).viewProjection[0].x));
}

TEST_CASE("controls are the axes that mean something, and a new axis appears by itself") {
    const Case c = makeCase("vk-ext", "mesh");
    const auto before = controlsOf(c);
    for (const Axis& axis : axes()) CHECK(std::ranges::contains(before, &axis) == axis.applies(c));
    CHECK(before.size() > 15);
    Axis extra = *findAxis("cull");
    extra.name = "extra";
    axisTable().push_back(extra);
    const auto after = controlsOf(c);
    axisTable().pop_back();
    CHECK(after.size() == before.size() + 1);
}

TEST_CASE("what a device cannot draw has its reason") {
    BothApis some{.missing = "OpenGL: no device"};
    some.vulkan.nv = {};
    const Backends devices = some.open();
    Case c = makeCase("vk-ext", "mesh");
    CHECK(!reasonOf(c, devices, "route", "vk"));
    CHECK_THAT(reasonOf(c, devices, "route", "vk-nv").value_or(""), ContainsSubstring("has no VK_NV_mesh_shader"));
    CHECK(reasonOf(c, devices, "route", "gl") == "OpenGL: no device");
    CHECK(reasonOf(c, devices, "route", "cpu") == "route cpu draws nothing");
    CHECK_THAT(reasonOf(c, devices, "view", "velocity").value_or(""), ContainsSubstring("velocity"));
    CHECK_THAT(reasonOf(c, devices, "view", "culled").value_or(""), ContainsSubstring("--cluster-cull"));
    c.cull = Cull::compact;
    CHECK(!reasonOf(c, devices, "view", "culled"));
}

TEST_CASE("any value of any axis makes a case that has an id") {
    for (const char* const route : {"vk", "vk-ext", "gl-nv"})
        for (const char* const variant : {"vertex", "compute", "mesh", "mesh-ci", "palette", "cpu"}) {
            if (!runsOn(*findVariant(variant), *findRoute(route))) continue;
            const Case c = makeCase(route, variant);
            for (const Axis* axis : controlsOf(c))
                for (const std::string& word : axis->words) {
                    const auto then = chosen(c, *axis, word);
                    if (!then) continue;
                    INFO(route << " " << variant << " " << axis->name << " " << word);
                    const auto back = parseCaseId(caseId(*then));
                    REQUIRE(back);
                    CHECK(caseId(*back) == caseId(*then));
                    if (!joinsWords(c, *axis) && axis->name != "meshlet_limits") CHECK(axis->get(*then) == word);
                }
        }
}

TEST_CASE("what is chosen holds for both cases where they are linked, but for the route") {
    ViewState state = twoCases();
    choose(state, *findAxis("variant"), "mesh-ci");
    CHECK(caseId(state.cases[0]) == "vk-ext/mesh-ci/uc/meshopt/redirect");
    CHECK(caseId(state.cases[1]) == "gl-ext/mesh-ci/uc/meshopt/redirect");
    CHECK(linkText(state) == "");
    choose(state, *findAxis("route"), "vk");
    CHECK(caseId(state.cases[0]) == "vk/vertex/uc");
    CHECK(caseId(state.cases[1]) == "gl-ext/mesh-ci/uc/meshopt/redirect");
    CHECK(linkText(state) ==
          "linked, but A and B differ in variant (vertex, mesh-ci): gl-ext has no vertex, vk has no mesh-ci");
    // A variant that the route lacks leads to one of the API that has it; what the other case lacks changes this one
    // alone.
    choose(state, *findAxis("variant"), "palette");
    CHECK(caseId(state.cases[1]) == "gl/palette/uc+slots-32");
    choose(state, *findAxis("route"), "vk-ext");
    choose(state, *findAxis("layout"), "fixed");
    CHECK(caseId(state.cases[1]) == "gl/palette/uc+slots-32");
    choose(state, *findAxis("variant"), "compute-mesh");
    CHECK(caseId(state.cases[0]) == "vk-ext/compute-mesh/uc/meshopt/fixed");
    state.linked = false;
    state.active = 1;
    choose(state, *findAxis("codec"), "pc");
    state.active = 0;
    CHECK(linkText(state) == "");
    CHECK(state.cases[0].codec->name == std::string("uc"));
    choose(state, *findAxis("route"), "vk");
    choose(state, *findAxis("variant"), "compute");
    for (const char* word : {"previous", "tangents"}) choose(state, *findAxis("compute"), word);
    CHECK(caseId(state.cases[0]) == "vk/compute/uc+previous+tangents");
    choose(state, *findAxis("compute"), "previous");
    CHECK(caseId(state.cases[0]) == "vk/compute/uc+tangents");
}

TEST_CASE("the first cases are the device's best and the same on the other API") {
    ViewState state;
    chooseCases(state, bothApis());
    CHECK(caseId(state.cases[0]) == "vk-ext/mesh/uc/meshopt/redirect");
    CHECK(caseId(state.cases[1]) == "gl-ext/mesh/uc/meshopt/redirect");
    BothApis some;
    some.opengl.ext = some.opengl.nv = {};
    state = {};
    state.cases[0] = makeCase("vk-ext", "mesh", "pc");
    chooseCases(state, some.open());
    CHECK(caseId(state.cases[1]) == "gl/vertex/pc+pull");
    // A's codec needs meshlets, which the other API does not have.
    state = {};
    state.cases[0] = makeCase("vk-ext", "mesh", "pdc8");
    chooseCases(state, some.open());
    CHECK(caseId(state.cases[1]) == "gl/compute/uc");
    some.missing = "no driver";
    state = {};
    chooseCases(state, some.open());
    CHECK(caseId(state.cases[1]) == caseId(state.cases[0]));
}

TEST_CASE("keys are listed once and step through what a device can draw") {
    std::set<std::string> keys;
    for (const KeyRow& row : keyRows()) CHECK((*row.key == 0 || keys.insert(row.key).second));
    BothApis some;
    some.vulkan.nv = {};
    const Backends devices = some.open();
    ViewState state = twoCases();
    state.linked = false;
    std::set<std::string> routes;
    for (int i = 0; i < 12; ++i) {
        CHECK(pressKey(state, devices, "R") == Ask::nothing);
        routes.insert(state.cases[0].route->name);
    }
    CHECK(routes == std::set<std::string>{"vk", "vk-ext", "gl", "gl-ext", "gl-nv"});
    const std::string here = caseId(state.cases[0]);
    pressKey(state, devices, "V");
    CHECK(caseId(state.cases[0]) != here);
    pressKey(state, devices, "V", true);
    CHECK(caseId(state.cases[0]) == here);
    pressKey(state, devices, "Tab");
    CHECK(state.mode == Mode::one);
    CHECK(state.shown == 0);
    pressKey(state, devices, "Tab");
    CHECK(state.shown == 1);
    CHECK(pressKey(state, devices, "Q") == Ask::close);
    CHECK(pressKey(state, devices, "F9") == Ask::nothing);
}

TEST_CASE("the command measures what is on the screen") {
    ViewState state = twoCases();
    state.scene = "my hero.glb";
    state.cases[0].view = View::weights;
    state.copies = 7;
    state.playing = false;
    state.seconds = 0.25;
    CHECK(benchCommand(state) ==
          "skinbench bench 'my hero.glb' --case vk-ext/mesh/uc/meshopt/redirect --case gl-ext/mesh/uc/meshopt/redirect "
          "--copies 7 --pose frozen --time 0.25");
    state.cases[1] = state.cases[0];
    state.clip = "Walk";
    state.playing = true;
    CHECK(benchCommand(state) ==
          "skinbench bench 'my hero.glb' --case vk-ext/mesh/uc/meshopt/redirect --copies 7 --pose "
          "animated --clip Walk --time 0.25");
}
