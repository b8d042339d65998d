// What is Vulkan's own: its guarantees, its validation layer, its pipeline cache.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/frame/hand_plans.h"

using namespace skinbench;
using namespace skinbench::hand;
namespace fs = std::filesystem;

namespace {

// The cache folder of this process, so that no test reads what another program left.
fs::path cacheFolder() {
    struct Folder {
        fs::path path = fs::temp_directory_path() / ("skinbench-test-" + std::to_string(std::random_device{}()));
        Folder() { setenv("XDG_CACHE_HOME", path.c_str(), 1); }
        ~Folder() {
            std::error_code ignored;
            fs::remove_all(path, ignored);
        }
    };
    static const Folder folder;
    return folder.path;
}

std::unique_ptr<Backend> openChecked() {
    cacheFolder();
    auto devices = listVulkanDevices();
    if (!devices) SKIP(devices.error().text);
    auto backend = openVulkan({.device = {}, .validation = true});
    if (!backend && backend.error().text.contains("VK_LAYER_KHRONOS_validation")) backend = openVulkan({});
    return must(std::move(backend));
}

Image draw(Backend& backend, const FramePlan& plan) {
    const PlanId id = must(backend.prepare(plan));
    const FrameInput frame = stillFrame();
    must(backend.run(id, {&frame, 1}));
    return must(backend.readImage(id));
}

}  // namespace

TEST_CASE("vulkan: devices have what the specification guarantees") {
    openChecked();
    for (const DeviceCaps& caps : must(listVulkanDevices())) {
        CAPTURE(caps.name);
        CHECK(caps.version.starts_with("Vulkan 1."));
        CHECK(caps.subgroupSize > 0);
        CHECK(caps.maxComputeGroupSize >= 128);
        CHECK(caps.maxComputeGroupCount >= 65535);
        CHECK(caps.maxStorageBytes >= 1u << 27);
        CHECK(caps.maxUniformBytes >= 16384);
        CHECK(caps.maxImageSize >= 4096);
        CHECK(caps.storageBlocksVertex >= 4);
        CHECK(caps.deviceBytes > 0);
        CHECK((std::ranges::binary_search(caps.extensions, "VK_EXT_mesh_shader") || !caps.ext.available));
        if (!caps.ext.available) continue;
        CHECK(caps.ext.maxVertices >= 256);
        CHECK(caps.ext.maxTriangles >= 256);
        CHECK(caps.ext.maxGroupSize >= 128);
        CHECK(caps.ext.maxGroupCount >= 65535);
        CHECK(caps.ext.maxOutputBytes >= 32768);
        CHECK(caps.ext.maxSharedBytes >= 28672);
        CHECK(caps.ext.preferredGroupSize > 0);
    }
}

TEST_CASE("vulkan: what the validation layer reports is collected") {
    auto backend = openChecked();
    if (!openVulkan({.device = {}, .validation = true})) SKIP("no validation layer");
    FramePlan plan = trianglePlan(Api::vulkan);
    plan.programs[0].attributeStride = 51;  // not a multiple of the component's size
    plan.programs[0].attributes[1].offset = 11;
    draw(*backend, plan);
    CHECK_FALSE(backend->takeMessages().empty());
    CHECK(backend->takeMessages().empty());
}

TEST_CASE("vulkan: pipelines are cached across runs, and a broken cache is ignored") {
    openChecked().reset();
    const fs::path folder = cacheFolder() / "skinbench";
    fs::remove_all(folder);
    auto drawOnce = [] {
        auto backend = openChecked();
        CHECK(upperHalf(draw(*backend, trianglePlan(Api::vulkan))) == kRed);
        CHECK(backend->takeMessages().empty());
    };
    drawOnce();
    REQUIRE(fs::exists(folder));
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    REQUIRE(files.size() == 1);
    const auto good = fs::file_size(files[0]);
    CHECK(good > 24);
    drawOnce();
    CHECK(std::distance(fs::directory_iterator(folder), {}) == 1);
    {
        std::fstream file(files[0], std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(good) - 1);
        file.put('\x5a');
    }
    drawOnce();
    fs::resize_file(files[0], good / 2);
    drawOnce();
    std::ofstream(files[0]) << "no cache at all, but long enough to hold a header and more";
    drawOnce();
    CHECK(fs::file_size(files[0]) > 24);
}
