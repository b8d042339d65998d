// Culling of meshlets and triangles: the same image in every camera on every route, and counts beside the oracle's.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <utility>

#include "common/frame/image.h"
#include "common/measure/bench.h"
#include "common/measure/drawing.h"
#include "common/measure/picking.h"
#include "tests/cases.h"
#include "tests/drivers.h"

using namespace skinbench;

namespace {

// Every vertex follows its heaviest joint alone, so that meshlets have cones.
Scene rigidScene() {
    auto scene = loadScene("builtin:biped:3000");
    REQUIRE(scene);
    for (Influences& own : scene->mesh.influences) {
        const auto heaviest = std::ranges::max_element(own.weights) - std::begin(own.weights);
        const uint16_t joint = own.joints[heaviest];
        own = {};
        own.joints[0] = joint;
        own.weights[0] = 1;
    }
    return std::move(*scene);
}

Workload cameraWorkload(Scene scene, Camera camera, uint32_t copies) {
    auto workload = makeWorkload(std::move(scene), testShaders(),
                                 {.copies = copies, .width = 320, .height = 180, .camera = camera});
    REQUIRE(workload);
    return std::move(*workload);
}

struct Drawn {
    Image image;
    Culling culling;
};

Drawn draw(Workload& workload, const Case& c, Backend& backend) {
    INFO(caseId(c));
    BenchSettings settings;
    settings.timed = false;
    auto results = runBench(workload, {c}, {{c.route->api, {&backend, {}}}}, settings, {});
    REQUIRE(results);
    INFO(results->front().reason);
    REQUIRE(results->front().status == CaseStatus::ok);
    auto image = renderImage(workload, c, backend);
    REQUIRE(image);
    return {std::move(*image), results->front().culling.value_or(Culling{})};
}

// The case on every route that its drivers run, small meshlets so that there are many.
std::vector<Case> onEveryRoute(const char* variant) {
    std::vector<Case> cases;
    for (const Route& route : routes()) {
        if (route.api == Api::cpu || !runsOn(*findVariant(variant), route)) continue;
        Case c = makeCase(route.name, variant);
        if (onMeshRoute(c)) c.limits = {24, 24};
        const Backend* backend = openedBackends().at(route.api).backend;
        if (backend && !unsupported(c, backend->caps())) cases.push_back(c);
    }
    return cases;
}

Backend& backendOf(const Case& c) { return *openedBackends().at(c.route->api).backend; }

}  // namespace

TEST_CASE("meshlets that are left out change no image, in any camera, and there are some of each test") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    for (Camera camera : {Camera::crowd, Camera::half, Camera::inside, Camera::close}) {
        Workload workload = cameraWorkload(rigidScene(), camera, camera == Camera::close ? 2 : 8);
        CAPTURE(cameraNames()[static_cast<size_t>(camera)]);
        for (const char* variant : {"mesh", "compute-mesh", "compute-cull"})
            for (Case c : onEveryRoute(variant)) {
                const Image whole = draw(workload, c, backendOf(c)).image;
                const bool plain = !onMeshRoute(c);
                c.clusterCull = plain || c.variant->readsSkinned ? ClusterCull::list : ClusterCull::task;
                INFO(caseId(c));
                const Drawn culled = draw(workload, c, backendOf(c));
                CHECK(compareImages(whole, culled.image, 0).fraction == 0);
                const Culling& counts = culled.culling;
                CHECK(counts.meshlets > 0);
                CHECK(counts.wrong == 0);
                CHECK(counts.frustum.count <= counts.frustum.possible);
                if (camera == Camera::half || camera == Camera::inside)
                    CHECK(counts.frustum.count * 10 >= counts.frustum.possible * 7);
                if (camera == Camera::half || camera == Camera::inside) CHECK(counts.frustum.count > 0);
                // Routes without mesh shaders have large meshlets, hardly any of one joint here.
                if (camera == Camera::close && !plain) CHECK(counts.cone.count > 0);
                if (camera != Camera::crowd && !plain) CHECK(counts.frustum.count != counts.cone.count);
                if (!plain) continue;
                CHECK(counts.triangles > 0);
                CHECK(counts.triangleBack.count > 0);
            }
    }
}

TEST_CASE("every kind of bounds leaves out some, none too much, and tighter ones more") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = cameraWorkload(tinyScene(), Camera::half, 60);
    for (Case c : onEveryRoute("mesh")) {
        c.clusterCull = ClusterCull::list;
        c.clusterTests = CLUSTER_TEST_FRUSTUM;
        auto countOf = [&](ClusterBounds bounds) {
            c.clusterBounds = bounds;
            const Culling counts = draw(workload, c, backendOf(c)).culling;
            CHECK(counts.cone.count == 0);
            CHECK(counts.frustum.count <= counts.frustum.possible);
            return counts.frustum.count;
        };
        const uint64_t spheres = countOf(ClusterBounds::jointSpheres), boxes = countOf(ClusterBounds::jointBoxes);
        const uint64_t one = countOf(ClusterBounds::oneSphere), instance = countOf(ClusterBounds::instance);
        CHECK(spheres * 10 >= one * 9);  // a sphere around fewer points may stick out of one around more
        CHECK(boxes > instance);
        CHECK(one > instance);
        CHECK(instance > 0);
        c.clusterTests = 0;
        CHECK(countOf(ClusterBounds::jointSpheres) == 0);
    }
}

namespace {

// What a verifying plan of the case counts.
Culling countsOf(Workload& workload, const Case& c) {
    INFO(caseId(c));
    const auto picture = renderPicture(workload, c, backendOf(c));
    REQUIRE(picture);
    CHECK(picture->fault == "");
    CHECK(backendOf(c).takeMessages().empty());
    return picture->culling.value_or(Culling{});
}

}  // namespace

TEST_CASE("triangles that mesh stages drop are counted, as many as compute-cull drops and positions turn away") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    constexpr uint32_t kCopies = 6;
    Workload workload = cameraWorkload(tinyScene(), Camera::half, kCopies);
    const uint64_t all = workload.stored.mesh.indices.size() / 3 * kCopies;
    bool first = true;
    for (Case c : onEveryRoute("mesh")) {
        INFO(caseId(c));
        Case listed = makeCase(c.route->api == Api::vulkan ? "vk" : "gl", "compute-cull");
        listed.triangleTests = TEST_BACK;
        const LeftOut back = countsOf(workload, listed).triangleBack;
        CHECK(back.count <= back.possible);
        CHECK(back.count * 100 > back.possible * 98);
        const auto check = [&](const Case& culling) {
            if (unsupported(culling, backendOf(culling).caps())) return;
            INFO(caseId(culling));
            const Culling counts = countsOf(workload, culling);
            CHECK(counts.triangles == all);
            CHECK(counts.triangleBack.possible == back.possible);
            // Torabi's form leaves nothing that is in doubt.
            if (culling.cull != Cull::torabi) CHECK(counts.triangleBack.count == back.count);
            if (culling.cull == Cull::torabi) CHECK(counts.triangleBack.count >= back.count);
        };
        for (Cull cull : {Cull::compact, Cull::primitive, Cull::torabi}) {
            c.cull = cull;
            check(c);
        }
        if (!std::exchange(first, false)) continue;
        c.cull = Cull::compact;
        Case other = c;
        other.submission = Submission::batched;
        other.vertexWrites = VertexWrites::last;
        check(other);
        other = c;
        other.scenario = Scenario::prepass;
        check(other);
        // Those of meshlets that are drawn.
        other = c;
        other.variant = findVariant("compute-mesh");
        other.clusterCull = ClusterCull::list;
        const Culling counts = countsOf(workload, other);
        CHECK(counts.triangles > 0);
        CHECK(counts.triangles < all);
        CHECK(counts.triangleBack.count > 0);
        CHECK(counts.triangleBack.count <= counts.triangleBack.possible);
    }
}

TEST_CASE("triangles are counted by the shader that drops them") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = cameraWorkload(tinyScene(), Camera::half, 2);
    std::string& text = workload.shaders.files.at("cull.glsl");
    const std::string test = "facesAway(a, b, c)";
    text.replace(text.find(test), test.size(), "false");
    for (Case c : onEveryRoute("mesh")) {
        c.cull = Cull::compact;
        const Culling counts = countsOf(workload, c);
        CHECK(counts.triangles > 0);
        CHECK(counts.triangleBack.count == 0);
        CHECK(counts.triangleBack.possible > 0);
    }
}

TEST_CASE("bounds that are too small fail the case") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = cameraWorkload(tinyScene(), Camera::half, 12);
    std::string& text = workload.shaders.files.at("cluster_tests.glsl");
    const std::string scale = "* CLUSTER_SCALE";
    text.replace(text.find(scale), scale.size(), "* CLUSTER_SCALE * 0.1");
    for (Case c : onEveryRoute("mesh")) {
        c.clusterCull = ClusterCull::list;
        BenchSettings settings;
        settings.timed = false;
        auto results = runBench(workload, {c}, openedBackends(), settings, {});
        REQUIRE(results);
        CHECK(results->front().status == CaseStatus::failed);
        CHECK(results->front().reason.contains("meshlets were left out that can be seen"));
    }
}

namespace {

// The verdict whose colour of the legend a pixel has, lit as it may be; empty: none, the background.
std::optional<uint32_t> verdictAt(const Image& image, size_t pixel) {
    static const glm::dvec3 colors[VERDICT_COUNT] = {{COLOR_DRAWN},         {COLOR_BEYOND},
                                                     {COLOR_AWAY},          {COLOR_TRIANGLE_BEYOND},
                                                     {COLOR_TRIANGLE_AWAY}, {COLOR_TRIANGLE_SMALL}};
    const uint8_t* const rgb = &image.rgba[pixel * 4];
    const glm::dvec3 seen(rgb[0], rgb[1], rgb[2]);
    for (uint32_t verdict = 0; verdict < VERDICT_COUNT; ++verdict) {
        const double light = glm::dot(seen, colors[verdict]) / glm::dot(colors[verdict], colors[verdict]);
        if (light > 0.35 * 255 && glm::distance(seen, colors[verdict] * light) < 3) return verdict;
    }
    return std::nullopt;
}

using Shares = std::array<size_t, VERDICT_COUNT>;

// Pixels of each verdict; every pixel has one or is the background, which the first pixel shows.
Shares sharesOf(const Image& image) {
    Shares shares{};
    size_t other = 0;
    for (size_t pixel = 0; pixel * 4 < image.rgba.size(); ++pixel) {
        if (std::equal(&image.rgba[pixel * 4], &image.rgba[pixel * 4] + 4, image.rgba.begin())) continue;
        const auto verdict = verdictAt(image, pixel);
        verdict ? ++shares[*verdict] : ++other;
    }
    CHECK(other == 0);
    return shares;
}

Picture drawCulled(Workload& workload, Case c) {
    c.view = View::culled;
    INFO(caseId(c));
    auto picture = renderPicture(workload, c, backendOf(c));
    REQUIRE(picture);
    CHECK(picture->fault == "");
    CHECK(backendOf(c).takeMessages().empty());
    REQUIRE(picture->culling);
    return std::move(*picture);
}

// What a shaded picture of the case counts must be what the view of culling does.
void checkSameCounts(Workload& workload, const Case& c, const Culling& culled) {
    const auto picture = renderPicture(workload, c, backendOf(c));
    REQUIRE(picture);
    const Culling& plain = picture->culling.value_or(Culling{});
    if (c.clusterCull != ClusterCull::off) CHECK(plain.meshlets > 0);
    CHECK(culled.meshlets == plain.meshlets);
    CHECK(culled.frustum.count == plain.frustum.count);
    CHECK(culled.cone.count == plain.cone.count);
    CHECK(culled.triangles == plain.triangles);
    CHECK(culled.triangleFrustum.count == plain.triangleFrustum.count);
    CHECK(culled.triangleBack.count == plain.triangleBack.count);
    CHECK(culled.triangleSmall.count == plain.triangleSmall.count);
}

// The share of a hundred places in the picture whose colour is the verdict that positions in double precision give, on
// either side of the view's edge and of a face; beyond these two tests none may be made.
double rightShare(Workload& workload, Case c) {
    const Image image = drawCulled(workload, c).image;
    c.view = View::culled;
    const auto input = planInput(workload, c);
    const auto frame = makeFrame(workload, c.influences, 0);
    REQUIRE(input);
    REQUIRE(frame);
    const std::vector<uint32_t>& indices = input->scene->mesh.indices;
    size_t tried = 0, right = 0;
    for (size_t pixel = 0; pixel * 4 < image.rgba.size() && tried < 150; pixel += 17) {
        const auto shown = verdictAt(image, pixel);
        const glm::vec2 at((pixel % image.width + 0.5f) / image.width, (pixel / image.width + 0.5f) / image.height);
        const auto lines = shown ? pickLines(c, *input, *frame, at) : std::vector<std::string>();
        if (lines.empty()) continue;
        unsigned copy = 0, triangle = 0;
        REQUIRE(std::sscanf(lines[0].c_str(), "copy %u, triangle %u", &copy, &triangle) == 2);
        const auto posed = skinReference(input->scene->mesh, paletteOfCopy(*frame, copy));
        std::array<glm::dvec4, 3> p;
        bool beside = true, left = true, below = true, above = true;
        for (size_t i = 0; i < 3; ++i) {
            p[i] = clipPosition(frame->constants, copy, posed.positions[indices[triangle * 3 + i]]);
            beside = beside && p[i].x > p[i].w, left = left && -p[i].x > p[i].w;
            below = below && p[i].y > p[i].w, above = above && -p[i].y > p[i].w;
        }
        const bool beyond = beside || left || below || above;
        const bool away =
            glm::determinant(glm::dmat3(glm::dvec3(p[0].x, p[0].y, p[0].w), glm::dvec3(p[1].x, p[1].y, p[1].w),
                                        glm::dvec3(p[2].x, p[2].y, p[2].w))) > 0;
        ++tried;
        right += *shown == uint32_t(beyond ? VERDICT_TRIANGLE_BEYOND : away ? VERDICT_TRIANGLE_AWAY : VERDICT_DRAWN);
    }
    REQUIRE(tried > 60);
    return static_cast<double>(right) / static_cast<double>(tried);
}

}  // namespace

TEST_CASE("the view of culling has the colours of its legend alone, and shows what each camera leaves out") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    for (Camera camera : {Camera::crowd, Camera::half}) {
        Workload workload = cameraWorkload(rigidScene(), camera, 4);
        const bool half = camera == Camera::half;
        CAPTURE(half);
        for (const char* variant : {"mesh", "mesh-ci", "compute-mesh", "compute-cull"}) {
            std::optional<Image> first;
            for (Case c : onEveryRoute(variant)) {
                const bool plain = !onMeshRoute(c), usual = plain || c.variant == findVariant("mesh");
                if ((first || !usual) && !half) continue;
                if (first && c.variant == findVariant("mesh-ci")) continue;
                c.clusterCull = plain || c.variant->readsSkinned ? ClusterCull::list : ClusterCull::task;
                if (usual && !plain) c.cull = Cull::compact;
                INFO(caseId(c));
                const Picture picture = drawCulled(workload, c);
                const Shares shares = sharesOf(picture.image);
                const size_t beyond = shares[VERDICT_BEYOND] + shares[VERDICT_TRIANGLE_BEYOND];
                CHECK(shares[VERDICT_DRAWN] > 500);
                if (half) CHECK(beyond > 300);
                if (!half) CHECK(beyond == 0);
                CHECK((shares[VERDICT_TRIANGLE_AWAY] > 100) == (triangleTestsOf(c) != 0));
                if (!plain) CHECK(shares[VERDICT_AWAY] > 0);
                const Culling& counts = *picture.culling;
                if (c.cull != Cull::off) CHECK(counts.triangleBack.count <= counts.triangleBack.possible);
                if (c.cull != Cull::off) CHECK(counts.triangleBack.count * 10 > counts.triangleBack.possible * 9);
                if (first) CHECK(compareImages(*first, picture.image, 2).fraction < 0.001);
                if (!first && half && usual) checkSameCounts(workload, c, counts);
                if (!first) first = picture.image;
            }
        }
    }
}

TEST_CASE("each way of dropping back faces shows the same ones in the view of culling") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = cameraWorkload(tinyScene(), Camera::half, 6);
    for (Case c : onEveryRoute("mesh")) {
        c.cull = Cull::compact;
        const Picture compact = drawCulled(workload, c);
        CHECK(sharesOf(compact.image)[VERDICT_TRIANGLE_AWAY] > 100);
        for (Cull cull : {Cull::primitive, Cull::torabi}) {
            c.cull = cull;
            if (unsupported(c, backendOf(c).caps())) continue;
            INFO(caseId(c));
            const Picture other = drawCulled(workload, c);
            CHECK(compareImages(compact.image, other.image, 2).fraction < 0.01);
            if (cull == Cull::primitive)
                CHECK(other.culling->triangleBack.count == compact.culling->triangleBack.count);
        }
        for (Submission submission : {Submission::perCopy, Submission::batched}) {
            c.cull = Cull::compact;
            c.vertexWrites = VertexWrites::last;
            c.submission = submission;
            CHECK(compareImages(compact.image, drawCulled(workload, c).image, 0).fraction == 0);
        }
    }
}

TEST_CASE("a colour of the view of culling is the verdict that positions give, and a wrong verdict shows") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    for (const char* change : {"", "facesAway(pa, pb, pc)", "isBeyondOnePlane(a, b, c)"})
        for (Case c : onEveryRoute("compute-cull")) {
            Workload workload = cameraWorkload(tinyScene(), Camera::half, 6);
            c.triangleTests = TEST_FRUSTUM | TEST_BACK;
            std::string& text = workload.shaders.files.at("cull_triangles.glsl");
            if (*change) text.insert(text.find(change), "!");
            INFO(caseId(c) << " with the opposite of '" << change << "'");
            const double share = rightShare(workload, c);
            CHECK((share > 0.97) == (*change == 0));
            if (*change) CHECK(share < 0.8);
        }
}

TEST_CASE("what is picked in the view of culling lies where the overview shows it, with its meshlet's verdict") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = cameraWorkload(tinyScene(), Camera::half, 12);
    for (Case c : onEveryRoute("mesh")) {
        c.clusterCull = ClusterCull::list;
        c.clusterTests = CLUSTER_TEST_FRUSTUM;
        const Image image = drawCulled(workload, c).image;
        const auto frame = makeFrame(workload, c.influences, 0);
        const auto verdicts = verdictsOfPose(workload, c, backendOf(c));
        REQUIRE(frame);
        REQUIRE(verdicts);
        c.view = View::culled;
        const auto input = planInput(workload, c);
        REQUIRE(input);
        INFO(caseId(c));
        size_t tried = 0, right = 0, leftOut = 0;
        for (size_t pixel = 0; pixel * 4 < image.rgba.size(); pixel += 29) {
            const auto shown = verdictAt(image, pixel);
            const glm::vec2 at((pixel % image.width + 0.5f) / image.width, (pixel / image.width + 0.5f) / image.height);
            const auto lines = shown ? pickLines(c, *input, *frame, at, *verdicts) : std::vector<std::string>();
            if (lines.empty()) continue;
            REQUIRE(lines.size() > 4);
            if (tried == 0) CHECK(pickLines(c, *input, *frame, at).size() + 1 == lines.size());
            const bool out = lines[2].contains("left out: its bounds are outside of the view");
            CHECK(out != lines[2].contains("drawn"));
            ++tried;
            leftOut += out;
            right += out == (*shown == VERDICT_BEYOND);
        }
        CHECK(tried > 10);
        CHECK(leftOut > 0);
        CHECK(leftOut < tried);
        CHECK(right * 20 >= tried * 19);
    }
}
