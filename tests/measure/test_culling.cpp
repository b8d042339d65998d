// Culling of meshlets and triangles: the same image in every camera on every route, and counts beside the oracle's.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>

#include "common/frame/image.h"
#include "common/measure/bench.h"
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
