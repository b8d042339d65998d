// Vertices without bytes: a position that follows from the vertex' number.
#include <algorithm>
#include <bit>
#include <format>

#include "common/codecs/codec.h"
#include "common/scene/pose.h"

namespace skinbench {

// Bits instead of digits: every compiler reads them as the same float.
static std::string floatsText(const glm::vec3& v) {
    return std::format("uintBitsToFloat(uvec3({:#x}u, {:#x}u, {:#x}u))", std::bit_cast<uint32_t>(v.x),
                       std::bit_cast<uint32_t>(v.y), std::bit_cast<uint32_t>(v.z));
}

// Every second bit, from bit 0 on.
static uint32_t evenBits(uint32_t bits) {
    uint32_t even = 0;
    for (uint32_t i = 0; i < 16; ++i) even |= (bits >> 2 * i & 1) << i;
    return even;
}

// As loadVertex of shaders_glsl/codecs/ids.glsl.
static Mesh idVertices(uint32_t count, uint32_t side, const Bounds& bounds) {
    Mesh mesh;
    const glm::vec3 extent = bounds.max - bounds.min;
    for (uint32_t number = 0; number < count; ++number) {
        const glm::vec2 cell(static_cast<float>(evenBits(number)), static_cast<float>(evenBits(number >> 1)));
        const glm::vec2 uv = (cell + 0.5f) / static_cast<float>(side);
        mesh.positions.push_back(glm::vec3((uv - 0.5f) / 16.0f + 0.5f, 0.5f) * extent + bounds.min);
        mesh.normals.push_back({0, 0, 1});
        mesh.uvs.push_back(uv);
        mesh.influences.push_back({});
    }
    return mesh;
}

Result<EncodedMesh> encodeIds(const EncodeInput& in) {
    const Mesh& mesh = in.mesh;
    Bounds bounds{mesh.positions.front(), mesh.positions.front()};
    for (const glm::vec3& position : mesh.positions)
        bounds = {glm::min(bounds.min, position), glm::max(bounds.max, position)};
    EncodedMesh encoded;
    encoded.vertexCount = static_cast<uint32_t>(mesh.positions.size());
    const uint32_t bits = std::bit_width(std::max(encoded.vertexCount, 1u) - 1);
    const uint32_t side = 1u << (bits + 1) / 2;
    encoded.defines = {{"IDS_SIDE", std::to_string(side)},
                       {"POSITION_MIN", floatsText(bounds.min)},
                       {"POSITION_EXTENT", floatsText(bounds.max - bounds.min)}};
    encoded.decode = [count = encoded.vertexCount, side, bounds] { return idVertices(count, side, bounds); };
    return encoded;
}

}  // namespace skinbench
