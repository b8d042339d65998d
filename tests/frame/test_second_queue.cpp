// FramePlan::passesAhead and streams in turn, on every backend whose device has a second queue.
#include <algorithm>

#include "common/frame/check_plan.h"
#include "tests/frame/subject.h"

using namespace skinbench;
using namespace skinbench::hand;

namespace {

constexpr uint32_t kNumbers = 1 << 16;
constexpr RunMode kModes[] = {RunMode::timed, RunMode::overlap, RunMode::batch};

// One pass writes a frame's number everywhere, and the next one reads it slowly, all over. What it finds is kept for
// each frame, so that a number of another frame shows wherever it was read.
FramePlan numbersPlan(Api api, size_t frames) {
    FramePlan plan = dispatchPlan(api, R"(
layout(local_size_x = 64) in;
layout(std140, binding = SLOT_FRAME) uniform FrameBlock { FrameConstants frame; };
layout(std430, binding = SLOT_SKINNED) writeonly buffer SkinnedBlock { vec4 skinned[]; };
void main() { skinned[gl_GlobalInvocationID.x] = vec4(frame.grid.w); }
)",
                                  kNumbers);
    plan.passes[0].draws[0].count = kNumbers / 64;
    plan.programs.push_back({.label = "read", .stages = {glsl(api, Stage::compute, R"(
layout(local_size_x = 64) in;
layout(std140, binding = SLOT_FRAME) uniform FrameBlock { FrameConstants frame; };
layout(std430, binding = SLOT_SKINNED) readonly buffer SkinnedBlock { vec4 skinned[]; };
layout(std430, binding = SLOT_CAPTURE) buffer CaptureBlock { uint wrong[]; };
void main() {
    uint found = 0u;
    for (uint i = 0u; i < 256u; ++i)
        found += uint(skinned[(gl_GlobalInvocationID.x + i * 4099u) & 65535u].x != frame.grid.w);
    if (found != 0u) atomicAdd(wrong[uint(frame.grid.w)], found);
}
)")}});
    plan.passes.push_back(
        {.label = "read", .kind = PassKind::dispatch, .program = 1, .draws = {{.count = kNumbers / 64}}});
    plan.streams.push_back({.slot = SLOT_CAPTURE, .gpuBytes = frames * sizeof(uint32_t)});
    plan.passesAhead = 1;
    plan.streams[*streamOfSlot(plan, SLOT_SKINNED)].inTurn = true;
    return plan;
}

bool hasQueue(Subject& subject, const FramePlan& plan) {
    if (subject.backend->caps().secondQueue) return true;
    auto refused = subject.backend->prepare(plan);
    REQUIRE_FALSE(refused);
    checkOneSentence(
        refused.error(), Fault::device,
        plan.label + ": " + subject.backend->caps().name + " has no second queue for passes that run ahead");
    return false;
}

}  // namespace

TEST_CASE("second queue: every frame reads what was prepared for it, not for one before or behind it") {
    Subject subject;
    constexpr size_t kFrames = 50;
    const FramePlan plan = numbersPlan(subject.api(), kFrames);
    if (!hasQueue(subject, plan)) return;
    const PlanId id = subject.prepare(plan);
    std::vector<FrameInput> frames(kFrames, stillFrame());
    for (size_t i = 0; i < kFrames; ++i) frames[i].constants.grid.w = static_cast<float>(i);
    // Twice, so that the second batch begins behind the end of the first one.
    for (RunMode mode : {RunMode::batch, RunMode::batch, RunMode::timed, RunMode::overlap, RunMode::batch})
        CHECK(subject.run(id, frames, mode).size() == kFrames);
    CHECK(subject.stream<uint32_t>(id, SLOT_CAPTURE) == std::vector<uint32_t>(kFrames, 0));
    if (!subject.draws) return;
    for (size_t count : {1, 2, 3, 4}) {
        subject.run(id, {frames.begin(), frames.begin() + static_cast<ptrdiff_t>(count)}, RunMode::batch);
        const auto last = static_cast<float>(count - 1);
        CHECK(subject.stream<Point>(id, SLOT_SKINNED)[7] == Point{last, last, last, last});
    }
}

TEST_CASE("second queue: a batch draws the image of its last frame, and its time is that of all frames") {
    Subject subject;
    FramePlan plan = computePlan(subject.api());
    plan.passesAhead = 1;
    plan.streams[*streamOfSlot(plan, SLOT_SKINNED)].inTurn = true;
    if (!hasQueue(subject, plan)) return;
    const PlanId id = subject.prepare(plan);
    for (RunMode mode : kModes)
        for (size_t count : {1, 2, 5}) {
            std::vector<FrameInput> frames(count, posedFrame(kIdentity));
            frames.back() = posedFrame(kTurned);
            for (const Timing& timing : subject.run(id, frames, mode)) {
                CHECK(timing.passes.size() == (mode == RunMode::timed ? 2 : 1));
                CHECK(std::ranges::all_of(timing.passes, [](double ms) { return ms >= 0 && ms < 60'000; }));
            }
            if (!subject.draws) continue;
            const Image image = must(subject.backend->readImage(id));
            CHECK(upperHalf(image) == kBackground);
            CHECK(lowerHalf(image) == kGreen);
        }
}

TEST_CASE("second queue: both buffers of a stream in turn begin with its bytes, and count as memory") {
    Subject subject;
    FramePlan plan = numbersPlan(subject.api(), 4);
    const uint64_t once = planBytes(plan);
    plan.streams.push_back({.slot = SLOT_TUPLE, .bytes = bytesOf(std::vector<uint32_t>{3, 1, 4}), .inTurn = true});
    CHECK(planBytes(plan) == once + 24);
    CHECK(streamBytes(plan.streams.back()) == 12);
    if (!hasQueue(subject, plan)) return;
    const PlanId id = subject.prepare(plan);
    for (size_t count : {1, 2}) {
        subject.run(id, std::vector<FrameInput>(count, stillFrame()), RunMode::batch);
        CHECK(subject.stream<uint32_t>(id, SLOT_TUPLE) == std::vector<uint32_t>{3, 1, 4});
    }
}
