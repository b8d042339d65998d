#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <meshoptimizer.h>
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <glm/glm.hpp>

#include "common/scene/gltf/meshopt_decode.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Packed = std::vector<uint8_t>;

namespace {

Packed decode(const Packed& source, size_t stride, size_t count) {
    Packed out(stride * count);
    const auto good = decodeMeshoptAttributes(source, stride, out);
    INFO((good ? std::string() : good.error().text));
    REQUIRE(good);
    return out;
}

// Header and tail around the blocks.
Packed version1(const Packed& blocks, const Packed& first, const Packed& modes) {
    Packed out = {0xA1};
    out.insert(out.end(), blocks.begin(), blocks.end());
    const size_t tail = first.size() + modes.size();
    if (tail < 24) out.resize(out.size() + 24 - tail, 0);
    out.insert(out.end(), first.begin(), first.end());
    out.insert(out.end(), modes.begin(), modes.end());
    return out;
}

Packed encode(const Packed& vertices, size_t stride) {
    meshopt_encodeVertexVersion(0);
    const size_t count = vertices.size() / stride;
    Packed out(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), vertices.data(), count, stride));
    return out;
}

// Of neighbours that differ little, much, or not at all, so that every bit length occurs.
Packed randomVertices(std::mt19937& random, size_t stride, size_t count) {
    Packed out(stride * count);
    for (size_t byte = 0; byte < stride; ++byte) {
        const uint32_t spread = 1u << random() % 9;
        uint8_t value = static_cast<uint8_t>(random());
        for (size_t i = 0; i < count; ++i) {
            if (i % 16 != 0 || random() % 2) value = static_cast<uint8_t>(value + random() % spread - spread / 2);
            out[i * stride + byte] = value;
        }
    }
    return out;
}

template <class T, size_t N>
std::array<T, N> filtered(std::array<T, N> values, void (*filter)(std::span<uint8_t>, uint64_t)) {
    filter({reinterpret_cast<uint8_t*>(values.data()), sizeof(values)}, 4 * sizeof(T));
    return values;
}

}  // namespace

TEST_CASE("the specification's example of 4-bit deltas") {
    // One block of 16 elements of 4 bytes: byte 0 has the example's deltas, the others none.
    Packed source = {0xA0, 2, 0x17, 0x5F, 0xF0, 0xBC, 0x77, 0xA9, 0x21, 0x00, 0x34, 0xB5, 0, 0, 0};
    source.resize(source.size() + 28, 0);
    source.insert(source.end(), {0, 7, 8, 9});
    const Packed out = decode(source, 4, 16);
    const std::array<int, 16> deltas = {-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0};
    int value = 0;
    for (size_t i = 0; i < 16; ++i) {
        value += deltas[i];
        CHECK(out[i * 4] == static_cast<uint8_t>(value));
        CHECK(out[i * 4 + 1] == 7);
        CHECK(out[i * 4 + 3] == 9);
    }
}

TEST_CASE("the four control modes of version 1") {
    // Byte 0: mode 0 with 1-bit deltas, byte 1: mode 1 with 2 bits, byte 2: nothing, byte 3: literal.
    const Packed blocks = {0b11'10'01'00,
                           1,
                           0b0000'0010,
                           0b1000'0000,
                           4,
                           1,  // elements 1 and 15 are whole bytes: 2 and -1
                           1,
                           0b01'00'00'11,
                           0,
                           0,
                           0,
                           6,  // element 0: -1, element 3: 3
                           2,
                           4};
    Packed whole = blocks;
    whole.resize(whole.size() + 14, 0);  // 16 literal bytes: +1, +2, then nothing
    const Packed out = decode(version1(whole, {10, 20, 30, 40}, {0}), 4, 16);
    CHECK(Packed(out.begin(), out.begin() + 4) == Packed{10, 19, 30, 41});
    CHECK(Packed(out.begin() + 4, out.begin() + 8) == Packed{12, 19, 30, 43});
    CHECK(Packed(out.begin() + 12, out.begin() + 16) == Packed{12, 22, 30, 43});
    CHECK(Packed(out.end() - 4, out.end()) == Packed{11, 22, 30, 43});
}

TEST_CASE("the three channel modes of version 1") {
    // Two elements of 12 bytes, all deltas literal; each channel starts from its own baseline.
    Packed blocks = {0xFF, 0xFF, 0xFF};
    const std::array<Packed, 2> deltas = {Packed{2, 1, 0, 0, 2, 0, 1, 0, 1, 0, 0, 0x80},
                                          Packed{0, 0, 0, 0, 0xFF, 0xFF, 0, 0, 0, 1, 0, 0}};
    for (size_t byte = 0; byte < 12; ++byte)
        for (const Packed& element : deltas) blocks.push_back(element[byte]);
    const Packed baseline = {10, 20, 30, 40, 0xFF, 0x00, 0, 0, 1, 2, 3, 4};
    const Packed out = decode(version1(blocks, baseline, {0, 1, 4 << 4 | 2}), 12, 2);
    // Packed: +1, -1. Words: 0x00FF + 1 = 0x0100, 0 - 1 = 0xFFFF. XOR after 4 bits to the right: 0x80000001 ->
    // 0x18000000.
    CHECK(Packed(out.begin(), out.begin() + 12) == Packed{11, 19, 30, 40, 0x00, 0x01, 0xFF, 0xFF, 1, 2, 3, 0x1C});
    // 0xFFFF stands for -0x8000; 0x100 becomes 0x10.
    CHECK(Packed(out.begin() + 12, out.end()) == Packed{11, 19, 30, 40, 0x00, 0x81, 0xFF, 0xFF, 0x11, 2, 3, 0x1C});
}

TEST_CASE("version 1 as meshoptimizer 1.3 writes it") {
    const auto words = [](const Packed& source, size_t count) {
        const Packed out = decode(source, 4, count);
        std::vector<uint32_t> values(count);
        std::memcpy(values.data(), out.data(), out.size());
        return values;
    };
    // The floats from 0 to 11: 2-byte deltas.
    Packed floats = {161, 122, 0, 0, 0, 128, 128, 64, 64, 64, 64, 32, 32, 32, 0, 6, 0, 127, 1};
    floats.resize(floats.size() + 23, 0);
    floats.push_back(1);
    const std::vector<uint32_t> first = words(floats, 12);
    for (size_t i = 0; i < 12; ++i) CHECK(std::bit_cast<float>(first[i]) == static_cast<float>(i));
    // Words that differ in few bits: XOR, rotated by 7.
    Packed bits = {161, 86, 0, 0, 18, 4, 8, 0, 14, 5, 128, 128, 48, 4, 3, 1, 4, 215, 1, 48, 6, 8, 6};
    bits.resize(bits.size() + 19, 0);
    bits.insert(bits.end(), {251, 110, 239, 0, 114});
    CHECK(words(bits, 14) == std::vector<uint32_t>{15691515, 15625979, 15560443, 15535867, 14749435, 14880507, 14749435,
                                                   15798011, 15795963, 15795955, 15794419, 15925491, 15925475,
                                                   16711907});
}

TEST_CASE("what meshoptimizer encodes is decoded to the same bytes") {
    std::mt19937 random(31);
    for (int round = 0; round < 60; ++round) {
        const size_t stride = (1 + random() % 64) * 4, count = 1 + random() % 600;
        INFO(stride << " bytes, " << count << " elements");
        const Packed vertices = randomVertices(random, stride, count);
        CHECK(decode(encode(vertices, stride), stride, count) == vertices);
    }
}

TEST_CASE("attributes that are cut off, too long or damaged are refused, and no byte outside is touched") {
    std::mt19937 random(32);
    const Packed vertices = randomVertices(random, 12, 100), whole = encode(vertices, 12);
    Packed out(vertices.size());
    for (size_t length = 0; length < whole.size(); ++length) {
        // A copy of the right size, so that a sanitizer sees what is read behind it.
        const Packed cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        CHECK_FALSE(decodeMeshoptAttributes(cut, 12, out));
    }
    Packed longer = whole;
    longer.insert(longer.end() - 32, 0);
    CHECK_FALSE(decodeMeshoptAttributes(longer, 12, out));
    for (int round = 0; round < 500; ++round) {
        Packed damaged = whole;
        damaged[0] = static_cast<uint8_t>(0xA0 + round % 2);
        for (int flips = 0; flips < 4; ++flips)
            damaged[1 + random() % (damaged.size() - 1)] = static_cast<uint8_t>(random());
        static_cast<void>(decodeMeshoptAttributes(damaged, 12, out));
    }
    const auto error = [&](Packed source, size_t stride) {
        Packed one(stride);
        const auto good = decodeMeshoptAttributes(source, stride, one);
        return good ? std::string() : good.error().text;
    };
    CHECK_THAT(error({}, 4), ContainsSubstring("missing"));
    CHECK_THAT(error(Packed(40, 0xA2), 4), ContainsSubstring("start with 0xa2"));
    CHECK_THAT(error(version1({0xAA}, {1, 2, 3, 4}, {3}), 4), ContainsSubstring("channel 0 has the mode 0x03"));
    CHECK_THAT(error(version1({0xAA}, {1, 2, 3, 4}, {0x10}), 4), ContainsSubstring("channel 0 has the mode 0x10"));
    CHECK(error(version1({0xAA}, {1, 2, 3, 4}, {0x12}), 4).empty());
}

TEST_CASE("octahedral filter: the axes, whatever the precision") {
    using Four = std::array<int8_t, 4>;
    CHECK(filtered(Four{0, 0, 127, 5}, decodeMeshoptOctahedral) == Four{0, 0, 127, 5});
    CHECK(filtered(Four{7, 0, 7, 5}, decodeMeshoptOctahedral) == Four{127, 0, 0, 5});
    CHECK(filtered(Four{0, -7, 7, 5}, decodeMeshoptOctahedral) == Four{0, -127, 0, 5});
    CHECK(filtered(Four{7, 7, 7, 5}, decodeMeshoptOctahedral) == Four{0, 0, -127, 5});
    using Wide = std::array<int16_t, 4>;
    CHECK(filtered(Wide{1, 2, 3, 4}, decodeMeshoptOctahedral) == Wide{14654, 29308, 0, 4});
}

TEST_CASE("the filters agree with meshoptimizer's to one unit") {
    std::mt19937 random(33);
    constexpr size_t kCount = 200;
    std::vector<float> units;
    for (size_t i = 0; i < kCount; ++i) {
        glm::vec4 v(static_cast<int>(random() % 2001) - 1000, static_cast<int>(random() % 2001) - 1000,
                    static_cast<int>(random() % 2001) - 1000, 1 + static_cast<int>(random() % 1000));
        v /= glm::length(v);
        units.insert(units.end(), {v.x, v.y, v.z, v.w});
    }
    const auto compare = [&](auto type, auto encodeWith, auto ours, auto theirs) {
        using T = decltype(type);
        std::vector<T> a(kCount * 4);
        encodeWith(a.data());
        std::vector<T> b = a;
        ours(std::span<uint8_t>(reinterpret_cast<uint8_t*>(a.data()), a.size() * sizeof(T)));
        theirs(b.data());
        for (size_t i = 0; i < a.size(); ++i) REQUIRE(std::abs(a[i] - b[i]) <= 1);
    };
    compare(
        int8_t{}, [&](void* out) { meshopt_encodeFilterOct(out, kCount, 4, 8, units.data()); },
        [](std::span<uint8_t> bytes) { decodeMeshoptOctahedral(bytes, 4); },
        [](void* out) { meshopt_decodeFilterOct(out, kCount, 4); });
    compare(
        int16_t{}, [&](void* out) { meshopt_encodeFilterOct(out, kCount, 8, 12, units.data()); },
        [](std::span<uint8_t> bytes) { decodeMeshoptOctahedral(bytes, 8); },
        [](void* out) { meshopt_decodeFilterOct(out, kCount, 8); });
    compare(
        int16_t{}, [&](void* out) { meshopt_encodeFilterQuat(out, kCount, 8, 14, units.data()); },
        [](std::span<uint8_t> bytes) { decodeMeshoptQuaternion(bytes); },
        [](void* out) { meshopt_decodeFilterQuat(out, kCount, 8); });
    std::vector<uint8_t> a(kCount * 16);
    meshopt_encodeFilterExp(a.data(), kCount, 16, 15, units.data(), meshopt_EncodeExpSeparate);
    std::vector<uint8_t> b = a;
    decodeMeshoptExponential(a);
    meshopt_decodeFilterExp(b.data(), kCount, 16);
    CHECK(a == b);
}

TEST_CASE("colour filter: the specification's formula by hand") {
    using Four = std::array<uint8_t, 4>;
    // K = 8, alpha 127 of 7 bits. Y = 100, Co = 20, Cg = -10: r = 130, g = 90, b = 90.
    CHECK(filtered(Four{100, 20, static_cast<uint8_t>(-10), 0xFF}, decodeMeshoptColor) == Four{130, 90, 90, 255});
    // K = 4: of 15 steps; alpha 0b1000 is none.
    CHECK(filtered(Four{15, 0, 0, 8}, decodeMeshoptColor) == Four{255, 255, 255, 0});
    using Wide = std::array<uint16_t, 4>;
    CHECK(filtered(Wide{3, 0, 0, 3}, decodeMeshoptColor) == Wide{65535, 65535, 65535, 65535});
    CHECK(filtered(Wide{1, 2, 3, 0}, decodeMeshoptColor) == Wide{0, 0, 0, 0});
}
