// Every claim of backend.h on every backend; those of indirect draws are in test_backend_indirect.cpp, what is refused
// is in test_check_plan.cpp. What is seen in images is skipped for the null backend, which draws none.
#include <algorithm>
#include <format>

#include "common/frame/devices.h"
#include "tests/frame/subject.h"

using namespace skinbench;
using namespace skinbench::hand;
using Catch::Matchers::ContainsSubstring;

// --- streams --------------------------------------------------------------------------------------------------------

TEST_CASE("backends: streams hold all replicas, or zeros where only the device writes") {
    Subject subject;
    FramePlan plan = trianglePlan(subject.api());
    std::vector<uint32_t> words((5u << 20) - 3);  // 20 MiB: what travels at once ends inside replicas
    for (size_t i = 0; i < words.size(); ++i) words[i] = static_cast<uint32_t>(i * 2654435761u);
    const std::vector<uint32_t> few(words.begin(), words.begin() + 7);
    plan.streams.push_back({.slot = SLOT_TUPLE, .bytes = bytesOf(words), .replicas = 4, .replicaAdd = 11});
    plan.streams.push_back({.slot = SLOT_MESHLET, .bytes = bytesOf(few), .replicas = 3});
    plan.streams.push_back({.slot = SLOT_MESHLET_DATA, .bytes = bytesOf(few), .replicas = 500, .replicaAdd = 1000});
    plan.streams.push_back({.slot = SLOT_MESHLET_EXTRA, .bytes = bytesOf(std::vector<uint32_t>{})});
    plan.streams.push_back({.slot = SLOT_CAPTURE, .gpuBytes = 4 * 5});
    plan.streams.push_back({.slot = SLOT_TANGENT, .bytes = bytesOf(std::vector<uint8_t>{1, 2, 3, 4, 5})});
    const PlanId id = subject.prepare(plan);
    for (const Stream& stream : plan.streams) {
        if (!stream.bytes || stream.slot == SLOT_TANGENT) continue;
        CAPTURE(stream.slot);
        const auto source = valuesOf<uint32_t>(*stream.bytes), back = subject.stream<uint32_t>(id, stream.slot);
        REQUIRE(back.size() == source.size() * stream.replicas);
        size_t wrong = 0;
        for (size_t i = 0; i < back.size(); ++i)
            wrong +=
                back[i] != source[i % source.size()] + stream.replicaAdd * static_cast<uint32_t>(i / source.size());
        CHECK(wrong == 0);
    }
    CHECK(subject.stream<uint32_t>(id, SLOT_CAPTURE) == std::vector<uint32_t>(5, 0));
    CHECK(subject.stream<uint8_t>(id, SLOT_TANGENT) == std::vector<uint8_t>{1, 2, 3, 4, 5});
}

TEST_CASE("backends: a plan is cleared to its background") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api());
    plan.background = {1, 0, 0, 1};
    for (RunMode mode : drawingModes(subject)) CHECK(lowerHalf(subject.image(plan, {stillFrame()}, mode)) == kRed);
    plan.background = FramePlan{}.background;
    CHECK(lowerHalf(subject.image(plan)) == kBackground);
}

TEST_CASE("backends: every stream is bound at the number of its slot: eight storage blocks, and a uniform one") {
    Subject subject(Needs::images);
    std::string blocks, reads;
    std::vector<Stream> streams;
    std::vector<Point> wanted = {{1, 0, 0, 0}};
    for (uint32_t slot :
         {SLOT_VERTEX, SLOT_MESHLET, SLOT_MESHLET_DATA, SLOT_MESHLET_EXTRA, SLOT_CAPTURE, SLOT_TANGENT, SLOT_TUPLE}) {
        const bool uniform = slot == SLOT_TUPLE;
        streams.push_back({.slot = slot,
                           .use = uniform ? useUniform : useStorage,
                           .bytes = bytesOf(std::vector<uint32_t>{0, 0, 0, 0, slot, 1, 2, 3})});
        blocks += std::format("layout({0}, binding = {1}) {2} Block{1} {{ uvec4 from{1}[2]; }};\n",
                              uniform ? "std140" : "std430", slot, uniform ? "uniform" : "readonly buffer");
        reads += std::format("    skinned[{}] = vec4(from{}[1]);\n", wanted.size(), slot);
        wanted.push_back({static_cast<float>(slot), 1, 2, 3});
    }
    FramePlan plan = dispatchPlan(subject.api(), blocks + R"(
layout(local_size_x = 1) in;
layout(std430, binding = SLOT_PALETTE) readonly buffer PaletteBlock { vec4 rows[]; };
layout(std430, binding = SLOT_SKINNED) writeonly buffer SkinnedBlock { vec4 skinned[]; };
void main() {
    skinned[0] = rows[0];
)" + reads + "}\n",
                                  wanted.size());
    plan.paletteBytes = sizeof(Rows);
    plan.streams.insert(plan.streams.end(), streams.begin(), streams.end());
    const PlanId id = subject.prepare(plan);
    subject.run(id, {posedFrame(kIdentity)});
    CHECK(subject.stream<Point>(id, SLOT_SKINNED) == wanted);
}

TEST_CASE("backends: the host replaces its stream before each frame") {
    Subject subject;
    FramePlan plan = computePlan(subject.api());
    plan.paletteBytes = 0;
    plan.streams[2].hostWritten = true;
    plan.passes.erase(plan.passes.begin());
    std::vector<Point> hidden(8), shown(8);
    shown[0] = {-1, -1, 0.5f, 1}, shown[1] = {-1, 1, 0.5f, 1}, shown[2] = {1, -1, 0.5f, 1};
    std::vector<FrameInput> frames(2, stillFrame());
    frames[0].skinned = std::as_bytes(std::span(hidden));
    frames[1].skinned = std::as_bytes(std::span(shown));
    const PlanId id = subject.prepare(plan);
    for (RunMode mode : drawingModes(subject)) {
        for (const Timing& timing : subject.run(id, frames, mode)) CHECK((timing.upload > 0) == subject.draws);
        if (!subject.draws) continue;
        CHECK(onlyUpperHalf(must(subject.backend->readImage(id)), kGreen));
        CHECK(subject.stream<Point>(id, SLOT_SKINNED) == shown);
        std::swap(frames[0], frames[1]);
        subject.run(id, frames, mode);
        CHECK(nothingDrawn(must(subject.backend->readImage(id))));
        std::swap(frames[0], frames[1]);
    }
}

// --- what a draw sees -----------------------------------------------------------------------------------------------

TEST_CASE("backends: row 0 is the top row, y points down, front faces are counter-clockwise as seen") {
    Subject subject(Needs::images);
    CHECK(onlyUpperHalf(subject.image(trianglePlan(subject.api())), kRed));
    FramePlan reversed = trianglePlan(subject.api(), kUpperReversed);
    CHECK(nothingDrawn(subject.image(reversed)));
    reversed.passes[0].cullBackFaces = false;
    CHECK(onlyUpperHalf(subject.image(reversed), kRed));
}

TEST_CASE("backends: a draw has its constants, its first index and its base vertex, also among replicas") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api(), {7, 7, 0, 1, 2, 2, 1, 0});
    plan.passes[0].draws = {draw(3, 2), draw(3, 5, kGreen)};
    plan.passes[0].draws[1].baseVertex = 2;
    plan.passes[0].cullBackFaces = false;
    const Image image = subject.image(plan);
    CHECK(upperHalf(image) == kRed);
    CHECK(lowerHalf(image) == kGreen);
    // The third copy of the indices draws the third copy of the vertices.
    plan = trianglePlan(subject.api());
    plan.streams[0].replicas = plan.streams[1].replicas = 3;
    plan.streams[1].replicaAdd = static_cast<uint32_t>(kVertices.size());
    plan.passes[0].draws = {draw(3, 6)};
    CHECK(onlyUpperHalf(subject.image(plan), kRed));
}

TEST_CASE("backends: every frame of a batch has its palette and its constants, and may be drawn twice only at first") {
    Subject subject(Needs::images);
    constexpr size_t kFrames = 120;
    FramePlan plan = dispatchPlan(subject.api(), R"(
layout(local_size_x = 1) in;
layout(std140, binding = SLOT_FRAME) uniform FrameBlock { FrameConstants frame; };
layout(std430, binding = SLOT_PALETTE) readonly buffer PaletteBlock { vec4 rows[]; };
layout(std430, binding = SLOT_SKINNED) buffer SkinnedBlock { vec4 seen[]; };
void main() {
    uint number = uint(frame.grid.w);
    seen[number] = vec4(rows[0].x, frame.grid.w, number == 0u ? 1.0 : seen[number - 1u].z + 1.0, seen[number].w + 1.0);
}
)",
                                  kFrames);
    plan.paletteBytes = sizeof(Rows);
    std::vector<Rows> palettes(kFrames, kIdentity);
    std::vector<FrameInput> frames;
    for (size_t i = 0; i < kFrames; ++i) {
        palettes[i][0][0] = static_cast<float>(i * i);
        frames.push_back(posedFrame(palettes[i]));
        frames.back().constants.grid.w = static_cast<float>(i);
    }
    for (RunMode mode : {RunMode::timed, RunMode::overlap, RunMode::batch}) {
        const PlanId id = subject.prepare(plan);
        subject.run(id, frames, mode);
        const auto seen = subject.stream<Point>(id, SLOT_SKINNED);
        REQUIRE(seen.size() == kFrames);
        CHECK((seen[0][3] == 1 || seen[0][3] == 2));
        for (size_t i = 0; i < kFrames; ++i) {
            const auto f = static_cast<float>(i);
            if (seen[i] != Point{f * f, f, f + 1, i ? 1 : seen[0][3]}) FAIL_CHECK("frame " << i);
        }
    }
    FramePlan mirrored = trianglePlan(subject.api(), kUpperReversed);
    FrameInput frame = stillFrame();
    frame.constants.viewProjection[0][0] = -1;
    const Image image = subject.image(mirrored, {stillFrame(), frame});
    CHECK(pixel(image, image.width - 2, 1) == kRed);
    CHECK(pixel(image, 1, image.height - 2) == kBackground);
}

TEST_CASE("backends: a uniform palette shows each draw its own part of the frame's") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api(), {0, 1, 2, 3, 2, 1});
    plan.paletteBytes = kPaletteAlignment + 48;
    plan.paletteRange = 48;
    plan.programs[0].stages[1] = glsl(subject.api(), Stage::fragment, R"(
layout(std140, binding = SLOT_PALETTE) uniform PaletteBlock { vec4 rows[3]; };
layout(location = 0) in vec4 color;
layout(location = 0) out vec4 target;
void main() { target = rows[2] * color; }
)");
    plan.passes[0].draws = {draw(3), draw(3, 3)};
    plan.passes[0].draws[1].paletteOffset = kPaletteAlignment;
    std::vector<Point> first(kPaletteAlignment / 16 + 3), second = first;
    first[2] = {1, 0, 0, 1}, first[kPaletteAlignment / 16 + 2] = {0, 1, 0, 1};
    second[2] = {0, 1, 0, 1}, second[kPaletteAlignment / 16 + 2] = {0, 0, 1, 1};
    std::vector<FrameInput> frames(2, stillFrame());
    frames[0].palette = std::as_bytes(std::span(first));
    frames[1].palette = std::as_bytes(std::span(second));
    const Image image = subject.image(plan, frames);
    CHECK(upperHalf(image) == kGreen);
    CHECK(lowerHalf(image) == kBlue);
}

TEST_CASE("backends: a pass sees what the passes before it wrote") {
    Subject subject(Needs::images);
    for (RunMode mode : drawingModes(subject)) {
        const PlanId id = subject.prepare(computePlan(subject.api()));
        subject.run(id, {posedFrame(kIdentity), posedFrame(kTurned)}, mode);
        const auto skinned = subject.stream<Point>(id, SLOT_SKINNED);
        CHECK(skinned[1] == Point{1, -1, 0.5f, 1});
        CHECK(skinned[6] == Point{1, 1, 0.5f, 1});
        CHECK(skinned[7] == Point{0, 0, 0, 0});
        const Image image = must(subject.backend->readImage(id));
        CHECK(upperHalf(image) == kBackground);
        CHECK(lowerHalf(image) == kGreen);
    }
}

TEST_CASE("backends: mesh stages draw, with and without a task stage") {
    Subject subject(Needs::images);
    for (MeshDialect dialect : {MeshDialect::ext, MeshDialect::nv})
        for (bool withTask : {false, true}) {
            FramePlan plan = meshPlan(subject.api(), dialect, withTask);
            CAPTURE(dialect == MeshDialect::nv, withTask);
            const MeshLimitsOfDevice& limits = meshLimits(subject.backend->caps(), dialect);
            if (!limits.available || (withTask && !limits.taskStages)) {
                CHECK_FALSE(subject.backend->prepare(plan));
                continue;
            }
            const Image image = subject.image(plan);
            CHECK(upperHalf(image) == kRed);
            CHECK(lowerHalf(image) == kGreen);
            plan.passes[0].draws = {{.count = 2, .constants = {0, kBlue, 0, 0}}};
            CHECK(countOf(subject.image(plan), kBlue) == size_t{kWidth} * kHeight);
            plan.passes[0].draws[0].count = 1;
            CHECK(onlyUpperHalf(subject.image(plan), kBlue));
        }
}

// --- rasterising ----------------------------------------------------------------------------------------------------

TEST_CASE("backends: raster modes shade nothing, and clear all the same") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api());
    for (RasterMode mode : {RasterMode::noFragments, RasterMode::discard, RasterMode::full}) {
        plan.passes[0].raster = mode;
        const Image image = subject.image(plan);
        CHECK((mode == RasterMode::full ? onlyUpperHalf(image, kRed) : nothingDrawn(image)));
    }
    plan.passes[0].writeColor = false;
    CHECK(nothingDrawn(subject.image(plan)));
}

TEST_CASE("backends: depth runs from 0 to 1, and the nearer triangle wins") {
    Subject subject(Needs::images);
    std::vector<Vertex> vertices(1);
    std::vector<uint32_t> indices;
    for (float z : {0.25f, 0.75f, 1.25f, -0.25f})
        for (size_t corner : {1, 2, 3}) {
            indices.push_back(static_cast<uint32_t>(indices.size()));
            vertices.push_back(kVertices[corner]);
            vertices.back().position[2] = z;
        }
    FramePlan plan = trianglePlan(subject.api(), indices, vertices);
    plan.passes[0].draws = {draw(3, 0), draw(3, 3, kGreen)};
    CHECK(onlyUpperHalf(subject.image(plan), kRed));
    plan.passes[0].draws = {draw(3, 3, kGreen)};
    CHECK(onlyUpperHalf(subject.image(plan), kGreen));
    plan.passes[0].draws = {draw(6, 6)};  // beyond the far plane and before the near one
    CHECK(nothingDrawn(subject.image(plan)));
}

TEST_CASE("backends: a pass that keeps equal depth shades what a depth pass laid down, and clears only if asked") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api(), {0, 1, 2, 3, 2, 1});
    Pass depth = plan.passes[0], color = plan.passes[0];
    depth.label = "depth";
    depth.writeColor = false;
    depth.draws = {draw(3, 0, kGreen)};
    color.depth = DepthTest::equalKeep;
    color.clear = false;
    plan.passes = {depth, color};
    for (RunMode mode : drawingModes(subject)) {
        CHECK(onlyUpperHalf(subject.image(plan, {stillFrame(), stillFrame()}, mode), kRed));
    }
    plan.passes[0].raster = RasterMode::noFragments;
    CHECK(nothingDrawn(subject.image(plan)));

    FramePlan twice = trianglePlan(subject.api(), {0, 1, 2, 3, 2, 1});
    twice.passes.push_back(twice.passes[0]);
    twice.passes[0].draws = {draw(3)};
    twice.passes[1].draws = {draw(3, 3, kGreen)};
    for (RunMode mode : drawingModes(subject)) {
        const Image image = subject.image(twice, {stillFrame()}, mode);
        CHECK(upperHalf(image) == kBackground);
        CHECK(lowerHalf(image) == kGreen);
    }
    // At the same place, which only a cleared depth lets pass.
    twice.passes[1].draws = {draw(3, 0, kGreen)};
    for (RunMode mode : drawingModes(subject)) CHECK(onlyUpperHalf(subject.image(twice, {stillFrame()}, mode), kGreen));
}

// --- timings --------------------------------------------------------------------------------------------------------

TEST_CASE("backends: one timing a frame, in the shape of its mode") {
    Subject subject;
    const PlanId id = subject.prepare(computePlan(subject.api()));
    const std::vector<FrameInput> frames(3, posedFrame(kIdentity));
    for (RunMode mode : {RunMode::timed, RunMode::overlap, RunMode::batch, RunMode::counted}) {
        const auto timings = subject.run(id, frames, mode);
        REQUIRE(timings.size() == 3);
        for (const Timing& timing : timings) {
            CHECK(timing.passes.size() == (mode == RunMode::timed ? 2 : mode == RunMode::counted ? 0 : 1));
            if (mode == RunMode::batch) CHECK(timing.passes == timings.front().passes);
            CHECK(std::ranges::all_of(timing.passes, [](double ms) { return ms >= 0 && ms < 60'000; }));
            CHECK(timing.upload == 0);
            CHECK(timing.counters.has_value() ==
                  (mode == RunMode::counted && subject.backend->caps().pipelineStatistics));
            if (mode == RunMode::counted) continue;
            CHECK((timing.record > 0) == subject.draws);
            CHECK(timing.submit >= 0);
        }
        CHECK(subject.run(id, {}, mode).empty());
    }
}

TEST_CASE("backends: counters count what a plan has, and nothing else") {
    Subject subject;
    if (!subject.backend->caps().pipelineStatistics) SKIP(subject.backend->caps().name + " counts nothing");
    const auto timings = subject.run(subject.prepare(trianglePlan(subject.api(), {0, 1, 2, 3, 2, 1})),
                                     {stillFrame(), stillFrame()}, RunMode::counted);
    const auto skinned =
        subject.run(subject.prepare(computePlan(subject.api())), {posedFrame(kIdentity)}, RunMode::counted);
    for (const Timing& timing : timings) {
        const Counters& counters = *timing.counters;
        CHECK(counters.inputPrimitives == (subject.draws ? std::optional<uint64_t>(2) : std::nullopt));
        CHECK(counters.inputVertices == (subject.draws ? std::optional<uint64_t>(6) : std::nullopt));
        if (subject.draws) CHECK(counters.fragmentInvocations.value_or(0) >= uint64_t{kWidth} * kHeight);
        CHECK_FALSE(counters.computeInvocations);
        CHECK_FALSE(counters.meshInvocations);
    }
    if (!subject.draws) return;
    CHECK(skinned[0].counters->computeInvocations.value_or(0) >= 8);
    CHECK(skinned[0].counters->inputPrimitives == 1u);
}

// --- several plans --------------------------------------------------------------------------------------------------

TEST_CASE("backends: plans live side by side, and those of one size share their image") {
    Subject subject;
    Backend& backend = *subject.backend;
    FramePlan large = trianglePlan(subject.api(), kLower);
    large.width = 2 * kWidth + 1;
    const PlanId a = subject.prepare(trianglePlan(subject.api())), b = subject.prepare(computePlan(subject.api()));
    const PlanId c = subject.prepare(large),
                 dispatch =
                     subject.prepare(dispatchPlan(subject.api(), "layout(local_size_x = 1) in;\nvoid main() {}\n", 1));
    const std::string gone =
        "triangle: its image is not there: not run yet, or another plan of its size ran after it; "
        "run it again";
    auto image = backend.readImage(a);
    REQUIRE_FALSE(image);
    checkOneSentence(image.error(), Fault::input, gone);
    image = backend.readImage(dispatch);
    REQUIRE_FALSE(image);
    checkOneSentence(image.error(), Fault::input, "dispatch: draws no image");

    subject.run(a);
    subject.run(c);
    subject.run(dispatch);
    const Image first = must(backend.readImage(a));
    if (subject.draws) CHECK(onlyUpperHalf(first, kRed));
    CHECK(must(backend.readImage(c)).width == 2 * kWidth + 1);
    subject.run(b, std::vector<FrameInput>(500, posedFrame(kIdentity)));  // moves what all plans' palettes lie in
    if (subject.draws) CHECK(onlyUpperHalf(must(backend.readImage(b)), kGreen));
    image = backend.readImage(a);
    REQUIRE_FALSE(image);
    checkOneSentence(image.error(), Fault::input, gone);
    subject.run(a, {});
    CHECK_FALSE(backend.readImage(a));
    backend.release(b);
    CHECK_FALSE(backend.readImage(a));  // the image of a released plan is nobody's
    subject.run(a);
    CHECK(must(backend.readImage(a)).rgba == first.rgba);
}

TEST_CASE("backends: a released plan is gone, and its id is not used again") {
    Subject subject;
    Backend& backend = *subject.backend;
    const PlanId id = subject.prepare(trianglePlan(subject.api()));
    subject.run(id);
    backend.release(id);
    backend.release(id);
    CHECK(subject.prepare(trianglePlan(subject.api())) != id);
    const FrameInput frame = stillFrame();
    auto timings = backend.run(id, {&frame, 1});
    auto image = backend.readImage(id);
    auto bytes = backend.readStream(id, SLOT_VERTEX);
    REQUIRE((!timings && !image && !bytes));
    for (const Error& error : {timings.error(), image.error(), bytes.error()})
        checkOneSentence(error, Fault::input, std::format("there is no plan {}", id));
}

// --- devices and texts -----------------------------------------------------------------------------------------------

TEST_CASE("backends: a text that does not compile is one sentence, every time") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api());
    plan.programs[0].stages[1] = glsl(subject.api(), Stage::fragment, "void main() { undeclared = 1.0; }\n");
    for (int i = 0; i < 2; ++i) {
        auto failed = subject.backend->prepare(plan);
        REQUIRE_FALSE(failed);
        checkOneSentence(failed.error(), Fault::device, failed.error().text);
        CHECK_THAT(failed.error().text,
                   ContainsSubstring("triangle: hand.glsl (fragment): fragment shader does not compile: ") &&
                       ContainsSubstring("undeclared"));
    }
    CHECK(onlyUpperHalf(subject.image(trianglePlan(subject.api())), kRed));
}

TEST_CASE("backends: a plan for which there is no memory leaves nothing behind") {
    Subject subject(Needs::images);
    const DeviceCaps& caps = subject.backend->caps();
    FramePlan plan = trianglePlan(subject.api());
    const PlanId before = subject.prepare(plan);
    // As much as checkPlan lets through: nearly all of the device's memory, or more than any has.
    const uint64_t all = caps.deviceBytes ? caps.deviceBytes / 100 * 99 : uint64_t{1} << 46;
    const uint64_t each = std::min(caps.maxBufferBytes, all / 6) / 4096 * 4096;
    for (uint32_t slot : {SLOT_MESHLET, SLOT_MESHLET_DATA, SLOT_MESHLET_EXTRA, SLOT_TUPLE, SLOT_CAPTURE, SLOT_TANGENT})
        plan.streams.push_back({.slot = slot, .use = useAttributes, .gpuBytes = each});
    if (planBytes(plan) < all / 10 * 9) SKIP("the largest plan fits into " + caps.name);
    for (int i = 0; i < 3; ++i) {
        auto failed = subject.backend->prepare(plan);
        if (failed) {
            subject.backend->release(*failed);
            SKIP(caps.name + " holds the largest plan");
        }
        CHECK(failed.error().fault == Fault::device);
        CHECK_THAT(failed.error().text,
                   ContainsSubstring("triangle: slot ") && ContainsSubstring("MiB of device memory"));
    }
    subject.run(before);
    CHECK(onlyUpperHalf(must(subject.backend->readImage(before)), kRed));
}

TEST_CASE("backends: a device is opened by its number in the list") {
    Subject subject(Needs::images);
    const bool vulkan = subject.api() == Api::vulkan;
    const auto devices = must(vulkan ? listVulkanDevices() : listGlDevices());
    const std::string& name = subject.backend->caps().name;
    CHECK(std::ranges::find(devices, name, &DeviceCaps::name) != devices.end());
    for (const DeviceCaps& caps : devices) {
        CAPTURE(caps.name);
        CHECK(caps.api == subject.api());
        CHECK_FALSE((caps.name.empty() || caps.driver.empty() || caps.version.empty()));
        CHECK((caps.uuid.empty() || caps.uuid.size() == 36));
        CHECK(caps.pci == pciText(caps.pci));
        CHECK((caps.timestampPeriodNs > 0) == (caps.timestampBits > 0));
        CHECK(std::ranges::is_sorted(caps.extensions));
    }
    auto open = vulkan ? openVulkan : openGl;
    CHECK(must(open({.device = 0}))->caps().name == devices.front().name);
    const auto none = open({.device = devices.size()});
    REQUIRE_FALSE(none);
    CHECK(none.error().fault == Fault::device);
    CHECK_THAT(none.error().text, ContainsSubstring(std::format("no device {}", devices.size())));
}
