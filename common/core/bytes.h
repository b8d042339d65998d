// Little-endian integers of 1 to 8 bytes.
#pragma once

#include <cstdint>
#include <span>

namespace skinbench {

inline void writeBytes(std::span<uint8_t> out, uint64_t value) {
    for (uint8_t& byte : out) {
        byte = static_cast<uint8_t>(value);
        value >>= 8;
    }
}

inline uint64_t readBytes(std::span<const uint8_t> bytes) {
    uint64_t value = 0;
    for (size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
    return value;
}

}  // namespace skinbench
