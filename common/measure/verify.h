// What a plan captured, compared with the reference.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/cases/workload.h"
#include "common/plans/plan.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

struct CapturedError {
    SkinError decoded;  // against the reference skinned from what the codec decodes to
    SkinError source;   // against the reference skinned from the scene's own vertices
};

// What rounding the palette to half floats moves vertices by, at most.
struct RowsError {
    double position = 0;  // relative to errorScale
    double pixels = 0;    // in the image, of vertices before the eye
};

// What position errors are divided by: the diagonal of the posed bounding box, or half of the farthest reach of a
// vertex where that is more. A vertex reaches sum_j w_j (|M_j| |p| + |t_j|): the numbers that single precision rounds,
// which a small character far from the origin has large. Infinite beyond 1e18, where squares of floats end: nothing
// passes then.
double errorScale(const Mesh& mesh, const Palette& palette);

// What captured vertices are compared with in one pose. It depends on the encoded vertices and on whether the variant
// skins, not on the route or the device.
struct References {
    struct Copy {
        double scale = 0;                         // errorScale
        SkinnedReference source;                  // by encoded vertex
        std::optional<SkinnedReference> decoded;  // empty: the codec loses nothing
    };
    std::vector<Copy> copies;            // the first and the last one; a single copy once
    std::optional<double> bound;         // codecPositionBound
    std::optional<RowsError> rowsError;  // of such palettes
};
// The vertices of `mesh` as the rows of such palettes move them.
SkinnedReference skinnedReference(const PlanInput& input, const Mesh& mesh, const Palette& palette);

References makeReferences(const Case& c, const PlanInput& input, const FrameData& frame);

// `captured` holds the encoded vertices of the first copy, then those of the last one, as the references' frame poses
// them. A single copy is captured in the first half only. Vertices that are marked in `leftOut` are not compared.
CapturedError capturedError(const References& references, std::span<const SkinnedVertex> captured,
                            std::span<const char> leftOut = {});

// The largest CapturedError::source.position that the codec's bounds (CodecBounds) and the joint transforms of `frame`
// allow, over the vertices that capturedError compares; 0 for a codec that loses nothing. What the variant's own
// arithmetic adds comes on top. Empty where the codec promises nothing, and for dual quaternions.
//
//   p' - p = sum_j w'_j M_j dp + sum_j dw_j M_j p      w' = w + dw, sum_j dw_j = 0, |dp| and sum_j |dw_j| bounded
std::optional<double> codecPositionBound(const Case& c, const PlanInput& input, const FrameData& frame);

// What the variant `compute` keeps beside positions and normals: the larger error of the first and the last copy, 0 for
// what the case does not keep.
struct KeptError {
    double previous = 0;  // of positions, relative to errorScale
    double tangent = 0;   // radians; infinite where a tangent's side is wrong
};

// The content of SLOT_SKINNED and, where packsTangents(), of SLOT_SKINNED_TANGENT once `before` and then
// `frame` were drawn, with ComputeOptions::halfRate each twice, so that every copy showed both.
struct KeptBytes {
    std::vector<std::byte> records, tangents;
};
KeptError keptError(const Case& c, const PlanInput& input, const FrameData& before, const FrameData& frame,
                    const KeptBytes& bytes);

}  // namespace skinbench
