// Words, case ids, and what a device can run. No driver takes part.
#include <algorithm>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/plans/plan.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("every row is found under its name") {
    for (const Route& route : routes()) CHECK(findRoute(route.name) == &route);
    for (const Variant& variant : variants()) CHECK(findVariant(variant.name) == &variant);
    CHECK(findRoute("dx") == nullptr);
    CHECK(findVariant("") == nullptr);
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
    CHECK(unsupported(mesh, able) == "only --cull compact exchanges by shuffles");
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

TEST_CASE("variants run on the routes that can carry them") {
    const std::map<std::string, std::string> wanted = {{"none", "vk vk-ext vk-nv gl gl-ext gl-nv"},
                                                       {"vertex", "vk gl"},
                                                       {"compute", "vk gl"},
                                                       {"compute-cull", "vk gl"},
                                                       {"mesh", "vk-ext vk-nv gl-ext gl-nv"},
                                                       {"mesh-ci", "vk-ext vk-nv gl-ext gl-nv"},
                                                       {"compute-mesh", "vk-ext vk-nv gl-ext gl-nv"},
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
    for (const Case& c : everyCase()) CHECK(!unsupported(c, generousCaps(c.route->api)));

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
