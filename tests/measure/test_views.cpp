// What the debug views show, alike on every route that this machine's drivers offer.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>

#include "common/frame/image.h"
#include "common/measure/bench.h"
#include "tests/cases.h"
#include "tests/drivers.h"

using namespace skinbench;

TEST_CASE("the resolution view shows a grid where there is one, alike on every route") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    Workload workload = tinyWorkload(1);
    std::map<std::string, Image> first;  // by codec
    for (const char* name : {"vk", "gl", "vk-ext", "gl-ext"}) {
        Case c = makeCase(name, findRoute(name)->dialect == MeshDialect::none ? "vertex" : "mesh");
        c.view = View::resolution;
        Backend* backend = openedBackends().at(c.route->api).backend;
        for (const char* codec : {"uc", "pc"}) {
            c.codec = findCodec(codec);
            c.fetch = VertexFetch::pull;
            if (!backend || unsupported(c, backend->caps())) continue;
            auto image = renderImage(workload, c, *backend);
            REQUIRE(image);
            INFO(name << " " << codec);
            // Grey has no hue; light and background have little.
            size_t coloured = 0;
            for (size_t i = 0; i < image->rgba.size(); i += 4) {
                const auto [low, high] = std::minmax({image->rgba[i], image->rgba[i + 1], image->rgba[i + 2]});
                coloured += high - low > 40;
            }
            INFO(coloured << " coloured pixels");
            CHECK((coloured > 100) == (codec == std::string("pc")));
            const auto [other, isFirst] = first.try_emplace(codec, *image);
            if (!isFirst) CHECK(compareImages(other->second, *image, 24).fraction < 0.01);
        }
    }
}

TEST_CASE("the view of normals shows unit vectors, that of joints the only ones of a rigid character") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    auto robot = makeBuiltin("robot", 2000);
    REQUIRE(robot);
    auto rigid = makeWorkload(std::move(*robot), testShaders(), {.width = 160, .height = 120});
    REQUIRE(rigid);
    Workload smooth = tinyWorkload(1);
    for (const char* name : {"vk", "vk-ext", "gl", "gl-ext"}) {
        Case c = makeCase(name, findRoute(name)->dialect == MeshDialect::none ? "vertex" : "mesh");
        Backend* const backend = openedBackends().at(c.route->api).backend;
        if (!backend || unsupported(c, backend->caps())) continue;
        INFO(name);
        const auto draw = [&](Workload& workload, View view) {
            c.view = view;
            auto image = renderImage(workload, c, *backend);
            REQUIRE(image);
            return std::move(*image);
        };
        const Image normals = draw(*rigid, View::normals);
        size_t drawn = 0;
        double worst = 0;
        for (size_t at = 0; at < normals.rgba.size(); at += 4) {
            if (std::equal(&normals.rgba[at], &normals.rgba[at] + 4, normals.rgba.begin())) continue;
            const glm::dvec3 n(normals.rgba[at], normals.rgba[at + 1], normals.rgba[at + 2]);
            worst = std::max(worst, std::abs(glm::length(n / 127.5 - 1.0) - 1));
            ++drawn;
        }
        CHECK(drawn > 500);
        CHECK(worst < 0.02);
        CHECK(compareImages(draw(*rigid, View::weights), draw(*rigid, View::joints), 0).fraction == 0);
        CHECK(compareImages(draw(smooth, View::weights), draw(smooth, View::joints), 2).fraction > 0.01);
    }
}

TEST_CASE("the velocity view tells what moves from what rests") {
    if (!anyDriver()) SKIP("no Vulkan and no OpenGL driver on this machine");
    for (const auto& [api, open] : openedBackends())
        for (bool packed : {false, true}) {
            if (!open.backend) continue;
            Case c = makeCase(api == Api::vulkan ? "vk" : "gl", "compute");
            c.compute = {.previous = true, .packed = packed};
            c.view = View::velocity;
            auto yellow = [&](bool animated) {
                Workload workload = tinyWorkload(1);
                workload.settings.animated = animated;
                auto image = renderImage(workload, c, *open.backend);
                REQUIRE(image);
                size_t pixels = 0;
                for (size_t i = 0; i < image->rgba.size(); i += 4) pixels += image->rgba[i] > image->rgba[i + 2] + 10;
                return pixels;
            };
            INFO(caseId(c));
            CHECK(yellow(false) == 0);
            CHECK(yellow(true) > 20);
        }
}
