#include "common/scene/skin_cpu.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/parallel.h"

namespace skinbench {
namespace {

// Template over the scalar, so that the reference and the timed code are the same formula.
template <class T>
struct Blended {
    glm::vec<3, T> position;
    glm::vec<3, T> normal;
    T length;  // of the normal before it had unit length
};

template <class T>
Blended<T> blend(const Mesh& mesh, size_t vertex, const Palette& palette) {
    using Vec3 = glm::vec<3, T>;
    using Vec4 = glm::vec<4, T>;
    std::array<Vec4, 3> rows{Vec4(0), Vec4(0), Vec4(0)};
    const Influences& influences = mesh.influences[vertex];
    for (int k = 0; k < kMaxInfluences; ++k) {
        const T weight = influences.weights[k];
        if (weight == 0 || influences.joints[k] == kNoJoint) continue;
        const PaletteEntry& joint = palette[influences.joints[k]];
        for (int row = 0; row < 3; ++row) rows[row] += weight * Vec4(joint.rows[row]);
    }
    const Vec4 p(Vec3(mesh.positions[vertex]), 1);
    const Vec3 n(mesh.normals[vertex]);
    const Vec3 normal(glm::dot(Vec3(rows[0]), n), glm::dot(Vec3(rows[1]), n), glm::dot(Vec3(rows[2]), n));
    const T length = glm::length(normal);
    return {{glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p)},
            length > 0 ? normal / length : Vec3(0, 0, 1),
            length};
}

// Whether a normal of this length has a direction in single precision: little of what was summed cancels, and its
// square is neither infinite nor denormal.
bool hasDirection(const Mesh& mesh, size_t vertex, const Palette& palette, double length) {
    constexpr double kLeastOfTerms = 1e-3, kLeast = 1e-18, kMost = 1e18;
    const glm::dvec3 n = glm::abs(glm::dvec3(mesh.normals[vertex]));
    const Influences& influences = mesh.influences[vertex];
    double terms = 0;
    for (int k = 0; k < kMaxInfluences; ++k) {
        if (influences.weights[k] == 0 || influences.joints[k] == kNoJoint) continue;
        const PaletteEntry& joint = palette[influences.joints[k]];
        glm::dvec3 sum;
        for (int row = 0; row < 3; ++row) sum[row] = glm::dot(glm::abs(glm::dvec3(joint.rows[row])), n);
        terms += influences.weights[k] * glm::length(sum);
    }
    return length > kLeastOfTerms * terms && length > kLeast && length < kMost;
}

// Out of line: where it was inlined into the threads, it took 1.1 to 1.25 of the time on 16 cores.
[[gnu::noinline]] void skinRange(const CpuSkinJob& job, size_t vertices, size_t begin, size_t end) {
    while (begin < end) {
        const size_t copy = begin / vertices;
        const size_t stop = std::min(end, (copy + 1) * vertices);
        const Mesh& mesh = job.copies[copy];
        const Palette& palette = job.palettes[copy];
        for (; begin < stop; ++begin) {
            const size_t vertex = begin - copy * vertices;
            const Blended<float> skinned = blend<float>(mesh, vertex, palette);
            job.out[begin] = {skinned.position, mesh.uvs[vertex].x, skinned.normal, mesh.uvs[vertex].y};
        }
    }
}

}  // namespace

SkinnedReference skinReference(const Mesh& mesh, const Palette& palette) {
    SkinnedReference reference;
    reference.positions.resize(mesh.positions.size());
    reference.normals.resize(mesh.positions.size());
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        const Blended<double> skinned = blend<double>(mesh, v, palette);
        reference.positions[v] = skinned.position;
        reference.normals[v] = hasDirection(mesh, v, palette, skinned.length) ? skinned.normal : glm::dvec3(0);
    }
    return reference;
}

void skinOnCpu(const CpuSkinJob& job, unsigned threads) {
    SKINBENCH_ASSERT(job.copies.size() == job.palettes.size());
    if (job.copies.empty()) return;
    const size_t vertices = job.copies[0].positions.size();
    for (const Mesh& mesh : job.copies) SKINBENCH_ASSERT(mesh.positions.size() == vertices);
    const size_t total = vertices * job.copies.size();
    SKINBENCH_ASSERT(job.out.size() == total);

    const size_t workers = std::clamp<size_t>(threads, 1, std::max<size_t>(total, 1));
    const auto rangeEnd = [&](size_t worker) { return total * worker / workers; };
    parallelEach(workers, [&](size_t worker) { skinRange(job, vertices, rangeEnd(worker), rangeEnd(worker + 1)); });
}

SkinError compareSkinned(const SkinnedReference& reference, std::span<const SkinnedVertex> measured, double scale,
                         std::span<const char> leftOut) {
    SKINBENCH_ASSERT(reference.positions.size() == measured.size());
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    SkinError worst;
    for (size_t v = 0; v < measured.size(); ++v) {
        if (!leftOut.empty() && leftOut[v]) continue;
        if (!reference.undecided.empty() && reference.undecided[v]) {
            ++worst.undecided;
            continue;
        }
        const glm::dvec3 normal(measured[v].normal);
        const double distance = glm::length(glm::dvec3(measured[v].position) - reference.positions[v]);
        worst.position = std::max(worst.position, std::isfinite(distance) ? distance : kInfinity);
        if (reference.normals[v] == glm::dvec3(0)) continue;
        const double angle =
            std::atan2(glm::length(glm::cross(normal, reference.normals[v])), glm::dot(normal, reference.normals[v]));
        const bool zero = glm::length(normal) == 0;
        worst.normal = std::max(worst.normal, std::isfinite(angle) && !zero ? angle : kInfinity);
    }
    if (worst.position > 0) worst.position = scale > 0 && std::isfinite(scale) ? worst.position / scale : kInfinity;
    return worst;
}

}  // namespace skinbench
