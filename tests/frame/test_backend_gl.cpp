// What is OpenGL's own: its guarantees, its contexts, its linker and the faults of its drivers.
#include <algorithm>

#include "tests/frame/hand_plans.h"

using namespace skinbench;
using namespace skinbench::hand;

namespace {

std::unique_ptr<Backend> openOrSkip() {
    auto devices = listGlDevices();
    if (!devices) SKIP(devices.error().text);
    return must(openGl({.device = {}, .validation = true}));
}

uint32_t upperPixel(Backend& backend, const FramePlan& plan) {
    const PlanId id = must(backend.prepare(plan));
    const FrameInput frame = stillFrame();
    must(backend.run(id, {&frame, 1}));
    return upperHalf(must(backend.readImage(id)));
}

// Draws the whole image red in the colour of the mesh stage's last output; `culled` as gl_CullPrimitiveEXT says.
FramePlan outputPlan(bool spare, bool culled) {
    FramePlan plan = meshPlan(Api::opengl, MeshDialect::ext, false);
    const Defines defines = {{"SPARE", spare ? "1" : "0"}, {"CULLED", culled ? "true" : "false"}};
    plan.programs[0].stages = {glsl(Api::opengl, Stage::mesh, R"(
layout(local_size_x = 1) in;
layout(triangles, max_vertices = 3, max_primitives = 1) out;
layout(location = 0) out vec4 color[];
#if SPARE
layout(location = 1) out vec4 spare[];
#endif
void main() {
    SetMeshOutputsEXT(3u, 1u);
    for (uint i = 0u; i < 3u; ++i) {
        gl_MeshVerticesEXT[i].gl_Position = vec4(i == 2u ? 3.0 : -1.0, i == 1u ? 3.0 : -1.0, 0.5, 1.0);
        color[i] = unpackUnorm4x8(drawConstants.y);
#if SPARE
        spare[i] = color[i] * vec4(2, 3, 4, 5) + 1.0;
#endif
    }
    gl_PrimitiveTriangleIndicesEXT[0] = uvec3(0, 1, 2);
    gl_MeshPrimitivesEXT[0].gl_CullPrimitiveEXT = CULLED;
}
)",
                                    MeshDialect::ext, defines),
                               glsl(Api::opengl, Stage::fragment, R"(
layout(location = 0) in vec4 color;
#if SPARE
layout(location = 1) in vec4 spare;
#endif
layout(location = 0) out vec4 target;
void main() {
    target = color;
#if SPARE
    if (dot(spare, vec4(1.0)) < 0.0) target = spare;  // never, which no linker knows
#endif
}
)",
                                    MeshDialect::none, defines)};
    plan.passes[0].draws.resize(1);
    return plan;
}

}  // namespace

TEST_CASE("OpenGL devices have what the specification guarantees", "[gpu]") {
    auto backend = openOrSkip();
    CHECK(backend->caps().storageBlocksVertex >= 8);
    for (const DeviceCaps& caps : must(listGlDevices())) {
        CAPTURE(caps.name, caps.driver);
        CHECK(caps.version >= "OpenGL 4.5");
        CHECK(caps.driver.find(caps.version.substr(7)) != std::string::npos);
        CHECK(caps.maxComputeGroupSize >= 1024);
        CHECK(caps.maxComputeGroupCount >= 65535);
        CHECK(caps.maxStorageBytes >= uint64_t{1} << 24);
        CHECK(caps.maxUniformBytes >= 16384);
        CHECK(caps.maxImageSize >= 16384);
        CHECK(std::ranges::binary_search(caps.extensions, "GL_EXT_mesh_shader") == caps.ext.available);
        CHECK(std::ranges::binary_search(caps.extensions, "GL_NV_mesh_shader") == caps.nv.available);
        CHECK(caps.software ==
              (caps.name.find("llvmpipe") != std::string::npos || caps.name.find("softpipe") != std::string::npos));
        for (const MeshLimitsOfDevice& limits : {caps.ext, caps.nv}) {
            if (!limits.available) continue;
            CHECK(limits.maxVertices >= 64);
            CHECK(limits.maxTriangles >= 64);
            CHECK(limits.maxGroupSize >= 32);
            CHECK(limits.maxGroupCount >= 65535);
            CHECK(limits.maxOutputBytes >= 16384);
            CHECK(limits.maxSharedBytes >= 16384);
        }
    }
}

TEST_CASE("OpenGL: the faults of a driver are there where the device says so", "[gpu]") {
    auto backend = openOrSkip();
    if (!backend->caps().ext.available) SKIP("no GL_EXT_mesh_shader");
    const bool lost = backend->caps().lastMeshOutputLost;
    CHECK(upperPixel(*backend, outputPlan(lost, false)) == kRed);
    if (lost) CHECK(upperPixel(*backend, outputPlan(false, false)) != kRed);
    CHECK((upperPixel(*backend, outputPlan(lost, true)) == kRed) == backend->caps().primitiveCullIgnored);
    CHECK(backend->takeMessages().empty());
}

TEST_CASE("OpenGL: a program that does not link is one sentence", "[gpu]") {
    auto backend = openOrSkip();
    FramePlan plan = trianglePlan(Api::opengl);
    plan.programs[0].stages[1] = glsl(Api::opengl, Stage::fragment, "void other();\nvoid main() { other(); }\n");
    auto failed = backend->prepare(plan);
    REQUIRE_FALSE(failed);
    CHECK(failed.error().text.starts_with("triangle: "));
    CHECK_FALSE(failed.error().text.contains('\n'));
    CHECK(upperPixel(*backend, trianglePlan(Api::opengl)) == kRed);
    CHECK(backend->takeMessages().empty());
}

TEST_CASE("OpenGL: contexts stay apart, and one outlives the other", "[gpu]") {
    auto first = openOrSkip(), second = openOrSkip();
    const PlanId id = must(first->prepare(trianglePlan(Api::opengl)));
    CHECK(upperPixel(*second, trianglePlan(Api::opengl, kLower)) == kBackground);
    const FrameInput frame = stillFrame();
    must(first->run(id, {&frame, 1}));
    CHECK(upperPixel(*second, trianglePlan(Api::opengl)) == kRed);
    CHECK(upperHalf(must(first->readImage(id))) == kRed);
    for (Backend* backend : {first.get(), second.get()}) CHECK(backend->takeMessages().empty());
    first.reset();
    CHECK(upperPixel(*second, trianglePlan(Api::opengl, kLower)) == kBackground);
    CHECK(second->takeMessages().empty());
}
