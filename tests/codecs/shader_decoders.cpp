#include "tests/codecs/shader_decoders.h"

#include <bit>
#include <cctype>
#include <cmath>

#include "tests/codec_test.h"
#include "tests/codecs/glsl_decoders.h"

namespace skinbench::glsl {
namespace {

// The integers of a define's text: its literals with a suffix, or the whole text.
std::vector<uint32_t> literals(const std::string& text) {
    std::vector<uint32_t> values;
    for (size_t i = 0; i < text.size(); ++i) {
        if (!std::isdigit(static_cast<unsigned char>(text[i]))) continue;
        size_t length = 0;
        const auto value = static_cast<uint32_t>(std::stoul(text.substr(i), &length, 0));
        i += length;
        if (i == text.size() || text[i] == 'u') values.push_back(value);
    }
    return values;
}

template <class Vector>
bool setFloats(Vector& vector, const std::vector<uint32_t>& bits) {
    if (bits.size() != static_cast<size_t>(Vector::length())) return false;
    for (int i = 0; i < Vector::length(); ++i) vector[i] = std::bit_cast<float>(bits[static_cast<size_t>(i)]);
    return true;
}

bool setDefine(const Decoder& decoder, const std::string& name, const std::vector<uint32_t>& values) {
    Numbers& n = numbers;
    if (name == "POSITION_MIN") return setFloats(n.positionMin, values);
    if (name == "POSITION_EXTENT") return setFloats(n.positionExtent, values);
    if (name == "UV_MIN") return setFloats(n.uvMin, values);
    if (name == "UV_EXTENT") return setFloats(n.uvExtent, values);
    if (name == "SECTIONS" || name == "PC_EXTRA") {
        lists[name] = values;
        return true;
    }
    const std::map<std::string, uint32_t*> known = {{"BUFFER_WORDS", &n.bufferWords}, {"TUPLE_COUNT", &n.tupleCount},
                                                    {"MOST_TUPLES", &n.mostTuples},   {"PC_VALUES", &n.values},
                                                    {"OSS_BITS", &n.simplexBits},     {"OSS_POINTS", &n.simplexPoints}};
    // Those that it was compiled with must agree.
    const std::map<std::string, uint32_t> compiled = {
        {"VERTEX_BYTES", decoder.vertexBytes}, {"VERTEX_ALIGNMENT", decoder.alignment}, {"PC_BITS", decoder.bits}};
    if (values.size() != 1 || (!known.contains(name) && !compiled.contains(name))) return false;
    if (known.contains(name)) *known.at(name) = values[0];
    return !compiled.contains(name) || compiled.at(name) == values[0];
}

// Empty, or the define that is wrong.
std::string setDefines(const Decoder& decoder, const EncodedMesh& encoded) {
    numbers = {};
    numbers.vertexCount = encoded.vertexCount;
    lists["SECTIONS"].clear();
    for (const auto& [name, text] : encoded.defines)
        if (!setDefine(decoder, name, literals(text))) return "define " + name + " " + text;
    return {};
}

// Binds `copies` copies; all but the last are noise.
bool bind(int slot, const Bytes& bytes, uint32_t copies) {
    std::vector<uint32_t>& words = memory[static_cast<size_t>(slot)];
    words.clear();
    if (!bytes) return true;
    const size_t count = bytes->size() / 4;
    test::Random random(91);
    words.resize(count * copies);
    for (size_t i = 0; i < count * (copies - 1); ++i) words[i] = static_cast<uint32_t>(random.next());
    if (count > 0) std::memcpy(&words[count * (copies - 1)], bytes->data(), count * 4);
    return bytes->size() % 4 == 0;
}

// Bit for bit, but for the weights of oss: the CPU rounds them from double precision.
bool differs(const Decoded& got, const Mesh& expected, uint32_t v, float tolerance) {
    bool wrong =
        got.position != expected.positions[v] || got.normal != expected.normals[v] || got.uv != expected.uvs[v];
    const Influences& influences = expected.influences[v];
    for (size_t i = 0; i < kMaxInfluences; ++i) {
        wrong |= !(std::abs(got.weights[i] - influences.weights[i]) <= tolerance);
        wrong |= influences.weights[i] == 0 && got.weights[i] != 0;
        wrong |= influences.weights[i] != 0 && got.joints[i] != influences.joints[i];
        wrong |= influences.weights[i] == 0 && influences.joints[i] == kNoJoint && got.joints[i] == kNoJoint;
    }
    return wrong;
}

// The text's result for one code, in the order of PermutationBlend.
template <class Blend>
PermutationBlend ascending(const PermutationCode& code, const Blend& blend) {
    PermutationBlend result;
    result.tuple = blend.tuple;
    for (int i = 0; i <= code.entries; ++i) result.weights[i] = blend.weights[code.entries - i];
    return result;
}

}  // namespace

std::span<const Decoder* const> decoders() { return kDecoders; }

Differences compareDecoded(const Decoder& decoder, const EncodedMesh& encoded, const Mesh& expected, uint32_t copies) {
    Differences result;
    result.fault = setDefines(decoder, encoded);
    if (!result.fault.empty()) return result;
    if (!bind(SLOT_VERTEX, encoded.vertices, copies) || !bind(SLOT_TUPLE, encoded.tuples, copies) ||
        !bind(SLOT_MESHLET_EXTRA, encoded.meshletExtra, copies)) {
        result.fault = "a buffer is not made of words";
        return result;
    }
    readsOutside = 0;
    const float tolerance = std::string(decoder.codec).starts_with("oss") ? 0x1p-24f : 0.0f;
    const uint32_t copy = copies - 1;
    const auto check = [&](uint32_t v, uint32_t meshlet, uint32_t blendBytes) {
        const Decoded got = decoder.load(copy * encoded.vertexCount + v, copy, meshlet, blendBytes);
        result.vertices += differs(got, expected, v, tolerance);
    };
    if (!encoded.meshlets) {
        for (uint32_t v = 0; v < encoded.vertexCount; ++v) check(v, 0, 0);
    } else {
        const MeshletMesh& cut = *encoded.meshlets;
        numbers.meshletCount = static_cast<uint32_t>(cut.meshlets.size());
        for (uint32_t m = 0; m < cut.meshlets.size(); ++m)
            for (uint32_t i = 0; i < cut.meshlets[m].vertexCount; ++i)
                check(cut.vertices[cut.meshlets[m].firstVertex + i], m, encoded.blendBytes[m]);
    }
    result.readsOutside = readsOutside;
    return result;
}

PermutationBlend decodePermutation(const PermutationCode& code, uint64_t value) {
    numbers.values = code.values;
    lists["PC_EXTRA"].assign(code.extra.begin(), code.extra.begin() + code.entries);
    const glm::uvec2 words(static_cast<uint32_t>(value), static_cast<uint32_t>(value >> 32));
    if (code.entries == 7)
        return code.bits > 32 ? ascending(code, pc8::decodePermutation(words))
                              : ascending(code, pc32x8::decodePermutation(words));
    return code.bits > 32 ? ascending(code, pc64::decodePermutation(words))
                          : ascending(code, pc4::decodePermutation(words));
}

glm::vec4 simplexWeights(uint32_t points, uint32_t value) {
    numbers.simplexPoints = points;
    return simplex16::simplexWeights(value);
}

}  // namespace skinbench::glsl
