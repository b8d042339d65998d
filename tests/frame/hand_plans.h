// Small plans written by hand for the tests of backends: one text for both APIs, so that every backend gets the same.
#pragma once

#include <cstring>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/frame/shader_text.h"
#include "tests/cases.h"

namespace skinbench::hand {

inline constexpr uint32_t kWidth = 64, kHeight = 48;

// Pixels are words, red in the lowest byte.
inline constexpr uint32_t kBackground = 0xff2e2621, kRed = 0xff0000ff, kGreen = 0xff00ff00, kBlue = 0xffff0000;

inline uint32_t pixel(const Image& image, uint32_t x, uint32_t y) {
    uint32_t word;
    std::memcpy(&word, &image.rgba[(size_t{y} * image.width + x) * 4], sizeof word);
    return word;
}

inline size_t countOf(const Image& image, uint32_t color) {
    size_t count = 0;
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) count += pixel(image, x, y) == color;
    return count;
}

// The half of the image above, or below, the diagonal from the lower left to the upper right corner.
inline uint32_t upperHalf(const Image& image) { return pixel(image, 1, 1); }
inline uint32_t lowerHalf(const Image& image) { return pixel(image, image.width - 2, image.height - 2); }

template <class T>
std::shared_ptr<const std::vector<std::byte>> bytesOf(const std::vector<T>& values) {
    auto bytes = std::as_bytes(std::span(values));
    return std::make_shared<std::vector<std::byte>>(bytes.begin(), bytes.end());
}

template <class T>
std::vector<T> valuesOf(const std::vector<std::byte>& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

template <class T>
T must(Result<T> result) {
    if (!result) FAIL(result.error().text);
    return std::move(*result);
}
inline void must(const Result<void>& result) {
    if (!result) FAIL(result.error().text);
}

inline FrameInput stillFrame() {
    FrameInput frame;
    frame.constants.viewProjection = glm::mat4(1);
    return frame;
}

inline ShaderText glsl(Api api, Stage stage, const std::string& body, MeshDialect dialect = MeshDialect::none,
                       Defines defines = {}) {
    static const ShaderLibrary shaders = testShaders();
    ShaderLibrary library = shaders;
    library.files["hand.glsl"] = "#include \"shared.h\"\n#include \"platform.glsl\"\n#line 1\n" + body;
    return must(shaderText(library, {"hand.glsl", stage, api, dialect, false, std::move(defines)}));
}

// Every draw in the colour of its second constant.
inline const char* const kFlatFragment = R"(
layout(location = 0) out vec4 target;
void main() { target = unpackUnorm4x8(drawConstants.y); }
)";

// --- fed by attributes ---------------------------------------------------------------------------------------------

struct Vertex {
    std::array<float, 3> position;
    std::array<float, 2> redGreen{1, 1};
    std::array<uint32_t, 4> blue{7, 255, 7, 7};
    std::array<float, 4> alpha{7, 7, 7, 1};
};

// From 1 on: the corners of the upper half, counter-clockwise as seen, and of the lower half with the last two of them.
inline const std::vector<Vertex> kVertices = {
    {{9, 9, 9}}, {{-1, -1, 0.5f}}, {{-1, 1, 0.5f}}, {{1, -1, 0.5f}}, {{1, 1, 0.5f}}};
inline const std::vector<uint32_t> kUpper = {0, 1, 2}, kUpperReversed = {0, 2, 1}, kLower = {3, 2, 1};

inline Draw draw(uint32_t count, uint32_t firstIndex = 0, uint32_t color = kRed) {
    return {.count = count, .firstIndex = firstIndex, .baseVertex = 1, .constants = {0, color, 0, 0}};
}

// Draws the triangles of `indices`, which count from vertex 1, in red.
inline FramePlan trianglePlan(Api api, const std::vector<uint32_t>& indices = kUpper,
                              const std::vector<Vertex>& vertices = kVertices) {
    FramePlan plan;
    plan.label = "triangle";
    plan.width = kWidth;
    plan.height = kHeight;
    plan.streams = {{.slot = SLOT_VERTEX, .use = useAttributes, .bytes = bytesOf(vertices)},
                    {.slot = SLOT_INDEX, .use = useIndices, .bytes = bytesOf(indices)}};
    plan.programs.push_back({.label = "triangle",
                             .stages = {glsl(api, Stage::vertex, R"(
layout(std140, binding = SLOT_FRAME) uniform FrameBlock { FrameConstants frame; };
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 redGreen;
layout(location = 2) in uvec4 blue;
layout(location = 3) in vec4 alpha;
layout(location = 0) out vec4 color;
void main() {
    color = vec4(redGreen, float(blue.y) / 255.0, alpha.w);
    gl_Position = frame.viewProjection * vec4(position, 1.0);
}
)"),
                                        glsl(api, Stage::fragment, R"(
layout(location = 0) in vec4 color;
layout(location = 0) out vec4 target;
void main() { target = color * unpackUnorm4x8(drawConstants.y); }
)")},
                             .attributes = {{0, AttributeFormat::float3, offsetof(Vertex, position)},
                                            {1, AttributeFormat::float2, offsetof(Vertex, redGreen)},
                                            {2, AttributeFormat::uint4, offsetof(Vertex, blue)},
                                            {3, AttributeFormat::float4, offsetof(Vertex, alpha)}},
                             .attributeStride = sizeof(Vertex)});
    plan.passes.push_back({.label = "draw", .draws = {draw(static_cast<uint32_t>(indices.size()))}});
    return plan;
}

// --- a compute pass, and a vertex stage that pulls what it wrote ---------------------------------------------------

using Rows = std::array<std::array<float, 4>, 3>;
inline constexpr Rows kIdentity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
inline constexpr Rows kTurned = {{{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}}};  // half a turn: to the lower half

inline FrameInput posedFrame(const Rows& palette) {
    FrameInput frame = stillFrame();
    frame.palette = std::as_bytes(std::span(palette));
    return frame;
}

using Point = std::array<float, 4>;

// Moves eight points, of which the first three are the upper half, by the palette, and draws the half green. Two
// dispatches of four invocations; the second one leaves the last point out.
inline FramePlan computePlan(Api api) {
    FramePlan plan;
    plan.label = "compute";
    plan.width = kWidth;
    plan.height = kHeight;
    plan.paletteBytes = sizeof(Rows);
    std::vector<Point> points(8, {-1, -1, 0.5f, 0});
    points[1] = {-1, 1, 0.5f, 0};
    points[2] = {1, -1, 0.5f, 0};
    plan.streams = {{.slot = SLOT_VERTEX, .bytes = bytesOf(points)},
                    {.slot = SLOT_INDEX, .use = useIndices, .bytes = bytesOf(kUpper)},
                    {.slot = SLOT_SKINNED, .gpuBytes = points.size() * sizeof(Point)}};
    plan.programs = {{.label = "skin", .stages = {glsl(api, Stage::compute, R"(
layout(local_size_x = 4) in;
layout(std430, binding = SLOT_PALETTE) readonly buffer PaletteBlock { vec4 rows[]; };
layout(std430, binding = SLOT_VERTEX) readonly buffer VertexBlock { vec4 points[]; };
layout(std430, binding = SLOT_SKINNED) writeonly buffer SkinnedBlock { vec4 skinned[]; };
void main() {
    uint i = gl_GlobalInvocationID.x + drawConstants.x;
    vec4 p = vec4(points[i].xyz, 1.0);
    if (i < drawConstants.w) skinned[i] = vec4(dot(rows[0], p), dot(rows[1], p), dot(rows[2], p), 1.0);
}
)")}},
                     {.label = "pull",
                      .stages = {glsl(api, Stage::vertex, R"(
layout(std430, binding = SLOT_SKINNED) readonly buffer SkinnedBlock { vec4 skinned[]; };
void main() { gl_Position = skinned[VERTEX_INDEX]; }
)"),
                                 glsl(api, Stage::fragment, kFlatFragment)}}};
    plan.passes = {{.label = "skin",
                    .kind = PassKind::dispatch,
                    .draws = {{.count = 1, .constants = {0, 0, 0, 7}}, {.count = 1, .constants = {4, 0, 0, 7}}}},
                   {.label = "draw", .program = 1, .draws = {{.count = 3, .constants = {0, kGreen, 0, 0}}}}};
    return plan;
}

// One dispatch of one work group that runs `body`; SLOT_SKINNED has room for `points`.
inline FramePlan dispatchPlan(Api api, const std::string& body, size_t points) {
    FramePlan plan;
    plan.label = "dispatch";
    plan.streams = {{.slot = SLOT_SKINNED, .gpuBytes = points * sizeof(Point)}};
    plan.programs = {{.label = "dispatch", .stages = {glsl(api, Stage::compute, body)}}};
    plan.passes = {{.label = "skin", .kind = PassKind::dispatch, .draws = {{.count = 1}}}};
    return plan;
}

// --- a mesh stage ---------------------------------------------------------------------------------------------------

// Work group 0 draws the upper half, 1 the lower; the first draw, red, starts one of them, the second, green, the
// other.
inline FramePlan meshPlan(Api api, MeshDialect dialect, bool withTask) {
    const std::string body = R"(
#if MESH_NV
#define PAYLOAD(way) taskNV way Payload { uint group; } payload
#else
#define PAYLOAD(way) struct Payload { uint group; }; taskPayloadSharedEXT Payload payload
#endif
#if STAGE_TASK
layout(local_size_x = 1) in;
PAYLOAD(out);
void main() {
    payload.group = gl_WorkGroupID.x + drawConstants.x;
#if MESH_NV
    gl_TaskCountNV = 1u;
#else
    EmitMeshTasksEXT(1u, 1u, 1u);
#endif
}
#else
layout(local_size_x = 32) in;
layout(triangles, max_vertices = 3, max_primitives = 1) out;
#if WITH_TASK
PAYLOAD(in);
#define GROUP payload.group
#else
#define GROUP (gl_WorkGroupID.x + drawConstants.x)
#endif
const vec2 corners[6] = vec2[](vec2(-1, -1), vec2(-1, 1), vec2(1, -1), vec2(1, 1), vec2(1, -1), vec2(-1, 1));
void main() {
    uint lane = gl_LocalInvocationIndex, group = GROUP;
#if MESH_NV
    if (lane < 3u) gl_MeshVerticesNV[lane].gl_Position = vec4(corners[group * 3u + lane], 0.5, 1.0);
    if (lane < 3u) gl_PrimitiveIndicesNV[lane] = lane;
    if (lane == 0u) gl_PrimitiveCountNV = 1u;
#else
    SetMeshOutputsEXT(3u, 1u);
    if (lane < 3u) gl_MeshVerticesEXT[lane].gl_Position = vec4(corners[group * 3u + lane], 0.5, 1.0);
    if (lane == 0u) gl_PrimitiveTriangleIndicesEXT[0] = uvec3(0, 1, 2);
#endif
}
#endif
)";
    FramePlan plan;
    plan.label = "mesh";
    plan.dialect = dialect;
    plan.width = kWidth;
    plan.height = kHeight;
    Program program{.label = "mesh"};
    const Defines defines = {{"WITH_TASK", withTask ? "1" : "0"}};
    if (withTask) program.stages.push_back(glsl(api, Stage::task, body, dialect, defines));
    program.stages.push_back(glsl(api, Stage::mesh, body, dialect, defines));
    program.stages.push_back(glsl(api, Stage::fragment, kFlatFragment));
    plan.programs = {program};
    plan.passes = {
        {.label = "draw",
         .kind = PassKind::drawMesh,
         .draws = {{.count = 1, .constants = {0, kRed, 0, 0}}, {.count = 1, .constants = {1, kGreen, 0, 0}}}}};
    return plan;
}

}  // namespace skinbench::hand
