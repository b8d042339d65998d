#include "backend_gl/driver_faults.h"

#include <array>

#include "backend_gl/plan.h"

namespace skinbench {

namespace {

const char* kConstantsMesh = R"(#version 450
#extension GL_EXT_mesh_shader : require
layout(local_size_x = 1) in;
layout(triangles, max_vertices = 3, max_primitives = 1) out;
layout(location = 0) uniform uvec4 drawConstants;
layout(std430, binding = 0) writeonly buffer Seen { uint seen; };
void main() {
    SetMeshOutputsEXT(0, 0);
    seen = drawConstants.x;
}
)";

const char* kConstantsFragment = R"(#version 450
layout(location = 0) out vec4 pixel;
void main() { pixel = vec4(0); }
)";

// The values depend on a uniform and every component counts: a linker moves constants and unused outputs away. The
// second triangle is in front, of another value of `first`, and culled.
const char* kOutputsMesh = R"(#version 450
#extension GL_EXT_mesh_shader : require
layout(local_size_x = 1) in;
layout(triangles, max_vertices = 6, max_primitives = 2) out;
layout(location = 0) uniform float one;
layout(location = 0) out vec4 first[];
layout(location = 1) out vec4 second[];
void main() {
    SetMeshOutputsEXT(6, 2);
    for (uint i = 0u; i < 6u; ++i) {
        gl_MeshVerticesEXT[i].gl_Position =
            vec4(i % 3u == 1u ? 3.0 : -1.0, i % 3u == 2u ? 3.0 : -1.0, i < 3u ? 0.5 : 0.25, 1.0);
        first[i] = vec4(0.1, 0.2, 0.3, 0.4) * (i < 3u ? one : 2.0 * one);
        second[i] = vec4(0.5, 0.6, 0.7, 0.8) * one;
    }
    gl_PrimitiveTriangleIndicesEXT[0] = uvec3(0, 1, 2);
    gl_PrimitiveTriangleIndicesEXT[1] = uvec3(3, 4, 5);
    gl_MeshPrimitivesEXT[0].gl_CullPrimitiveEXT = false;
    gl_MeshPrimitivesEXT[1].gl_CullPrimitiveEXT = true;
}
)";

const char* kOutputsFragment = R"(#version 450
layout(location = 0) in vec4 first;
layout(location = 1) in vec4 second;
layout(location = 0) out vec4 pixel;
void main() { pixel = vec4(dot(first, vec4(0.25)), dot(second, vec4(0.25)), 0.0, 1.0); }
)";

// An empty vertex array and a 1x1 image to draw into, bound.
struct TestTargets {
    GlVertexArray vertexArray;
    GlTargets targets;
};

Result<TestTargets> bindTestTargets() {
    auto targets = makeTargets(1, 1);
    SKINBENCH_TRY(targets);
    GLuint vertexArray = 0;
    glCreateVertexArrays(1, &vertexArray);
    glBindVertexArray(vertexArray);
    glBindFramebuffer(GL_FRAMEBUFFER, targets->framebuffer.id());
    glViewport(0, 0, 1, 1);
    return TestTargets{GlVertexArray(vertexArray), std::move(*targets)};
}

}  // namespace

Result<LinkedProgram> findStaleConstants(DrawMeshTasksExt drawMeshTasksExt, ProgramCache& programs, Staging& staging) {
    Program program;
    program.label = "constants";
    program.stages = {{Stage::mesh, "constants.mesh", kConstantsMesh},
                      {Stage::fragment, "constants.frag", kConstantsFragment}};
    auto linked = programs.get(program);
    if (!linked) return linked;
    auto seen = makeBuffer(4, "OpenGL: a test buffer");
    SKINBENCH_TRY(seen);
    auto bound = bindTestTargets();
    SKINBENCH_TRY(bound);

    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, seen->id());
    glUseProgram(linked->id);
    constexpr GLuint kLast = 2;
    for (GLuint value = 1; value <= kLast; ++value) {
        glUniform4ui(linked->constants, value, 0, 0, 0);
        drawMeshTasksExt(1, 1, 1);
        glMemoryBarrier(GL_ALL_BARRIER_BITS);
    }
    std::array<GLuint, 1> value{};
    staging.read(*seen, std::as_writable_bytes(std::span(value)));
    SKINBENCH_TRY(checkGl("OpenGL: a first mesh shader", 4));
    return value[0] == kLast ? LinkedProgram{} : *linked;
}

void findMeshFaults(DrawMeshTasksExt drawMeshTasksExt, DeviceCaps& caps) {
    Program program;
    program.label = "outputs";
    program.stages = {{Stage::mesh, "outputs.mesh", kOutputsMesh}, {Stage::fragment, "outputs.frag", kOutputsFragment}};
    ProgramCache programs;
    auto linked = programs.get(program);
    auto bound = bindTestTargets();
    std::array<GLubyte, 4> seen{};
    if (linked && bound) {
        const GLfloat farthest = 1;
        glClearNamedFramebufferfv(bound->targets.framebuffer.id(), GL_DEPTH, 0, &farthest);
        glUseProgram(linked->id);
        glUniform1f(0, 1);
        drawMeshTasksExt(1, 1, 1);
        glGetTextureImage(bound->targets.color.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE, seen.size(), seen.data());
        glUseProgram(0);
    }
    dropGlErrors();
    constexpr GLubyte kFirst = 64, kCulled = 128;  // 0.25, the mean of `first`, and twice that; of `second` it is 0.65
    caps.primitiveCullIgnored = seen[0] == kCulled;
    caps.lastMeshOutputLost = (seen[0] == kFirst || seen[0] == kCulled) && seen[1] == 0;
}

}  // namespace skinbench
