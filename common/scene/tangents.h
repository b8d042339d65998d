// Tangents of a mesh that stores none.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/scene.h"

namespace skinbench {

// One a vertex: xyz is the unit direction in which u grows, perpendicular to the normal (summed over the triangles
// around the vertex, weighted by their area in space, then Gram-Schmidt); w is 1 or -1, so that
// w * cross(normal, xyz) is the side on which v grows. Where the uvs span no area, xyz is any perpendicular and w is 1.
std::vector<glm::vec4> vertexTangents(const Mesh& mesh);

// A unit vector perpendicular to one that is not zero.
glm::dvec3 anyPerpendicular(const glm::dvec3& normal);

// Such a tangent in a word, as packTangent of shaders_glsl/octahedral.glsl: signed coordinates on the unfolded
// octahedron,
//
// [31:16] v  [15:1] u  [0] set where w is -1
uint32_t packTangent(const glm::vec4& tangent);
glm::vec4 unpackTangent(uint32_t word);

// The same as shaders_glsl/byte_vectors.glsl has it, each component q / 255 * 2 - 1:
//
// [31:24] w  [23:16] z  [15:8] y  [7:0] x
uint32_t packTangentBytes(const glm::vec4& tangent);
glm::vec4 unpackTangentBytes(uint32_t word);

// Radians that rounding a unit vector to such bytes turns it by at the most: three components, each off by half a step,
// 1 / 255.
double mostTurnOfBytes();

}  // namespace skinbench
