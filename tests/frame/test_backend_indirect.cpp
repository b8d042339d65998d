// Draws and dispatches whose counts the device writes, on every backend that draws.
#include "tests/frame/subject.h"

using namespace skinbench;
using namespace skinbench::hand;

TEST_CASE("backends: an indirect draw counts what the device wrote, and takes the rest from its command") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api(), {0, 1, 2, 3, 2, 1});
    plan.streams.push_back(
        {.slot = SLOT_COMMAND,
         .use = useStorage | useIndirect,
         .bytes = bytesOf(std::vector<DrawCommand>{{.count = 3, .firstIndex = 0, .baseVertex = 1},
                                                   {.count = 0, .firstIndex = 3, .baseVertex = 1}})});
    plan.passes[0].draws = {{.constants = {0, kRed, 0, 0}, .command = 0}};
    CHECK(onlyUpperHalf(subject.image(plan), kRed));
    plan.passes[0].draws = {{.constants = {0, kRed, 0, 0}, .command = 1}};
    CHECK(nothingDrawn(subject.image(plan)));
    // The second command is written by a pass before, and the first one emptied.
    plan.programs.push_back({.label = "count", .stages = {glsl(subject.api(), Stage::compute, R"(
layout(local_size_x = 1) in;
layout(std430, binding = SLOT_COMMAND) buffer CommandBlock { uint words[]; };
void main() {
    words[0] = 0u;
    atomicAdd(words[5], 3u - words[5]);
}
)")}});
    plan.passes.insert(plan.passes.begin(),
                       {.label = "cull", .kind = PassKind::dispatch, .program = 1, .draws = {{.count = 1}}});
    plan.passes[1].draws = {{.constants = {0, kRed, 0, 0}, .command = 0},
                            {.constants = {0, kGreen, 0, 0}, .command = 1}};
    for (RunMode mode : drawingModes(subject)) {
        const Image image = subject.image(plan, {stillFrame()}, mode);
        CHECK(upperHalf(image) == kBackground);
        CHECK(lowerHalf(image) == kGreen);
    }
}

namespace {

// A dispatch that sets the first word of command `command` to the number that its draw's second constant says.
void addCounting(FramePlan& plan, Api api, uint32_t command, uint32_t count) {
    plan.programs.push_back({.label = "count", .stages = {glsl(api, Stage::compute, R"(
layout(local_size_x = 1) in;
layout(std430, binding = SLOT_COMMAND) buffer CommandBlock { uint words[]; };
void main() { words[drawConstants.x * 5u] = drawConstants.y; }
)")}});
    plan.passes.insert(plan.passes.begin(), {.label = "count",
                                             .kind = PassKind::dispatch,
                                             .program = static_cast<uint32_t>(plan.programs.size() - 1),
                                             .draws = {{.count = 1, .constants = {command, count, 0, 0}}}});
}

}  // namespace

TEST_CASE("backends: an indirect dispatch starts as many work groups as the device wrote") {
    Subject subject(Needs::images);
    for (uint32_t groups : {0u, 1u, 3u}) {
        FramePlan plan = dispatchPlan(subject.api(), R"(
layout(local_size_x = 1) in;
layout(std430, binding = SLOT_SKINNED) writeonly buffer SkinnedBlock { vec4 skinned[]; };
void main() { skinned[gl_WorkGroupID.x] = vec4(drawConstants.z); }
)",
                                      4);
        plan.passes[0].draws = {{.constants = {0, 0, 7, 0}, .command = 1}};
        plan.streams.push_back({.slot = SLOT_COMMAND,
                                .use = useStorage | useIndirect,
                                .bytes = bytesOf(std::vector<DrawCommand>(2, groupCommand(9, MeshDialect::none)))});
        addCounting(plan, subject.api(), 1, groups);
        for (RunMode mode : {RunMode::timed, RunMode::overlap, RunMode::batch}) {
            const PlanId id = subject.prepare(plan);
            subject.run(id, {stillFrame()}, mode);
            std::vector<Point> wanted(4, {0, 0, 0, 0});
            for (uint32_t i = 0; i < groups; ++i) wanted[i] = {7, 7, 7, 7};
            CHECK(subject.stream<Point>(id, SLOT_SKINNED) == wanted);
        }
    }
}

TEST_CASE("backends: an indirect mesh draw starts as many work groups as the device wrote, behind a task stage too") {
    Subject subject(Needs::images);
    for (MeshDialect dialect : {MeshDialect::ext, MeshDialect::nv})
        for (bool withTask : {false, true}) {
            const MeshLimitsOfDevice& limits = meshLimits(subject.backend->caps(), dialect);
            if (!limits.available || (withTask && !limits.taskStages)) continue;
            CAPTURE(dialect == MeshDialect::nv, withTask);
            for (uint32_t groups : {0u, 1u, 2u}) {
                FramePlan plan = meshPlan(subject.api(), dialect, withTask);
                plan.passes[0].draws = {{.constants = {0, kBlue, 0, 0}, .command = 1}};
                plan.streams.push_back({.slot = SLOT_COMMAND,
                                        .use = useStorage | useIndirect,
                                        .bytes = bytesOf(std::vector<DrawCommand>(2, groupCommand(1, dialect)))});
                addCounting(plan, subject.api(), 1, groups);
                for (RunMode mode : drawingModes(subject)) {
                    const Image image = subject.image(plan, {stillFrame()}, mode);
                    CHECK(upperHalf(image) == (groups > 0 ? kBlue : kBackground));
                    CHECK(lowerHalf(image) == (groups > 1 ? kBlue : kBackground));
                }
            }
        }
}

TEST_CASE("backends: a pass may overwrite the command that a draw before it has read") {
    Subject subject(Needs::images);
    FramePlan plan = trianglePlan(subject.api(), {0, 1, 2, 3, 2, 1});
    plan.streams.push_back({.slot = SLOT_COMMAND, .use = useStorage | useIndirect, .gpuBytes = sizeof(DrawCommand)});
    plan.programs.push_back({.label = "write", .stages = {glsl(subject.api(), Stage::compute, R"(
layout(local_size_x = 1) in;
layout(std430, binding = SLOT_COMMAND) buffer CommandBlock { uint words[]; };
void main() {
    words[0] = 3u;
    words[1] = 1u;
    words[2] = drawConstants.x;
    words[3] = 1u;
}
)")}});
    Pass write{.label = "cull", .kind = PassKind::dispatch, .program = 1, .draws = {{.count = 1}}}, other = write;
    other.draws[0].constants = {3, 0, 0, 0};
    plan.passes[0].draws = {{.constants = {0, kRed, 0, 0}, .command = 0}};
    Pass image = plan.passes[0];
    image.clear = false;
    plan.passes = {write, plan.passes[0], other, image};
    for (RunMode mode : drawingModes(subject))
        CHECK(countOf(subject.image(plan, {stillFrame()}, mode), kRed) == size_t{kWidth} * kHeight);
}
