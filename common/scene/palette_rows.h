// How joints lie in the palette that shaders read, and the reference that skins from such rows.
//
// lbs: linear blending; the three rows of the joint's matrix.
// dqs: dual quaternion blending (Kavan, Collins, Zara, O'Sullivan: "Geometric Skinning with Approximate Dual Quaternion
//      Blending", ACM TOG 27(4), 2008, algorithm 1). Two rows: the real and the dual part of the joint's rigid motion,
//      a quaternion each, xyz the vector and w the scalar. Where joints also scale, shear or mirror, three rows more:
//      that part, which is blended linearly before the motion (his 4.2). It keeps the joint's own place in the bind
//      pose, so that a joint's motion does not depend on how it scales; a mirror belongs to it.
//
// q and -q are one rotation, so each weight takes the sign that turns its quaternion towards that of the largest
// weight, of equal weights towards that of the lowest joint.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/pose.h"
#include "common/scene/skin_cpu.h"
#include "shaders_glsl/shared.h"

namespace skinbench {

enum class Method { lbs = METHOD_LBS, dqs = METHOD_DQS };
enum class RowFormat { f32, f16 };

struct PaletteForm {
    Method method = Method::lbs;
    RowFormat format = RowFormat::f32;
    bool stretches = false;  // dqs: five rows
    uint32_t rowsOfJoint() const { return method == Method::lbs ? 3 : stretches ? 5 : 2; }
    uint32_t bytesOfJoint() const { return rowsOfJoint() * (format == RowFormat::f16 ? 8 : 16); }
    auto operator<=>(const PaletteForm&) const = default;
};

// A joint's matrix M as a rigid motion behind a stretch: M p = R (S p) + t, where `stretch` has the rows of S. For
// every affine M, singular ones too; R is the rotation of the polar decomposition.
struct SplitJoint {
    glm::dvec4 real{0, 0, 0, 1};
    glm::dvec4 dual{0};
    std::array<glm::dvec4, 3> stretch{};
};

// `place`: where the joint is in the bind pose.
SplitJoint splitJoint(const PaletteEntry& joint, const glm::dvec3& place);

// Whether a joint is farther from a rotation and a translation than exported files round: 1e-4.
bool stretches(const Palette& palette);

// Whether joints do so in the clip, or in the rest pose without one: animated scales, or what sixteen moments show. A
// scale that holds still and that the bind matrices undo is none.
bool stretches(const Scene& scene, const Clip* clip);

// The rows as the device reads them, joint after joint, rounded to the format. Half floats that a GPU may take for zero
// (below 6.1e-5) are zero. Fails where a number exceeds 65504, the largest half float, and where a joint stretches that
// the form has no rows for.
Result<std::vector<glm::vec4>> paletteRows(const Skeleton& skeleton, const Palette& palette, const PaletteForm& form);

// Appends the bytes of such rows.
void appendRows(std::vector<std::byte>& bytes, std::span<const glm::vec4> rows, RowFormat format);

// In double precision from such rows. Vertices whose result hangs on a sign that rounding may turn (a quaternion within
// 1e-4 of a right angle to the pivot, or largest weights, equal within 0.01, that disagree about the signs) are
// SkinnedReference::undecided.
SkinnedReference skinReference(const Mesh& mesh, std::span<const glm::vec4> rows, const PaletteForm& form);

}  // namespace skinbench
