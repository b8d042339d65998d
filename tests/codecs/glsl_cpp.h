// What the decoders of shaders_glsl/codecs/ need of GLSL, as C++: the very text that shaders compile runs in a test.
// tests/CMakeLists.txt rewrites three things: storage blocks become Block, constant lists become List, float literals
// single. Defines that an encoder hands to the shader come from EncodedMesh::defines at run time.
#pragma once

#include <array>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/integer.hpp>
#include <glm/packing.hpp>

#include "shaders_glsl/shared.h"
#include "tests/codecs/shader_decoders.h"

namespace skinbench::glsl {

using glm::abs, glm::bitfieldExtract, glm::max, glm::min, glm::normalize, glm::pow, glm::sqrt, glm::uintBitsToFloat;
using glm::unpackHalf2x16;
using glm::uvec2, glm::uvec3, glm::uvec4, glm::vec2, glm::vec3, glm::vec4;
using uint = uint32_t;

// What is bound to a slot, and how often a decoder read behind its end.
inline std::array<std::vector<uint32_t>, SLOT_COUNT> memory;
inline uint64_t readsOutside = 0;

template <class T, int slot>
struct Block {
    T operator[](uint i) const {
        const size_t first = size_t{i} * (sizeof(T) / 4);
        T value{};
        if (first + sizeof(T) / 4 > memory[slot].size()) {
            ++readsOutside;
        } else {
            std::memcpy(&value, &memory[slot][first], sizeof(T));
        }
        return value;
    }
};

inline std::map<std::string, std::vector<uint32_t>> lists;

class List {
public:
    explicit List(const char* define) : values_(&lists[define]) {}
    uint operator[](size_t i) const { return i < values_->size() ? (*values_)[i] : 0; }

private:
    const std::vector<uint32_t>* values_;
};

// Defines whose value is known at run time only.
struct Numbers {
    uint vertexCount = 0;
    uint bufferWords = 0;
    uint tupleCount = 0;
    uint meshletCount = 0;
    uint mostTuples = 0;
    uint values = 0;
    uint simplexBits = 0;
    uint simplexPoints = 0;
    vec3 positionMin{0};
    vec3 positionExtent{0};
    vec2 uvMin{0};
    vec2 uvExtent{0};
};
inline Numbers numbers;

}  // namespace skinbench::glsl

#define VERTEX_COUNT numbers.vertexCount
#define BUFFER_WORDS numbers.bufferWords
#define TUPLE_COUNT numbers.tupleCount
#define MESHLET_COUNT numbers.meshletCount
#define MOST_TUPLES numbers.mostTuples
#define PC_VALUES numbers.values
#define OSS_BITS numbers.simplexBits
#define OSS_POINTS numbers.simplexPoints
#define POSITION_MIN numbers.positionMin
#define POSITION_EXTENT numbers.positionExtent
#define UV_MIN numbers.uvMin
#define UV_EXTENT numbers.uvExtent
