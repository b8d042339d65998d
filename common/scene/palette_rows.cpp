#include "common/scene/palette_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <format>

#include <glm/gtc/packing.hpp>

#include "common/scene/tangents.h"

namespace skinbench {
namespace {

glm::dmat3 linearPart(const PaletteEntry& joint) {
    glm::dmat3 m;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) m[column][row] = joint.rows[row][column];
    return m;
}

// Columns are the eigenvectors of a symmetric matrix, the one of the largest eigenvalue first; by Jacobi's rotations,
// which reach the last bit in fewer rounds than this.
glm::dmat3 eigenvectors(glm::dmat3 m) {
    constexpr int kRounds = 12;
    glm::dmat3 vectors(1);
    for (int round = 0; round < kRounds * 3; ++round) {
        const int p = round % 3 == 2 ? 1 : 0, q = round % 3 == 0 ? 1 : 2;
        if (m[q][p] == 0) continue;
        const double cotangent = (m[q][q] - m[p][p]) / (2 * m[q][p]);
        const double tangent = std::copysign(1 / (std::abs(cotangent) + std::hypot(cotangent, 1)), cotangent);
        glm::dmat3 turn(1);
        turn[p][p] = turn[q][q] = 1 / std::hypot(tangent, 1);
        turn[q][p] = tangent * turn[p][p];
        turn[p][q] = -turn[q][p];
        m = glm::transpose(turn) * m * turn;
        vectors = vectors * turn;
    }
    std::array<int, 3> order{0, 1, 2};
    std::ranges::sort(order, [&](int a, int b) { return m[a][a] > m[b][b]; });
    return {vectors[order[0]], vectors[order[1]], vectors[order[2]]};
}

// R of A = R S by the singular values of A; directions that A loses are filled up to a rotation.
glm::dmat3 nearestRotation(const glm::dmat3& a) {
    constexpr double kLost = 1e-6;  // of the largest singular value
    const glm::dmat3 right = eigenvectors(glm::transpose(a) * a);
    const glm::dmat3 images = a * right;
    const double largest = glm::length(images[0]);
    if (!(largest > 0) || !std::isfinite(largest)) return glm::dmat3(1);
    const auto lost = [&](int k) { return glm::length(images[k]) <= kLost * largest; };
    glm::dmat3 left;
    left[0] = images[0] / largest;
    left[1] = lost(1) ? anyPerpendicular(left[0]) : glm::normalize(images[1]);
    left[2] = lost(2) ? glm::cross(left[0], left[1]) * glm::determinant(right) : glm::normalize(images[2]);
    const glm::dmat3 rotation = left * glm::transpose(right);
    return glm::determinant(rotation) < 0 ? -rotation : rotation;
}

glm::dvec4 quaternionOf(const glm::dmat3& rotation) {
    const glm::dquat q = glm::normalize(glm::quat_cast(rotation));
    return {q.x, q.y, q.z, q.w};
}

glm::dvec3 vectorOf(const glm::dvec4& q) { return glm::dvec3(q); }

float toHalf(float value) {
    constexpr float kLeastNormal = 6.103515625e-5f;
    const float rounded = glm::unpackHalf1x16(glm::packHalf1x16(value));
    return std::abs(rounded) < kLeastNormal ? 0 : rounded;
}

// An influence that moves a vertex.
struct Share {
    double weight = 0;
    const glm::vec4* rows = nullptr;
    uint16_t joint = 0;
};

struct Shares {
    std::array<Share, kMaxInfluences> all;
    size_t count = 0;
};

Shares sharesOf(const Influences& influences, std::span<const glm::vec4> rows, uint32_t rowsOfJoint) {
    Shares shares;
    for (int k = 0; k < kMaxInfluences; ++k) {
        const uint16_t joint = influences.joints[k];
        if (influences.weights[k] == 0 || joint == kNoJoint) continue;
        shares.all[shares.count++] = {influences.weights[k], &rows[size_t{joint} * rowsOfJoint], joint};
    }
    return shares;
}

struct Signs {
    uint32_t bits = 0;
    bool undecided = false;
};

Signs signsTowards(const Shares& shares, const Share& pivot) {
    constexpr double kRightAngle = 1e-4;
    Signs signs;
    for (size_t i = 0; i < shares.count; ++i) {
        const double cosine = glm::dot(glm::dvec4(*pivot.rows), glm::dvec4(*shares.all[i].rows));
        signs.bits |= uint32_t{cosine < 0} << i;
        signs.undecided = signs.undecided || std::abs(cosine) < kRightAngle;
    }
    return signs;
}

// Of the pivot; undecided where a weight as large, but for rounding, would choose others that are not all turned round.
Signs signsOf(const Shares& shares) {
    constexpr double kRounding = 0.01;  // of weights, by codecs
    const auto before = [](const Share& a, const Share& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
    };
    const auto end = shares.all.begin() + static_cast<std::ptrdiff_t>(shares.count);
    const Share& pivot = *std::min_element(shares.all.begin(), end, before);
    Signs signs = signsTowards(shares, pivot);
    const uint32_t all = (1u << shares.count) - 1;
    for (auto other = shares.all.begin(); other != end; ++other) {
        if (pivot.weight - other->weight > kRounding) continue;
        const uint32_t bits = signsTowards(shares, *other).bits;
        signs.undecided = signs.undecided || (bits != signs.bits && bits != (~signs.bits & all));
    }
    return signs;
}

struct MovedVertex {
    glm::dvec3 position, normal;
};

// Kavan et al. 2008, algorithm 1, behind the linear part.
MovedVertex blendDual(const Shares& shares, const Signs& signs, bool stretches, const glm::dvec3& position,
                      const glm::dvec3& normal) {
    glm::dvec4 real(0), dual(0);
    std::array<glm::dvec4, 3> stretch{};
    for (size_t i = 0; i < shares.count; ++i) {
        const Share& share = shares.all[i];
        const double weight = signs.bits >> i & 1 ? -share.weight : share.weight;
        real += weight * glm::dvec4(share.rows[0]);
        dual += weight * glm::dvec4(share.rows[1]);
        for (int row = 0; row < 3 && stretches; ++row) stretch[row] += share.weight * glm::dvec4(share.rows[2 + row]);
    }
    const auto stretched = [&](const glm::dvec4& p) {
        return stretches ? glm::dvec3(glm::dot(stretch[0], p), glm::dot(stretch[1], p), glm::dot(stretch[2], p))
                         : glm::dvec3(p);
    };
    const double length = glm::length(real);
    real /= length;
    dual /= length;
    const glm::dvec3 axis = vectorOf(real);
    const auto rotated = [&](const glm::dvec3& v) {
        return v + 2.0 * glm::cross(axis, glm::cross(axis, v) + real.w * v);
    };
    const glm::dvec3 moved = 2.0 * (real.w * vectorOf(dual) - dual.w * axis + glm::cross(axis, vectorOf(dual)));
    const glm::dvec3 turned = rotated(stretched(glm::dvec4(normal, 0)));
    const double turnedLength = glm::length(turned);
    return {rotated(stretched(glm::dvec4(position, 1))) + moved,
            turnedLength > 1e-18 ? turned / turnedLength : glm::dvec3(0)};
}

SkinnedReference skinDual(const Mesh& mesh, std::span<const glm::vec4> rows, const PaletteForm& form) {
    SkinnedReference reference;
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        const Shares shares = sharesOf(mesh.influences[v], rows, form.rowsOfJoint());
        const Signs signs = shares.count ? signsOf(shares) : Signs{};
        const MovedVertex moved = blendDual(shares, signs, form.stretches, mesh.positions[v], mesh.normals[v]);
        reference.positions.push_back(moved.position);
        reference.normals.push_back(moved.normal);
        reference.undecided.push_back(signs.undecided);
    }
    return reference;
}

}  // namespace

SplitJoint splitJoint(const PaletteEntry& joint, const glm::dvec3& place) {
    const glm::dmat3 linear = linearPart(joint);
    const glm::dmat3 rotation = nearestRotation(linear);
    const glm::dmat3 stretch = glm::transpose(rotation) * linear;
    const glm::dvec3 kept = place - stretch * place;  // the stretch leaves `place` where it is
    const glm::dvec3 translation(joint.rows[0].w, joint.rows[1].w, joint.rows[2].w);
    const glm::dvec3 t = translation - rotation * kept;
    SplitJoint split;
    split.real = quaternionOf(rotation);
    const glm::dvec3 axis = vectorOf(split.real);
    split.dual = 0.5 * glm::dvec4(split.real.w * t + glm::cross(t, axis), -glm::dot(t, axis));
    for (int row = 0; row < 3; ++row)
        split.stretch[row] = {stretch[0][row], stretch[1][row], stretch[2][row], kept[row]};
    return split;
}

bool stretches(const Palette& palette) {
    constexpr double kTolerance = 1e-4;
    return std::ranges::any_of(palette, [&](const PaletteEntry& joint) {
        const glm::dmat3 linear = linearPart(joint);
        const glm::dmat3 off = glm::transpose(linear) * linear - glm::dmat3(1);
        double worst = 0;
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 3; ++row) worst = std::max(worst, std::abs(off[column][row]));
        return !(worst <= 2 * kTolerance) || glm::determinant(linear) < 0;
    });
}

bool stretches(const Scene& scene, const Clip* clip) {
    constexpr int kMoments = 16;
    const auto changes = [](const Channel& channel) {
        const bool cubic = channel.interpolation == Interpolation::cubicSpline;
        for (size_t i = 0; i < channel.values.size(); ++i) {
            const bool tangent = cubic && i % 3 != 1;
            if (channel.values[i] != (tangent ? glm::vec4(0) : channel.values[cubic ? 1 : 0])) return true;
        }
        return false;
    };
    if (clip && std::ranges::any_of(clip->channels, [&](const Channel& channel) {
            return channel.path == ChannelPath::scale && changes(channel);
        }))
        return true;
    for (int moment = 0; moment < (clip ? kMoments : 1); ++moment) {
        const float seconds = clip ? clip->duration * static_cast<float>(moment) / kMoments : 0;
        if (stretches(poseScene(scene, clip, seconds))) return true;
    }
    return false;
}

Result<std::vector<glm::vec4>> paletteRows(const Skeleton& skeleton, const Palette& palette, const PaletteForm& form) {
    SKINBENCH_ASSERT(skeleton.joints.size() == palette.size());
    constexpr float kLargestHalf = 65504;
    if (form.method == Method::dqs && !form.stretches && stretches(palette))
        return inputError("a joint stretches in a frame that is drawn, and in no moment that was looked at before");
    std::vector<glm::vec4> rows;
    rows.reserve(palette.size() * form.rowsOfJoint());
    for (size_t j = 0; j < palette.size(); ++j) {
        if (form.method == Method::lbs) {
            rows.insert(rows.end(), palette[j].rows.begin(), palette[j].rows.end());
            continue;
        }
        const glm::dmat4 bind(skeleton.joints[j].inverseBind);
        const bool invertible = std::abs(glm::determinant(glm::dmat3(bind))) > 1e-30;
        const SplitJoint split = splitJoint(palette[j], invertible ? glm::dvec3(glm::inverse(bind)[3]) : glm::dvec3(0));
        rows.push_back(glm::vec4(split.real));
        rows.push_back(glm::vec4(split.dual));
        for (int row = 0; row < 3 && form.stretches; ++row) rows.push_back(glm::vec4(split.stretch[row]));
    }
    if (form.format == RowFormat::f32) return rows;
    for (size_t i = 0; i < rows.size(); ++i)
        for (int k = 0; k < 4; ++k) {
            if (!(std::abs(rows[i][k]) <= kLargestHalf))
                return inputError(
                    std::format("joint {} moves by {:.3g}, more than half floats hold (65504); scale the "
                                "model, or use --palette-rows f32",
                                i / form.rowsOfJoint(), rows[i][k]));
            rows[i][k] = toHalf(rows[i][k]);
        }
    return rows;
}

void appendRows(std::vector<std::byte>& bytes, std::span<const glm::vec4> rows, RowFormat format) {
    const size_t first = bytes.size();
    if (format == RowFormat::f32) {
        bytes.resize(first + rows.size_bytes());
        if (!rows.empty()) std::memcpy(&bytes[first], rows.data(), rows.size_bytes());
        return;
    }
    bytes.resize(first + rows.size() * sizeof(uint64_t));
    for (size_t i = 0; i < rows.size(); ++i) {
        const uint64_t row = glm::packHalf4x16(rows[i]);
        std::memcpy(&bytes[first + i * sizeof(row)], &row, sizeof(row));
    }
}

SkinnedReference skinReference(const Mesh& mesh, std::span<const glm::vec4> rows, const PaletteForm& form) {
    if (form.method == Method::dqs) return skinDual(mesh, rows, form);
    Palette palette(rows.size() / 3);
    for (size_t i = 0; i < rows.size(); ++i) palette[i / 3].rows[i % 3] = rows[i];
    return skinReference(mesh, palette);
}

}  // namespace skinbench
