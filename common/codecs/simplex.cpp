#include "common/codecs/simplex.h"

#include <algorithm>
#include <cmath>
#include <format>

namespace skinbench {
namespace {

// T(n): grid points in all.  S(j, n): points of one layer of w4 with index j or above. Both divisions round; u64 holds
// every value up to 58 bits, u32 up to n = 1288.
template <class U>
U gridCount(U n) {
    return ((n + 1) * (n + 1) * (2 * n + 5) + 18) / 36;
}

// 2 n + 1 - 3 j may be negative: its square is right modulo 2^bits all the same.
template <class U>
U layerCount(U j, U n) {
    const U a = 2 * n + 1 - 3 * j;
    return (a * a + 6) / 12;
}

// Round half up, clamped to 0..most; NaN gives 0.
uint64_t roundTo(double x, uint64_t most) {
    const double r = x + 0.5;
    if (!(r > 0)) return 0;
    return r >= static_cast<double>(most) ? most : static_cast<uint64_t>(r);
}

// docs/codecs.md 6, decode. Real is the precision of the two estimates; each is off by one step at most.
template <class U, class Real>
SimplexPoint pointOf(U n, U count, U value) {
    const U x = count - value;
    const Real r = std::cbrt(Real(144) * static_cast<Real>(x));
    const U u = static_cast<U>(r + 1 / r);
    U k = 2 * n + 3 > u ? (2 * n + 3 - u) / 4 : 0;
    if (x > gridCount<U>(n - 2 * k)) --k;
    U c = value - (count - gridCount<U>(n - 2 * k));
    const U m = n - 2 * k;
    const U all = layerCount<U>(0, m);
    const U y = all - c;
    const U root = static_cast<U>(std::sqrt(Real(12) * static_cast<Real>(y)));
    U j = 2 * m + 1 > root ? (2 * m + 1 - root) / 3 : 0;
    if (y > layerCount<U>(j, m)) --j;
    if (y <= layerCount<U>(j + 1, m)) ++j;
    return {c - (all - layerCount<U>(j, m)), j, k};
}

}  // namespace

Result<SimplexCode> makeSimplexCode(int bits) {
    if (bits < 1 || bits > kMaxSimplexBits) {
        return inputError(std::format("simplex code of {} bits: the bits must be 1 to {}", bits, kMaxSimplexBits));
    }
    uint64_t low = 2;
    uint64_t high = uint64_t{1} << (bits / 3 + 3);  // T(n) > n^3 / 18
    while (low < high) {
        const uint64_t middle = (low + high + 1) / 2;
        if (gridCount(middle) <= uint64_t{1} << bits) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return SimplexCode{bits, low, gridCount(low), 0.5 / static_cast<double>(low - 1)};
}

const SimplexCode& simplexCode16() {
    static const SimplexCode code = *makeSimplexCode(16);
    return code;
}

uint64_t encodeSimplexPoint(const SimplexCode& code, SimplexPoint point) {
    SKINBENCH_ASSERT(2 * point.i + 3 * point.j + 4 * point.k <= 2 * (code.n - 1));
    const uint64_t m = code.n - 2 * point.k;
    return (code.count - gridCount(m)) + (layerCount<uint64_t>(0, m) - layerCount(point.j, m)) + point.i;
}

uint64_t encodeSimplex(const SimplexCode& code, glm::vec4 weights) {
    const glm::dvec4 w(weights);
    const double s = code.step;
    SimplexPoint p;
    p.k = roundTo(w[3] / s, (code.n - 1) / 2);
    const uint64_t m = code.n - 2 * p.k;
    const double fourth = static_cast<double>(p.k) * s;
    p.j = roundTo((w[2] - fourth) / s, (2 * m - 2) / 3);
    p.i = roundTo((w[1] - static_cast<double>(p.j) * s - fourth) / s, m - (3 * p.j + 1) / 2 - 1);
    return encodeSimplexPoint(code, p);
}

Result<SimplexPoint> decodeSimplexPoint(const SimplexCode& code, uint64_t value) {
    if (value >= code.count) {
        return inputError(
            std::format("simplex code {}: only {} codes exist; encode the mesh again", value, code.count));
    }
    return pointOf<uint64_t, double>(code.n, code.count, value);
}

SimplexPoint decodeSimplexPoint32(const SimplexCode& code, uint32_t value) {
    SKINBENCH_ASSERT(code.bits <= kMaxSimplexBits32 && value < code.count);
    return pointOf<uint32_t, float>(static_cast<uint32_t>(code.n), static_cast<uint32_t>(code.count), value);
}

glm::vec4 simplexWeights(const SimplexCode& code, SimplexPoint point) {
    const double w4 = static_cast<double>(point.k) * code.step;
    const double w3 = static_cast<double>(point.j + point.k) * code.step;
    const double w2 = static_cast<double>(point.i + point.j + point.k) * code.step;
    return glm::vec4(glm::dvec4(1 - w2 - w3 - w4, w2, w3, w4));
}

Result<glm::vec4> decodeSimplex(const SimplexCode& code, uint64_t value) {
    const Result<SimplexPoint> point = decodeSimplexPoint(code, value);
    SKINBENCH_TRY(point);
    return simplexWeights(code, *point);
}

}  // namespace skinbench
