// What the decoders of shaders_glsl/codecs/ make of an encoder's bytes: the very text that shaders compile, as C++.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <glm/glm.hpp>

#include "common/codecs/codec.h"
#include "common/codecs/permutation.h"

namespace skinbench::glsl {

struct Decoded {
    glm::vec3 position{0};
    glm::vec3 normal{0};
    glm::vec2 uv{0};
    std::array<uint32_t, kMaxInfluences> joints{};
    std::array<float, kMaxInfluences> weights{};
};

struct Decoder {
    const char* codec;
    int influences;
    uint32_t vertexBytes;  // 0: the codec does not say
    uint32_t alignment;
    uint32_t bits;  // of a permutation code
    Decoded (*load)(uint32_t place, uint32_t copyNumber, uint32_t meshletNumber, uint32_t blendBytes);
};

std::span<const Decoder* const> decoders();

struct Differences {
    uint64_t vertices = 0;      // that differ from the CPU's
    uint64_t readsOutside = 0;  // of what is bound
    std::string fault;          // a define or a buffer that the decoder cannot take; nothing was decoded then
};

// Decodes every vertex of the last of `copies` copies; `expected`: what decodeOnCpu makes of it.
Differences compareDecoded(const Decoder& decoder, const EncodedMesh& encoded, const Mesh& expected, uint32_t copies);

// Of any code with 4 or 8 influences.
PermutationBlend decodePermutation(const PermutationCode& code, uint64_t value);

// Of the grid with so many points along its longest edge.
glm::vec4 simplexWeights(uint32_t points, uint32_t value);

}  // namespace skinbench::glsl
