// From a clip and a time to the joint palette that the shaders read: sample the local transforms, walk the hierarchy
// to model space, multiply by the inverse bind matrices. Hierarchies are walked in double precision, so that the
// palette's own rounding to float is the only error that reaches a variant.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"

namespace skinbench {

// The upper three rows of an affine joint matrix: p' = (dot(rows[0], vec4(p, 1)), ...). 48 bytes, the GPU layout.
struct PaletteEntry {
    std::array<glm::vec4, 3> rows{glm::vec4{1, 0, 0, 0}, glm::vec4{0, 1, 0, 0}, glm::vec4{0, 0, 1, 0}};
};
static_assert(sizeof(PaletteEntry) == 48);

using Palette = std::vector<PaletteEntry>;  // one entry a joint, in the order of Skeleton::joints

struct LocalPose {
    std::vector<Node> nodes;  // the skeleton's nodes with the sampled transforms
};

// glTF 2.0, appendix C. Times before the first and behind the last key hold that key; rotations are interpolated
// spherically on the short way (LINEAR) or normalised (CUBICSPLINE). A null clip gives the rest pose.
LocalPose sampleClip(const Skeleton& skeleton, const Clip* clip, float seconds);

std::vector<glm::dmat4> toModelSpace(const LocalPose& pose);

Palette makePalette(const Skeleton& skeleton, std::span<const glm::dmat4> modelSpace);

// The three steps above; `seconds` wraps around the clip's duration where it lies outside of [0, duration].
Palette poseScene(const Scene& scene, const Clip* clip, float seconds);

struct Bounds {
    glm::vec3 min{0};
    glm::vec3 max{0};
    // Squares of large and of small floats leave their range.
    double diagonal() const { return glm::length(glm::dvec3(max) - glm::dvec3(min)); }
};

// Of the skinned positions under `palette`: of the vertices from `first` up to, not including, `last`.
Bounds posedBounds(const Mesh& mesh, const Palette& palette, size_t first = 0, size_t last = SIZE_MAX);

}  // namespace skinbench
