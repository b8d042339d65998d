// Every variant on every route that this machine's drivers offer: captured vertices against the CPU reference, images
// across routes, under validation with no message allowed. Every model of the shared folder where it is there.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <filesystem>
#include <set>

#include "common/frame/image.h"
#include "common/measure/bench.h"
#include "tests/cases.h"
#include "tests/codec_test.h"
#include "tests/drivers.h"

using namespace skinbench;

namespace {

// Verifies the cases and requires each to be right, or skipped because of the device.
size_t requireVerified(Workload& workload, const std::vector<Case>& cases) {
    BenchSettings settings;
    settings.timed = false;
    auto results = runBench(workload, cases, openedBackends(), settings, {});
    REQUIRE(results);
    size_t right = 0;
    for (const CaseResult& result : *results) {
        INFO(workload.stored.name << ": " << result.id << ": " << result.reason);
        CHECK(result.status != CaseStatus::failed);
        if (result.status == CaseStatus::skipped) {
            const Backend* backend = openedBackends().at(result.theCase.route->api).backend;
            const bool limits = result.reason.find("storage buffer") != std::string::npos;
            const bool tuples = result.reason.find("joint tuples, the limit is") != std::string::npos;
            CHECK((!backend || unsupported(result.theCase, backend->caps()) || limits || tuples));
        }
        right += result.status == CaseStatus::ok;
    }
    return right;
}

Workload modelWorkload(const std::string& name, uint32_t copies) {
    auto scene = loadScene(name);
    REQUIRE(scene);
    WorkloadSettings settings;
    settings.copies = copies;
    settings.width = 320;
    settings.height = 180;
    auto workload = makeWorkload(std::move(*scene), testShaders(), settings);
    REQUIRE(workload);
    return std::move(*workload);
}

// One case of each variant on each route, default options; of one codec, or of all.
std::vector<Case> plainCases(int influences, bool everyCodec = false) {
    std::set<std::string> known;
    std::vector<Case> cases;
    for (Case c : everyCase()) {
        Case plain;
        plain.route = c.route;
        plain.variant = c.variant;
        plain.codec = c.codec;
        plain.builder = findBuilder("meshopt");
        plain.layout = c.layout ? findMeshletLayout("redirect") : nullptr;
        if (!plain.layout) plain.builder = nullptr;
        plain.influences = influences;
        if (!c.codec->feedsAttributes) plain.fetch = c.fetch;
        if ((everyCodec || c.codec->feedsAttributes) && known.insert(caseId(plain)).second) cases.push_back(plain);
    }
    return cases;
}

// Every third case, beginning with the one of that number. Each case compiles shaders of its own, which is most of what
// such a test takes; together three scenes meet every case.
std::vector<Case> everyThird(const std::vector<Case>& cases, size_t first) {
    std::vector<Case> some;
    for (size_t i = first % 3; i < cases.size(); i += 3) some.push_back(cases[i]);
    return some;
}

// One skinning case on each route, another variant for each number.
std::vector<Case> oneOfEachRoute(const std::vector<Case>& cases, size_t number) {
    std::vector<Case> some;
    for (const Route& route : routes()) {
        std::vector<Case> onRoute;
        for (const Case& c : cases)
            if (c.route == &route && c.variant->skins) onRoute.push_back(c);
        if (!onRoute.empty()) some.push_back(onRoute[number % onRoute.size()]);
    }
    return some;
}

}  // namespace

TEST_CASE("every case is right on every route, and the images agree") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(3);
    std::vector<Case> cases;
    std::set<std::string> known;
    size_t others = 0;
    for (const Case& c : everyCase()) {
        if (c.view != View::shaded || !known.insert(caseId(c)).second) continue;
        // All options with one codec and API, and a fifth of them elsewhere; glslang sees all (test_shaders.cpp).
        const bool all = !caseId(c).contains('+') || (c.codec == findCodec("uc") && c.route->api == Api::vulkan);
        if (all || others++ % 5 == 0) cases.push_back(c);
    }
    INFO(cases.size() << " cases");
    CHECK(requireVerified(workload, cases) > 200);
}

TEST_CASE("a joint of scale 0, which hides a part, is no fault") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    for (const glm::vec3& scale : {glm::vec3(0), glm::vec3(0, 1, 1)}) {
        Workload workload = tinyWorkload(2);
        workload.stored.skeleton.nodes[workload.stored.skeleton.joints.back().node].scale = scale;
        std::vector<Case> cases = plainCases(4);
        std::erase_if(cases, [](const Case& c) { return c.variant->storedAs != StoredAs::sceneVertices; });
        CHECK(requireVerified(workload, cases) > 5);
    }
}

TEST_CASE("the built-in characters are right on every route") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    size_t number = 0;
    for (const BuiltinScene& builtin : builtinScenes()) {
        Workload workload = modelWorkload(std::string("builtin:") + builtin.name + ":3000", 2);
        CHECK(requireVerified(workload, everyThird(plainCases(4, true), number++)) > 5);
    }
}

namespace {

// Joints that all turn another way below a root that swings.
Scene posedScene(const std::string& name, Mesh mesh) {
    Scene scene;
    scene.name = name;
    uint16_t highest = 0;
    for (const Influences& influences : mesh.influences)
        for (uint16_t joint : influences.joints)
            if (joint != kNoJoint) highest = std::max(highest, joint);
    scene.mesh = std::move(mesh);
    scene.parts.push_back({name, 0, static_cast<uint32_t>(scene.mesh.indices.size()), false});
    scene.skeleton.nodes.push_back({"root"});
    for (uint32_t joint = 0; joint <= highest; ++joint) {
        Node node{"joint", 0};
        const float half = 0.6f * std::sin(1.7f * static_cast<float>(joint));
        node.rotation = {std::cos(half), joint % 2 ? std::sin(half) : 0, joint % 2 ? 0 : std::sin(half), 0};
        scene.skeleton.nodes.push_back(node);
        scene.skeleton.joints.push_back({joint + 1, glm::mat4(1)});
    }
    scene.clips.push_back({"swing",
                           1,
                           {{0,
                             ChannelPath::rotation,
                             Interpolation::linear,
                             {0, 1},
                             {{0, 0, 0, 1}, {0, std::sin(0.4f), 0, std::cos(0.4f)}}}}});
    return scene;
}

}  // namespace

TEST_CASE("degenerate meshes are right with every codec, as meshlets and as vertices") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    std::vector<Case> all;
    for (const Case& c : plainCases(4, true)) {
        const bool mesh = c.route == findRoute("vk-ext") && c.variant == findVariant("mesh");
        const bool vertex = c.route == findRoute("vk") && c.variant == findVariant("vertex");
        if (mesh || vertex) all.push_back(c);
    }
    size_t number = 0;
    auto meshes = test::degenerateMeshes();
    meshes.emplace_back("every joint", test::everyJointMesh());
    for (auto& [name, mesh] : meshes) {
        INFO(name);
        WorkloadSettings settings;
        settings.copies = 2;
        settings.width = 320;
        settings.height = 180;
        auto workload = makeWorkload(posedScene(name, std::move(mesh)), testShaders(), settings);
        REQUIRE(workload);
        // Half of them with each mesh, the other half with the next; tests of the codecs see all.
        std::vector<Case> cases;
        for (size_t i = number++ % 2; i < all.size(); i += 2) cases.push_back(all[i]);
        // oss22 counts 1024 tuples.
        const auto fewer = name != "every joint" ? 0 : std::ranges::count(cases, findCodec("oss22"), &Case::codec);
        if (openedBackends().at(Api::vulkan).backend)
            CHECK(requireVerified(*workload, cases) + static_cast<size_t>(fewer) == cases.size());
    }
}

TEST_CASE("every shared model is right on every route") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    if (modelFiles().empty()) SKIP("no model folder: set SKINBENCH_MODELS to run this test");
    size_t loaded = 0;
    for (const std::string& file : modelFiles()) {
        if (!loadScene(file)) continue;  // which files must load is tested in test_scene_gltf.cpp
        INFO(file);
        Workload workload = modelWorkload(file, 2);
        const bool eight = sceneStats(**sceneFor(workload, 8)).maxInfluences > 4;
        const std::vector<Case> cases = oneOfEachRoute(plainCases(eight ? 8 : 4), loaded++);
        CHECK(requireVerified(workload, cases) > 0);
    }
    CHECK(loaded > 30);
}

TEST_CASE("the first copy stands at the top left, seen from its front, on both APIs") {
    // Five copies fill a grid of more than one row whose last row is not full; what is covered must say so.
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(5);
    for (const auto& [api, open] : openedBackends()) {
        if (!open.backend) continue;
        Case c;
        c.route = findRoute(api == Api::vulkan ? "vk" : "gl");
        c.variant = findVariant("vertex");
        c.codec = findCodec("uc");
        auto image = renderImage(workload, c, *open.backend);
        REQUIRE(image);
        auto covered = [&](uint32_t x0, uint32_t y0) {
            size_t pixels = 0;
            for (uint32_t y = y0; y < y0 + image->height / 2; ++y)
                for (uint32_t x = x0; x < x0 + image->width / 2; ++x)
                    pixels += image->rgba[(size_t{y} * image->width + x) * 4] != image->rgba[0];
            return pixels;
        };
        INFO(c.route->name);
        const size_t all = covered(0, 0) + covered(image->width / 2, 0) + covered(0, image->height / 2) +
                           covered(image->width / 2, image->height / 2);
        CHECK(all > 100);
        // Back faces are culled: the character must still be there when they are not, with the same outline.
        Case kept = c;
        kept.keepBackFaces = true;
        auto both = renderImage(workload, kept, *open.backend);
        REQUIRE(both);
        CHECK(compareImages(*image, *both, 2).fraction < 0.02);
    }
}

TEST_CASE("culling in the mesh stage draws what the rasteriser's culling draws, and drops back faces") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(2);
    // Half of the bar is gone, so its inside shows where nothing culls.
    std::vector<uint32_t> half;
    const std::vector<uint32_t>& indices = workload.stored.mesh.indices;
    for (size_t i = 0; i < indices.size(); i += 3)
        if (indices[i] % 8 >= 2 && indices[i] % 8 < 6) half.insert(half.end(), &indices[i], &indices[i] + 3);
    workload.stored.mesh.indices = half;
    workload.stored.parts.front().indexCount = static_cast<uint32_t>(half.size());
    for (const char* name : {"vk-ext", "vk-nv", "gl-ext", "gl-nv"}) {
        const Case c = makeCase(name, "mesh");
        Backend* backend = openedBackends().at(c.route->api).backend;
        if (!backend || unsupported(c, backend->caps())) continue;
        auto draw = [&](Cull cull, Exchange exchange, uint32_t groupSize, bool keep) {
            Case drawn = c;
            drawn.cull = cull;
            drawn.exchange = exchange;
            drawn.groupSize = groupSize;
            drawn.keepBackFaces = keep;
            if (unsupported(drawn, backend->caps())) return Image{};
            auto image = renderImage(workload, drawn, *backend);
            if (!image) FAIL(image.error().text);
            return *image;
        };
        INFO(name);
        const Image culled = draw(Cull::off, Exchange::automatic, 32, false);
        const Image kept = draw(Cull::off, Exchange::automatic, 32, true);
        CHECK(compareImages(culled, kept, 2).fraction > 0.0007);
        for (Cull cull : {Cull::compact, Cull::primitive, Cull::torabi})
            for (Exchange exchange : {Exchange::shared, Exchange::shuffle})
                for (uint32_t groupSize : {8u, 16u, 32u}) {
                    const Image image = draw(cull, exchange, groupSize, true);
                    if (image.rgba.empty()) continue;
                    INFO(static_cast<int>(cull) << " " << static_cast<int>(exchange) << " " << groupSize);
                    // Torabi's test loses triangles that are seen edge-on.
                    CHECK(compareImages(culled, image, 0).fraction <= (cull == Cull::torabi ? 0.0005 : 0));
                }
    }
}

TEST_CASE("work groups and meshlets of mesh stages are right up to what the device allows") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = modelWorkload("builtin:robot:2000", 2);
    std::vector<Case> cases;
    for (const char* route : {"vk-ext", "vk-nv", "gl-ext", "gl-nv"}) {
        const Case usual = makeCase(route, "mesh");
        const Backend* backend = openedBackends().at(usual.route->api).backend;
        if (!backend || unsupported(usual, backend->caps())) continue;
        const MeshLimitsOfDevice& limits = meshLimits(backend->caps(), usual.route->dialect);
        for (uint32_t groupSize : {129u, 256u, std::min(limits.maxGroupSize, 1024u)}) {
            Case large = usual;
            large.groupSize = groupSize;
            if (groupSize <= limits.maxGroupSize) cases.push_back(large);
        }
        Case most = usual;
        most.limits = {std::min(limits.maxVertices, 255u), std::min(limits.maxTriangles, 512u)};
        if (!unsupported(most, backend->caps())) cases.push_back(most);
    }
    if (cases.empty()) SKIP("no mesh shaders on this machine");
    CHECK(requireVerified(workload, cases) == cases.size());
}

namespace {

// Several rows, so that a far half exists, of even and odd copies.
constexpr uint32_t kGridCopies = 60;

std::vector<Case> computeCases(const char* codec = nullptr) {
    std::set<std::string> known;
    std::vector<Case> cases;
    for (const Case& c : everyCase())
        if (c.compute != ComputeOptions{} && c.view == View::shaded && (!codec || c.codec == findCodec(codec)) &&
            known.insert(caseId(c)).second)
            cases.push_back(c);
    return cases;
}

Case computeCase(Api api, const ComputeOptions& options) {
    Case c = makeCase(api == Api::vulkan ? "vk" : "gl", "compute");
    c.compute = options;
    return c;
}

}  // namespace

TEST_CASE("every option of compute is right on a grid with a far half") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(kGridCopies);
    CHECK(requireVerified(workload, computeCases("uc")) > 10);
    if (modelFiles().empty()) return;
    size_t models = 0;
    for (const char* name : {"/cesium_man.glb", "/fox.glb"})
        for (const std::string& file : modelFiles())
            if (file.ends_with(name)) {
                Workload model = modelWorkload(file, 7);
                CHECK(requireVerified(model, everyThird(computeCases("uc"), models++)) > 3);
            }
    CHECK(models == 2);
}

TEST_CASE("Wicked Engine's layout is right in compute, and its codec wherever vertices are decoded") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(3);
    std::vector<Case> cases;
    for (Api api : {Api::vulkan, Api::opengl})
        for (const ComputeOptions& options :
             {ComputeOptions{}, ComputeOptions{.wicked = true}, ComputeOptions{.earlyExit = true, .wicked = true},
              ComputeOptions{.packed = true, .shortTangents = true}}) {
            cases.push_back(computeCase(api, options));
            cases.back().codec = findCodec("wicked");
        }
    cases.push_back(*parseCaseId("vk-ext/mesh/wicked/meshopt/redirect"));
    cases.push_back(*parseCaseId("gl/vertex/wicked+pull"));
    CHECK(requireVerified(workload, cases) > 3);
}

TEST_CASE("half-rate skips odd copies of the far half in even frames, and no others") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(kGridCopies);
    for (const auto& [api, open] : openedBackends())
        for (Submission submission : {Submission::perCopy, Submission::batched})
            for (uint32_t number : {0u, 1u}) {
                if (!open.backend) continue;
                Case c = computeCase(api, {.halfRate = true});
                c.submission = submission;
                auto input = planInput(workload, c);
                REQUIRE(input);
                auto plan = makePlan(c, *input, open.backend->caps());
                REQUIRE(plan);
                auto id = open.backend->prepare(*plan);
                REQUIRE(id);
                auto frame = makeFrame(workload, 4, number);
                REQUIRE(frame);
                const auto palette = paletteBytes(*input, {}, *frame);
                REQUIRE(palette);
                const std::vector<FrameInput> frames{{frame->constants, *palette, {}}};
                REQUIRE(open.backend->run(*id, frames));
                auto bytes = open.backend->readStream(*id, SLOT_SKINNED);
                REQUIRE(bytes);
                open.backend->release(*id);
                const auto columns = static_cast<uint32_t>(frame->constants.grid.x);
                const uint32_t rows = (kGridCopies + columns - 1) / columns;
                REQUIRE(rows > 2);
                const size_t size = bytes->size() / kGridCopies;
                uint32_t skipped = 0;
                for (uint32_t copy = 0; copy < kGridCopies; ++copy) {
                    const auto part = std::span(*bytes).subspan(copy * size, size);
                    const bool untouched = std::ranges::all_of(part, [](std::byte b) { return b == std::byte{0}; });
                    const bool far = copy >= (rows + 1) / 2 * columns;
                    INFO(caseId(c) << " frame " << number << " copy " << copy);
                    CHECK(untouched == (far && copy % 2 != number));
                    skipped += untouched;
                }
                CHECK(skipped > kGridCopies / 8);
            }
}

TEST_CASE("a fault in any option of compute is found") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    struct Fault {
        ComputeOptions options;
        const char *file, *right, *wrong, *reason;
    };
    const std::vector<Fault> faults = {
        {{.staged = true},
         "compute.glsl",
         "STAGED_JOINTS * PALETTE_ROWS); row",
         "STAGED_JOINTS * 2); row",
         "positions"},
        {{.previous = true},
         "skinned.glsl",
         "vec4(skinnedVertices[place].positionU.xyz",
         "vec4(position",
         "previous positions"},
        {{.tangents = true}, "compute.glsl", "turned(blend, tangent.xyz)", "tangent.xyz", "tangents"},
        {{.tangents = true}, "compute.glsl", "tangent.w);", "-tangent.w);", "tangents"},
        {{.shortTangents = true}, "compute.glsl", "turned(blend, tangent.xyz)", "tangent.xyz", "tangents"},
        {{.earlyExit = true}, "compute.glsl", "whole = 1.0 -", "whole = 0.5 -", "positions"},
        {{.packed = true}, "octahedral.glsl", "n.z < 0.0 ? fold", "n.z < -2.0 ? fold", "normals"},
        {{.wicked = true}, "byte_vectors.glsl", "vec4(n * 0.5 + 0.5", "vec4(n * 0.5 + 0.48", "normals"},
        {{.wicked = true}, "compute.glsl", "turned(blend, tangent.xyz)", "tangent.xyz", "tangents"},
        {{.halfRate = true}, "compute.glsl", "% 2u != 0u", "% 2u != 2u", "positions"},
    };
    BenchSettings settings;
    settings.timed = false;
    for (const Fault& fault : faults) {
        Workload workload = tinyWorkload(kGridCopies);
        std::string& text = workload.shaders.files[fault.file];
        INFO(fault.right);
        REQUIRE(text.find(fault.right) != std::string::npos);
        const std::string right = fault.right;
        for (size_t at = 0; (at = text.find(right, at)) != std::string::npos; at += std::string(fault.wrong).size())
            text.replace(at, right.size(), fault.wrong);
        std::vector<Case> cases;
        for (Api api : {Api::vulkan, Api::opengl}) cases.push_back(computeCase(api, fault.options));
        auto results = runBench(workload, cases, openedBackends(), settings, {});
        REQUIRE(results);
        for (const CaseResult& result : *results) {
            if (result.status == CaseStatus::skipped) continue;
            INFO(result.id << ": " << result.reason);
            CHECK(result.status == CaseStatus::failed);
            CHECK(result.reason.find(std::string(fault.reason) + " are off by") == 0);
        }
    }
}

TEST_CASE("a wrong palette, a wrong tolerance and a foreign image are found") {
    // The verification itself must be able to fail.
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(2);
    BenchSettings settings;
    settings.timed = false;
    settings.tolerance = 1e-12;
    auto results = runBench(workload, plainCases(4), openedBackends(), settings, {});
    REQUIRE(results);
    for (const CaseResult& result : *results)
        if (result.status != CaseStatus::skipped && result.theCase.variant->skins) {
            CHECK(result.status == CaseStatus::failed);
            CHECK(result.reason.find("positions are off by") == 0);
        }

    // A shader that forgets one influence.
    Workload broken = tinyWorkload(2);
    std::string& skin = broken.shaders.files["skin.glsl"];
    const std::string four = "for (uint i = 0u; i < 4u; ++i)";
    REQUIRE(skin.contains(four));
    skin.replace(skin.find(four), four.size(), "for (uint i = 0u; i < 3u; ++i)");
    settings.tolerance = 2e-6;
    results = runBench(broken, plainCases(4), openedBackends(), settings, {});
    REQUIRE(results);
    for (const CaseResult& result : *results)
        if (result.status != CaseStatus::skipped && result.theCase.variant->skins &&
            result.theCase.variant != findVariant("cpu")) {
            INFO(result.id);
            CHECK(result.status == CaseStatus::failed);
        }
}
