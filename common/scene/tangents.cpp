#include "common/scene/tangents.h"

#include <cmath>

#include <glm/gtc/packing.hpp>

namespace skinbench {
namespace {

struct Directions {
    glm::dvec3 u{0};
    glm::dvec3 v{0};
};

// Where u and v grow on a triangle, twice its area long; zero for a triangle without area in space or in uv.
Directions growth(const Mesh& mesh, const uint32_t* corners) {
    const glm::dvec3 origin(mesh.positions[corners[0]]);
    const glm::dvec3 first = glm::dvec3(mesh.positions[corners[1]]) - origin,
                     second = glm::dvec3(mesh.positions[corners[2]]) - origin;
    const glm::dvec2 uv(mesh.uvs[corners[0]]);
    const glm::dvec2 firstUv = glm::dvec2(mesh.uvs[corners[1]]) - uv, secondUv = glm::dvec2(mesh.uvs[corners[2]]) - uv;
    const double side = firstUv.x * secondUv.y - secondUv.x * firstUv.y;
    const double area = glm::length(glm::cross(first, second));
    if (side == 0 || area == 0) return {};
    auto scaled = [&](glm::dvec3 direction) {
        const double length = glm::length(direction);
        return length > 0 ? direction * (std::copysign(area, side) / length) : glm::dvec3(0);
    };
    return {scaled(secondUv.y * first - firstUv.y * second), scaled(firstUv.x * second - secondUv.x * first)};
}

}  // namespace

// Crossed with the axis that the normal is farthest from.
glm::dvec3 anyPerpendicular(const glm::dvec3& normal) {
    const glm::dvec3 size = glm::abs(normal);
    const glm::dvec3 axis = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                            : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                 : glm::dvec3(0, 0, 1);
    return glm::normalize(glm::cross(normal, axis));
}

std::vector<glm::vec4> vertexTangents(const Mesh& mesh) {
    std::vector<Directions> sums(mesh.positions.size());
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Directions directions = growth(mesh, &mesh.indices[i]);
        for (size_t corner = 0; corner < 3; ++corner) {
            sums[mesh.indices[i + corner]].u += directions.u;
            sums[mesh.indices[i + corner]].v += directions.v;
        }
    }
    std::vector<glm::vec4> tangents(mesh.positions.size());
    for (size_t v = 0; v < tangents.size(); ++v) {
        const glm::dvec3 normal = glm::normalize(glm::dvec3(mesh.normals[v]));
        const glm::dvec3 along = sums[v].u - normal * glm::dot(normal, sums[v].u);
        // What cancels down to rounding has no direction.
        const bool known = glm::length(along) > 1e-6 * glm::length(sums[v].u);
        const glm::dvec3 tangent = known ? glm::normalize(along) : anyPerpendicular(normal);
        const bool flipped = known && glm::dot(glm::cross(normal, tangent), sums[v].v) < 0;
        tangents[v] = glm::vec4(glm::vec3(tangent), flipped ? -1.0f : 1.0f);
    }
    return tangents;
}

static glm::vec2 foldOctahedron(const glm::vec2& v) {
    return {(1 - std::abs(v.y)) * (v.x < 0 ? -1.0f : 1.0f), (1 - std::abs(v.x)) * (v.y < 0 ? -1.0f : 1.0f)};
}

uint32_t packTangent(const glm::vec4& tangent) {
    const glm::vec2 unfolded = glm::vec2(tangent) / (std::abs(tangent.x) + std::abs(tangent.y) + std::abs(tangent.z));
    const uint32_t word = glm::packSnorm2x16(tangent.z < 0 ? foldOctahedron(unfolded) : unfolded);
    return (word & ~1u) | (tangent.w < 0 ? 1u : 0u);
}

glm::vec4 unpackTangent(uint32_t word) {
    const glm::vec2 unfolded = glm::unpackSnorm2x16(word & ~1u);
    const float z = 1 - std::abs(unfolded.x) - std::abs(unfolded.y);
    return glm::vec4(glm::normalize(glm::vec3(z < 0 ? foldOctahedron(unfolded) : unfolded, z)),
                     word & 1 ? -1.0f : 1.0f);
}

uint32_t packTangentBytes(const glm::vec4& tangent) { return glm::packUnorm4x8(tangent * 0.5f + 0.5f); }

glm::vec4 unpackTangentBytes(uint32_t word) {
    const glm::vec4 read = glm::unpackUnorm4x8(word) * 2.0f - 1.0f;
    return glm::vec4(glm::normalize(glm::vec3(read)), read.w < 0 ? -1.0f : 1.0f);
}

double mostTurnOfBytes() { return std::asin(std::sqrt(3.0) / 255); }

}  // namespace skinbench
