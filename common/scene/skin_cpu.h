// Linear blend skinning on the CPU: the reference that every variant is checked against, and the `cpu` variant.
//
//   p' = sum_i w_i * M_i * (p, 1)        n' = normalize(sum_i w_i * M3_i * n)
//
// Normals use the upper 3x3 of the blended matrix, not its inverse transpose, as both theses and nearly every engine
// do: the two agree for rotations and uniform scales.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/pose.h"
#include "common/scene/scene.h"

namespace skinbench {

// A normal is 0 where single precision knows no direction, as under a joint of scale 0: none is compared then.
struct SkinnedReference {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;
    std::vector<bool> undecided{};  // vertices that cannot be compared (palette_rows.h); empty: none
};

// Double precision throughout, from the float palette and the float vertices that the GPU reads too.
SkinnedReference skinReference(const Mesh& mesh, const Palette& palette);

// What a compute pass and the CPU write and a plain vertex shader reads: 32 bytes.
struct SkinnedVertex {
    glm::vec3 position{0};
    float u = 0;
    glm::vec3 normal{0};
    float v = 0;
};
static_assert(sizeof(SkinnedVertex) == 32);

// The `cpu` variant: single precision, `copies` copies that own their input and output memory, split over `threads`
// threads. vertices[c], palettes[c] and out[c] belong to copy c; out[c] has one element a vertex.
struct CpuSkinJob {
    std::span<const Mesh> copies;
    std::span<const Palette> palettes;  // one a copy
    std::span<SkinnedVertex> out;       // copies * vertices
};
void skinOnCpu(const CpuSkinJob& job, unsigned threads);

// Largest deviation from the reference. Position error is divided by `scale`; normal error is an angle in
// radians. A value that is not finite counts as an infinite error, and so does any error where `scale` is 0 or
// infinite.
struct SkinError {
    double position = 0;
    double normal = 0;
    size_t undecided = 0;  // vertices of SkinnedReference::undecided, which are not compared
};
// `leftOut`: empty, or for each vertex whether it is not compared.
SkinError compareSkinned(const SkinnedReference& reference, std::span<const SkinnedVertex> measured, double scale,
                         std::span<const char> leftOut = {});

}  // namespace skinbench
