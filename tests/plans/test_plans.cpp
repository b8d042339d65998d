// The plans: draws, buffers, limits. No driver takes part.
#include <algorithm>
#include <cstring>
#include <format>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/frame/check_plan.h"
#include "common/scene/skin_cpu.h"
#include "tests/plans/plan_of.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

std::set<uint32_t> slotsOf(const FramePlan& plan) {
    std::set<uint32_t> slots;
    for (const Stream& stream : plan.streams) CHECK(slots.insert(stream.slot).second);
    return slots;
}

// Every (copy, group) pair that the draws of a pass start; fails when one is started twice.
std::set<std::pair<uint32_t, uint32_t>> groupsOf(const Pass& pass) {
    std::set<std::pair<uint32_t, uint32_t>> groups;
    for (const Draw& draw : pass.draws)
        for (uint32_t group = 0; group < draw.count; ++group)
            if (!groups.emplace(draw.constants[0], draw.constants[1] + group).second) FAIL("a group is started twice");
    return groups;
}

std::set<std::pair<uint32_t, uint32_t>> grid(uint32_t copies, uint32_t groups) {
    std::set<std::pair<uint32_t, uint32_t>> all;
    for (uint32_t copy = 0; copy < copies; ++copy)
        for (uint32_t group = 0; group < groups; ++group) all.emplace(copy, group);
    return all;
}

}  // namespace

TEST_CASE("uniform palettes are blocks that draws point into") {
    Workload workload = tinyWorkload(3);
    Case mesh = makeCase("vk-ext", "mesh");
    mesh.shape.uniformPalette = true;
    Case palette = makeCase("vk", "palette");
    palette.paletteSlots = 9;
    for (const Case& c : {mesh, palette}) {
        INFO(caseId(c));
        const FramePlan plan = planOf(workload, c, generousCaps(c.route->api));
        const auto input = planInput(workload, c);
        const auto blocks = paletteBlocks(c, *input);
        REQUIRE(blocks);
        CHECK(plan.paletteRange == blocks->size * sizeof(PaletteEntry));
        CHECK(plan.paletteBytes == blocks->stride() * (blocks->joints.size() / blocks->size) * 3);
        std::set<uint64_t> offsets;
        for (const Draw& draw : passOf(plan, "draw").draws) {
            CHECK(draw.paletteOffset % kPaletteAlignment == 0);
            CHECK(draw.paletteOffset + plan.paletteRange <= plan.paletteBytes);
            offsets.insert(draw.paletteOffset);
        }
        CHECK(offsets.size() == 3 * (blocks->joints.size() / blocks->size));
        const FrameData frame = *makeFrame(workload, 4, 0);
        const std::vector<std::byte> bytes = *paletteBytes(*input, blocks, frame);
        REQUIRE(bytes.size() == plan.paletteBytes);
        for (size_t i = 0; i < blocks->joints.size(); ++i) {
            if (blocks->joints[i] == kNoJoint) continue;
            const size_t at = i / blocks->size * blocks->stride() + i % blocks->size * sizeof(PaletteEntry);
            CHECK(std::memcmp(&bytes[at], &frame.phases[0][blocks->joints[i]], sizeof(PaletteEntry)) == 0);
        }
    }
    DeviceCaps small = generousCaps(Api::vulkan);
    small.maxUniformBytes = 12 * sizeof(PaletteEntry) - 1;
    const auto refused = makePlan(mesh, *planInput(workload, mesh), small);
    REQUIRE(!refused);
    CHECK_THAT(refused.error().text, ContainsSubstring("needs a uniform block of 576 bytes for joints"));
}

TEST_CASE("indexed draws: one a copy, or one for all with shifted indices") {
    Workload workload = tinyWorkload(3);
    for (const char* variant : {"none", "vertex", "compute", "cpu"}) {
        Case c = makeCase("vk", variant);
        INFO(variant);
        auto scene = sceneFor(workload, 4);
        REQUIRE(scene);
        const Mesh& mesh = (*scene)->mesh;
        const auto vertices = static_cast<uint32_t>(mesh.positions.size());
        const auto indices = static_cast<uint32_t>(mesh.indices.size());

        const FramePlan perCopy = planOf(workload, c, generousCaps(Api::vulkan));
        const Pass draw = passOf(perCopy, "draw");
        CHECK(draw.kind == PassKind::drawIndexed);
        REQUIRE(draw.draws.size() == 3);
        for (uint32_t copy = 0; copy < 3; ++copy) {
            CHECK(draw.draws[copy].count == indices);
            CHECK(draw.draws[copy].firstIndex == copy * indices);
            CHECK(draw.draws[copy].baseVertex == static_cast<int32_t>(copy * vertices));
            CHECK(draw.draws[copy].constants == std::array<uint32_t, 4>{copy, 0, 0, 0});
        }
        CHECK(streamOf(perCopy, SLOT_INDEX)->replicas == 3);
        CHECK(streamOf(perCopy, SLOT_INDEX)->replicaAdd == 0);

        c.submission = Submission::batched;
        const FramePlan batched = planOf(workload, c, generousCaps(Api::vulkan));
        REQUIRE(passOf(batched, "draw").draws.size() == 1);
        CHECK(passOf(batched, "draw").draws[0].count == indices * 3);
        CHECK(passOf(batched, "draw").draws[0].baseVertex == 0);
        // Through the null backend, the whole index buffer as a driver would receive it.
        auto null = openNull(generousCaps(Api::vulkan));
        const auto bytes = null->readStream(*null->prepare(batched), SLOT_INDEX);
        REQUIRE(bytes);
        std::vector<uint32_t> wanted;
        for (uint32_t copy = 0; copy < 3; ++copy)
            for (uint32_t index : mesh.indices) wanted.push_back(index + copy * vertices);
        CHECK(std::ranges::equal(*bytes, std::as_bytes(std::span(wanted))));
    }
}

TEST_CASE("work groups: every group of every copy exactly once, also where the device allows few") {
    Workload workload = tinyWorkload(5);
    for (const char* name : {"vk-ext", "vk-nv", "gl-ext", "gl-nv"})
        for (uint32_t most : {1u, 2u, 7u, 65535u, UINT32_MAX}) {
            Case c = makeCase(name, "mesh");
            c.limits = {16, 16};
            DeviceCaps caps = generousCaps(c.route->api);
            caps.ext.maxGroupCount = caps.nv.maxGroupCount = most;
            auto input = planInput(workload, c);
            REQUIRE(input);
            const auto meshlets = static_cast<uint32_t>(input->meshlets->meshlets.size());
            REQUIRE(meshlets > 10);
            INFO(name << " " << most);
            const FramePlan perCopy = planOf(workload, c, caps);
            CHECK(passOf(perCopy, "draw").kind == PassKind::drawMesh);
            CHECK(groupsOf(passOf(perCopy, "draw")) == grid(5, meshlets));
            c.submission = Submission::batched;
            const FramePlan batched = planOf(workload, c, caps);
            CHECK(groupsOf(passOf(batched, "draw")) == grid(1, meshlets * 5));
            for (const FramePlan* plan : {&perCopy, &batched})
                for (const Draw& draw : passOf(*plan, "draw").draws) {
                    CHECK(draw.count > 0);
                    CHECK(draw.count <= std::min(most, 65535u));
                }
        }
}

TEST_CASE("compute groups of 64 vertices are split too") {
    Workload workload = tinyWorkload(4);
    const auto vertices = static_cast<uint32_t>((*sceneFor(workload, 4))->mesh.positions.size());
    for (uint32_t most : {1u, 3u, 65535u}) {
        Case c = makeCase("gl", "compute");
        DeviceCaps caps = generousCaps(Api::opengl);
        caps.maxComputeGroupCount = most;
        const FramePlan perCopy = planOf(workload, c, caps);
        CHECK(passOf(perCopy, "skin").kind == PassKind::dispatch);
        CHECK(groupsOf(passOf(perCopy, "skin")) == grid(4, (vertices + 63) / 64));
        c.submission = Submission::batched;
        const FramePlan batched = planOf(workload, c, caps);
        CHECK(groupsOf(passOf(batched, "skin")) == grid(1, (vertices * 4 + 63) / 64));
    }
}

TEST_CASE("a draw of more than 65535 groups is split on a device without a limit") {
    Workload workload = tinyWorkload(20'000);
    Case c = makeCase("vk-ext", "mesh");
    c.submission = Submission::batched;
    c.limits = {16, 16};
    DeviceCaps caps = generousCaps(Api::vulkan);
    caps.ext.maxGroupCount = UINT32_MAX;
    auto input = planInput(workload, c);
    REQUIRE(input);
    const uint64_t groups = uint64_t{input->meshlets->meshlets.size()} * 20'000;
    const FramePlan plan = planOf(workload, c, caps);
    uint64_t next = 0;
    for (const Draw& draw : passOf(plan, "draw").draws) {
        CHECK(draw.count <= 65535);
        CHECK(draw.constants[1] == next);
        next += draw.count;
    }
    CHECK(next == groups);
    CHECK(passOf(plan, "draw").draws.size() == (groups + 65534) / 65535);
}

TEST_CASE("the streams of each variant are what its passes read") {
    Workload workload = tinyWorkload(2);
    const DeviceCaps caps = generousCaps(Api::vulkan);
    auto slots = [&](const Case& c, bool capture = false) { return slotsOf(planOf(workload, c, caps, capture)); };
    using Set = std::set<uint32_t>;
    CHECK(slots(makeCase("vk", "none")) == Set{SLOT_VERTEX, SLOT_INDEX});
    CHECK(slots(makeCase("vk", "vertex"), true) == Set{SLOT_VERTEX, SLOT_INDEX, SLOT_CAPTURE});
    CHECK(slots(makeCase("vk", "compute")) == Set{SLOT_VERTEX, SLOT_SKINNED, SLOT_INDEX});
    CHECK(slots(makeCase("vk", "cpu")) == Set{SLOT_SKINNED, SLOT_INDEX});
    CHECK(slots(makeCase("vk-nv", "mesh")) == Set{SLOT_VERTEX, SLOT_MESHLET, SLOT_MESHLET_DATA});
    CHECK(slots(makeCase("cpu", "cpu")).empty());

    const auto vertices = (*sceneFor(workload, 4))->mesh.positions.size();
    const uint64_t skinned = 2 * vertices * sizeof(SkinnedVertex);
    const FramePlan compute = planOf(workload, makeCase("vk", "compute"), caps);
    REQUIRE(compute.passes.size() == 2);
    CHECK(compute.passes[0].label == "skin");
    CHECK(compute.passes[1].label == "draw");
    CHECK(streamOf(compute, SLOT_SKINNED)->gpuBytes == skinned);
    CHECK(streamOf(compute, SLOT_SKINNED)->use == (useStorage | useAttributes));
    CHECK(!streamOf(compute, SLOT_SKINNED)->hostWritten);
    CHECK(compute.programs[compute.passes[1].program].attributeSlot == SLOT_SKINNED);
    CHECK(compute.programs[compute.passes[1].program].attributeStride == sizeof(SkinnedVertex));

    const FramePlan cpu = planOf(workload, makeCase("vk", "cpu"), caps);
    CHECK(streamOf(cpu, SLOT_SKINNED)->hostWritten);
    CHECK(streamOf(cpu, SLOT_SKINNED)->gpuBytes == skinned);
    CHECK(cpu.paletteBytes == 0);
    CHECK(cpu.passes.size() == 1);
    CHECK(planOf(workload, makeCase("cpu", "cpu"), caps).passes.empty());

    Case pull = makeCase("vk", "vertex");
    CHECK(streamOf(planOf(workload, pull, caps), SLOT_VERTEX)->use == useAttributes);
    pull.fetch = VertexFetch::pull;
    CHECK(streamOf(planOf(workload, pull, caps), SLOT_VERTEX)->use == useStorage);
    CHECK(planOf(workload, pull, caps).programs[0].attributes.empty());

    CHECK(streamOf(planOf(workload, pull, caps, true), SLOT_CAPTURE)->gpuBytes == skinned);
}

TEST_CASE("options of compute: what a skinned vertex holds, and where the draw finds it") {
    struct Wanted {
        ComputeOptions options;
        uint64_t stride;
        std::vector<std::pair<uint32_t, uint32_t>> attributes;  // location, offset
    };
    const std::vector<Wanted> wanted = {
        {{}, 32, {{0, 0}, {1, 16}}},
        {{.staged = true, .earlyExit = true, .halfRate = true}, 32, {{0, 0}, {1, 16}}},
        {{.previous = true}, 48, {{0, 0}, {1, 16}, {2, 32}}},
        {{.tangents = true}, 48, {{0, 0}, {1, 16}, {3, 32}}},
        {{.previous = true, .tangents = true}, 64, {{0, 0}, {1, 16}, {2, 32}, {3, 48}}},
        {{.packed = true}, 16, {{0, 0}}},
        {{.previous = true, .tangents = true, .packed = true}, 48, {{0, 0}, {2, 16}, {3, 32}}},
        {{.wicked = true}, 16, {{0, 0}}},
    };
    Workload workload = tinyWorkload(3);
    const uint64_t vertices = (*sceneFor(workload, 4))->mesh.positions.size();
    for (const char* route : {"vk", "gl"})
        for (const Wanted& row : wanted) {
            Case c = makeCase(route, "compute");
            c.compute = row.options;
            INFO(caseId(c));
            const FramePlan plan = planOf(workload, c, generousCaps(c.route->api));
            const Program& draw = plan.programs[passOf(plan, "draw").program];
            CHECK(draw.attributeStride == row.stride);
            REQUIRE(draw.attributes.size() == row.attributes.size());
            for (size_t i = 0; i < row.attributes.size(); ++i) {
                CHECK(draw.attributes[i].location == row.attributes[i].first);
                CHECK(draw.attributes[i].offset == row.attributes[i].second);
                // A packed normal must not pass through a float, which may lose the bits of a NaN or a denormal.
                const bool bits = packsVertices(row.options) && i == 0;
                CHECK(draw.attributes[i].format == (bits ? AttributeFormat::uint4 : AttributeFormat::float4));
            }
            CHECK(streamOf(plan, SLOT_SKINNED)->gpuBytes == 3 * vertices * row.stride);
            const Stream* tangents = streamOf(plan, SLOT_TANGENT);
            REQUIRE((tangents != nullptr) == skinsTangents(row.options));
            const uint64_t tangentBytes = !tangents ? 0 : packsTangents(row.options) ? 4 : 16;
            if (tangents) CHECK(tangents->bytes->size() == vertices * tangentBytes);
            const MemoryBytes memory = memoryOfOneCopy(plan, 3);
            CHECK(memory.skinned == vertices * (row.stride + (packsTangents(row.options) ? 4 : 0)));
            CHECK(memory.vertex == vertices * (64 + tangentBytes));
            CHECK(memory.meshlet == 0);
        }
}

TEST_CASE("staging a palette is refused where it does not fit, and where a group spans copies") {
    Workload workload = tinyWorkload(2);
    Case c = makeCase("gl", "compute");
    c.compute.staged = true;
    auto input = planInput(workload, c);
    REQUIRE(input);
    DeviceCaps caps = generousCaps(Api::opengl);
    caps.maxComputeSharedBytes = 12 * sizeof(PaletteEntry);
    CHECK(!unsupported(c, caps));
    CHECK(makePlan(c, *input, caps));
    --caps.maxComputeSharedBytes;
    const auto plan = makePlan(c, *input, caps);
    REQUIRE(!plan);
    CHECK(plan.error().fault == Fault::device);
    CHECK(plan.error().text == "needs 576 bytes of shared memory for 12 joints: test device allows 575");
    c.compute.staged = false;
    CHECK(makePlan(c, *input, caps));

    c.compute = {.staged = true, .packed = true};
    c.submission = Submission::batched;
    CHECK(unsupported(c, generousCaps(Api::opengl)) ==
          "a work group of a batched dispatch spans copies, so it cannot stage the palette of one");
    c.compute.staged = false;
    CHECK(!unsupported(c, generousCaps(Api::opengl)));
}

TEST_CASE("memory of one copy, buffer by buffer") {
    Workload workload = tinyWorkload(7);
    const DeviceCaps caps = generousCaps(Api::vulkan);
    const Scene& scene = **sceneFor(workload, 4);
    const uint64_t vertices = scene.mesh.positions.size(), indices = scene.mesh.indices.size();
    const uint64_t palette = scene.skeleton.joints.size() * sizeof(PaletteEntry);
    for (Submission submission : {Submission::perCopy, Submission::batched})
        for (const char* variant : {"none", "vertex", "compute", "cpu", "mesh"}) {
            const bool mesh = std::string(variant) == "mesh";
            Case c = makeCase(mesh ? "vk-ext" : "vk", variant);
            c.submission = submission;
            INFO(caseId(c));
            const MemoryBytes memory = memoryOfOneCopy(planOf(workload, c, caps), 7);
            const bool cpu = std::string(variant) == "cpu";
            CHECK(memory.vertex == (cpu ? 0 : vertices * 64));
            CHECK(memory.index == (mesh ? 0 : indices * 4));
            CHECK(memory.skinned == (cpu || std::string(variant) == "compute" ? vertices * 32 : 0));
            CHECK(memory.palette == (cpu ? 0 : palette));
            CHECK(memory.tuple == 0);
            CHECK(memory.additionalMeshlet == 0);
            uint64_t meshlet = 0;
            if (mesh)
                for (const Meshlet& m : (*planInput(workload, c)).meshlets->meshlets)
                    meshlet += 8 + 4 * (m.vertexCount + (m.triangleCount + 3) / 4 * 3);
            CHECK(memory.meshlet == meshlet);
            CHECK(memory.total() == memory.vertex + memory.index + memory.skinned + memory.palette + memory.meshlet);
        }
    Case eight = makeCase("vk", "vertex");
    eight.influences = 8;
    CHECK(memoryOfOneCopy(planOf(workload, eight, caps), 7).vertex ==
          (*sceneFor(workload, 8))->mesh.positions.size() * 96);
    const MemoryBytes none = memoryOfOneCopy(planOf(workload, makeCase("cpu", "cpu"), caps), 7);
    CHECK(none.total() == 0);
}

TEST_CASE("a plan that the device cannot hold is refused with the copies and both numbers") {
    Workload workload = tinyWorkload(1000);
    const Case mesh = makeCase("vk-ext", "mesh"), vertex = makeCase("vk", "vertex");
    auto input = planInput(workload, mesh);
    REQUIRE(input);
    const uint64_t vertices = input->encoded->vertices->size() * 1000, palettes = 1000 * 12 * 48;
    const uint64_t everything = planBytes(*makePlan(mesh, *input, generousCaps(Api::vulkan)));
    auto mebibytes = [](uint64_t bytes) { return std::format("{:.1f} MiB", static_cast<double>(bytes) / 1048576); };
    // A limit of `needed` bytes is enough, one byte less is not.
    auto checkLimit = [&](const Case& c, uint64_t DeviceCaps::*limit, uint64_t needed, const std::string& what,
                          const std::string& allows) {
        DeviceCaps caps = generousCaps(Api::vulkan);
        caps.*limit = needed;
        CHECK(makePlan(c, *input, caps));
        caps.*limit = needed - 1;
        auto plan = makePlan(c, *input, caps);
        REQUIRE(!plan);
        CHECK(plan.error().fault == Fault::device);
        CHECK(plan.error().text == std::format("needs {}{} for 1000 copies: test device {} {}; use fewer copies", what,
                                               mebibytes(needed), allows, mebibytes(needed - 1)));
    };
    checkLimit(mesh, &DeviceCaps::maxStorageBytes, vertices, "a storage buffer of ", "allows");
    checkLimit(vertex, &DeviceCaps::maxStorageBytes, palettes, "a palette of ", "allows");  // attributes are no block
    checkLimit(vertex, &DeviceCaps::maxBufferBytes, vertices, "a buffer of ", "allows");
    checkLimit(mesh, &DeviceCaps::deviceBytes, everything, "", "has");
}

TEST_CASE("too many copies for 32-bit numbers are refused, on every route") {
    Workload workload = tinyWorkload(1);
    for (const char* words : {"vk vertex", "gl compute", "vk-ext mesh", "cpu cpu"}) {
        const std::string text(words);
        const Case c = makeCase(text.substr(0, text.find(' ')).c_str(), text.substr(text.find(' ') + 1).c_str());
        auto input = planInput(workload, c);
        REQUIRE(input);
        input->copies = static_cast<uint32_t>(INT32_MAX / input->scene->mesh.indices.size()) + 1;
        DeviceCaps caps = generousCaps(c.route->api);
        caps.maxStorageBytes = UINT64_MAX;
        const auto plan = makePlan(c, *input, caps);
        INFO(words);
        REQUIRE(!plan);
        CHECK(plan.error().fault == Fault::device);
        CHECK_THAT(plan.error().text, ContainsSubstring("exceed 32-bit numbers; use fewer copies"));
        CHECK_THAT(plan.error().text, ContainsSubstring(std::to_string(input->copies) + " copies"));
    }
}

TEST_CASE("what a case asks of the rasteriser reaches its draw pass") {
    Workload workload = tinyWorkload(1);
    for (const char* route : {"vk", "vk-ext"})
        for (RasterMode raster : {RasterMode::full, RasterMode::noFragments, RasterMode::discard})
            for (bool keep : {false, true}) {
                Case c = makeCase(route, "none");
                c.raster = raster;
                c.keepBackFaces = keep;
                const FramePlan plan = planOf(workload, c, generousCaps(Api::vulkan));
                CHECK(passOf(plan, "draw").raster == raster);
                CHECK(passOf(plan, "draw").cullBackFaces == !keep);
                CHECK(plan.dialect == c.route->dialect);
                CHECK(plan.width == 320);
                CHECK(plan.height == 180);
            }
}

TEST_CASE("the null backend runs every plan of every case") {
    Workload workload = tinyWorkload(2);
    size_t ran = 0;
    for (const Case& c : everyCase())
        for (bool capture : {false, true}) {
            INFO(caseId(c));
            const DeviceCaps caps = generousCaps(c.route->api);
            const FramePlan plan = planOf(workload, c, caps, capture);
            auto null = openNull(caps);
            auto id = null->prepare(plan);
            REQUIRE(id);
            auto frame = makeFrame(workload, c.influences, 0);
            REQUIRE(frame);
            const PlanInput planned = *planInput(workload, c);
            const auto palette = paletteBytes(planned, paletteBlocks(c, planned), *frame);
            REQUIRE(palette);
            FrameInput input{frame->constants, *palette, {}};
            if (plan.paletteBytes == 0) input.palette = {};
            const Stream* written = hostWrittenStream(plan);
            const std::vector<std::byte> skinned(written ? streamBytes(*written) : 0);
            input.skinned = skinned;
            auto timings = null->run(*id, std::vector{input, input});
            REQUIRE(timings);
            CHECK(plan.passesAhead == (c.queues == Queues::async ? 1 : 0));
            uint64_t bytes = 0;
            for (const Stream& stream : plan.streams)
                bytes += null->readStream(*id, stream.slot)->size() * (stream.inTurn ? 2 : 1);
            CHECK(bytes == planBytes(plan));
            CHECK(null->readImage(*id).has_value() == drawsImage(plan));
            ++ran;
        }
    CHECK(ran > 50);
}
