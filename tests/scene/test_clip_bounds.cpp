#include <catch2/catch_test_macros.hpp>

#include "common/scene/clip_bounds.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;

namespace {

// One vertex at the origin, moved by a clip.
Scene moved(std::vector<float> times, std::vector<glm::vec4> places) {
    Scene scene;
    scene.skeleton.nodes.resize(1);
    scene.skeleton.joints.resize(1);
    scene.mesh.positions = {{0, 0, 0}};
    scene.mesh.influences = {{{0}, {1}}};
    Clip clip;
    clip.duration = times.back();
    clip.channels.push_back({0, ChannelPath::translation, Interpolation::linear, std::move(times), std::move(places)});
    scene.clips.push_back(std::move(clip));
    return scene;
}

Bounds directly(const Scene& scene, const Clip& clip, const std::vector<float>& times) {
    Bounds all = posedBounds(scene.mesh, poseScene(scene, &clip, times[0]));
    for (const float time : times) {
        const Bounds one = posedBounds(scene.mesh, poseScene(scene, &clip, time));
        all.min = glm::min(all.min, one.min);
        all.max = glm::max(all.max, one.max);
    }
    return all;
}

}  // namespace

TEST_CASE("jumps between evenly spaced moments are inside the bounds") {
    std::vector<float> times;
    std::vector<glm::vec4> places;
    for (int i = 0; i <= 32; ++i) {
        times.push_back(static_cast<float>(i) / 8);
        places.push_back({0, i % 4 == 2 ? 5 : 0, 0, 0});
    }
    const Scene scene = moved(times, places);
    const Bounds bounds = clipBounds(scene, &scene.clips[0]);
    CHECK(bounds.min == glm::vec3(0));
    CHECK(bounds.max == glm::vec3(0, 5, 0));
}

TEST_CASE("frames between the keys are inside the bounds") {
    Scene scene = moved({0, 1}, {{0, 0, 0, 0}, {0, 0, 0, 0}});
    CHECK(clipBounds(scene, &scene.clips[0]).max.y == 0);
    // A spline that leaves both keys upwards.
    scene.clips[0].channels[0].interpolation = Interpolation::cubicSpline;
    scene.clips[0].channels[0].values = {{}, {}, {0, 8, 0, 0}, {0, -8, 0, 0}, {}, {}};
    CHECK(clipBounds(scene, &scene.clips[0]).max.y == 2);
    CHECK(clipBounds(scene, nullptr).max.y == 0);
}

TEST_CASE("the bounds of built-in clips are those of every vertex at every key and sixty times a second") {
    for (const BuiltinScene& builtin : builtinScenes()) {
        INFO(builtin.name);
        const auto made = makeBuiltin(builtin.name, 2'000);
        REQUIRE(made);
        const auto scene = prepareScene(*made, {});
        REQUIRE(scene);
        const Clip& clip = scene->clips.at(0);
        std::vector<float> times;
        for (int frame = 0; frame / 60.0 <= clip.duration; ++frame) times.push_back(static_cast<float>(frame / 60.0));
        for (const Channel& channel : clip.channels)
            times.insert(times.end(), channel.times.begin(), channel.times.end());
        const Bounds wanted = directly(*scene, clip, times), found = clipBounds(*scene, &clip);
        CHECK(found.min == wanted.min);
        CHECK(found.max == wanted.max);
    }
}

TEST_CASE("a clip of very many keys is looked at in some of them, the first and the last among them") {
    std::vector<float> times;
    std::vector<glm::vec4> places;
    for (int i = 0; i < 100'000; ++i) {
        times.push_back(static_cast<float>(i));
        places.push_back({i, 0, 0, 0});
    }
    const Scene scene = moved(times, places);
    const Bounds bounds = clipBounds(scene, &scene.clips[0]);
    CHECK(bounds.min.x == 0);
    CHECK(bounds.max.x == 99'999);
}
