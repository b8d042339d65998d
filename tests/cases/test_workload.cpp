// What a run's cases share, and where the camera puts the copies.
#include <cmath>
#include <limits>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/cases/workload.h"
#include "common/scene/skin_cpu.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

Case meshCase(const char* builder, int influences = 4) {
    Case c;
    c.route = findRoute("vk-ext");
    c.variant = findVariant("mesh");
    c.codec = findCodec("uc");
    c.builder = findBuilder(builder);
    c.layout = findMeshletLayout("redirect");
    c.influences = influences;
    return c;
}

Workload workloadOf(Scene scene, WorkloadSettings settings) {
    auto workload = makeWorkload(std::move(scene), testShaders(), settings);
    REQUIRE(workload);
    return std::move(*workload);
}

bool equalPalettes(const std::vector<PaletteEntry>& a, const std::vector<PaletteEntry>& b) {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i)
        if (a[i].rows != b[i].rows) return false;
    return true;
}

FrameData frameOf(Workload& workload, uint32_t number, int influences = 4) {
    auto frame = makeFrame(workload, influences, number);
    REQUIRE(frame);
    return std::move(*frame);
}

struct Extent {
    glm::vec3 min{std::numeric_limits<float>::max()};
    glm::vec3 max{std::numeric_limits<float>::lowest()};
};

// Normalised device coordinates of a copy's corners, its place in the grid found as the shaders find it.
Extent projected(const FrameConstants& constants, const Bounds& bounds, uint32_t copy, const glm::mat4& view) {
    const auto columns = static_cast<uint32_t>(constants.grid.x);
    const glm::vec3 offset(static_cast<float>(copy % columns) * constants.grid.y,
                           -static_cast<float>(copy / columns) * constants.grid.z, 0);
    Extent extent;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p =
            offset + glm::vec3(corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                               corner & 4 ? bounds.max.z : bounds.min.z);
        const glm::vec4 clip = view * glm::vec4(p, 1);
        REQUIRE(clip.w > 0);
        extent.min = glm::min(extent.min, glm::vec3(clip) / clip.w);
        extent.max = glm::max(extent.max, glm::vec3(clip) / clip.w);
    }
    return extent;
}

Extent projected(const FrameConstants& constants, const Bounds& bounds, uint32_t copy) {
    return projected(constants, bounds, copy, constants.viewProjection);
}

}  // namespace

TEST_CASE("scene, meshlets and encodings are made once and kept") {
    Workload workload = tinyWorkload(2);
    const auto four = sceneFor(workload, 4), eight = sceneFor(workload, 8);
    REQUIRE(four);
    REQUIRE(eight);
    CHECK(*four != *eight);
    CHECK(*sceneFor(workload, 4) == *four);

    const auto first = planInput(workload, meshCase("scan")), again = planInput(workload, meshCase("scan"));
    REQUIRE(first);
    REQUIRE(again);
    CHECK(first->scene == *four);
    CHECK(again->meshlets == first->meshlets);
    CHECK(again->encoded == first->encoded);
    CHECK(first->copies == 2);
    CHECK(first->width == 320);
    CHECK(!first->capture);
    const auto other = planInput(workload, meshCase("meshopt"));
    REQUIRE(other);
    CHECK(other->meshlets != first->meshlets);
    CHECK(other->encoded == first->encoded);  // a codec that needs no meshlets is encoded once for all builders
    Case small = meshCase("scan");
    small.limits = {32, 60};
    CHECK(planInput(workload, small)->meshlets != first->meshlets);
    CHECK(planInput(workload, meshCase("scan", 8))->encoded != first->encoded);
    Case vertex = meshCase("scan");
    vertex.route = findRoute("vk");
    vertex.variant = findVariant("vertex");
    vertex.builder = nullptr;
    vertex.layout = nullptr;
    CHECK(planInput(workload, vertex)->meshlets == nullptr);
    CHECK(planInput(workload, vertex)->encoded == first->encoded);
}

TEST_CASE("the first clip is the default, none is the rest pose, an unknown one names those that exist") {
    Scene scene = tinyScene();
    Clip second = scene.clips[0];
    second.name = "wave";
    scene.clips.push_back(second);
    CHECK(chosenClip(workloadOf(scene, {}))->name == "bend");
    CHECK(chosenClip(workloadOf(scene, {.clip = "none"})) == nullptr);
    {
        const Workload waving = workloadOf(scene, {.clip = "wave"});
        CHECK(chosenClip(waving) == &waving.stored.clips[1]);
    }
    auto unknown = makeWorkload(scene, testShaders(), {.clip = "jump"});
    REQUIRE(!unknown);
    CHECK(unknown.error().fault == Fault::input);
    CHECK(unknown.error().text == "bar: no clip 'jump'; there is bend, wave");
    scene.clips.clear();
    unknown = makeWorkload(scene, testShaders(), {.clip = "jump"});
    REQUIRE(!unknown);
    CHECK(unknown.error().text == "bar: no clip 'jump'; there is none");
    CHECK(chosenClip(workloadOf(scene, {})) == nullptr);
}

TEST_CASE("copies run through the clip with sixteen offsets") {
    const uint32_t copies = 35;
    Workload workload = tinyWorkload(copies);
    const FrameData frame = frameOf(workload, 0);
    REQUIRE(frame.phases.size() == kPhases);
    Workload few = tinyWorkload(3);
    CHECK(frameOf(few, 0).phases.size() == 3);
    for (uint32_t a = 0; a < copies; ++a)
        for (uint32_t b = 0; b < copies; ++b) {
            INFO(a << " " << b);
            const bool equal = equalPalettes(paletteOfCopy(frame, a), paletteOfCopy(frame, b));
            CHECK(equal == (a % kPhases == b % kPhases));
        }
    const float duration = workload.stored.clips[0].duration;
    for (uint32_t copy : {0u, 5u, 20u}) {
        const auto offset = duration * static_cast<float>(copy % kPhases) / static_cast<float>(kPhases);
        const Palette wanted = poseScene(workload.stored, chosenClip(workload), 0.4f + offset);
        CHECK(equalPalettes(paletteOfCopy(frame, copy), wanted));
    }
}

TEST_CASE("a frozen pose gives equal frames, an animated one different ones") {
    for (bool animated : {false, true}) {
        Workload workload = workloadOf(tinyScene(), {.animated = animated, .copies = 3});
        const FrameData first = frameOf(workload, 0), later = frameOf(workload, 9), again = frameOf(workload, 9);
        for (uint32_t copy = 0; copy < 3; ++copy) {
            CHECK(equalPalettes(paletteOfCopy(first, copy), paletteOfCopy(later, copy)) == !animated);
            CHECK(equalPalettes(paletteOfCopy(later, copy), paletteOfCopy(again, copy)));
        }
        CHECK(first.constants.viewProjection == later.constants.viewProjection);
        CHECK(first.constants.grid.w == 0);
        CHECK(later.constants.grid.w == 9);
    }
    // Without a clip nothing moves.
    Workload still = workloadOf(tinyScene(), {.clip = "none", .copies = 3});
    CHECK(equalPalettes(frameOf(still, 0).phases[0], frameOf(still, 30).phases[0]));
}

TEST_CASE("frames are sixty a second") {
    Workload workload = workloadOf(tinyScene(), {.seconds = 0.25f});
    const FrameData frame = frameOf(workload, 30);
    CHECK(equalPalettes(frame.phases[0], poseScene(workload.stored, chosenClip(workload), 0.75f)));
}

TEST_CASE("every copy stands inside the view, the first one at the top left") {
    auto biped = makeBuiltin("biped", 2000);
    auto creature = makeBuiltin("creature", 3000);
    REQUIRE(biped);
    REQUIRE(creature);
    for (const Scene& scene : {tinyScene(), *biped, *creature})
        for (auto [width, height] : {std::pair{1920u, 1080u}, {320u, 180u}, {200u, 900u}})
            for (uint32_t copies : {1u, 2u, 7u, 200u}) {
                INFO(scene.name << " " << copies << " " << width << "x" << height);
                Workload workload = workloadOf(scene, {.copies = copies, .width = width, .height = height});
                const FrameData frame = frameOf(workload, 17);
                const Mesh& mesh = workload.prepared[4]->mesh;
                Extent all;
                for (uint32_t copy = 0; copy < copies; ++copy) {
                    const Bounds bounds = posedBounds(mesh, paletteOfCopy(frame, copy));
                    const Extent extent = projected(frame.constants, bounds, copy);
                    all.min = glm::min(all.min, extent.min);
                    all.max = glm::max(all.max, extent.max);
                }
                CHECK(all.min.x >= -1);
                CHECK(all.max.x <= 1);
                CHECK(all.min.y >= -1);
                CHECK(all.max.y <= 1);
                CHECK(all.min.z >= 0);
                CHECK(all.max.z <= 1);
                // Just inside: a crowd nearly fills one side or the other.
                if (copies == 200) CHECK(std::max(all.max.x - all.min.x, all.max.y - all.min.y) > 1.4f);
            }
}

TEST_CASE("the camera is that of the whole clip, whatever moment and however many copies are drawn") {
    Workload run = workloadOf(tinyScene(), {.animated = true, .copies = 7});
    Workload picture = workloadOf(tinyScene(), {.animated = false, .seconds = 1.3f, .copies = 7});
    CHECK(frameOf(run, 0).constants.viewProjection == frameOf(picture, 0).constants.viewProjection);
    CHECK(frameOf(run, 0).constants.grid == frameOf(picture, 0).constants.grid);
    Workload one = workloadOf(tinyScene(), {});
    frameOf(one, 0);
    CHECK(one.bounds.at(4).min == run.bounds.at(4).min);
    CHECK(one.bounds.at(4).max == run.bounds.at(4).max);
}

TEST_CASE("copies go right and down, and y points down") {
    Workload workload = tinyWorkload(7);
    const FrameData frame = frameOf(workload, 0);
    const Bounds bounds = workload.bounds[4];
    const auto columns = static_cast<uint32_t>(frame.constants.grid.x);
    REQUIRE(columns > 1);
    REQUIRE(columns < 7);
    const Extent first = projected(frame.constants, bounds, 0), right = projected(frame.constants, bounds, 1),
                 below = projected(frame.constants, bounds, columns);
    CHECK(right.min.x > first.min.x);
    CHECK(below.min.y > first.min.y);
    for (uint32_t copy = 1; copy < 7; ++copy) {
        const Extent extent = projected(frame.constants, bounds, copy);
        CHECK(extent.min.x >= first.min.x - 1e-5f);
        CHECK(extent.min.y >= first.min.y - 1e-5f);
    }
    auto height = [&](float y) {
        const glm::vec4 clip = frame.constants.viewProjection * glm::vec4(0, y, 0, 1);
        return clip.y / clip.w;
    };
    CHECK(height(1) < height(0));
    // Nearer is smaller in depth: the camera looks from +z.
    auto depth = [&](float z) {
        const glm::vec4 clip = frame.constants.viewProjection * glm::vec4(0, 0, z, 1);
        return clip.z / clip.w;
    };
    CHECK(depth(0.1f) < depth(-0.1f));
}

TEST_CASE("a turned character stays in the view") {
    auto creature = makeBuiltin("creature", 3000);
    REQUIRE(creature);
    for (float yaw : {25.0f, 90.0f, -135.0f, 180.0f, 360.0f}) {
        Workload workload = workloadOf(*creature, {.width = 640, .height = 360, .yaw = yaw});
        const FrameData frame = frameOf(workload, 0);
        const SkinnedReference posed = skinReference(workload.prepared[4]->mesh, frame.phases[0]);
        INFO(yaw);
        bool inside = true;
        for (const glm::dvec3& p : posed.positions) {
            const glm::vec4 clip = frame.constants.viewProjection * glm::vec4(glm::vec3(p), 1);
            inside = inside && clip.w > 0 && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w && clip.z >= 0 &&
                     clip.z <= clip.w;
        }
        CHECK(inside);
    }
}

TEST_CASE("what leaves the image is counted") {
    Workload workload = workloadOf(tinyScene(), {.copies = 40, .width = 640, .height = 360});
    CHECK(inView(workload, 4)->vertices == 1.0);
    CHECK(inView(workload, 4)->triangles == 1.0);
    CHECK(inView(workload, 4)->copies == 1.0);
    Workload one = workloadOf(tinyScene(), {.width = 640, .height = 360});
    CHECK(inView(one, 4)->vertices == 1.0);
    // A view of a quarter of the character.
    Bounds& bounds = one.bounds[4];
    const glm::vec3 middle = (bounds.min + bounds.max) * 0.5f;
    bounds = {glm::mix(middle, bounds.min, 0.25f), glm::mix(middle, bounds.max, 0.25f)};
    const auto seen = inView(one, 4);
    REQUIRE(seen);
    CHECK(seen->vertices < 0.7);
    CHECK(seen->vertices > 0);
    // A triangle may be seen with all its corners outside, not the other way round.
    CHECK(seen->triangles > seen->vertices / 2);
    CHECK(seen->triangles < 1);
    CHECK(seen->copies == 1.0);
}

TEST_CASE("cameras have less in view than the crowd, or all of it at one place") {
    const auto share = [](Camera camera) {
        Workload workload = workloadOf(tinyScene(), {.copies = 60, .width = 640, .height = 360, .camera = camera});
        return inView(workload, 4)->vertices;
    };
    CHECK(share(Camera::crowd) == 1.0);
    CHECK(share(Camera::close) == 1.0);
    CHECK(share(Camera::half) > 0.35);
    CHECK(share(Camera::half) < 0.65);
    CHECK(share(Camera::inside) > 0.02);
    CHECK(share(Camera::inside) < 0.4);
    Workload half = workloadOf(tinyScene(), {.copies = 60, .width = 640, .height = 360, .camera = Camera::half});
    CHECK(inView(half, 4)->copies < 1);
    CHECK(inView(half, 4)->copies > share(Camera::half));
    Workload close = workloadOf(tinyScene(), {.copies = 60, .width = 640, .height = 360, .camera = Camera::close});
    Workload one = workloadOf(tinyScene(), {.width = 640, .height = 360});
    const FrameConstants together = frameOf(close, 0).constants;
    CHECK(together.grid.y == 0);
    CHECK(together.grid.z == 0);
    // As large as a single one is drawn, but for the clips' bounds.
    CHECK(std::abs(together.viewProjection[1].y / frameOf(one, 0).constants.viewProjection[1].y - 1) < 0.2f);
}

TEST_CASE("the camera inside sees copies however short their rows are") {
    // As wide as eight bars side by side: few of them make a row.
    Scene wide = tinyScene();
    const Mesh bar = wide.mesh;
    for (int i = 1; i < 8; ++i) {
        const auto first = static_cast<uint32_t>(wide.mesh.positions.size());
        for (const glm::vec3& p : bar.positions) wide.mesh.positions.push_back(p + glm::vec3(i * 3, 0, 0));
        wide.mesh.normals.insert(wide.mesh.normals.end(), bar.normals.begin(), bar.normals.end());
        wide.mesh.uvs.insert(wide.mesh.uvs.end(), bar.uvs.begin(), bar.uvs.end());
        wide.mesh.influences.insert(wide.mesh.influences.end(), bar.influences.begin(), bar.influences.end());
        for (uint32_t index : bar.indices) wide.mesh.indices.push_back(first + index);
    }
    for (const Scene& scene : {tinyScene(), wide})
        for (uint32_t copies : {1u, 2u, 5u, 20u}) {
            INFO(scene.mesh.indices.size() << " indices, " << copies << " copies");
            Workload workload =
                workloadOf(scene, {.copies = copies, .width = 640, .height = 360, .camera = Camera::inside});
            CHECK(inView(workload, 4)->triangles > 0.1);
        }
}

// How many copies have a place on the upright line through their middle in that view.
static uint32_t copiesSeen(FrameConstants constants, const Bounds& bounds, uint32_t copies, const glm::mat4& view) {
    constants.viewProjection = view;
    uint32_t seen = 0;
    for (uint32_t copy = 0; copy < copies; ++copy) {
        bool any = false;
        for (int step = 0; step <= 40; ++step) {
            glm::dvec3 place = glm::dvec3(bounds.min + bounds.max) * 0.5;
            place.y = glm::mix(bounds.min.y, bounds.max.y, static_cast<float>(step) / 40);
            const glm::dvec4 clip = clipPosition(constants, copy, place);
            any = any || (clip.w > 0 && std::abs(clip.x) < clip.w && std::abs(clip.y) < clip.w && clip.z > 0 &&
                          clip.z < clip.w);
        }
        seen += any;
    }
    return seen;
}

TEST_CASE("the overview moves by itself") {
    Workload workload = workloadOf(tinyScene(), {.copies = 9, .width = 640, .height = 360});
    const FrameConstants usual = frameOf(workload, 0).constants;
    workload.settings.move = {.turn = 20, .zoom = 2};
    const FrameConstants moved = frameOf(workload, 0).constants;
    CHECK(moved.viewProjection != usual.viewProjection);
    CHECK(moved.overview == usual.overview);
    workload.settings = {.copies = 9, .width = 640, .height = 360, .overview = {.turn = 20}};
    const FrameConstants turned = frameOf(workload, 0).constants;
    CHECK(turned.viewProjection == usual.viewProjection);
    CHECK(turned.overview != usual.overview);
}

TEST_CASE("the other views look at the copies from directions of their own, and the overview at all of them") {
    auto creature = makeBuiltin("creature", 3000);  // longer than it is wide
    REQUIRE(creature);
    for (const Scene& scene : {tinyScene(), *creature})
        for (uint32_t copies : {1u, 37u})
            for (Camera camera : {Camera::crowd, Camera::half, Camera::inside, Camera::close}) {
                Workload workload =
                    workloadOf(scene, {.copies = copies, .width = 640, .height = 360, .camera = camera});
                const FrameConstants constants = frameOf(workload, 0).constants;
                const Bounds bounds = workload.bounds[4];
                std::vector<glm::mat4> views{constants.viewProjection};
                views.insert(views.end(), std::begin(constants.otherViews), std::end(constants.otherViews));
                glm::vec3 least(1), most(-1);
                for (uint32_t copy = 0; copy < copies; ++copy) {
                    const Extent extent = projected(constants, bounds, copy, constants.overview);
                    CHECK(glm::all(glm::lessThan(extent.max, glm::vec3(1))));
                    CHECK(glm::all(glm::greaterThan(extent.min, glm::vec3(-1, -1, 0))));
                    least = glm::min(least, extent.min);
                    most = glm::max(most, extent.max);
                }
                // Together they reach two opposite edges, but for the room between copies.
                CHECK(std::max(most.x - least.x, most.y - least.y) > 1.7f);
                for (size_t view = 0; view < views.size(); ++view) {
                    INFO(scene.name << ", " << copies << " copies, camera "
                                    << cameraNames()[static_cast<size_t>(camera)] << ", view " << view);
                    for (size_t other = 0; other < view; ++other) CHECK(views[view] != views[other]);
                    CHECK(copiesSeen(constants, bounds, copies, views[view]) > 0);
                    if (camera == Camera::half || camera == Camera::inside) continue;
                    for (uint32_t copy = 0; copy < copies; ++copy) {
                        const Extent extent = projected(constants, bounds, copy, views[view]);
                        CHECK(glm::all(glm::lessThan(extent.max, glm::vec3(1))));
                        CHECK(glm::all(glm::greaterThan(extent.min, glm::vec3(-1, -1, 0))));
                    }
                }
            }
}
