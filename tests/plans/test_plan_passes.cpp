// The passes of a frame: pre-passes, views, verdicts. No driver takes part.
#include <set>

#include "common/scene/skin_cpu.h"
#include "tests/plans/plan_of.h"

using namespace skinbench;

TEST_CASE("a pre-pass lays down depth, keeps the skinned vertices, and draws where the depth is equal") {
    Workload workload = tinyWorkload(2);
    for (const char* words : {"vk vertex", "gl compute", "vk-ext mesh", "gl-nv mesh-ci"}) {
        const std::string text(words);
        Case c = makeCase(text.substr(0, text.find(' ')).c_str(), text.substr(text.find(' ') + 1).c_str());
        c.scenario = Scenario::prepass;
        INFO(words);
        const bool mesh = c.builder != nullptr;
        for (bool differs : {false, true}) {
            DeviceCaps caps = generousCaps(c.route->api);
            caps.meshDepthDiffers = differs;
            const FramePlan plan = planOf(workload, c, caps);
            const Pass &depth = passOf(plan, "depth"), &draw = passOf(plan, "draw");
            CHECK(plan.passes.size() == (c.variant == findVariant("compute") ? 3 : 2));
            CHECK(!depth.writeColor);
            CHECK(depth.depth == DepthTest::lessWrite);
            CHECK(depth.clear);
            CHECK(plan.programs[depth.program].stages.size() == 1);
            CHECK(draw.depth == DepthTest::equalKeep);
            CHECK(!draw.clear);
            CHECK(draw.kind == (mesh && differs ? PassKind::drawMesh : PassKind::drawIndexed));
            CHECK(streamOf(plan, SLOT_SKINNED)->gpuBytes % sizeof(SkinnedVertex) == 0);
        }
    }
}

TEST_CASE("the other views are drawn before the main one, depth alone, from what is skinned once or again") {
    Workload workload = tinyWorkload(2);
    struct Expected {
        const char *route, *variant;
        Scenario scenario;
        uint32_t views;
        std::vector<std::string> passes;
        ClusterCull clusters = ClusterCull::off;
    };
    const std::vector<Expected> all = {
        {"vk", "vertex", Scenario::direct, 4, {"views", "views", "views", "draw"}},
        {"gl", "palette", Scenario::direct, 2, {"views", "draw"}},
        {"vk", "cpu", Scenario::direct, 2, {"views", "draw"}},
        {"vk-nv", "mesh-ci", Scenario::direct, 2, {"views", "draw"}},
        {"gl", "compute", Scenario::direct, 4, {"skin", "views", "views", "views", "draw"}},
        {"vk-ext", "compute-mesh", Scenario::direct, 2, {"skin", "views", "draw"}},
        {"vk",
         "compute-cull",
         Scenario::direct,
         4,
         {"skin", "cull", "views", "cull", "views", "cull", "views", "cull", "draw"}},
        {"vk-ext", "mesh", Scenario::direct, 2, {"cluster", "views", "cluster", "draw"}, ClusterCull::list},
        {"vk-nv", "mesh", Scenario::direct, 2, {"views", "draw"}, ClusterCull::task},
        {"gl",
         "compute-cull",
         Scenario::direct,
         2,
         {"skin", "cluster", "cull", "views", "cluster", "cull", "draw"},
         ClusterCull::list},
        {"vk", "compute", Scenario::prepass, 2, {"skin", "views", "depth", "draw"}},
        {"vk", "vertex", Scenario::prepass, 4, {"views", "views", "views", "depth", "draw"}},
        {"gl-ext", "mesh", Scenario::prepass, 4, {"views", "views", "views", "depth", "draw"}},
    };
    for (const Expected& expected : all) {
        Case c = makeCase(expected.route, expected.variant);
        c.scenario = expected.scenario;
        c.clusterCull = expected.clusters;
        const FramePlan one = planOf(workload, c, generousCaps(c.route->api));
        c.views = expected.views;
        const FramePlan plan = planOf(workload, c, generousCaps(c.route->api));
        INFO(caseId(c));
        std::vector<std::string> labels;
        std::vector<uint32_t> drawn, keeping;
        for (const Pass& pass : plan.passes) {
            labels.push_back(pass.label);
            const Program& program = plan.programs[pass.program];
            if (program.stages.front().text.contains("#define PREPASS 1\n")) keeping.push_back(pass.program);
            for (const Draw& draw : pass.draws) CHECK(draw.constants[3] == pass.draws.front().constants[3]);
            if (pass.label != "views") continue;
            CHECK(!pass.writeColor);
            CHECK(pass.clear);
            CHECK(pass.depth == DepthTest::lessWrite);
            CHECK(program.stages.size() == (c.clusterCull == ClusterCull::task ? 2 : 1));
            for (const ShaderText& stage : program.stages) CHECK(stage.text.contains("#define OTHER_VIEW 1\n"));
            drawn.push_back(pass.draws.front().constants[3]);
        }
        CHECK(labels == expected.passes);
        CHECK(drawn == (c.views == 2 ? std::vector<uint32_t>{1} : std::vector<uint32_t>{1, 2, 3}));
        const bool keeps = c.scenario == Scenario::prepass && c.variant != findVariant("compute");
        CHECK(keeping == (keeps ? std::vector<uint32_t>{0} : std::vector<uint32_t>{}));
        // The main view's program is that of one view.
        const auto& image = plan.programs[passOf(plan, "draw").program].stages;
        const auto& alone = one.programs[passOf(one, "draw").program].stages;
        REQUIRE(image.size() == alone.size());
        for (size_t i = 0; i < image.size(); ++i) CHECK(image[i].text == alone[i].text);
    }
}

TEST_CASE("the view of culling has a pass for each verdict, what is drawn first, and draws back faces too") {
    Workload workload = tinyWorkload(3);
    struct Expected {
        const char *route, *variant;
        ClusterCull clusters;
        Cull cull;
        std::vector<uint32_t> verdicts;
    };
    const Expected all[] = {
        {"vk", "compute-cull", ClusterCull::off, Cull::off, {0, 3, 4, 5}},
        {"gl", "compute-cull", ClusterCull::list, Cull::off, {0, 1, 2, 3, 4, 5}},
        {"vk-ext", "mesh", ClusterCull::task, Cull::off, {0, 1, 2}},
        {"vk-nv", "mesh-ci", ClusterCull::off, Cull::compact, {0, 4}},
        {"gl-ext", "compute-mesh", ClusterCull::list, Cull::compact, {0, 1, 2, 4}},
    };
    for (const Expected& expected : all) {
        Case c = makeCase(expected.route, expected.variant);
        c.clusterCull = expected.clusters;
        c.cull = expected.cull;
        c.view = View::culled;
        c.views = 2;  // the others draw nothing of the picture
        const FramePlan plan = planOf(workload, c, generousCaps(c.route->api));
        INFO(caseId(c));
        CHECK(verdictsOf(c) == expected.verdicts);
        std::vector<uint32_t> drawn;
        for (const Pass& pass : plan.passes) {
            if (pass.kind == PassKind::dispatch) continue;
            drawn.push_back(pass.draws.front().constants[3]);
            CHECK(pass.clear == (drawn.back() == VERDICT_DRAWN));
            CHECK(!pass.cullBackFaces);
            CHECK(pass.writeColor);
        }
        CHECK(drawn == expected.verdicts);
        CHECK(streamOf(plan, SLOT_VERDICT));
        c.view = View::shaded;
        CHECK(!streamOf(planOf(workload, c, generousCaps(c.route->api)), SLOT_VERDICT));
    }
}

TEST_CASE("of a verifying plan the first pass of the main view says which triangles mesh stages drop") {
    Workload workload = tinyWorkload(3);
    for (Scenario scenario : {Scenario::direct, Scenario::prepass})
        for (uint32_t views : {1, 2})
            for (bool differs : {false, true}) {
                Case c = makeCase("vk-ext", "mesh");
                c.cull = Cull::compact;
                c.scenario = scenario;
                c.views = views;
                DeviceCaps caps = generousCaps(Api::vulkan);
                caps.meshDepthDiffers = differs;
                INFO(caseId(c));
                const FramePlan plan = planOf(workload, c, caps, true);
                std::vector<std::string> labels;
                for (const Pass& pass : plan.passes)
                    for (const ShaderText& stage : plan.programs[pass.program].stages)
                        if (stage.stage == Stage::mesh && stage.text.contains("#define STORES_VERDICTS 1\n"))
                            labels.push_back(pass.label);
                const bool prepass = scenario == Scenario::prepass;
                // There the pass that culls is one of the other view.
                const bool none = prepass && views > 1;
                CHECK(labels ==
                      (none ? std::vector<std::string>{} : std::vector<std::string>{prepass ? "depth" : "draw"}));
                CHECK((streamOf(plan, SLOT_VERDICT) == nullptr) == none);
                for (const Stream& stream : planOf(workload, c, caps).streams) CHECK(stream.slot != SLOT_VERDICT);
            }
}

TEST_CASE("each view's triangles are counted in commands of their own") {
    Workload workload = tinyWorkload(3);
    for (Submission submission : {Submission::perCopy, Submission::batched}) {
        Case c = makeCase("gl", "compute-cull");
        c.views = 2;
        c.submission = submission;
        const FramePlan plan = planOf(workload, c, generousCaps(Api::opengl));
        const uint32_t commands = submission == Submission::batched ? 1 : 3;
        INFO(caseId(c));
        CHECK(streamBytes(*streamOf(plan, SLOT_COMMAND)) == 2 * commands * sizeof(DrawCommand));
        std::set<uint32_t> image, other;
        for (const Draw& draw : passOf(plan, "draw").draws) image.insert(*draw.command);
        for (const Draw& draw : passOf(plan, "views").draws) other.insert(*draw.command);
        CHECK(image.size() == commands);
        CHECK(*image.rbegin() == commands - 1);
        CHECK(other.size() == commands);
        CHECK(*other.begin() == commands);
        CHECK(*other.rbegin() == 2 * commands - 1);
    }
}
