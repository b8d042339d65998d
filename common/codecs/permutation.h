// Permutation Coding: sorted blend weights and a tuple index in one integer (docs/codecs.md 4 and 5; Peters, Kuth,
// Meyer, "Permutation Coding for Vertex-Blend Attribute Compression", I3D 2022).
//
// N weights ("entries") of N + 1 influences are stored, in ascending order; the largest follows from the sum. Each is
// quantised to values * extra steps on transformed axes where the entries differ strictly, so that the order in which
// they are written carries a permutation: N! choices of payload that cost no bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/core/result.h"

namespace skinbench {

inline constexpr int kMaxEntries = 12;

struct PermutationCode {
    int entries = 3;                            // N: influences - 1, 1 to 12
    int bits = 32;                              // b: a code lies below 2^b
    uint32_t values = 0;                        // W: N < W < 65536
    std::array<uint32_t, kMaxEntries> extra{};  // E: 1 or more, ascending; places N and above are 0
    uint64_t tuples = 0;                        // T: tuple indices 0..T-1; T * product(E) <= 2^32
    uint64_t quotients = 0;                     // P = ceil(T * product(E) / N!); W^N * P <= 2^b

    // V and O of docs/codecs.md 4.1, for entry i.
    constexpr uint64_t levels(int i) const { return uint64_t{values - static_cast<uint32_t>(entries)} * extra[i]; }
    constexpr uint64_t offset(int i) const { return (static_cast<uint64_t>(i) + 1) * extra[i] - 1; }
    bool operator==(const PermutationCode&) const = default;
};

// The parameter sets of docs/codecs.md 4.7, all for four influences and 32 bits.
inline constexpr PermutationCode kPermutationPc{3, 32, 58, {1, 1, 2}, 65536, 21846};
inline constexpr PermutationCode kPermutationDpdc16{3, 32, 36, {1, 1, 2}, 262144, 87382};        // 5 + 13 bits
inline constexpr PermutationCode kPermutationDpdc16Text{3, 32, 29, {1, 1, 2}, 524288, 174763};   // 5 + 14 bits
inline constexpr PermutationCode kPermutationDpdc16Mixed{3, 32, 32, {1, 1, 2}, 393216, 131072};  // 24 * 2^14

// Derives P and checks every condition above; the error names the one that does not hold.
Result<PermutationCode> makePermutationCode(std::span<const uint32_t> extra, uint32_t values, uint64_t tuples,
                                            int bits);

// docs/codecs.md 5: the code with the smallest worst-case error for `influences` (2 to 13), `tuples` (1 to 2^32) and
// `bits` (1 to 64). Fails where the bits cannot hold even two levels a weight.
Result<PermutationCode> configurePermutation(int influences, uint64_t tuples, int bits);

// docs/codecs.md 4.2 in strict single precision. `ascending` holds at least N weights, ascending, that sum to at most 1
// with the one not stored; the largest is not read. `tuple` is below 2^32 / product(E). Weights out of range (NaN,
// negative, sum above 1) are clamped: the tuple is still decoded exactly.
uint64_t encodePermutation(const PermutationCode& code, std::span<const float> ascending, uint32_t tuple);

struct PermutationBlend {
    uint32_t tuple = 0;  // the payload divided by product(E): below P * N! / product(E), which may exceed T slightly
    // N + 1 of them with sum 1, ascending and not negative but for rounding: entries whose E differ lie on different
    // grids, so equal weights may come back half a step apart in either order, and with 5 or more influences and a
    // coarse code a small one may come back below 0 by up to worstErrorSingle. 0 comes back as 0.
    std::array<float, kMaxEntries + 1> weights{};
    bool operator==(const PermutationBlend&) const = default;
};

// docs/codecs.md 4.3. Fails on a code that the encoder cannot have made: equal entries, a level out of range, a
// quotient of P or more. Compare the tuple with the table's size before use.
Result<PermutationBlend> decodePermutation(const PermutationCode& code, uint64_t value);

// docs/codecs.md 4.5: the largest error of the N + 1 decoded weights, as Euclidean length and as the largest single
// one.
double worstErrorLength(const PermutationCode& code);
double worstErrorSingle(const PermutationCode& code);

}  // namespace skinbench
