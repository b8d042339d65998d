// Files that once went wrong, of ../shared/faults or $SKINBENCH_FAULTS; skipped where neither is there.
#include <algorithm>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/scene/clip_bounds.h"
#include "common/scene/skin_cpu.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

std::string fault(const std::string& name) {
    const char* given = std::getenv("SKINBENCH_FAULTS");
    const std::string folder = given ? given : SKINBENCH_SOURCE_DIR "/../shared/faults";
    if (!std::filesystem::exists(folder)) SKIP("no files in " << folder << "; set SKINBENCH_FAULTS");
    return folder + "/" + name;
}

Scene loadFault(const std::string& name) {
    auto scene = loadScene(fault(name));
    INFO(name << ": " << (scene ? "" : scene.error().text));
    REQUIRE(scene);
    return std::move(*scene);
}

bool warns(const Scene& scene, const std::string& text) {
    return std::ranges::any_of(scene.warnings, [&](const std::string& w) { return w.find(text) != w.npos; });
}

std::string refusal(const std::string& name) {
    const auto scene = loadScene(fault(name));
    REQUIRE_FALSE(scene);
    CHECK(scene.error().fault == Fault::input);
    CHECK(scene.error().text.size() < 400);
    return scene.error().text;
}

}  // namespace

TEST_CASE("what is ignored or hidden is said") {
    const Scene rigid = loadFault("skin_without_attributes_all.glb");
    CHECK(warns(rigid, "1 primitive has a skin but no JOINTS_0"));
    CHECK_FALSE(checkSkinned(rigid));
    const Scene hidden = loadFault("node_visibility.glb");
    CHECK(hidden.parts.size() == 1);
    CHECK(warns(hidden, "hidden by KHR_node_visibility"));
}

TEST_CASE("a mirrored armature is wound by its mesh's node") {
    const Scene mirrored = loadFault("mirrored_armature.glb"), plain = loadFault("end_pose.glb");
    REQUIRE(mirrored.mesh.indices.size() == plain.mesh.indices.size());
    CHECK(mirrored.mesh.indices[1] == plain.mesh.indices[2]);
    CHECK(mirrored.mesh.indices[2] == plain.mesh.indices[1]);
    CHECK(mirrored.warnings.empty());
}

TEST_CASE("the end of a clip is its last pose") {
    const Scene scene = loadFault("end_pose.glb");
    const Clip& clip = scene.clips.at(0);
    const auto at = [&](float t) { return skinReference(scene.mesh, poseScene(scene, &clip, t)).positions; };
    const auto end = at(clip.duration), before = at(clip.duration * 0.9999f), start = at(0);
    double near = 0, far = 0;
    for (size_t v = 0; v < end.size(); ++v) {
        near = std::max(near, glm::distance(end[v], before[v]));
        far = std::max(far, glm::distance(end[v], start[v]));
    }
    CHECK(near < 0.01);
    CHECK(far > 0.1);
}

TEST_CASE("eight jumps of a clip are all in its bounds") {
    const auto scene = prepareScene(loadFault("eight_jumps.glb"), {});
    REQUIRE(scene);
    const Clip& clip = scene->clips.at(0);
    const Bounds bounds = clipBounds(*scene, &clip);
    for (const float time : clip.channels.at(0).times) {
        const Bounds posed = posedBounds(scene->mesh, poseScene(*scene, &clip, time));
        CHECK(glm::all(glm::lessThanEqual(bounds.min, posed.min)));
        CHECK(glm::all(glm::greaterThanEqual(bounds.max, posed.max)));
    }
}

TEST_CASE("files that other readers read are read") {
    const Scene packed = loadFault("meshopt_khr_required.glb");
    CHECK(packed.mesh.positions.size() == 289);
    CHECK(packed.warnings.empty());  // its weights sum to 1
    CHECK(loadFault("byte_stride_zero.glb").mesh.positions == loadFault("end_pose.glb").mesh.positions);
    CHECK(loadFault("second_skin_empty.glb").mesh.positions.size() == 289);
    CHECK(loadFault("uri_backslash.gltf").mesh.positions.size() == 289);
    const Scene shared = loadFault("shared_100k_x400_meshes.glb");
    CHECK(shared.parts.size() == 400);
    CHECK(shared.mesh.positions.size() < 400 * 1000);
}

TEST_CASE("files that ask for much are refused in one line or load small") {
    CHECK_THAT(refusal("fuzz/two_kB_asks_8_GB.glb"), ContainsSubstring("asks for more memory"));
    CHECK_THAT(refusal("fuzz/two_kB_asks_1_GiB_meshopt.glb"), ContainsSubstring("two_kB_asks_1_GiB_meshopt.glb: "));
    CHECK_THAT(refusal("fuzz/uri_absolute.gltf"), ContainsSubstring("is absolute"));
    CHECK_THAT(refusal("fuzz/positions_1e20.glb"), ContainsSubstring("scale the file"));
    CHECK(loadFault("fuzz/eight_kB_asks_20_GB_primitives.glb").mesh.positions.size() < 1000);
    CHECK(loadFault("fuzz/28_kB_runs_minutes_skins.glb").skeleton.joints.size() < 1000);
}
