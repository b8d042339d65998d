#include <algorithm>
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "common/frame/backend.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

namespace {

constexpr uint32_t kSize = 64;
constexpr const char* kDrawBlock = "layout(push_constant) uniform DrawBlock { uvec4 drawConstants; };\n";

std::string glsl(const std::string& body) { return std::string("#version 450\n") + kDrawBlock + body; }

const char* const kFragment = R"(
layout(location = 0) in vec4 color;
layout(location = 0) out vec4 target;
void main() { target = color; }
)";

// Fed by attributes: a position in clip space and a colour.
const char* const kAttributeVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 tint;
layout(location = 0) out vec4 color;
void main() {
    color = tint;
    gl_Position = vec4(position, 1.0);
}
)";

// Pulls positions that another pass or the host wrote.
const char* const kPullingVertex = R"(
layout(std430, binding = 7) readonly buffer Skinned { vec4 skinned[]; };
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0, 1.0, 0.0, 1.0);
    gl_Position = vec4(skinned[gl_VertexIndex].xyz, 1.0);
}
)";

template <class T>
std::shared_ptr<const std::vector<std::byte>> bytesOf(const std::vector<T>& values) {
    auto bytes = std::make_shared<std::vector<std::byte>>(values.size() * sizeof(T));
    std::memcpy(bytes->data(), values.data(), bytes->size());
    return bytes;
}

template <class T>
std::vector<T> valuesOf(const std::vector<std::byte>& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

struct Rgba {
    int r, g, b, a;
    bool operator==(const Rgba&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Rgba& c) {
    return out << c.r << ' ' << c.g << ' ' << c.b << ' ' << c.a;
}
constexpr Rgba kBackground{33, 38, 46, 255}, kRed{255, 0, 0, 255}, kGreen{0, 255, 0, 255}, kBlue{0, 0, 255, 255};

Rgba pixel(const Image& image, uint32_t x, uint32_t y) {
    const uint8_t* p = &image.rgba[(size_t{y} * image.width + x) * 4];
    return {p[0], p[1], p[2], p[3]};
}

size_t countOf(const Image& image, const Rgba& color) {
    size_t count = 0;
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) count += pixel(image, x, y) == color;
    return count;
}

// The upper left corner of the screen, counter-clockwise as seen: left top, left bottom, right top.
const std::vector<float> kCorner{-1, -1, 0.5f, 1, 0, 0, 1, -1, 0, 0.5f, 1, 0, 0, 1, 0, -1, 0.5f, 1, 0, 0, 1};

FramePlan trianglePlan(std::vector<uint32_t> indices) {
    FramePlan plan;
    plan.label = "triangle";
    plan.width = plan.height = kSize;
    plan.streams.push_back({.slot = SLOT_VERTEX, .use = useAttributes, .bytes = bytesOf(kCorner)});
    const uint32_t count = static_cast<uint32_t>(indices.size());
    plan.streams.push_back({.slot = SLOT_INDEX, .use = useIndices, .bytes = bytesOf(indices)});
    plan.programs.push_back({.label = "triangle",
                             .stages = {{Stage::vertex, "triangle.vert", glsl(kAttributeVertex)},
                                        {Stage::fragment, "flat.frag", glsl(kFragment)}},
                             .attributes = {{0, AttributeFormat::float3, 0}, {1, AttributeFormat::float4, 12}},
                             .attributeStride = 28});
    plan.passes.push_back({.label = "draw", .draws = {{.count = count}}});
    return plan;
}

// A compute pass writes three vertices scaled by its draw's second constant, a pulling pass draws them.
FramePlan computePlan() {
    FramePlan plan;
    plan.label = "compute";
    plan.width = plan.height = kSize;
    plan.streams.push_back({.slot = SLOT_SKINNED, .gpuBytes = 48});
    plan.streams.push_back({.slot = SLOT_INDEX, .use = useIndices, .bytes = bytesOf<uint32_t>({0, 1, 2})});
    plan.programs.push_back({.label = "skin",
                             .stages = {{Stage::compute, "skin.comp", glsl(R"(
layout(local_size_x = 4) in;
layout(std430, binding = 7) writeonly buffer Skinned { vec4 skinned[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < 3u) skinned[i] = vec4(i == 2u ? 1.0 : -1.0, i == 1u ? 1.0 : -1.0, 0.5, float(drawConstants.y));
}
)")}},
                             .attributes = {}});
    plan.programs.push_back({.label = "pull",
                             .stages = {{Stage::vertex, "pull.vert", glsl(kPullingVertex)},
                                        {Stage::fragment, "flat.frag", glsl(kFragment)}},
                             .attributes = {}});
    plan.passes.push_back(
        {.label = "skin", .kind = PassKind::dispatch, .draws = {{.count = 1, .constants = {5, 7, 0, 0}}}});
    plan.passes.push_back({.label = "draw", .program = 1, .draws = {{.count = 3}}});
    return plan;
}

// A mesh-shader plan whose one work group emits the corner triangle, coloured by the palette and the constants.
FramePlan meshPlan(MeshDialect dialect) {
    const bool nv = dialect == MeshDialect::nv;
    const std::string body =
        std::string(R"(
layout(local_size_x = 1) in;
layout(triangles, max_vertices = 3, max_primitives = 1) out;
layout(std430, binding = 1) readonly buffer Palette { vec4 palette[]; };
layout(location = 0) out vec4 color[];
void main() {
)") + (nv ? "gl_PrimitiveCountNV = 1u;\n" : "SetMeshOutputsEXT(3u, 1u);\n") +
        R"(for (uint i = 0u; i < 3u; ++i) {
        color[i] = palette[0] + vec4(0.0, 0.0, float(drawConstants.x), 0.0);
        VERTICES[i].gl_Position = vec4(i == 2u ? 0.0 : -1.0, i == 1u ? 0.0 : -1.0, 0.5, 1.0);
    }
)" +
        (nv ? "gl_PrimitiveIndicesNV[0] = 0u; gl_PrimitiveIndicesNV[1] = 1u; gl_PrimitiveIndicesNV[2] = 2u;\n}\n"
            : "gl_PrimitiveTriangleIndicesEXT[0] = uvec3(0u, 1u, 2u);\n}\n");
    const std::string head =
        nv ? "#version 450\n#extension GL_NV_mesh_shader : require\n#define VERTICES gl_MeshVerticesNV\n"
           : "#version 450\n#extension GL_EXT_mesh_shader : require\n#define VERTICES gl_MeshVerticesEXT\n";
    FramePlan plan;
    plan.label = nv ? "mesh nv" : "mesh ext";
    plan.dialect = dialect;
    plan.width = plan.height = kSize;
    plan.paletteBytes = 48;
    plan.programs.push_back({.label = "mesh",
                             .stages = {{Stage::mesh, "triangle.mesh", head + kDrawBlock + body},
                                        {Stage::fragment, "flat.frag", glsl(kFragment)}},
                             .attributes = {}});
    plan.passes.push_back(
        {.label = "draw", .kind = PassKind::drawMesh, .draws = {{.count = 1, .constants = {1, 0, 0, 0}}}});
    return plan;
}

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

std::unique_ptr<Backend> openOrSkip() {
    cacheFolder();
    // Hazards on storage buffers too; not on by default, as draws that write apart from each other look like one.
    setenv("VK_LAYER_SYNCVAL_SHADER_ACCESSES_HEURISTIC", "1", 1);
    auto devices = listVulkanDevices();
    if (!devices || devices->empty()) SKIP("no Vulkan device");
    auto backend = openVulkan({.device = {}, .validation = true});
    if (!backend && backend.error().text.contains("VK_LAYER_KHRONOS_validation")) backend = openVulkan({});
    if (!backend) FAIL(backend.error().text);
    return std::move(*backend);
}

void requireSilence(Backend& backend) {
    for (const std::string& message : backend.takeMessages()) FAIL_CHECK(message);
}

template <class T>
T must(Result<T> result) {
    if (!result) FAIL(result.error().text);
    return std::move(*result);
}

Image imageOf(Backend& backend, const FramePlan& plan, std::span<const FrameInput> frames = {}) {
    const PlanId id = must(backend.prepare(plan));
    const FrameInput still;
    auto timings = must(backend.run(id, frames.empty() ? std::span(&still, 1) : frames));
    for (const Timing& timing : timings) {
        CHECK(timing.passes.size() == plan.passes.size());
        CHECK(std::ranges::all_of(timing.passes, [](double ms) { return ms >= 0 && ms < 60'000; }));
        CHECK(timing.record > 0);
        CHECK(timing.submit > 0);
    }
    Image image = must(backend.readImage(id));
    CHECK(image.width == plan.width);
    CHECK(image.height == plan.height);
    REQUIRE(image.rgba.size() == size_t{plan.width} * plan.height * 4);
    backend.release(id);
    return image;
}

}  // namespace

TEST_CASE("vulkan: devices are listed with their facts") {
    auto backend = openOrSkip();
    const auto devices = must(listVulkanDevices());
    for (const DeviceCaps& caps : devices) {
        CAPTURE(caps.name);
        CHECK(caps.api == Api::vulkan);
        CHECK_FALSE(caps.name.empty());
        CHECK_FALSE(caps.driver.empty());
        CHECK(caps.version.starts_with("Vulkan 1."));
        CHECK(caps.timestampPeriodNs > 0);
        CHECK(caps.subgroupSize > 0);
        CHECK(caps.maxComputeGroupSize >= 128);
        CHECK(caps.maxComputeGroupCount >= 65535);
        CHECK(caps.maxStorageBytes >= 1u << 27);
        CHECK(caps.maxUniformBytes >= 16384);
        CHECK(caps.storageBlocksVertex >= 4);
        CHECK(caps.deviceBytes > 0);
        CHECK(std::ranges::is_sorted(caps.extensions));
        const bool named = std::ranges::binary_search(caps.extensions, "VK_EXT_mesh_shader");
        CHECK((named || !caps.ext.available));
        if (caps.ext.available) {
            CHECK(caps.ext.maxVertices >= 256);
            CHECK(caps.ext.maxTriangles >= 256);
            CHECK(caps.ext.maxGroupSize >= 128);
            CHECK(caps.ext.maxGroupCount >= 65535);
            CHECK(caps.ext.maxOutputBytes >= 32768);
            CHECK(caps.ext.maxSharedBytes >= 28672);
            CHECK(caps.ext.preferredGroupSize > 0);
        }
    }
    CHECK(std::ranges::find(devices, backend->caps().name, &DeviceCaps::name) != devices.end());
    requireSilence(*backend);

    auto none = openVulkan({.device = "no such device"});
    REQUIRE_FALSE(none);
    CHECK(none.error().fault == Fault::device);
    CHECK_THAT(none.error().text, ContainsSubstring("no such device") && ContainsSubstring(devices[0].name));
}

TEST_CASE("vulkan: y points down and front faces are counter-clockwise on the screen") {
    auto backend = openOrSkip();
    const Image image = imageOf(*backend, trianglePlan({0, 1, 2}));
    CHECK(pixel(image, 2, 2) == kRed);
    CHECK(pixel(image, kSize / 2 - 3, 0) == kRed);
    CHECK(pixel(image, 0, kSize / 2 - 3) == kRed);
    CHECK(pixel(image, kSize - 2, 2) == kBackground);
    CHECK(pixel(image, 2, kSize - 2) == kBackground);
    CHECK(pixel(image, kSize / 2, kSize / 2) == kBackground);
    CHECK(countOf(image, kRed) + countOf(image, kBackground) == kSize * kSize);

    FramePlan reversed = trianglePlan({0, 2, 1});
    CHECK(countOf(imageOf(*backend, reversed), kBackground) == kSize * kSize);
    reversed.passes[0].cullBackFaces = false;
    CHECK(imageOf(*backend, reversed).rgba == image.rgba);
    requireSilence(*backend);
}

TEST_CASE("vulkan: raster modes and depth tests") {
    auto backend = openOrSkip();
    for (RasterMode mode : {RasterMode::noFragments, RasterMode::discard}) {
        FramePlan plan = trianglePlan({0, 1, 2});
        plan.passes[0].raster = mode;
        CHECK(countOf(imageOf(*backend, plan), kBackground) == kSize * kSize);
    }
    const size_t lit = countOf(imageOf(*backend, trianglePlan({0, 1, 2})), kRed);
    REQUIRE(lit > 0);

    // A depth pass draws no colour; the colour pass after it keeps what is equal, and draws nothing without it.
    FramePlan twice = trianglePlan({0, 1, 2});
    twice.passes.push_back(twice.passes[0]);
    twice.passes[0].label = "depth";
    twice.passes[0].writeColor = false;
    twice.passes[1].depth = DepthTest::equalKeep;
    twice.passes[1].clear = false;
    CHECK(countOf(imageOf(*backend, twice), kRed) == lit);
    twice.passes[0].raster = RasterMode::noFragments;
    CHECK(countOf(imageOf(*backend, twice), kRed) == 0);
    twice.passes.pop_back();
    twice.passes[0].raster = RasterMode::full;
    CHECK(countOf(imageOf(*backend, twice), kBackground) == kSize * kSize);
    requireSilence(*backend);
}

TEST_CASE("vulkan: a compute pass feeds the drawing pass") {
    auto backend = openOrSkip();
    const PlanId id = must(backend->prepare(computePlan()));
    CHECK(valuesOf<float>(must(backend->readStream(id, SLOT_SKINNED))) == std::vector<float>(12, 0.0f));
    const std::vector<FrameInput> frames(3);
    auto timings = must(backend->run(id, frames));
    REQUIRE(timings.size() == 3);
    CHECK(timings[2].passes.size() == 2);
    CHECK(valuesOf<float>(must(backend->readStream(id, SLOT_SKINNED))) ==
          std::vector<float>{-1, -1, 0.5f, 7, -1, 1, 0.5f, 7, 1, -1, 0.5f, 7});
    const Image image = must(backend->readImage(id));
    CHECK(pixel(image, 1, 1) == kGreen);
    CHECK(pixel(image, kSize - 2, kSize - 2) == kBackground);
    CHECK(must(backend->run(id, {})).empty());
    requireSilence(*backend);
}

TEST_CASE("vulkan: every frame of a batch has its own palette and constants") {
    auto backend = openOrSkip();
    for (MeshDialect dialect : {MeshDialect::ext, MeshDialect::nv}) {
        CAPTURE(meshPlan(dialect).label);
        if (!meshLimits(backend->caps(), dialect).available) {
            auto refused = backend->prepare(meshPlan(dialect));
            REQUIRE_FALSE(refused);
            CHECK_THAT(refused.error().text, ContainsSubstring("_mesh_shader"));
            continue;
        }
        std::vector<float> red(12, 0.0f), green(12, 0.0f);
        red[0] = red[3] = green[1] = green[3] = 1;
        std::vector<FrameInput> frames(2);
        frames[0].palette = std::as_bytes(std::span(red));
        frames[1].palette = std::as_bytes(std::span(green));
        const Rgba cyan{0, 255, 255, 255}, magenta{255, 0, 255, 255};
        Image image = imageOf(*backend, meshPlan(dialect), frames);
        CHECK(pixel(image, 2, 2) == cyan);
        CHECK(pixel(image, kSize - 2, kSize - 2) == kBackground);
        CHECK(countOf(image, magenta) == 0);
        std::swap(frames[0], frames[1]);
        image = imageOf(*backend, meshPlan(dialect), frames);
        CHECK(pixel(image, 2, 2) == magenta);
    }
    requireSilence(*backend);
}

TEST_CASE("vulkan: frame constants reach the uniform block of their frame") {
    auto backend = openOrSkip();
    FramePlan plan = trianglePlan({0, 1, 2});
    plan.programs[0].stages[1].text = glsl(R"(
layout(std140, binding = 0) uniform FrameBlock { mat4 viewProjection; vec4 grid; };
layout(location = 0) in vec4 color;
layout(location = 0) out vec4 target;
void main() { target = vec4(0.0, 0.0, grid.w, color.a); }
)");
    std::vector<FrameInput> frames(20);
    frames.back().constants.grid.w = 1;
    CHECK(pixel(imageOf(*backend, plan, frames), 2, 2) == kBlue);
    frames.back().constants.grid.w = 0;
    frames.front().constants.grid.w = 1;
    CHECK(pixel(imageOf(*backend, plan, frames), 2, 2) == Rgba{0, 0, 0, 255});
    requireSilence(*backend);
}

TEST_CASE("vulkan: replicas are copies of their own, indices moved on") {
    auto backend = openOrSkip();
    // The second and the third copy of the indices draw the second and the third copy of the vertices.
    FramePlan plan = trianglePlan({0, 1, 2});
    plan.streams[0].replicas = plan.streams[1].replicas = 3;
    plan.streams[1].replicaAdd = 3;
    plan.passes[0].draws = {{.count = 3, .firstIndex = 6}};
    const PlanId id = must(backend->prepare(plan));
    CHECK(valuesOf<uint32_t>(must(backend->readStream(id, SLOT_INDEX))) ==
          std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8});
    std::vector<float> vertices;
    for (int i = 0; i < 3; ++i) vertices.insert(vertices.end(), kCorner.begin(), kCorner.end());
    CHECK(valuesOf<float>(must(backend->readStream(id, SLOT_VERTEX))) == vertices);
    const FrameInput still;
    must(backend->run(id, {&still, 1}));
    CHECK(pixel(must(backend->readImage(id)), 2, 2) == kRed);
    auto missing = backend->readStream(id, SLOT_TUPLE);
    REQUIRE_FALSE(missing);
    requireSilence(*backend);
}

TEST_CASE("vulkan: streams larger than one copy survive the way there and back") {
    auto backend = openOrSkip();
    std::vector<uint32_t> words((5u << 20) - 3);  // 20 MiB a replica: chunks end inside replicas
    for (size_t i = 0; i < words.size(); ++i) words[i] = static_cast<uint32_t>(i * 2654435761u);
    FramePlan plan = trianglePlan({0, 1, 2});
    plan.streams.push_back({.slot = SLOT_TUPLE, .bytes = bytesOf(words), .replicas = 4, .replicaAdd = 11});
    const PlanId id = must(backend->prepare(plan));
    const auto back = valuesOf<uint32_t>(must(backend->readStream(id, SLOT_TUPLE)));
    REQUIRE(back.size() == words.size() * 4);
    size_t wrong = 0;
    for (size_t i = 0; i < back.size(); ++i)
        wrong += back[i] != words[i % words.size()] + 11 * static_cast<uint32_t>(i / words.size());
    CHECK(wrong == 0);
    requireSilence(*backend);
}

TEST_CASE("vulkan: the host writes the skinned stream before each frame") {
    auto backend = openOrSkip();
    FramePlan plan = computePlan();
    plan.passes.erase(plan.passes.begin());
    plan.streams[0].hostWritten = true;
    const std::vector<float> full{-1, -1, 0.5f, 1, -1, 1, 0.5f, 1, 1, -1, 0.5f, 1}, nothing(12, 0.0f);
    std::vector<FrameInput> frames(2);
    frames[0].skinned = std::as_bytes(std::span(nothing));
    frames[1].skinned = std::as_bytes(std::span(full));
    const PlanId id = must(backend->prepare(plan));
    for (const Timing& timing : must(backend->run(id, frames))) CHECK(timing.upload > 0);
    CHECK(pixel(must(backend->readImage(id)), 1, 1) == kGreen);
    CHECK(valuesOf<float>(must(backend->readStream(id, SLOT_SKINNED))) == full);
    std::swap(frames[0], frames[1]);
    must(backend->run(id, frames));
    CHECK(countOf(must(backend->readImage(id)), kBackground) == kSize * kSize);
    requireSilence(*backend);
}

TEST_CASE("vulkan: a shader that does not compile is one sentence, and the backend stays usable") {
    auto backend = openOrSkip();
    FramePlan plan = trianglePlan({0, 1, 2});
    plan.programs[0].stages[1].text =
        "#version 450\nlayout(location = 0) out vec4 target;\nvoid main() {\n    target = nowhere;\n}\n";
    for (int i = 0; i < 2; ++i) {
        auto failed = backend->prepare(plan);
        REQUIRE_FALSE(failed);
        CHECK(failed.error().fault == Fault::device);
        CHECK_THAT(failed.error().text, ContainsSubstring("triangle: flat.frag") && ContainsSubstring("0:4:") &&
                                            ContainsSubstring("'nowhere'"));
        CHECK_FALSE(failed.error().text.contains('\n'));
    }
    CHECK(countOf(imageOf(*backend, trianglePlan({0, 1, 2})), kRed) > 0);
    requireSilence(*backend);
}

TEST_CASE("vulkan: a plan that the device cannot hold is refused with both numbers") {
    auto backend = openOrSkip();
    const DeviceCaps& caps = backend->caps();
    FramePlan plan = trianglePlan({0, 1, 2});
    plan.streams.push_back({.slot = SLOT_TUPLE, .gpuBytes = caps.maxStorageBytes + 4});
    auto refused = backend->prepare(plan);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().text, ContainsSubstring("slot 6") &&
                                         ContainsSubstring(std::to_string(caps.maxStorageBytes + 4)) &&
                                         ContainsSubstring(caps.name));
    plan.streams.back() = {.slot = SLOT_TUPLE, .use = useUniform, .gpuBytes = caps.maxUniformBytes + 4};
    refused = backend->prepare(plan);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().text, ContainsSubstring(std::to_string(caps.maxUniformBytes)));
    plan.streams.pop_back();
    plan.width = 1u << 20;
    REQUIRE_FALSE(backend->prepare(plan));
    plan.width = kSize;

    FramePlan groups = computePlan();
    if (caps.maxComputeGroupCount < UINT32_MAX) {
        groups.passes[0].draws[0].count = caps.maxComputeGroupCount + 1;
        refused = backend->prepare(groups);
        REQUIRE_FALSE(refused);
        CHECK_THAT(refused.error().text, ContainsSubstring(std::to_string(caps.maxComputeGroupCount)));
    }
    CHECK(countOf(imageOf(*backend, plan), kRed) > 0);
    requireSilence(*backend);
}

TEST_CASE("vulkan: running out of memory frees what the plan took") {
    auto backend = openOrSkip();
    const DeviceCaps& caps = backend->caps();
    constexpr uint64_t most = uint64_t{1} << 31;  // what every device takes in one buffer
    FramePlan plan = trianglePlan({0, 1, 2});
    for (uint32_t slot = SLOT_MESHLET; slot <= SLOT_CAPTURE; ++slot)
        plan.streams.push_back({.slot = slot, .use = useAttributes, .gpuBytes = most});
    if (planBytes(plan) < caps.deviceBytes) SKIP("the largest plan fits into this device");
    const FrameInput still;
    const PlanId first = must(backend->prepare(trianglePlan({0, 1, 2})));
    for (int i = 0; i < 3; ++i) {
        auto failed = backend->prepare(plan);
        REQUIRE_FALSE(failed);
        CHECK_THAT(failed.error().text, ContainsSubstring("2048 MiB of device memory") && ContainsSubstring(caps.name));
    }
    must(backend->run(first, {&still, 1}));
    CHECK(countOf(must(backend->readImage(first)), kRed) > 0);
    requireSilence(*backend);
}

TEST_CASE("vulkan: several plans live side by side") {
    auto backend = openOrSkip();
    const FrameInput still;
    FramePlan wide = trianglePlan({0, 1, 2});
    wide.width = 2 * kSize + 1;
    const PlanId a = must(backend->prepare(trianglePlan({0, 1, 2})));
    const PlanId b = must(backend->prepare(computePlan()));
    const PlanId c = must(backend->prepare(wide));
    CHECK_FALSE(backend->readImage(a));  // not run yet
    must(backend->run(a, {&still, 1}));
    must(backend->run(c, {&still, 1}));
    const Image first = must(backend->readImage(a));
    CHECK(must(backend->readImage(c)).width == 2 * kSize + 1);
    must(backend->run(b, std::vector<FrameInput>(500)));  // moves what the other plans' descriptors point to
    CHECK(pixel(must(backend->readImage(b)), kSize / 2 + 4, 2) == kGreen);
    auto overdrawn = backend->readImage(a);
    REQUIRE_FALSE(overdrawn);
    CHECK_THAT(overdrawn.error().text, ContainsSubstring("run it again"));
    backend->release(b);
    must(backend->run(a, {&still, 1}));
    CHECK(must(backend->readImage(a)).rgba == first.rgba);
    requireSilence(*backend);
}

TEST_CASE("vulkan: the validation layer's words are collected") {
    auto backend = openOrSkip();
    if (!openVulkan({.device = {}, .validation = true})) SKIP("no validation layer");
    FramePlan plan = trianglePlan({0, 1, 2});
    plan.programs[0].attributeStride = 27;  // not a multiple of the component's size
    plan.programs[0].attributes[1].offset = 11;
    const PlanId id = must(backend->prepare(plan));
    const FrameInput still;
    must(backend->run(id, {&still, 1}));
    CHECK_FALSE(backend->takeMessages().empty());
    CHECK(backend->takeMessages().empty());
}

TEST_CASE("vulkan: pipelines are cached across runs, and a broken cache is ignored") {
    openOrSkip().reset();
    const fs::path folder = cacheFolder() / "skinbench";
    fs::remove_all(folder);
    auto draw = [] {
        auto backend = openOrSkip();
        CHECK(countOf(imageOf(*backend, trianglePlan({0, 1, 2})), kRed) > 0);
        requireSilence(*backend);
    };
    draw();
    REQUIRE(fs::exists(folder));
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    REQUIRE(files.size() == 1);
    const auto good = fs::file_size(files[0]);
    CHECK(good > 24);
    draw();
    CHECK(std::distance(fs::directory_iterator(folder), {}) == 1);
    {
        std::fstream file(files[0], std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(good) - 1);
        file.put('\x5a');
    }
    draw();
    fs::resize_file(files[0], good / 2);
    draw();
    std::ofstream(files[0]) << "no cache at all, but long enough to hold a header and more";
    draw();
    CHECK(fs::file_size(files[0]) > 24);
}
