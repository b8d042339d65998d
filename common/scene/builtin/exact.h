// Arithmetic for the built-in characters. Only + - * /, sqrt and floor take part, which IEEE 754 rounds the same way
// everywhere; libm's sin or pow may differ in the last bit between systems.
#pragma once

#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace skinbench::builtin {

struct SinCos {
    double sin = 0;
    double cos = 1;
};

// Of an angle in turns. Taylor polynomials on an eighth of a turn, error below 1e-12.
inline SinCos sinCosTurns(double turns) {
    turns -= std::floor(turns);
    const int quarter = int(std::floor(turns * 4 + 0.5));
    const double x = (turns - quarter * 0.25) * 6.283185307179586;
    const double y = x * x;
    const double s = x * (1 + y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 + y * (1.0 / 362880 - y / 39916800)))));
    const double c =
        1 + y * (-0.5 + y * (1.0 / 24 + y * (-1.0 / 720 + y * (1.0 / 40320 + y * (-1.0 / 3628800 + y / 479001600)))));
    switch (quarter & 3) {
        case 0:
            return {s, c};
        case 1:
            return {c, -s};
        case 2:
            return {-s, -c};
        default:
            return {-c, s};
    }
}

inline float sinTurns(double turns) { return float(sinCosTurns(turns).sin); }
inline float cosTurns(double turns) { return float(sinCosTurns(turns).cos); }

inline glm::vec3 unit(glm::vec3 v) { return v / std::sqrt(glm::dot(v, v)); }

// `axis` has unit length.
inline glm::quat rotation(glm::vec3 axis, double degrees) {
    const SinCos half = sinCosTurns(degrees / 720);
    return {float(half.cos), float(axis.x * half.sin), float(axis.y * half.sin), float(axis.z * half.sin)};
}

inline float smoothStep(float x) {
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    return x * x * (3 - 2 * x);
}

// SplitMix64 (Steele, Lea, Flood 2014).
struct Random {
    uint64_t state = 0;

    uint64_t next() {
        uint64_t z = state += 0x9E3779B97F4A7C15u;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    float between(float low, float high) { return low + (high - low) * (float(next() >> 40) / 16777216.0f); }
};

}  // namespace skinbench::builtin
