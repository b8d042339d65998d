#include "common/scene/gltf/meshopt_decode.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <format>
#include <limits>
#include <memory>
#include <type_traits>

namespace skinbench {
namespace {

constexpr size_t kGroup = 16;  // elements
constexpr size_t kMaxBlock = 256;
constexpr size_t kMaxStride = 256;

using Deltas = std::array<std::array<uint8_t, kMaxBlock>, kMaxStride>;  // [byte of the element][element]

// What is not yet read, the tail excluded.
struct Stream {
    std::span<const uint8_t> rest;

    bool take(size_t count, std::span<const uint8_t>& out) {
        if (rest.size() < count) return false;
        out = rest.first(count);
        rest = rest.subspan(count);
        return true;
    }
};

//   1 bit:   d7 d6 d5 d4 d3 d2 d1 d0        2 bits:  d0 d0 d1 d1 d2 d2 d3 d3        4 bits:  d0 d0 d0 d0 d1 d1 d1 d1
//            most significant bit first; all ones: the delta is a whole byte behind the group
bool readGroup(Stream& stream, int bits, uint8_t* out) {
    std::span<const uint8_t> packed;
    if (bits == 0) {
        std::fill_n(out, kGroup, uint8_t{0});
        return true;
    }
    if (!stream.take(kGroup * bits / 8, packed)) return false;
    if (bits == 8) {
        std::ranges::copy(packed, out);
        return true;
    }
    const auto sentinel = static_cast<uint8_t>((1 << bits) - 1);
    const size_t inByte = 8 / bits;
    for (size_t i = 0; i < kGroup; ++i) {
        const size_t place = i % inByte;
        const size_t shift = bits == 1 ? place : 8 - bits * (place + 1);
        out[i] = packed[i / inByte] >> shift & sentinel;
        std::span<const uint8_t> whole;
        if (out[i] != sentinel) continue;
        if (!stream.take(1, whole)) return false;
        out[i] = whole[0];
    }
    return true;
}

// One byte of the element over a block. `lengths` are the bit lengths that a header's two bits choose from.
bool readHeadedBytes(Stream& stream, const std::array<int, 4>& lengths, size_t groups, uint8_t* out) {
    std::span<const uint8_t> header;
    if (!stream.take((groups + 3) / 4, header)) return false;
    for (size_t group = 0; group < groups; ++group)
        if (!readGroup(stream, lengths[header[group / 4] >> group % 4 * 2 & 3], out + group * kGroup)) return false;
    return true;
}

bool readBlock(Stream& stream, int version, size_t stride, size_t elements, Deltas& deltas) {
    constexpr std::array<int, 4> kVersion0 = {0, 2, 4, 8}, kSmall = {0, 1, 2, 4}, kLarge = {1, 2, 4, 8};
    const size_t groups = (elements + kGroup - 1) / kGroup;
    std::span<const uint8_t> control;
    if (version == 1 && !stream.take(stride / 4, control)) return false;
    for (size_t byte = 0; byte < stride; ++byte) {
        uint8_t* out = deltas[byte].data();
        const int mode = version == 1 ? control[byte / 4] >> byte % 4 * 2 & 3 : -1;
        if (mode == 2) {
            std::fill_n(out, elements, uint8_t{0});
        } else if (mode == 3) {
            std::span<const uint8_t> literal;
            if (!stream.take(elements, literal)) return false;
            std::ranges::copy(literal, out);
        } else if (!readHeadedBytes(stream, mode < 0 ? kVersion0 : mode == 0 ? kSmall : kLarge, groups, out)) {
            return false;
        }
    }
    return true;
}

template <class T>
T unzigzag(T v) {
    return static_cast<T>(v & 1 ? ~(v >> 1) : v >> 1);
}

// Four bytes of the element over a block; `last` is the element before it.
void applyChannel(uint8_t mode, const Deltas& deltas, size_t first, size_t elements, uint8_t* last,
                  std::span<uint8_t> out, size_t stride) {
    for (size_t i = 0; i < elements; ++i) {
        std::array<uint8_t, 4> delta;
        for (size_t k = 0; k < 4; ++k) delta[k] = deltas[first + k][i];
        if ((mode & 15) == 0) {
            for (size_t k = 0; k < 4; ++k) last[k] = static_cast<uint8_t>(last[k] + unzigzag(delta[k]));
        } else if ((mode & 15) == 1) {
            for (size_t k = 0; k < 4; k += 2) {
                const auto step = static_cast<uint16_t>(delta[k] | delta[k + 1] << 8);
                const auto value = static_cast<uint16_t>((last[k] | last[k + 1] << 8) + unzigzag(step));
                last[k] = static_cast<uint8_t>(value);
                last[k + 1] = static_cast<uint8_t>(value >> 8);
            }
        } else {
            // The stored delta was rotated to the left.
            const uint32_t step =
                std::rotr(delta[0] | delta[1] << 8 | delta[2] << 16 | uint32_t{delta[3]} << 24, mode >> 4);
            for (size_t k = 0; k < 4; ++k) last[k] ^= static_cast<uint8_t>(step >> 8 * k);
        }
        std::copy_n(last, 4, &out[i * stride + first]);
    }
}

template <class T>
T* typed(std::span<uint8_t> bytes, size_t element, std::array<T, 4>& values) {
    std::memcpy(values.data(), &bytes[element * sizeof(values)], sizeof(values));
    return values.data();
}

template <class T>
void put(std::span<uint8_t> bytes, size_t element, const std::array<T, 4>& values) {
    std::memcpy(&bytes[element * sizeof(values)], values.data(), sizeof(values));
}

template <class T>
T rounded(float value, float low, float high) {
    // Input out of the filter's range gives any value, but a defined one.
    return static_cast<T>(std::isfinite(value) ? std::clamp(std::round(value), low, high) : 0);
}

template <class T>
void octahedral(std::span<uint8_t> bytes) {
    constexpr float kMax = std::numeric_limits<T>::max();
    std::array<T, 4> v;
    for (size_t i = 0; i < bytes.size() / sizeof(v); ++i) {
        typed(bytes, i, v);
        const float one = v[2];
        float x = v[0] / one, y = v[1] / one;
        const float z = 1 - std::abs(x) - std::abs(y), fold = std::min(z, 0.0f);
        x -= std::copysign(fold, x);
        y -= std::copysign(fold, y);
        const float scale = kMax / std::sqrt(x * x + y * y + z * z);
        v = {rounded<T>(x * scale, -kMax, kMax), rounded<T>(y * scale, -kMax, kMax), rounded<T>(z * scale, -kMax, kMax),
             v[3]};
        put(bytes, i, v);
    }
}

template <class T>
void color(std::span<uint8_t> bytes) {
    constexpr float kMax = std::numeric_limits<T>::max();
    std::array<T, 4> v;
    for (size_t i = 0; i < bytes.size() / sizeof(v); ++i) {
        typed(bytes, i, v);
        using Signed = std::make_signed_t<T>;
        // The alpha's highest bit says how many bits the others have.
        const int range = (1 << std::bit_width(v[3])) - 1;
        const int y = static_cast<Signed>(v[0]), co = static_cast<Signed>(v[1]), cg = static_cast<Signed>(v[2]);
        const int alpha = v[3] & range >> 1;
        const float scale = range > 0 ? kMax / static_cast<float>(range) : 0;
        const auto toUnit = [&](int value) { return rounded<T>(static_cast<float>(value) * scale, 0, kMax); };
        v = {toUnit(y + co - cg), toUnit(y + cg), toUnit(y - co - cg), toUnit(alpha << 1 | (alpha & 1))};
        put(bytes, i, v);
    }
}

}  // namespace

Result<void> decodeMeshoptAttributes(std::span<const uint8_t> source, uint64_t stride, std::span<uint8_t> out) {
    SKINBENCH_ASSERT(stride >= 4 && stride <= kMaxStride && stride % 4 == 0 && out.size() % stride == 0);
    if (source.empty() || (source[0] != 0xA0 && source[0] != 0xA1))
        return inputError(source.empty() ? "its compressed bytes are missing"
                                         : std::format("its compressed bytes are broken: they start with {:#04x}, not "
                                                       "0xa0 or 0xa1",
                                                       source[0]));
    const int version = source[0] & 1;
    //   tail:  zeros up to 32 or 24 bytes | the element before the first | version 1: a mode for each four bytes
    const uint64_t tail = stride + (version == 1 ? stride / 4 : 0);
    const uint64_t padded = std::max<uint64_t>(tail, version == 1 ? 24 : 32);
    if (source.size() < 1 + padded) return inputError("its compressed bytes are broken: they end too early");
    const std::span<const uint8_t> end = source.last(tail);
    std::array<uint8_t, kMaxStride> last;
    std::copy_n(end.begin(), stride, last.begin());
    for (uint64_t channel = 0; version == 1 && channel < stride / 4; ++channel) {
        const uint8_t mode = end[stride + channel];
        if ((mode & 15) > 2 || ((mode & 15) < 2 && mode >> 4 != 0))
            return inputError(
                std::format("its compressed bytes are broken: channel {} has the mode {:#04x}", channel, mode));
    }

    Stream stream{source.subspan(1, source.size() - 1 - padded)};
    const auto deltas = std::make_unique<Deltas>();
    const size_t count = out.size() / stride, blockSize = std::min<size_t>(8192 / stride & ~size_t{15}, kMaxBlock);
    for (size_t done = 0; done < count; done += blockSize) {
        const size_t elements = std::min(count - done, blockSize);
        if (!readBlock(stream, version, stride, elements, *deltas))
            return inputError("its compressed bytes are broken: they end too early");
        for (uint64_t channel = 0; channel < stride / 4; ++channel)
            applyChannel(version == 1 ? end[stride + channel] : 0, *deltas, channel * 4, elements, &last[channel * 4],
                         out.subspan(done * stride), stride);
    }
    if (!stream.rest.empty())
        return inputError(std::format("its compressed bytes are broken: {} are left over", stream.rest.size()));
    return {};
}

void decodeMeshoptOctahedral(std::span<uint8_t> bytes, uint64_t stride) {
    stride == 4 ? octahedral<int8_t>(bytes) : octahedral<int16_t>(bytes);
}

void decodeMeshoptQuaternion(std::span<uint8_t> bytes) {
    std::array<int16_t, 4> v;
    for (size_t i = 0; i < bytes.size() / sizeof(v); ++i) {
        typed(bytes, i, v);
        // The largest component is left out: the lowest two bits of v[3] number it, the others are its K-bit "1".
        const float scale = 1 / std::sqrt(2.0f) / static_cast<float>(v[3] | 3);
        const float x = v[0] * scale, y = v[1] * scale, z = v[2] * scale;
        const float w = std::sqrt(std::max(0.0f, 1 - x * x - y * y - z * z));
        const int largest = v[3] & 3;
        const std::array<float, 4> turned = {w, x, y, z};
        for (int k = 0; k < 4; ++k) v[(largest + k) % 4] = rounded<int16_t>(turned[k] * 32767, -32767, 32767);
        put(bytes, i, v);
    }
}

void decodeMeshoptExponential(std::span<uint8_t> bytes) {
    for (size_t i = 0; i + 4 <= bytes.size(); i += 4) {
        int32_t v;
        std::memcpy(&v, &bytes[i], 4);
        const float number =
            std::ldexp(static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(v) << 8) >> 8), v >> 24);
        std::memcpy(&bytes[i], &number, 4);
    }
}

void decodeMeshoptColor(std::span<uint8_t> bytes, uint64_t stride) {
    stride == 4 ? color<uint8_t>(bytes) : color<uint16_t>(bytes);
}

}  // namespace skinbench
