// What is measured beside the cases: limits, counters, overlapped passes, bandwidth.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "common/frame/image.h"
#include "common/measure/peaks.h"
#include "tests/cases.h"
#include "tests/drivers.h"

using namespace skinbench;

namespace {

constexpr uint32_t kCopies = 3;

// Those that this machine's drivers run.
std::vector<Case> offered(std::initializer_list<Case> cases) {
    std::vector<Case> there;
    for (const Case& c : cases) {
        const Backend* backend = openedBackends().at(c.route->api).backend;
        if (backend && !unsupported(c, backend->caps())) there.push_back(c);
    }
    return there;
}

BenchSettings fewFrames() {
    BenchSettings settings;
    settings.frames = 4;
    settings.rounds = 2;
    return settings;
}

struct ModesDrawn {
    Image timed, overlapped, batched;
    std::vector<Timing> overlap, batch;
};

FramePlan planOf(Workload& workload, const Case& c, const Backend& backend) {
    const auto input = planInput(workload, c);
    REQUIRE(input);
    auto plan = makePlan(c, *input, backend.caps());
    REQUIRE(plan);
    return std::move(*plan);
}

Image imageOf(Backend& backend, const FramePlan& plan, const FrameInput& frame) {
    const auto id = backend.prepare(plan);
    REQUIRE(id);
    REQUIRE(backend.run(*id, std::vector{frame}));
    auto image = backend.readImage(*id);
    REQUIRE(image);
    backend.release(*id);
    return std::move(*image);
}

ModesDrawn drawBothWays(Workload& workload, const Case& c, Backend& backend) {
    auto input = planInput(workload, c);
    REQUIRE(input);
    auto plan = makePlan(c, *input, backend.caps());
    REQUIRE(plan);
    auto id = backend.prepare(*plan);
    REQUIRE(id);
    auto frame = makeFrame(workload, c.influences, 0);
    REQUIRE(frame);
    const auto palette = paletteBytes(*input, paletteBlocks(c, *input), *frame);
    REQUIRE(palette);
    const std::vector<FrameInput> inputs(2, {frame->constants, *palette, {}});
    ModesDrawn drawn;
    REQUIRE(backend.run(*id, inputs));
    drawn.timed = *backend.readImage(*id);
    auto overlap = backend.run(*id, inputs, RunMode::overlap);
    REQUIRE(overlap);
    drawn.overlap = *overlap;
    drawn.overlapped = *backend.readImage(*id);
    auto batch = backend.run(*id, inputs, RunMode::batch);
    REQUIRE(batch);
    drawn.batch = *batch;
    drawn.batched = *backend.readImage(*id);
    backend.release(*id);
    return drawn;
}

// Counts what is prepared on another backend.
struct CountingBackend final : Backend {
    explicit CountingBackend(Backend& inner) : inner(inner) {}
    const DeviceCaps& caps() const override { return inner.caps(); }
    Result<PlanId> prepare(const FramePlan& plan) override { return ++prepared, inner.prepare(plan); }
    Result<std::vector<Timing>> run(PlanId id, std::span<const FrameInput> frames, RunMode mode) override {
        return inner.run(id, frames, mode);
    }
    Result<void> begin(PlanId, const FrameInput&) override { return inputError("nothing begins"); }
    Result<FinishedFrame> finish(PlanId) override { return inputError("nothing has begun"); }
    Result<Image> readImage(PlanId id) override { return inner.readImage(id); }
    Result<std::vector<std::byte>> readStream(PlanId id, uint32_t slot) override { return inner.readStream(id, slot); }
    void release(PlanId id) override {
        ++released;
        inner.release(id);
    }
    std::vector<std::string> takeMessages() override { return inner.takeMessages(); }

    Backend& inner;
    size_t prepared = 0, released = 0;
};

}  // namespace

TEST_CASE("cases keep their memory between rounds, or each round prepares them anew") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    for (const Case& c : offered({makeCase("vk", "vertex"), makeCase("gl", "compute")}))
        for (bool fresh : {false, true}) {
            Workload workload = tinyWorkload(kCopies);
            CountingBackend counting(*openedBackends().at(c.route->api).backend);
            BenchSettings settings = fewFrames();
            settings.freshPlacement = fresh;
            auto results = runBench(workload, {c}, {{c.route->api, {&counting, {}}}}, settings, {});
            REQUIRE(results);
            INFO(results->at(0).id << ": " << results->at(0).reason);
            CHECK(results->at(0).status == CaseStatus::ok);
            CHECK(results->at(0).roundSizes == std::vector<size_t>{2, 2});
            CHECK(counting.prepared == (fresh ? 3 : 2));  // once to verify
            CHECK(counting.released == counting.prepared);
        }
}

TEST_CASE("limits are verified and timed beside the cases, each once") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(kCopies);
    Case discard = makeCase("vk", "vertex");
    discard.raster = RasterMode::discard;
    Case prepass = makeCase("vk", "vertex");
    prepass.scenario = Scenario::prepass;
    const std::vector<Case> cases =
        offered({makeCase("vk", "vertex"), makeCase("vk", "compute"), discard, prepass, makeCase("gl", "vertex"),
                 makeCase("vk-ext", "mesh"), makeCase("vk-ext", "mesh-ci"), makeCase("gl-ext", "mesh")});
    BenchSettings settings = fewFrames();
    settings.limits = true;
    auto results = runBench(workload, cases, openedBackends(), settings, {});
    REQUIRE(results);
    std::vector<std::string> limits;
    for (const CaseResult& result : *results) {
        INFO(result.id << ": " << result.reason);
        CHECK(result.status == CaseStatus::ok);
        CHECK(result.total.size() == 4);
        if (result.isLimit) {
            CHECK(std::ranges::find(limits, result.id) == limits.end());
            limits.push_back(result.id);
            CHECK(result.memory->vertex == 0);
        }
    }
    for (const CaseResult& result : *results) {
        if (result.isLimit) continue;
        INFO(result.id);
        const bool expected = result.theCase.scenario == Scenario::direct;
        CHECK(expected == (std::ranges::find(limits, result.limitId) != limits.end()));
    }
}

TEST_CASE("the timestamps of a software driver enclose the work, not its queue") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    auto scene = loadScene("builtin:biped:20000");
    REQUIRE(scene);
    WorkloadSettings settings;
    settings.width = 320;
    settings.height = 180;
    auto workload = makeWorkload(std::move(*scene), testShaders(), settings);
    REQUIRE(workload);
    for (const Case& c : offered({makeCase("vk", "vertex"), makeCase("vk", "compute"), makeCase("vk-ext", "mesh"),
                                  makeCase("gl", "vertex"), makeCase("gl", "compute"), makeCase("gl-ext", "mesh")})) {
        Backend& backend = *openedBackends().at(c.route->api).backend;
        if (!backend.caps().software) continue;
        auto input = planInput(*workload, c);
        REQUIRE(input);
        auto plan = makePlan(c, *input, backend.caps());
        REQUIRE(plan);
        auto id = backend.prepare(*plan);
        REQUIRE(id);
        auto frame = makeFrame(*workload, c.influences, 0);
        REQUIRE(frame);
        const auto palette = paletteBytes(*input, {}, *frame);
        REQUIRE(palette);
        const std::vector<FrameInput> inputs(8, {frame->constants, *palette, {}});
        for (RunMode mode : {RunMode::timed, RunMode::overlap}) {
            REQUIRE(backend.run(*id, inputs, mode));  // compiles what a driver compiles late
            const auto start = std::chrono::steady_clock::now();
            auto timings = backend.run(*id, inputs, mode);
            const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
            REQUIRE(timings);
            double timed = 0;
            for (const Timing& timing : *timings)
                timed = std::accumulate(timing.passes.begin(), timing.passes.end(), timed);
            INFO(caseId(c) << ": " << timed << " of " << wall.count() << " ms");
            CHECK(timed > 0.4 * wall.count());
            CHECK(timed < wall.count());
        }
        backend.release(*id);
    }
}

TEST_CASE("counters agree with what the plan draws") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(kCopies);
    const std::vector<Case> cases =
        offered({makeCase("vk", "vertex"), makeCase("gl", "vertex"), makeCase("vk", "compute"),
                 makeCase("gl", "compute"), makeCase("vk-ext", "mesh")});
    auto results = runBench(workload, cases, openedBackends(), fewFrames(), {});
    REQUIRE(results);
    size_t counted = 0;
    for (const CaseResult& result : *results) {
        INFO(result.id << ": " << result.reason);
        REQUIRE(result.status == CaseStatus::ok);
        const DeviceCaps& caps = openedBackends().at(result.theCase.route->api).backend->caps();
        CHECK(result.counters.has_value() == caps.pipelineStatistics);
        if (!result.counters) continue;
        const Mesh& mesh = workload.prepared.at(4)->mesh;
        const uint64_t triangles = mesh.indices.size() / 3 * kCopies;
        const Counters& c = *result.counters;
        if (result.theCase.builder) {
            CHECK_FALSE(c.inputVertices);
            CHECK_FALSE(c.vertexInvocations);
            CHECK(c.meshPrimitives.has_value() == caps.meshCounters);
            if (c.meshPrimitives) CHECK(*c.meshPrimitives == triangles);
            if (c.meshInvocations) CHECK(*c.meshInvocations >= uint64_t{result.meshlets} * kCopies);
        } else {
            REQUIRE(c.inputPrimitives);
            CHECK(*c.inputPrimitives == triangles);
            CHECK(*c.inputVertices == triangles * 3);
            CHECK(*c.vertexInvocations >= mesh.positions.size() * kCopies / 2);
            CHECK_FALSE(c.meshPrimitives);
        }
        CHECK(c.computeInvocations.has_value() == (result.theCase.variant == findVariant("compute")));
        if (c.computeInvocations) CHECK(*c.computeInvocations >= mesh.positions.size() * kCopies);
        CHECK(c.fragmentInvocations.value_or(0) > 0);
        ++counted;
    }
    if (counted == 0) SKIP("no driver here counts");
}

TEST_CASE("passes that overlap draw the same image, and are timed as one") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(kCopies);
    Case prepassVk = makeCase("vk", "compute"), prepassGl = makeCase("gl", "vertex"),
         prepassMesh = makeCase("vk-ext", "mesh");
    for (Case* c : {&prepassVk, &prepassGl, &prepassMesh}) c->scenario = Scenario::prepass;
    Case viewsVk = makeCase("vk", "compute-cull"), viewsGl = makeCase("gl", "compute-cull"), viewsMesh = prepassMesh;
    for (Case* c : {&viewsVk, &viewsGl, &viewsMesh}) c->views = 4;
    const std::vector<Case> cases = offered({makeCase("vk", "compute"), makeCase("gl", "compute"), prepassVk, prepassGl,
                                             prepassMesh, viewsVk, viewsGl, viewsMesh});
    for (const Case& c : cases) {
        INFO(caseId(c));
        Backend& backend = *openedBackends().at(c.route->api).backend;
        const ModesDrawn drawn = drawBothWays(workload, c, backend);
        CHECK(compareImages(drawn.timed, drawn.overlapped, 0).fraction == 0);
        for (const Timing& timing : drawn.overlap) CHECK(timing.passes.size() == 1);
        CHECK(compareImages(drawn.timed, drawn.batched, 0).fraction == 0);
        CHECK(drawn.batch[0].passes == drawn.batch[1].passes);
        CHECK(backend.takeMessages().empty());
    }
    auto results = runBench(workload, cases, openedBackends(), fewFrames(), {});
    REQUIRE(results);
    for (const CaseResult& result : *results) {
        INFO(result.id << ": " << result.reason);
        CHECK(result.overlapped.size() == result.total.size());
        CHECK(result.batches.empty());
        // Passes of one name are one.
        std::vector<double> sums(result.total.size(), 0);
        for (const auto& [label, samples] : result.passes) {
            REQUIRE(samples.size() == sums.size());
            for (size_t i = 0; i < sums.size(); ++i) sums[i] += samples[i];
        }
        for (size_t i = 0; i < sums.size(); ++i) CHECK(std::abs(sums[i] - result.total[i]) <= 1e-9 * sums[i]);
        CHECK(result.passes.contains("views") == (result.theCase.views > 1));
    }
}

TEST_CASE("several views draw the picture of one, wherever they look from") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Case batched = makeCase("gl", "compute-cull"), culling = makeCase("vk-ext", "mesh");
    batched.submission = Submission::batched;
    culling.cull = Cull::compact;
    const std::vector<Case> cases = offered({makeCase("vk", "vertex"), makeCase("vk", "compute-cull"), culling, batched,
                                             makeCase("gl-ext", "compute-mesh")});
    for (size_t number = 0; const Camera camera : {Camera::crowd, Camera::half, Camera::inside, Camera::close}) {
        Workload workload = tinyWorkload(7);
        workload.settings.camera = camera;
        for (Case c : cases) {
            if (number++ % 2) continue;  // each case in two cameras
            Backend& backend = *openedBackends().at(c.route->api).backend;
            const auto one = renderImage(workload, c, backend);
            c.views = 8;
            const auto eight = renderImage(workload, c, backend);
            INFO(caseId(c) << ", camera " << cameraNames()[static_cast<size_t>(camera)]);
            REQUIRE(one);
            REQUIRE(eight);
            CHECK(one->rgba == eight->rgba);
        }
    }
}

TEST_CASE("another view lays down the depth that its own matrix says") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(kCopies);
    Case vertex = makeCase("vk", "vertex"), compute = makeCase("gl", "compute"), ext = makeCase("vk-ext", "mesh"),
         nv = makeCase("gl-nv", "mesh"), glExt = makeCase("gl-ext", "mesh");
    for (Case* c : {&vertex, &compute, &ext, &nv, &glExt}) c->scenario = Scenario::prepass;
    for (Case c : offered({vertex, compute, ext, nv, glExt, makeCase("vk", "compute-cull"),
                           makeCase("gl", "compute-cull"), makeCase("vk-ext", "compute-mesh")})) {
        Backend& backend = *openedBackends().at(c.route->api).backend;
        const bool exact = c.scenario == Scenario::prepass || backend.caps().software;
        if (!exact) continue;
        c.views = 2;
        FramePlan plan = planOf(workload, c, backend);
        const auto input = planInput(workload, c);
        auto frame = makeFrame(workload, c.influences, 0);
        REQUIRE(frame);
        const auto palette = paletteBytes(*input, {}, *frame);
        REQUIRE(palette);
        INFO(caseId(c));
        const Image whole = imageOf(backend, plan, {frame->constants, *palette, {}});
        // The image keeps what lies at the depth of the other view.
        std::erase_if(plan.passes, [](const Pass& pass) { return pass.label == "depth"; });
        plan.passes.back().depth = DepthTest::equalKeep;
        plan.passes.back().clear = false;
        CHECK(compareImages(whole, imageOf(backend, plan, {frame->constants, *palette, {}}), 2).fraction > 0.01);
        frame->constants.otherViews[0] = frame->constants.viewProjection;
        CHECK(compareImages(whole, imageOf(backend, plan, {frame->constants, *palette, {}}), 2).fraction == 0);
    }
}

TEST_CASE("the copy bandwidth of a device is measured") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    for (const auto& [api, open] : openedBackends()) {
        if (!open.backend) continue;
        auto bandwidth = measureCopyBandwidth(*open.backend, testShaders());
        INFO((bandwidth ? "" : bandwidth.error().text));
        REQUIRE(bandwidth);
        CHECK(*bandwidth > 1e6);
        CHECK(open.backend->takeMessages().empty());
    }
}

TEST_CASE("with a second queue the vertices and the image are those of one, and every case is timed in batches") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(kCopies);
    std::vector<Case> cases =
        offered({makeCase("vk", "vertex"), makeCase("vk", "compute"), makeCase("vk", "compute-cull"),
                 makeCase("vk-ext", "compute-mesh"), makeCase("vk-nv", "compute-mesh"), makeCase("gl", "compute")});
    const size_t plain = cases.size();
    for (size_t i = 0; i < plain; ++i)
        if (findAxis("queues")->applies(cases[i])) {
            cases.push_back(cases[i]);
            cases.back().queues = Queues::async;
        }
    auto results = runBench(workload, cases, openedBackends(), fewFrames(), {});
    REQUIRE(results);
    size_t asynchronous = 0;
    for (const CaseResult& result : *results) {
        INFO(result.id << ": " << result.reason);
        const DeviceCaps& caps = openedBackends().at(result.theCase.route->api).backend->caps();
        const bool runs = result.theCase.queues == Queues::one || caps.secondQueue;
        asynchronous += result.theCase.queues == Queues::async;
        CHECK(result.status == (runs ? CaseStatus::ok : CaseStatus::skipped));
        if (!runs) CHECK(result.reason.ends_with("has no second queue"));
        CHECK(result.batchRounds.size() == (runs ? 2 : 0));
        CHECK(result.batches.empty() == !runs);
    }
    CHECK(asynchronous + 1 >= plain);  // all but `vertex`
}
