// Hand-written plans through the OpenGL backend, with debug output on: it must have nothing to say.
#include "tests/frame/gl_plans.h"

using namespace skinbench;
using namespace skinbench::gltest;

namespace {

void testMeshImages(Backend& backend, FramePlan plan) {
    Image image = render(backend, plan);
    CHECK(pixel(image, 1, 1) == kRed);
    CHECK(pixel(image, kWidth - 2, kHeight - 2) == kGreen);
    plan.passes[0].draws = {{2, 0, 0, {}}};
    CHECK((render(backend, plan).rgba == image.rgba));
    plan.passes[0].draws = {{1, 0, 0, {}}};
    requireTopLeftOnly(render(backend, plan), kRed);
}

void testMesh(MeshDialect dialect) {
    auto backend = openDevice();
    const MeshLimitsOfDevice& limits = meshLimits(backend->caps(), dialect);
    if (!limits.available) {
        auto refused = backend->prepare(meshPlan(dialect, false, MeshColor::perVertex));
        REQUIRE(!refused);
        CHECK(refused.error().text.find("mesh_shader") != std::string::npos);
        SKIP("the device does not offer this dialect");
    }
    CHECK(limits.maxVertices >= 64);
    CHECK(limits.maxTriangles >= 64);
    CHECK(limits.maxGroupSize >= 32);
    CHECK(limits.maxGroupCount >= 65535);
    CHECK(limits.maxOutputBytes >= 16384);
    CHECK(limits.maxSharedBytes >= 16384);
    for (bool withTask : {false, true}) {
        const bool lost = dialect == MeshDialect::ext && backend->caps().lastMeshOutputLost;
        for (MeshColor color : {MeshColor::perPrimitive, lost ? MeshColor::perVertexAndSpare : MeshColor::perVertex}) {
            INFO("task stage " << withTask << ", colour " << static_cast<int>(color));
            testMeshImages(*backend, meshPlan(dialect, withTask, color));
        }
        // The fault is there where the backend says so: without a spare output the colour does not arrive.
        if (lost) CHECK(pixel(render(*backend, meshPlan(dialect, withTask, MeshColor::perVertex)), 1, 1) != kRed);
    }
    if (limits.maxGroupCount < UINT32_MAX) {
        FramePlan plan = meshPlan(dialect, false, MeshColor::perPrimitive);
        plan.passes[0].draws[0].count = limits.maxGroupCount + 1;
        auto refused = backend->prepare(plan);
        REQUIRE(!refused);
        CHECK(refused.error().text.find(std::to_string(limits.maxGroupCount)) != std::string::npos);
    }
    requireQuiet(*backend);
}

}  // namespace

TEST_CASE("OpenGL devices tell what they are", "[gpu]") {
    auto devices = listGlDevices();
    if (!devices) SKIP(devices.error().text);
    if (devices->empty()) SKIP("no OpenGL device");
    for (const DeviceCaps& caps : *devices) {
        INFO(caps.name << ", " << caps.driver);
        CHECK(caps.api == Api::opengl);
        CHECK(!caps.name.empty());
        CHECK(caps.version >= "OpenGL 4.5");
        CHECK(caps.driver.find(caps.version.substr(7)) != std::string::npos);
        CHECK(caps.timestampBits <= 64);
        CHECK((caps.timestampPeriodNs > 0) == (caps.timestampBits > 0));
        // What OpenGL 4.5 guarantees.
        CHECK(caps.maxComputeGroupSize >= 1024);
        CHECK(caps.maxComputeGroupCount >= 65535);
        CHECK(caps.maxStorageBytes >= uint64_t{1} << 24);
        CHECK(caps.maxUniformBytes >= 16384);
        CHECK(std::ranges::is_sorted(caps.extensions));
        CHECK(std::ranges::binary_search(caps.extensions, "GL_EXT_mesh_shader") == caps.ext.available);
        CHECK(std::ranges::binary_search(caps.extensions, "GL_NV_mesh_shader") == caps.nv.available);
        CHECK(caps.software ==
              (caps.name.find("llvmpipe") != std::string::npos || caps.name.find("softpipe") != std::string::npos));
    }
    auto again = listGlDevices();
    REQUIRE(again);
    CHECK(again->size() == devices->size());
}

TEST_CASE("OpenGL names the devices there are when the wanted one is not", "[gpu]") {
    auto first = openDevice();
    auto none = openGl({.device = "no such device", .validation = false});
    REQUIRE(!none);
    CHECK(none.error().text.find(first->caps().name) != std::string::npos);
    CHECK(openGl({.device = first->caps().name, .validation = false}));
}

TEST_CASE("OpenGL draws indexed triangles from attributes, top row first", "[gpu]") {
    auto backend = openDevice();
    CHECK(backend->caps().storageBlocksVertex >= 8);
    requireTopLeftOnly(render(*backend, attributePlan(kTopLeft)), kRed);

    SECTION("counter-clockwise on the screen is the front") {
        FramePlan plan = attributePlan(kTopLeftReversed);
        CHECK(isOnlyBackground(render(*backend, plan)));
        plan.passes[0].cullBackFaces = false;
        requireTopLeftOnly(render(*backend, plan), kRed);
    }
    SECTION("each draw has its constants, first index and base vertex") {
        FramePlan plan = attributePlan({7, 7, 0, 1, 2, 1, 0, 2});
        plan.passes[0].draws = {makeDraw(3, 2, 1, kRedWord), makeDraw(3, 5, 2, kGreenWord)};
        plan.passes[0].cullBackFaces = false;
        Image image = render(*backend, plan);
        CHECK(pixel(image, 1, 1) == kRed);
        CHECK(pixel(image, kWidth - 2, kHeight - 2) == kGreen);
    }
    SECTION("frame constants reach the shader") {
        FrameInput frame = makeFrame();
        frame.constants.viewProjection[0][0] = -1;
        FramePlan plan = attributePlan(kTopLeftReversed);
        Image image = render(*backend, plan, std::span(&frame, 1));
        CHECK(pixel(image, kWidth - 2, 1) == kRed);
        CHECK(pixel(image, 1, kHeight - 2) == kBackground);
    }
    requireQuiet(*backend);
}

TEST_CASE("OpenGL depth runs from 0 to 1 and the nearer triangle wins", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = attributePlan({0, 1, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    std::vector<Vertex> vertices(1);
    for (float z : {0.25f, 0.75f, 1.25f, -0.25f})
        for (int corner : {1, 2, 3}) {
            vertices.push_back(kVertices[static_cast<size_t>(corner)]);
            vertices.back().position[2] = z;
        }
    plan.streams = {makeStream(SLOT_VERTEX, useAttributes, vertices),
                    makeStream(SLOT_INDEX, useIndices, std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11})};
    plan.passes[0].draws = {makeDraw(3, 0, 1, kRedWord), makeDraw(3, 3, 1, kGreenWord)};
    requireTopLeftOnly(render(*backend, plan), kRed);
    plan.passes[0].draws = {makeDraw(3, 3, 1, kGreenWord)};
    requireTopLeftOnly(render(*backend, plan), kGreen);
    plan.passes[0].draws = {makeDraw(6, 6, 1, kGreenWord)};  // beyond the far plane and before the near one
    CHECK(isOnlyBackground(render(*backend, plan)));
    requireQuiet(*backend);
}

TEST_CASE("OpenGL raster modes shade no fragment", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = attributePlan(kTopLeft);
    for (RasterMode mode : {RasterMode::noFragments, RasterMode::discard}) {
        plan.passes[0].raster = mode;
        CHECK(isOnlyBackground(render(*backend, plan)));
    }
    plan.passes[0].raster = RasterMode::full;
    requireTopLeftOnly(render(*backend, plan), kRed);  // the clear works behind discard too
    plan.passes[0].writeColor = false;
    CHECK(isOnlyBackground(render(*backend, plan)));
    requireQuiet(*backend);
}

TEST_CASE("OpenGL depth pre-pass: only equal depth is shaded", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = attributePlan({0, 1, 2, 3, 2, 1});
    Pass depth = plan.passes[0], color = plan.passes[0];
    depth.label = "depth";
    depth.writeColor = false;
    depth.draws = {makeDraw(3, 0, 1, kGreenWord)};
    color.depth = DepthTest::equalKeep;
    color.clear = false;
    plan.passes = {depth, color};
    requireTopLeftOnly(render(*backend, plan), kRed);
    requireQuiet(*backend);
}

TEST_CASE("OpenGL compute writes what the draw pulls, with the palette of its own frame", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = computePlan();
    std::array frames = {makeFrame(bytesOf(kTurned)), makeFrame(bytesOf(kIdentity))};
    requireTopLeftOnly(render(*backend, plan, frames), kGreen);

    auto id = backend->prepare(plan);
    REQUIRE(id);
    auto zero = readAs<float>(*backend, *id, SLOT_SKINNED);
    CHECK(std::ranges::all_of(zero, [](float f) { return f == 0; }));
    std::swap(frames[0], frames[1]);
    REQUIRE(backend->run(*id, frames));
    auto image = backend->readImage(*id);
    REQUIRE(image);
    CHECK(pixel(*image, 1, 1) == kBackground);
    CHECK(pixel(*image, kWidth - 2, kHeight - 2) == kGreen);
    auto skinned = readAs<std::array<float, 4>>(*backend, *id, SLOT_SKINNED);
    REQUIRE(skinned.size() == 8);
    CHECK(skinned[1] == std::array<float, 4>{1, -1, 0.5f, 1});
    CHECK(skinned[6] == std::array<float, 4>{1, 1, 0.5f, 1});
    CHECK(skinned[7] == std::array<float, 4>{0, 0, 0, 0});  // the second dispatch stops at its own constant
    requireQuiet(*backend);
}

TEST_CASE("OpenGL renders a long batch whose frames all keep their input", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = computePlan();
    const char* accumulate = R"(#version 450
layout(local_size_x = 1) in;
layout(std140, binding = 0) uniform Frame { mat4 viewProjection; vec4 grid; };
layout(std430, binding = 1) readonly buffer Palette { vec4 rows[]; };
layout(std430, binding = 8) buffer Capture { vec4 sums[]; };
void main() {
    uint frame = uint(grid.w);
    sums[frame] = vec4(rows[0].x, grid.w, sums[frame == 0u ? 0u : frame - 1u].z + 1.0, 0.0);
}
)";
    constexpr size_t kFrames = 120;
    plan.programs[0].stages[0].text = accumulate;
    plan.streams.push_back(makeGpuStream(SLOT_CAPTURE, kFrames * 16));
    plan.passes[0].draws = {{1, 0, 0, {}}};
    std::vector<Rows> palettes(kFrames, kIdentity);
    std::vector<FrameInput> frames;
    for (size_t i = 0; i < kFrames; ++i) {
        palettes[i][0][0] = static_cast<float>(i * i);
        frames.push_back(makeFrame(bytesOf(palettes[i])));
        frames.back().constants.grid[3] = static_cast<float>(i);
    }
    auto id = backend->prepare(plan);
    REQUIRE(id);
    REQUIRE(backend->run(*id, frames));
    auto sums = readAs<std::array<float, 4>>(*backend, *id, SLOT_CAPTURE);
    REQUIRE(sums.size() == kFrames);
    for (size_t i = 0; i < kFrames; ++i) {
        auto f = static_cast<float>(i);
        CHECK(sums[i] == std::array<float, 4>{f * f, f, f + 1, 0});
    }
    requireQuiet(*backend);
}

TEST_CASE("OpenGL takes vertices that the host has skinned", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = computePlan();
    plan.paletteBytes = 0;
    plan.streams[2].hostWritten = true;
    plan.passes = {plan.passes[1]};
    const std::vector<std::array<float, 4>> topLeft = {{-1, -1, 0.5f, 1}, {-1, 1, 0.5f, 1}, {1, -1, 0.5f, 1}};
    std::vector<std::array<float, 4>> first(8), second(8);
    std::ranges::copy(topLeft, second.begin());
    std::array frames = {makeFrame({}, std::as_bytes(std::span(first))),
                         makeFrame({}, std::as_bytes(std::span(second)))};
    auto id = backend->prepare(plan);
    REQUIRE(id);
    auto timings = backend->run(*id, frames);
    REQUIRE(timings);
    for (const Timing& timing : *timings) CHECK(timing.upload > 0);
    auto image = backend->readImage(*id);
    REQUIRE(image);
    requireTopLeftOnly(*image, kGreen);
    CHECK(readAs<std::array<float, 4>>(*backend, *id, SLOT_SKINNED) == second);

    std::array missing = {makeFrame()};
    auto refused = backend->run(*id, missing);
    REQUIRE(!refused);
    CHECK(refused.error().text.find("128") != std::string::npos);
    requireQuiet(*backend);
}

TEST_CASE("OpenGL replicas are copies of their own, indices shifted", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = attributePlan(kTopLeft);
    std::vector<uint32_t> words(1001);
    for (size_t i = 0; i < words.size(); ++i) words[i] = static_cast<uint32_t>(i * 2654435761u);
    Stream shifted = makeStream(SLOT_TUPLE, useStorage, words), plain = makeStream(SLOT_MESHLET, useStorage, words);
    shifted.replicas = plain.replicas = 3;
    shifted.replicaAdd = 1000;
    Stream large = makeStream(SLOT_MESHLET_DATA, useStorage, words);  // more than one piece of the staging buffer
    large.replicas = 20000;
    large.replicaAdd = 3;
    Stream empty = makeStream(SLOT_MESHLET_EXTRA, useStorage, std::vector<uint32_t>{});
    plan.streams.insert(plan.streams.end(), {shifted, plain, large, empty});
    auto id = backend->prepare(plan);
    REQUIRE(id);
    for (const Stream* stream : {&shifted, &plain, &large, &empty}) {
        auto read = readAs<uint32_t>(*backend, *id, stream->slot);
        size_t count = stream->bytes->size() / 4, wrong = 0;
        REQUIRE(read.size() == count * stream->replicas);
        for (size_t i = 0; i < read.size(); ++i) {
            auto replica = static_cast<uint32_t>(i / count);
            wrong += read[i] != words[i % count] + replica * stream->replicaAdd;
        }
        CHECK(wrong == 0);
    }
    auto none = backend->readStream(*id, SLOT_CAPTURE);
    REQUIRE(!none);
    CHECK(none.error().text == "attributes: there is no stream 8");
    requireQuiet(*backend);
}

TEST_CASE("OpenGL draws with GL_EXT_mesh_shader", "[gpu]") { testMesh(MeshDialect::ext); }

TEST_CASE("OpenGL draws with GL_NV_mesh_shader", "[gpu]") { testMesh(MeshDialect::nv); }

TEST_CASE("OpenGL turns faults of a plan into one sentence and stays usable", "[gpu]") {
    auto backend = openDevice();
    FramePlan plan = attributePlan(kTopLeft);
    auto errorOf = [&](const FramePlan& broken) {
        auto id = backend->prepare(broken);
        REQUIRE(!id);
        CHECK(!id.error().text.empty());
        CHECK(id.error().text.find('\n') == std::string::npos);
        CHECK(id.error().text.back() != '.');
        return id.error().text;
    };
    auto contains = [](const std::string& text, const std::string& part) {
        INFO(text);
        CHECK(text.find(part) != std::string::npos);
    };
    SECTION("a shader that does not compile") {
        plan.programs[0].stages[1].text = "#version 450\nvoid main() { undeclared = 1.0; }\n";
        std::string text = errorOf(plan);
        contains(text, "plain.frag");
        contains(text, "undeclared");
        errorOf(plan);
    }
    SECTION("a program that does not link") {
        plan.programs[0].stages[1].text = "#version 450\nvoid other();\nvoid main() { other(); }\n";
        errorOf(plan);
    }
    SECTION("a stream that no storage block can hold") {
        uint64_t limit = backend->caps().maxStorageBytes;
        plan.streams.push_back(makeGpuStream(SLOT_CAPTURE, limit + 4));
        std::string text = errorOf(plan);
        contains(text, std::to_string(limit));
        contains(text, std::to_string(limit + 4));
    }
    SECTION("a palette that no storage block can hold") {
        plan.paletteBytes = backend->caps().maxStorageBytes + 48;
        contains(errorOf(plan), std::to_string(plan.paletteBytes));
    }
    SECTION("a missing index stream") {
        plan.streams.pop_back();
        contains(errorOf(plan), "pass draw");
    }
    SECTION("attributes from nowhere") {
        plan.programs[0].attributeSlot = SLOT_SKINNED;
        contains(errorOf(plan), "stream 7");
    }
    SECTION("an image larger than the device draws") {
        plan.width = 1 << 24;
        contains(errorOf(plan), "16777216");
    }
    SECTION("input of the wrong size") {
        plan.paletteBytes = 48;
        auto id = backend->prepare(plan);
        REQUIRE(id);
        const FrameInput frame = makeFrame();
        auto refused = backend->run(*id, std::span(&frame, 1));
        REQUIRE(!refused);
        CHECK(refused.error().fault == Fault::input);
        contains(refused.error().text, "48");
        CHECK(backend->run(*id, {}));
    }
    SECTION("a plan that is not there") {
        const FrameInput frame = makeFrame();
        CHECK(!backend->run(77, std::span(&frame, 1)));
        CHECK(!backend->readImage(77));
        CHECK(!backend->readStream(77, SLOT_VERTEX));
        backend->release(77);
    }
    requireTopLeftOnly(render(*backend, attributePlan(kTopLeft)), kRed);
    requireQuiet(*backend);
}

TEST_CASE("OpenGL keeps several plans and backends apart", "[gpu]") {
    auto backend = openDevice();
    auto other = openDevice();
    FramePlan small = attributePlan(kTopLeft), same = attributePlan(kBottomRight), large = attributePlan(kTopLeft);
    large.width = 2 * kWidth;
    const FrameInput frame = makeFrame(), posed = makeFrame(bytesOf(kIdentity));
    std::span one(&frame, 1), onePosed(&posed, 1);
    auto smallId = backend->prepare(small), sameId = backend->prepare(same), largeId = backend->prepare(large);
    auto computeId = backend->prepare(computePlan());
    auto otherId = other->prepare(same);
    REQUIRE((smallId && sameId && largeId && computeId && otherId));

    CHECK(!backend->readImage(*smallId));  // nothing rendered yet
    REQUIRE(backend->run(*smallId, one));
    REQUIRE(backend->run(*largeId, one));
    REQUIRE(other->run(*otherId, one));
    auto image = backend->readImage(*smallId);
    REQUIRE(image);
    requireTopLeftOnly(*image, kRed);
    image = backend->readImage(*largeId);
    REQUIRE(image);
    CHECK(image->width == 2 * kWidth);
    CHECK(pixel(*image, kWidth, 2) == kRed);
    image = other->readImage(*otherId);
    REQUIRE(image);
    CHECK(pixel(*image, kWidth - 2, kHeight - 2) == kRed);
    CHECK(pixel(*image, 1, 1) == kBackground);

    REQUIRE(backend->run(*computeId, onePosed));
    auto stale = backend->readImage(*smallId);
    REQUIRE(!stale);
    CHECK(stale.error().text.find("run it again") != std::string::npos);
    backend->release(*computeId);
    CHECK(!backend->run(*computeId, onePosed));
    CHECK(!backend->readImage(*smallId));  // the image of a released plan is nobody's
    REQUIRE(backend->run(*sameId, one));
    image = backend->readImage(*sameId);
    REQUIRE(image);
    CHECK(pixel(*image, kWidth - 2, kHeight - 2) == kRed);

    requireQuiet(*backend);
    backend.reset();
    REQUIRE(other->run(*otherId, one));
    CHECK(other->readImage(*otherId));
    requireQuiet(*other);
}
