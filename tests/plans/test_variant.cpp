// Words, case ids, and what a device can run. No driver takes part.
#include <algorithm>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/plans/variant.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("every row is found under its name") {
    for (const Route& route : routes()) CHECK(findRoute(route.name) == &route);
    for (const Variant& variant : variants()) CHECK(findVariant(variant.name) == &variant);
    CHECK(findRoute("dx") == nullptr);
    CHECK(findVariant("") == nullptr);
    CHECK(std::string(rasterName(RasterMode::full)) == "full");
    CHECK(std::string(rasterName(RasterMode::noFragments)) == "no-fragments");
    CHECK(std::string(rasterName(RasterMode::discard)) == "discard");
    for (View view : {View::shaded, View::meshlets, View::weights, View::tuples, View::velocity, View::resolution})
        CHECK(std::string(viewName(view)) != "?");
}

TEST_CASE("case ids stay what result files of the past say") {
    CHECK(caseId(makeCase("cpu", "cpu")) == "cpu/cpu/uc");
    CHECK(caseId(makeCase("vk", "none")) == "vk/none/uc");
    CHECK(caseId(makeCase("gl", "vertex")) == "gl/vertex/uc");
    CHECK(caseId(makeCase("vk", "compute")) == "vk/compute/uc");
    CHECK(caseId(makeCase("vk-ext", "mesh")) == "vk-ext/mesh/uc/meshopt/redirect");

    Case compute = makeCase("vk", "compute");
    CHECK(computeName(compute.compute) == "plain");
    compute.compute = {.staged = true, .packed = true};
    CHECK(caseId(compute) == "vk/compute/uc+staged+packed");
    compute.compute = {true, true, true, true, true, true};
    compute.influences = 8;
    compute.scenario = Scenario::prepass;
    CHECK(caseId(compute) == "vk/compute/uc+staged+previous+tangents+early-exit+packed+half-rate+8-influences+prepass");

    Case pull = makeCase("vk", "vertex");
    pull.fetch = VertexFetch::pull;
    CHECK(caseId(pull) == "vk/vertex/uc+pull");
    pull.influences = 8;
    pull.submission = Submission::batched;
    pull.keepBackFaces = true;
    pull.raster = RasterMode::noFragments;
    CHECK(caseId(pull) == "vk/vertex/uc+8-influences+pull+batched+keep-back-faces+no-fragments");

    Case mesh = makeCase("vk-nv", "mesh");
    CHECK(caseId(mesh) == "vk-nv/mesh/uc/meshopt/redirect");
    mesh.builder = findBuilder("scan");
    mesh.limits = {128, 252};
    mesh.groupSize = 64;
    mesh.packedWrites = false;
    mesh.raster = RasterMode::discard;
    CHECK(caseId(mesh) == "vk-nv/mesh/uc/scan/redirect+128-252+group-64+unpacked-writes+discard");
    // Packed writes exist in the NV dialect only.
    mesh.route = findRoute("gl-ext");
    mesh.limits = {};
    mesh.groupSize = 32;
    mesh.raster = RasterMode::full;
    CHECK(caseId(mesh) == "gl-ext/mesh/uc/scan/redirect");
}

TEST_CASE("ids say every option that is not the default") {
    Case mesh = makeCase("vk-nv", "mesh");
    mesh.shape = {JointSource::staged, true, true, true};
    mesh.layout = findMeshletLayout("fixed");
    mesh.cull = Cull::compact;
    mesh.exchange = Exchange::shared;
    mesh.scenario = Scenario::prepass;
    CHECK(caseId(mesh) ==
          "vk-nv/mesh/uc/meshopt/fixed+joints-staged+clamped-loads+ordered-records+uniform-palette+cull-compact+shared"
          "+prepass");
    Case common = makeCase("gl-ext", "mesh-ci");
    CHECK(caseId(common) == "gl-ext/mesh-ci/uc/meshopt/redirect");
    common.common = {CiGrouping::triangles, CiKey::ordered, 32, true};
    common.cull = Cull::torabi;
    CHECK(caseId(common) == "gl-ext/mesh-ci/uc/meshopt/redirect+ci-triangles+ci-ordered+ci-min-32+fat+cull-torabi");
    CHECK(caseId(makeCase("gl", "palette")) == "gl/palette/uc+slots-32");
    CHECK(caseId(makeCase("vk-ext", "mesh", "dpdc16")) == "vk-ext/mesh/dpdc16/meshopt/redirect");
}

TEST_CASE("what an option cannot do is told in one sentence") {
    const DeviceCaps able = generousCaps(Api::vulkan);
    Case mesh = makeCase("vk-nv", "mesh");
    mesh.cull = Cull::primitive;
    CHECK(unsupported(mesh, able) == "gl_CullPrimitive exists in the EXT dialect only");
    mesh.cull = Cull::compact;
    mesh.exchange = Exchange::shuffle;
    CHECK(!unsupported(mesh, able));
    DeviceCaps narrow = able;
    narrow.subgroupSize = 8;
    CHECK(unsupported(mesh, narrow) ==
          "32 invocations a work group are not one subgroup that can shuffle: test device has 8");
    mesh.cull = Cull::torabi;
    CHECK(unsupported(mesh, able) == "--cull torabi exchanges through shared memory only");
    mesh = makeCase("vk-ext", "mesh");
    mesh.cull = Cull::primitive;
    DeviceCaps ignoring = able;
    ignoring.primitiveCullIgnored = true;
    CHECK(unsupported(mesh, ignoring) == "test device ignores gl_CullPrimitiveEXT");
    mesh = makeCase("vk-ext", "mesh", "pc");
    mesh.shape.joints = JointSource::staged;
    CHECK(unsupported(mesh, able) == "codec pc has no record without joint ids");
    mesh = makeCase("vk-ext", "mesh");
    mesh.shape.uniformPalette = true;
    mesh.submission = Submission::batched;
    CHECK(unsupported(mesh, able) == "a uniform block holds one copy's palette, so copies cannot be drawn at once");
    CHECK(unsupported(makeCase("vk", "vertex", "pc"), able) == "no attribute format carries codec pc");
    CHECK(unsupported(makeCase("vk", "compute", "pdc8"), able) == "codec pdc8 decodes in mesh stages only");
    Case palette = makeCase("vk", "palette", "pc");
    palette.fetch = VertexFetch::pull;
    CHECK(unsupported(palette, able) == "codec pc stores joints, and palette draws need slots");
}

TEST_CASE("different cases have different ids, but for views") {
    std::set<std::string> ids;
    size_t shaded = 0;
    for (const Case& which : everyCase()) {
        if (which.view != View::shaded) continue;
        ++shaded;
        // `second` of everyCase changes nothing where no option has two values.
        ids.insert(caseId(which));
        CHECK(caseId(which).find(' ') == std::string::npos);
    }
    CHECK(ids.size() > shaded / 3);
    CHECK(ids.contains("gl-nv/none/uc/scan/redirect+unpacked-writes+8-influences+batched"));
}

TEST_CASE("variants run on the routes that can carry them") {
    const std::map<std::string, std::string> wanted = {{"none", "vk vk-ext vk-nv gl gl-ext gl-nv"},
                                                       {"vertex", "vk gl"},
                                                       {"compute", "vk gl"},
                                                       {"mesh", "vk-ext vk-nv gl-ext gl-nv"},
                                                       {"mesh-ci", "vk-ext vk-nv gl-ext gl-nv"},
                                                       {"palette", "vk gl"},
                                                       {"cpu", "vk gl cpu"}};
    for (const auto& [variant, names] : wanted) {
        std::string found;
        for (const Route& route : routes())
            if (runsOn(*findVariant(variant), route)) found += (found.empty() ? "" : " ") + std::string(route.name);
        CHECK(found == names);
    }
}

TEST_CASE("a device that lacks something is told in one sentence") {
    const DeviceCaps able = generousCaps(Api::vulkan);
    for (const Case& which : everyCase()) CHECK(!unsupported(which, generousCaps(which.route->api)));

    DeviceCaps caps = able;
    caps.ext.available = false;
    caps.nv = {};
    CHECK(unsupported(makeCase("vk-ext", "mesh"), caps) == "test device has no VK_EXT_mesh_shader");
    CHECK(unsupported(makeCase("vk-nv", "mesh"), caps) == "test device has no VK_NV_mesh_shader");
    CHECK(unsupported(makeCase("gl-ext", "none"), caps) == "test device has no GL_EXT_mesh_shader");
    CHECK(unsupported(makeCase("gl-nv", "mesh"), caps) == "test device has no GL_NV_mesh_shader");
    CHECK(!unsupported(makeCase("vk", "compute"), caps));

    caps = able;
    caps.ext.maxVertices = 63;
    CHECK(unsupported(makeCase("vk-ext", "mesh"), caps) == "64 vertices a meshlet: test device allows 63");
    CHECK(!unsupported(makeCase("vk-nv", "mesh"), caps));
    caps.nv.maxTriangles = 123;
    CHECK(unsupported(makeCase("vk-nv", "mesh"), caps) == "124 triangles a meshlet: test device allows 123");
    caps = able;
    caps.ext.maxGroupSize = 31;
    CHECK(unsupported(makeCase("gl-ext", "mesh"), caps) == "32 invocations a mesh work group: test device allows 31");

    caps = able;
    caps.timestampBits = 0;
    for (const char* route : {"vk", "vk-ext", "gl"})
        CHECK(unsupported(makeCase(route, "none"), caps) ==
              "test device offers no timestamps, so passes cannot be timed");
    CHECK(!unsupported(makeCase("cpu", "cpu"), caps));

    caps = able;
    caps.storageBlocksVertex = 2;
    Case pull = makeCase("vk", "vertex");
    CHECK(!unsupported(pull, caps));
    pull.fetch = VertexFetch::pull;
    CHECK(unsupported(pull, caps) == "3 storage blocks in the vertex stage: test device allows 2");
    caps.storageBlocksVertex = 0;
    CHECK(unsupported(makeCase("gl", "vertex"), caps) == "2 storage blocks in the vertex stage: test device allows 0");
    CHECK(!unsupported(makeCase("vk-ext", "mesh"), caps));
}
