// What every backend refuses, in the same sentence.
#include <algorithm>
#include <format>
#include <functional>

#include "tests/frame/subject.h"

using namespace skinbench;
using namespace skinbench::hand;

namespace {

// A change of computePlan(), and the sentence that it earns.
struct Broken {
    std::string sentence;
    std::function<void(FramePlan&)> change;
};

void requireRefused(Subject& subject, Fault fault, const std::vector<Broken>& all) {
    const FramePlan good = computePlan(subject.api());
    for (const Broken& broken : all) {
        CAPTURE(broken.sentence);
        FramePlan plan = good;
        broken.change(plan);
        plan.label = good.label;
        auto refused = subject.backend->prepare(plan);
        REQUIRE_FALSE(refused);
        checkOneSentence(refused.error(), fault, "compute: " + broken.sentence);
    }
    subject.run(subject.prepare(good), {posedFrame(kIdentity)});
}

std::string mebibytes(uint64_t bytes) { return std::format("{:.1f} MiB", static_cast<double>(bytes) / 1048576); }

}  // namespace

TEST_CASE("backends refuse a plan that no device can run") {
    Subject subject;
    const std::vector<Broken> all = {
        {"slot 1 is not one that a stream may have", [](FramePlan& p) { p.streams[0].slot = SLOT_PALETTE; }},
        {std::format("slot {} is not one that a stream may have", SLOT_COUNT),
         [](FramePlan& p) { p.streams[0].slot = SLOT_COUNT; }},
        {"two streams at slot 7", [](FramePlan& p) { p.streams[0].slot = SLOT_SKINNED; }},
        {"the stream at slot 2 adds to 32-bit words, and is not made of them",
         [](FramePlan& p) { p.streams[0].bytes = bytesOf(std::vector<char>(7)), p.streams[0].replicaAdd = 1; }},
        {"two streams feed indexed draws", [](FramePlan& p) { p.streams[0].use |= useIndices; }},
        {"two streams hold the commands of indirect draws",
         [](FramePlan& p) { p.streams[0].use |= useIndirect, p.streams[2].use |= useIndirect; }},
        {"pass 'draw': a draw reads command 0, and there are 0",
         [](FramePlan& p) { p.passes[1].draws[0].command = 0; }},
        {"pass 'draw': a draw reads command 3, and there are 3",
         [](FramePlan& p) {
             p.streams.push_back({.slot = SLOT_COMMAND, .use = useIndirect, .gpuBytes = 3 * sizeof(DrawCommand) + 19});
             p.passes[1].draws[0].command = 3;
         }},
        {"pass 'skin': a draw reads command 0, and there are 0",
         [](FramePlan& p) { p.passes[0].draws[0].command = 0; }},
        {"the stream at slot 7 is in turn, and no pass runs ahead", [](FramePlan& p) { p.streams[2].inTurn = true; }},
        {"the stream at slot 7 is in turn, and the host writes it",
         [](FramePlan& p) { p.streams[2].inTurn = p.streams[2].hostWritten = true; }},
        {"passes run ahead of what the host writes for each frame",
         [](FramePlan& p) { p.passesAhead = 1, p.streams[2].hostWritten = true; }},
        {"3 passes run ahead, and there are 2", [](FramePlan& p) { p.passesAhead = 3; }},
        {"pass 'draw' draws, so that it cannot run ahead", [](FramePlan& p) { p.passesAhead = 2; }},
        {"two streams are written by the host",
         [](FramePlan& p) { p.streams[0].hostWritten = p.streams[2].hostWritten = true; }},
        {"pass 'draw': no stream feeds its indexed draws",
         [](FramePlan& p) { p.streams.erase(p.streams.begin() + 1); }},
        {"pass 'draw': names program 2 of 2", [](FramePlan& p) { p.passes[1].program = 2; }},
        {"pass 'draw': program 'skin' has a compute stage, which this kind of pass has not",
         [](FramePlan& p) { p.passes[1].program = 0; }},
        {"pass 'skin': program 'pull' has a vertex stage, which this kind of pass has not",
         [](FramePlan& p) { p.passes[0].program = 1; }},
        {"pass 'draw': program 'pull' has no vertex stage",
         [](FramePlan& p) { p.programs[1].stages.erase(p.programs[1].stages.begin()); }},
        {"pass 'draw': program 'pull' takes its attributes from slot 2, where no stream feeds any",
         [](FramePlan& p) { p.programs[1].attributes = {{}}; }},
        {"pass 'draw': draws 3 indices from number 1 on, and there are 3",
         [](FramePlan& p) { p.passes[1].draws[0].firstIndex = 1; }},
        {"pass 'skin': a draw sees 48 bytes of palette from byte 256 on, and a frame has 300",
         [](FramePlan& p) { p.paletteBytes = 300, p.paletteRange = 48, p.passes[0].draws[0].paletteOffset = 256; }},
        {"pass 'skin': a draw sees 48 bytes of palette from byte 16 on, and a frame has 300",
         [](FramePlan& p) { p.paletteBytes = 300, p.paletteRange = 48, p.passes[0].draws[0].paletteOffset = 16; }},
        {"pass 'draw': draws meshlets in no dialect",
         [&](FramePlan& p) {
             p = meshPlan(subject.api(), MeshDialect::ext, false);
             p.dialect = MeshDialect::none;
         }},
    };
    requireRefused(subject, Fault::input, all);
}

TEST_CASE("backends refuse a plan that their device cannot hold, with both numbers") {
    Subject subject;
    const DeviceCaps& caps = subject.backend->caps();
    const std::string& name = caps.name;
    const uint64_t storage = std::min(caps.maxStorageBytes, caps.maxBufferBytes), uniform = caps.maxUniformBytes;
    const std::string allows = std::format(": {} allows {}; use a smaller scene", name, mebibytes(storage));
    const std::string images = std::format("{} draws 1x1 to {}x{}", name, caps.maxImageSize, caps.maxImageSize);
    std::vector<Broken> all = {
        {"needs a storage buffer of " + mebibytes(storage + 4) + allows,
         [&](FramePlan& p) { p.streams[2].gpuBytes = storage + 4; }},
        {"needs a palette of " + mebibytes(storage + 48) + allows,
         [&](FramePlan& p) { p.paletteBytes = storage + 48; }},
        {std::format("needs a uniform buffer of {} for 5 copies: {} allows {}; use fewer copies",
                     mebibytes(uniform + 4), name, mebibytes(uniform)),
         [&](FramePlan& p) {
             p.streams[0].replicas = 5;
             p.streams.push_back({.slot = SLOT_TUPLE, .use = useUniform, .gpuBytes = uniform + 4});
         }},
        {std::format("needs an image of {}x48 pixels: {}", caps.maxImageSize + 1, images),
         [&](FramePlan& p) { p.width = caps.maxImageSize + 1; }},
        {"needs an image of 64x0 pixels: " + images, [](FramePlan& p) { p.height = 0; }},
    };
    if (uniform < UINT32_MAX - 48)
        all.push_back(
            {std::format("needs a uniform block of {} bytes for joints: {} allows {}", uniform + 48, name, uniform),
             [&](FramePlan& p) { p.paletteBytes = p.paletteRange = static_cast<uint32_t>(uniform + 48); }});
    const uint64_t part = std::min(caps.deviceBytes / 4, caps.maxBufferBytes);
    if (part && part * 6 > caps.deviceBytes)
        all.push_back({std::format("needs {}: {} has {}; use a smaller scene",
                                   mebibytes(planBytes(computePlan(subject.api())) + part * 6), name,
                                   mebibytes(caps.deviceBytes)),
                       [=](FramePlan& p) {
                           for (uint32_t slot : {SLOT_MESHLET, SLOT_MESHLET_DATA, SLOT_MESHLET_EXTRA, SLOT_TUPLE,
                                                 SLOT_CAPTURE, SLOT_TANGENT})
                               p.streams.push_back({.slot = slot, .use = useAttributes, .gpuBytes = part});
                       }});
    if (caps.maxComputeGroupCount < UINT32_MAX)
        all.push_back({std::format("pass 'skin': has a draw of {} work groups: {} allows {}; split it",
                                   caps.maxComputeGroupCount + 1, name, caps.maxComputeGroupCount),
                       [&](FramePlan& p) { p.passes[0].draws[0].count = caps.maxComputeGroupCount + 1; }});
    requireRefused(subject, Fault::device, all);
}

TEST_CASE("backends refuse mesh stages that their device has not, and more work groups than it starts") {
    Subject subject;
    const DeviceCaps& caps = subject.backend->caps();
    for (MeshDialect dialect : {MeshDialect::ext, MeshDialect::nv}) {
        const MeshLimitsOfDevice& limits = meshLimits(caps, dialect);
        const std::string extension = std::string(caps.api == Api::vulkan ? "VK_" : "GL_") +
                                      (dialect == MeshDialect::nv ? "NV" : "EXT") + "_mesh_shader";
        const std::string sentence = !limits.available ? caps.name + " has no " + extension
                                     : !limits.taskStages
                                         ? caps.name + " has no task stages"
                                         : std::format(
                                               "has a draw of {} work groups: {} allows {}; "
                                               "split it",
                                               limits.maxGroupCount + 1, caps.name, limits.maxGroupCount);
        if (limits.maxGroupCount == UINT32_MAX) continue;
        requireRefused(subject, Fault::device, {{"pass 'draw': " + sentence, [&](FramePlan& p) {
                                                     p = meshPlan(caps.api, dialect, true);
                                                     p.passes[0].draws[0].count = limits.maxGroupCount + 1;
                                                 }}});
    }
}

TEST_CASE("backends refuse frames of the wrong size, and slots without a stream") {
    Subject subject;
    FramePlan plan = computePlan(subject.api());
    const PlanId id = subject.prepare(plan);
    plan.streams[2].hostWritten = true;
    const PlanId written = subject.prepare(plan);
    FrameInput frame = posedFrame(kIdentity);
    const std::vector<std::byte> bytes(112);
    auto refused = [&](PlanId of, const std::string& sentence) {
        auto timings = subject.backend->run(of, std::vector{frame});
        REQUIRE_FALSE(timings);
        checkOneSentence(timings.error(), Fault::input, "compute: frame 0 has " + sentence);
    };
    refused(written, "0 bytes of skinned vertices, and the plan needs 128");
    frame.skinned = bytes;
    refused(written, "112 bytes of skinned vertices, and the plan needs 128");
    refused(id, "112 bytes of skinned vertices, and the plan needs 0");
    frame = stillFrame();
    refused(id, "a palette of 0 bytes, and the plan needs 48");
    auto stream = subject.backend->readStream(id, SLOT_TUPLE);
    REQUIRE_FALSE(stream);
    checkOneSentence(stream.error(), Fault::input, "compute: no stream at slot 6");
    subject.run(id, {posedFrame(kIdentity)});
}
