// begin() and finish() on every backend: what is on the way while the host goes on.
#include <algorithm>
#include <format>

#include "tests/frame/subject.h"

using namespace skinbench;
using namespace skinbench::hand;

namespace {

// The posed half of the image in green, which is all that computePlan draws.
void checkHalf(const Subject& subject, const Image& image, const Rows& pose) {
    REQUIRE(image.rgba.size() == size_t{4} * kWidth * kHeight);
    if (!subject.draws) return;
    CHECK(upperHalf(image) == (pose == kIdentity ? kGreen : kBackground));
    CHECK(lowerHalf(image) == (pose == kIdentity ? kBackground : kGreen));
}

// The frame's palette is overwritten once it has begun.
void begin(const Subject& subject, PlanId id, Rows pose) {
    must(subject.backend->begin(id, posedFrame(pose)));
    pose = {};
}

Image finished(const Subject& subject, PlanId id) { return must(subject.backend->finish(id)).image; }

}  // namespace

TEST_CASE("backends: frames in flight have their own input, and are finished in the order in which they began") {
    Subject subject;
    const PlanId id = subject.prepare(computePlan(subject.api()));
    const std::array poses = {kIdentity, kTurned, kTurned, kIdentity, kTurned, kIdentity, kIdentity};
    begin(subject, id, poses[0]);
    for (size_t frame = 0; frame < poses.size(); ++frame) {
        if (frame + 1 < poses.size()) begin(subject, id, poses[frame + 1]);
        checkHalf(subject, finished(subject, id), poses[frame]);
    }
}

TEST_CASE("backends: a frame in flight has its constants, and each draw its part of a uniform palette") {
    Subject subject;
    FramePlan plan = trianglePlan(subject.api(), kUpperReversed);
    plan.paletteBytes = kPaletteAlignment + 16;
    plan.paletteRange = 16;
    plan.programs[0].stages[1] = glsl(subject.api(), Stage::fragment, R"(
layout(std140, binding = SLOT_PALETTE) uniform PaletteBlock { vec4 rows[1]; };
layout(location = 0) in vec4 color;
layout(location = 0) out vec4 target;
void main() { target = rows[0] * color; }
)");
    plan.passes[0].draws[0].paletteOffset = kPaletteAlignment;
    const PlanId id = subject.prepare(plan);
    for (const uint32_t color : {kGreen, kBlue}) {
        std::vector<Point> palette(kPaletteAlignment / 16 + 1, Point{1, 0, 0, 1});
        palette.back() = {0, color == kGreen ? 1.0f : 0.0f, color == kBlue ? 1.0f : 0.0f, 1};
        FrameInput frame = stillFrame();
        frame.constants.viewProjection[0][0] = -1;
        frame.palette = std::as_bytes(std::span(palette));
        must(subject.backend->begin(id, frame));
    }
    for (const uint32_t color : {kGreen, kBlue}) {
        const Image image = finished(subject, id);
        if (!subject.draws) continue;
        CHECK(pixel(image, image.width - 2, 1) == color);
        CHECK(pixel(image, 1, image.height - 2) == kBackground);
    }
}

TEST_CASE("backends: plans of one size have frames in flight side by side") {
    Subject subject;
    const PlanId half = subject.prepare(computePlan(subject.api()));
    const PlanId red = subject.prepare(trianglePlan(subject.api(), {0, 1, 2, 3, 2, 1}));
    const FrameInput still = stillFrame();
    begin(subject, half, kIdentity);
    must(subject.backend->begin(red, still));
    begin(subject, half, kTurned);
    must(subject.backend->begin(red, still));
    for (int frame = 0; frame < 2; ++frame) {
        const Image image = finished(subject, red);
        if (subject.draws) CHECK(countOf(image, kRed) == size_t{kWidth} * kHeight);
        checkHalf(subject, finished(subject, half), frame == 0 ? kIdentity : kTurned);
    }
}

TEST_CASE("backends: other calls come after the frames that have begun, and leave them alone") {
    Subject subject;
    Backend& backend = *subject.backend;
    const PlanId id = subject.prepare(computePlan(subject.api()));
    begin(subject, id, kIdentity);
    begin(subject, id, kTurned);
    checkHalf(subject, must(backend.readImage(id)), kTurned);
    if (subject.draws) CHECK(subject.stream<Point>(id, SLOT_SKINNED)[1] == Point{1, -1, 0.5f, 1});
    subject.run(id, std::vector<FrameInput>(100, posedFrame(kIdentity)));
    checkHalf(subject, must(backend.readImage(id)), kIdentity);
    checkHalf(subject, finished(subject, id), kIdentity);
    begin(subject, id, kIdentity);
    const PlanId other = subject.prepare(trianglePlan(subject.api()));
    subject.run(other);
    checkHalf(subject, finished(subject, id), kTurned);
    CHECK_FALSE(backend.readImage(id));  // the other plan's is in its place
    checkHalf(subject, finished(subject, id), kIdentity);
    subject.run(id, {posedFrame(kTurned)});
    checkHalf(subject, must(backend.readImage(id)), kTurned);
}

TEST_CASE("backends: a released plan takes its frames in flight with it") {
    Subject subject;
    Backend& backend = *subject.backend;
    const PlanId gone = subject.prepare(computePlan(subject.api())), id = subject.prepare(computePlan(subject.api()));
    begin(subject, gone, kIdentity);
    begin(subject, id, kTurned);
    begin(subject, gone, kIdentity);
    backend.release(gone);
    const auto none = backend.finish(gone);
    REQUIRE_FALSE(none);
    checkOneSentence(none.error(), Fault::input, std::format("there is no plan {}", gone));
    checkHalf(subject, finished(subject, id), kTurned);
    begin(subject, id, kIdentity);  // dropped with the plan at the end
}

TEST_CASE("backends: a finished frame has the timing of a timed one") {
    Subject subject;
    const PlanId id = subject.prepare(computePlan(subject.api()));
    for (const Rows& pose : {kIdentity, kTurned}) begin(subject, id, pose);
    for (int frame = 0; frame < 2; ++frame) {
        const Timing timing = must(subject.backend->finish(id)).timing;
        CHECK(timing.passes.size() == 2);
        CHECK(std::ranges::all_of(timing.passes, [](double ms) { return ms >= 0 && ms < 60'000; }));
        CHECK(timing.upload == 0);
        CHECK((timing.record > 0) == subject.draws);
        CHECK_FALSE(timing.counters);
    }
}

TEST_CASE("backends: a frame that cannot begin is refused in one sentence, and nothing has begun") {
    Subject subject;
    Backend& backend = *subject.backend;
    FramePlan written = computePlan(subject.api());
    written.streams[2].hostWritten = true;
    const PlanId id = subject.prepare(computePlan(subject.api())), host = subject.prepare(written);
    const PlanId dispatch =
        subject.prepare(dispatchPlan(subject.api(), "layout(local_size_x = 1) in;\nvoid main() {}\n", 1));
    const auto refused = [&](PlanId plan, const FrameInput& frame, const std::string& sentence) {
        const auto begun = backend.begin(plan, frame);
        REQUIRE_FALSE(begun);
        checkOneSentence(begun.error(), Fault::input, sentence);
    };
    const auto nothing = [&](PlanId plan, const std::string& sentence) {
        const auto none = backend.finish(plan);
        REQUIRE_FALSE(none);
        checkOneSentence(none.error(), Fault::input, sentence);
    };
    nothing(id, "compute: no frame has begun");
    refused(id, stillFrame(), "compute: frame 0 has a palette of 0 bytes, and the plan needs 48");
    refused(host, posedFrame(kIdentity), "compute: the host writes its vertices; run its frames one by one");
    refused(dispatch, stillFrame(), "dispatch: draws no image");
    refused(0, stillFrame(), "there is no plan 0");
    for (const Rows& pose : {kTurned, kIdentity}) begin(subject, id, pose);
    refused(id, posedFrame(kTurned), "compute: 2 frames have begun; finish one of them first");
    for (const Rows& pose : {kTurned, kIdentity}) checkHalf(subject, finished(subject, id), pose);
    nothing(id, "compute: no frame has begun");
}
