// What GL_EXT_mesh_shader adds and the loader's registry does not know yet. Values: Khronos registry.
// The stage enums GL_MESH_SHADER_EXT and GL_TASK_SHADER_EXT have the values of GL_NV_mesh_shader.
#pragma once

#include <glad/gl.h>

namespace skinbench {

inline constexpr GLenum kMeshShader = 0x9559;
inline constexpr GLenum kTaskShader = 0x955A;

inline constexpr GLenum kMaxMeshOutputVertices = 0x9538;
inline constexpr GLenum kMaxMeshWorkGroupTotalCount = 0x9741;
inline constexpr GLenum kMaxMeshSharedMemorySize = 0x9744;
inline constexpr GLenum kMaxMeshOutputMemorySize = 0x9747;
inline constexpr GLenum kMaxPreferredMeshWorkGroupInvocations = 0x974C;
inline constexpr GLenum kMaxMeshWorkGroupCount = 0x9752;  // indexed: x, y, z
inline constexpr GLenum kMaxMeshOutputPrimitives = 0x9756;
inline constexpr GLenum kMaxMeshWorkGroupInvocations = 0x9757;

using DrawMeshTasksExt = void(GLAD_API_PTR*)(GLuint x, GLuint y, GLuint z);
using DrawMeshTasksIndirectExt = void(GLAD_API_PTR*)(GLintptr indirect);

}  // namespace skinbench
