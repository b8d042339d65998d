// What the fuzzers share: the input as numbers, as a scene, as a file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "common/scene/scene.h"

namespace skinbench::fuzz {

// Takes the input apart. Behind its end follow numbers that look random, so that few bytes make a large mesh.
class Input {
public:
    explicit Input(std::span<const uint8_t> bytes) : rest_(bytes) {}

    template <class T>
    T take() {
        static_assert(std::is_trivially_copyable_v<T>);
        std::array<uint8_t, sizeof(T)> bytes;
        for (uint8_t& byte : bytes) byte = next();
        T value;
        std::memcpy(&value, bytes.data(), sizeof(T));
        return value;
    }
    // 0 to count - 1.
    uint32_t below(uint32_t count) { return count <= 1 ? 0 : take<uint16_t>() % count; }
    bool flip() { return next() % 2 == 1; }
    std::span<const uint8_t> rest() const { return rest_; }

private:
    uint8_t next() {
        if (rest_.empty())
            return static_cast<uint8_t>((state_ = state_ * 6364136223846793005u + 1442695040888963407u) >> 56);
        const uint8_t byte = rest_.front();
        rest_ = rest_.subspan(1);
        state_ = (state_ ^ byte) * 1099511628211u;
        return byte;
    }

    std::span<const uint8_t> rest_;
    uint64_t state_ = 14695981039346656037u;
};

// Of up to 600 vertices and 3,000 joints; one that checkScene accepts, or nothing.
std::optional<Scene> takeScene(Input& in);

// A file that holds the bytes until the next call; its folder has no other that a glTF may name.
std::string fileOf(std::span<const uint8_t> bytes);

}  // namespace skinbench::fuzz
