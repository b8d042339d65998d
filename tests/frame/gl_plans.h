// Hand-written plans for the tests of the OpenGL backend, and what helps to look at their results.
#pragma once

#include <algorithm>
#include <catch2/catch_test_macros.hpp>
#include <cstring>
#include <format>

#include "common/frame/backend.h"

namespace skinbench::gltest {

inline constexpr uint32_t kWidth = 64, kHeight = 48;

using Color = std::array<uint8_t, 4>;
inline constexpr Color kBackground = {33, 38, 46, 255};
inline constexpr Color kRed = {255, 0, 0, 255}, kGreen = {0, 255, 0, 255};
inline constexpr uint32_t kRedWord = 0xff0000ff, kGreenWord = 0xff00ff00;

inline std::unique_ptr<Backend> openDevice() {
    auto devices = listGlDevices();
    if (!devices) SKIP(devices.error().text);
    if (devices->empty()) SKIP("no OpenGL device");
    auto backend = openGl({.device = {}, .validation = true});
    REQUIRE(backend);
    return std::move(*backend);
}

inline void requireQuiet(Backend& backend) {
    for (const std::string& message : backend.takeMessages()) FAIL_CHECK(message);
}

template <class T>
inline Stream makeStream(uint32_t slot, uint32_t use, const std::vector<T>& values) {
    auto bytes = std::make_shared<std::vector<std::byte>>(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(bytes->data(), values.data(), bytes->size());
    Stream stream;
    stream.slot = slot;
    stream.use = use;
    stream.bytes = bytes;
    return stream;
}

inline Stream makeGpuStream(uint32_t slot, uint64_t bytes) {
    Stream stream;
    stream.slot = slot;
    stream.gpuBytes = bytes;
    return stream;
}

template <class T>
std::vector<T> readAs(Backend& backend, PlanId plan, uint32_t slot) {
    auto bytes = backend.readStream(plan, slot);
    REQUIRE(bytes);
    std::vector<T> values(bytes->size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes->data(), bytes->size());
    return values;
}

inline Color pixel(const Image& image, uint32_t x, uint32_t y) {
    Color color;
    std::memcpy(color.data(), &image.rgba[(size_t{y} * image.width + x) * 4], 4);
    return color;
}

inline bool isOnlyBackground(const Image& image) {
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x)
            if (pixel(image, x, y) != kBackground) return false;
    return true;
}

inline FrameInput makeFrame(std::span<const std::byte> palette = {}, std::span<const std::byte> skinned = {}) {
    FrameInput frame;
    frame.constants.viewProjection = glm::mat4(1);
    frame.palette = palette;
    frame.skinned = skinned;
    return frame;
}

inline Image render(Backend& backend, const FramePlan& plan, std::span<const FrameInput> frames) {
    auto id = backend.prepare(plan);
    if (!id) FAIL(id.error().text);
    auto timings = backend.run(*id, frames);
    if (!timings) FAIL(timings.error().text);
    REQUIRE(timings->size() == frames.size());
    for (const Timing& timing : *timings) {
        REQUIRE(timing.passes.size() == plan.passes.size());
        for (double ms : timing.passes) CHECK((ms >= 0 && ms < 60'000));
        CHECK(timing.record > 0);
        CHECK(timing.submit >= 0);
    }
    auto image = backend.readImage(*id);
    if (!image) FAIL(image.error().text);
    REQUIRE(image->rgba.size() == size_t{4} * plan.width * plan.height);
    backend.release(*id);
    return *image;
}

inline Image render(Backend& backend, const FramePlan& plan) {
    const FrameInput frame = makeFrame();
    return render(backend, plan, std::span(&frame, 1));
}

inline const char* kFragment = R"(#version 450
layout(location = 0) in vec4 color;
layout(location = 0) out vec4 pixel;
void main() { pixel = color; }
)";

struct Vertex {
    std::array<float, 3> position;
    std::array<float, 2> redGreen;
    std::array<uint32_t, 4> blueAlpha;
};

inline const char* kAttributeVertex = R"(#version 450
layout(location = 0) uniform uvec4 drawConstants;
layout(std140, binding = 0) uniform Frame { mat4 viewProjection; vec4 grid; };
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 redGreen;
layout(location = 2) in uvec4 blueAlpha;
layout(location = 0) out vec4 color;
void main() {
    gl_Position = viewProjection * vec4(position, 1.0);
    color = vec4(redGreen, vec2(blueAlpha.yw) / 255.0) * unpackUnorm4x8(drawConstants.y);
}
)";

// Corners of the top left and of the bottom right half, y down, counter-clockwise as seen on the screen.
inline const std::vector<Vertex> kVertices = {
    {{9, 9, 9}, {0, 0}, {}},
    {{-1, -1, 0.5f}, {1, 1}, {7, 255, 7, 255}},
    {{-1, 1, 0.5f}, {1, 1}, {7, 255, 7, 255}},
    {{1, -1, 0.5f}, {1, 1}, {7, 255, 7, 255}},
    {{1, 1, 0.5f}, {1, 1}, {7, 255, 7, 255}},
};

inline Draw makeDraw(uint32_t count, uint32_t firstIndex = 0, int32_t baseVertex = 0, uint32_t color = 0) {
    return {count, firstIndex, baseVertex, {0, color, 0, 0}};
}

// Draws the triangles of `indices` red, each index one less than the vertex.
inline FramePlan attributePlan(const std::vector<uint32_t>& indices) {
    FramePlan plan;
    plan.label = "attributes";
    plan.width = kWidth;
    plan.height = kHeight;
    plan.streams = {makeStream(SLOT_VERTEX, useAttributes, kVertices), makeStream(SLOT_INDEX, useIndices, indices)};
    Program program;
    program.label = "attributes";
    program.stages = {{Stage::vertex, "attributes.vert", kAttributeVertex}, {Stage::fragment, "plain.frag", kFragment}};
    program.attributes = {{0, AttributeFormat::float3, offsetof(Vertex, position)},
                          {1, AttributeFormat::float2, offsetof(Vertex, redGreen)},
                          {2, AttributeFormat::uint4, offsetof(Vertex, blueAlpha)}};
    program.attributeStride = sizeof(Vertex);
    plan.programs = {program};
    Pass pass;
    pass.label = "draw";
    pass.draws = {makeDraw(static_cast<uint32_t>(indices.size()), 0, 1, kRedWord)};
    plan.passes = {pass};
    return plan;
}

inline const std::vector<uint32_t> kTopLeft = {0, 1, 2}, kTopLeftReversed = {0, 2, 1}, kBottomRight = {3, 2, 1};

inline void requireTopLeftOnly(const Image& image, Color color) {
    CHECK(pixel(image, 0, 0) == color);
    CHECK(pixel(image, kWidth / 2, 2) == color);
    CHECK(pixel(image, 2, kHeight / 2) == color);
    CHECK(pixel(image, kWidth - 1, kHeight - 1) == kBackground);
    CHECK(pixel(image, kWidth - 3, kHeight / 2) == kBackground);
    CHECK(pixel(image, kWidth / 2, kHeight - 3) == kBackground);
}

inline const char* kSkinCompute = R"(#version 450
layout(local_size_x = 4) in;
layout(location = 0) uniform uvec4 drawConstants;
layout(std430, binding = 1) readonly buffer Palette { vec4 rows[]; };
layout(std430, binding = 2) readonly buffer Vertices { vec4 positions[]; };
layout(std430, binding = 7) writeonly buffer Skinned { vec4 skinned[]; };
void main() {
    uint i = gl_GlobalInvocationID.x + drawConstants.x;
    vec4 p = vec4(positions[i].xyz, 1.0);
    if (i < drawConstants.w) skinned[i] = vec4(dot(rows[0], p), dot(rows[1], p), dot(rows[2], p), 1.0);
}
)";

inline const char* kPullVertex = R"(#version 450
layout(std430, binding = 7) readonly buffer Skinned { vec4 skinned[]; };
layout(location = 0) out vec4 color;
void main() {
    gl_Position = skinned[gl_VertexID];
    color = vec4(0.0, 1.0, 0.0, 1.0);
}
)";

using Rows = std::array<std::array<float, 4>, 3>;

inline std::span<const std::byte> bytesOf(const Rows& rows) { return std::as_bytes(std::span(rows)); }

// A compute pass moves a triangle by the palette and a draw pulls it.
inline FramePlan computePlan() {
    FramePlan plan;
    plan.label = "compute";
    plan.width = kWidth;
    plan.height = kHeight;
    plan.paletteBytes = sizeof(Rows);
    std::vector<std::array<float, 4>> positions(8, {-1, -1, 0.5f, 0});
    positions[1] = {-1, 1, 0.5f, 0};
    positions[2] = {1, -1, 0.5f, 0};
    plan.streams = {makeStream(SLOT_VERTEX, useStorage, positions), makeStream(SLOT_INDEX, useIndices, kTopLeft),
                    makeGpuStream(SLOT_SKINNED, positions.size() * 16)};
    Program skin{"skin", {{Stage::compute, "skin.comp", kSkinCompute}}, {}, SLOT_VERTEX, 0};
    Program draw{"draw",
                 {{Stage::vertex, "pull.vert", kPullVertex}, {Stage::fragment, "plain.frag", kFragment}},
                 {},
                 SLOT_VERTEX,
                 0};
    plan.programs = {skin, draw};
    Pass skinPass, drawPass;
    skinPass.label = "skin";
    skinPass.kind = PassKind::dispatch;
    skinPass.draws = {{1, 0, 0, {0, 0, 0, 7}}, {1, 0, 0, {4, 0, 0, 7}}};
    drawPass.label = "draw";
    drawPass.program = 1;
    drawPass.draws = {makeDraw(3)};
    plan.passes = {skinPass, drawPass};
    return plan;
}

inline constexpr Rows kIdentity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
inline constexpr Rows kTurned = {
    {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}}};  // half a turn: same winding, other corner

// What differs between the dialects, as macros; both write the same two triangles.
inline const char* kMeshExt = R"(#version 450
#extension GL_EXT_mesh_shader : require
#define PER_PRIMITIVE perprimitiveEXT
#define VERTICES gl_MeshVerticesEXT
#define BEGIN SetMeshOutputsEXT(3, 1)
#define END if (lane == 0) gl_PrimitiveTriangleIndicesEXT[0] = uvec3(0, 1, 2)
#ifdef AFTER_TASK
struct Payload { uint group; };
taskPayloadSharedEXT Payload payload;
#define GROUP payload.group
#endif
)";

inline const char* kMeshNv = R"(#version 450
#extension GL_NV_mesh_shader : require
#define PER_PRIMITIVE perprimitiveNV
#define VERTICES gl_MeshVerticesNV
#define BEGIN
#define END if (lane < 3) gl_PrimitiveIndicesNV[lane] = lane; if (lane == 0) gl_PrimitiveCountNV = 1
#ifdef AFTER_TASK
taskNV in Payload { uint group; };
#define GROUP group
#endif
)";

inline const char* kMeshBody = R"(
#ifndef GROUP
#define GROUP (gl_WorkGroupID.x + drawConstants.x)
#endif
layout(local_size_x = 32) in;
layout(triangles, max_vertices = 3, max_primitives = 1) out;
layout(location = 0) uniform uvec4 drawConstants;
layout(std430, binding = 3) readonly buffer Colors { uint colors[]; };
#ifdef COLOR_PER_VERTEX
#define LANES 3
layout(location = 0) out vec4 color[];
#else
#define LANES 1
layout(location = 0) PER_PRIMITIVE out vec4 color[];
#endif
#ifdef SPARE
layout(location = 1) out vec4 spare[];
#endif
const vec2 corners[6] = vec2[](vec2(-1, -1), vec2(-1, 1), vec2(1, -1), vec2(1, 1), vec2(1, -1), vec2(-1, 1));
void main() {
    uint lane = gl_LocalInvocationIndex, g = GROUP;
    BEGIN;
    if (lane < 3) VERTICES[lane].gl_Position = vec4(corners[g * 3 + lane], 0.5, 1.0);
    if (lane < LANES) color[lane] = unpackUnorm4x8(colors[g]);
#ifdef SPARE
    if (lane < LANES) spare[lane] = color[lane] * vec4(2, 3, 4, 5) + 1.0;
#endif
    END;
}
)";

// Reads all of `spare`, which is never negative.
inline const char* kSpareFragment = R"(#version 450
layout(location = 0) in vec4 color;
layout(location = 1) in vec4 spare;
layout(location = 0) out vec4 pixel;
void main() { pixel = dot(spare, vec4(1.0)) < 0.0 ? spare : color; }
)";

// `text` with `defines` behind its version line.
inline std::string withDefines(const std::string& text, const std::string& defines) {
    size_t line = text.find('\n') + 1;
    return text.substr(0, line) + defines + text.substr(line);
}

inline const char* kPrimitiveFragmentExt = R"(#version 450
#extension GL_EXT_mesh_shader : require
layout(location = 0) perprimitiveEXT in vec4 color;
layout(location = 0) out vec4 pixel;
void main() { pixel = color; }
)";

inline const char* kPrimitiveFragmentNv = R"(#version 450
#extension GL_NV_mesh_shader : require
layout(location = 0) perprimitiveNV in vec4 color;
layout(location = 0) out vec4 pixel;
void main() { pixel = color; }
)";

inline const char* kTaskExt = R"(#version 450
#extension GL_EXT_mesh_shader : require
layout(local_size_x = 1) in;
layout(location = 0) uniform uvec4 drawConstants;
struct Payload { uint group; };
taskPayloadSharedEXT Payload payload;
void main() {
    payload.group = gl_WorkGroupID.x + drawConstants.x;
    EmitMeshTasksEXT(1, 1, 1);
}
)";

inline const char* kTaskNv = R"(#version 450
#extension GL_NV_mesh_shader : require
layout(local_size_x = 1) in;
layout(location = 0) uniform uvec4 drawConstants;
taskNV out Payload { uint group; };
void main() {
    group = gl_WorkGroupID.x + drawConstants.x;
    gl_TaskCountNV = 1;
}
)";

enum class MeshColor { perPrimitive, perVertex, perVertexAndSpare };

// Group 0 draws the top left half red, group 1 the bottom right half green.
inline FramePlan meshPlan(MeshDialect dialect, bool withTask, MeshColor color) {
    bool nv = dialect == MeshDialect::nv;
    FramePlan plan;
    plan.label = "mesh";
    plan.dialect = dialect;
    plan.width = kWidth;
    plan.height = kHeight;
    plan.streams = {makeStream(SLOT_MESHLET, useStorage, std::vector<uint32_t>{kRedWord, kGreenWord})};
    std::string defines = withTask ? "#define AFTER_TASK\n" : "";
    if (color != MeshColor::perPrimitive) defines += "#define COLOR_PER_VERTEX\n";
    if (color == MeshColor::perVertexAndSpare) defines += "#define SPARE\n";
    Program program;
    program.label = "mesh";
    if (withTask) program.stages.push_back({Stage::task, "group.task", nv ? kTaskNv : kTaskExt});
    program.stages.push_back(
        {Stage::mesh, "two.mesh", withDefines(std::string(nv ? kMeshNv : kMeshExt) + kMeshBody, defines)});
    const char* primitive = nv ? kPrimitiveFragmentNv : kPrimitiveFragmentExt;
    const char* vertex = color == MeshColor::perVertex ? kFragment : kSpareFragment;
    program.stages.push_back({Stage::fragment, "plain.frag", color == MeshColor::perPrimitive ? primitive : vertex});
    plan.programs = {program};
    Pass pass;
    pass.label = "draw";
    pass.kind = PassKind::drawMesh;
    pass.draws = {{1, 0, 0, {0, 0, 0, 0}}, {1, 0, 0, {1, 0, 0, 0}}};
    plan.passes = {pass};
    return plan;
}

}  // namespace skinbench::gltest
