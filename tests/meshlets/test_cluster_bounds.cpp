// Whatever the joints do, nothing that can be seen is culled: the shaders' own text, compiled as C++, on random
// palettes, cameras and meshlets.
#include <atomic>
#include <bit>
#include <cmath>

#include <catch2/catch_test_macros.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/packing.hpp>

#include "common/core/parallel.h"
#include "common/meshlets/cluster_bounds.h"
#include "tests/cases.h"

namespace skinbench::shader {
namespace {
using namespace glm;
constexpr float kWeightError = 1e-6f;
constexpr uint kSubpixels = 256, kWidth = 640, kHeight = 360;
#define WEIGHT_ERROR kWeightError
#define SUBPIXELS kSubpixels
#define IMAGE_WIDTH kWidth
#define IMAGE_HEIGHT kHeight
#include "cluster_math.glsl"
#undef WEIGHT_ERROR
#undef SUBPIXELS
#undef IMAGE_WIDTH
#undef IMAGE_HEIGHT
}  // namespace
}  // namespace skinbench::shader

using namespace skinbench;

namespace {

// Xorshift (Marsaglia, 2003): much faster than the library's, which would take most of the time.
struct FastRandom {
    uint64_t state;
    float unit() {
        state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        return static_cast<float>(state >> 40) * 0x1p-24f;
    }
    float between(float low, float high) { return low + (high - low) * unit(); }
    glm::vec3 inBox(float half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
    uint32_t below(uint32_t n) { return static_cast<uint32_t>(unit() * static_cast<float>(n)); }
};

// A rotation with a scale of each axis, a shear, now and then a mirror, and a translation.
PaletteEntry randomJoint(FastRandom& random) {
    glm::mat4 m(1);
    m = glm::rotate(m, random.between(0, 6.28f), random.inBox(1) + glm::vec3(0, 0, 2));
    m = glm::scale(m, glm::vec3(random.between(0.3f, 2), random.between(0.3f, 2), random.between(0.3f, 2)));
    m[1].x += random.between(-0.5f, 0.5f);
    if (random.below(8) == 0) m[0] = -m[0];
    const glm::vec3 move = random.inBox(1);
    PaletteEntry entry;
    for (int row = 0; row < 3; ++row) entry.rows[row] = {m[0][row], m[1][row], m[2][row], move[row]};
    return entry;
}

// Looks past or at the origin from any side, near or far.
glm::mat4 randomView(FastRandom& random) {
    const glm::vec3 eye = glm::normalize(random.inBox(1) + glm::vec3(0, 0, 0.01f)) * random.between(0.5f, 30);
    const float angle = glm::radians(random.between(10, 70));
    glm::mat4 view = glm::perspectiveRH_ZO(angle, 16.0f / 9, 0.05f, random.between(10, 60)) *
                     glm::lookAtRH(eye, random.inBox(random.between(0.1f, 12)), glm::vec3(0, 1, 0));
    for (int column = 0; column < 4; ++column) view[column].y = -view[column].y;
    return view;
}

shader::JointRows rowsOf(const PaletteEntry& joint) { return {joint.rows[0], joint.rows[1], joint.rows[2]}; }

// In single precision, as the shaders skin and project.
glm::vec4 clipOf(const Mesh& mesh, uint32_t vertex, const Palette& palette, const glm::mat4& view,
                 const glm::vec3& offset) {
    std::array<glm::vec4, 3> rows{};
    const Influences& own = mesh.influences[vertex];
    for (int k = 0; k < kMaxInfluences; ++k)
        if (own.weights[k] > 0)
            for (int row = 0; row < 3; ++row) rows[row] += own.weights[k] * palette[own.joints[k]].rows[row];
    const glm::vec4 p(mesh.positions[vertex], 1);
    return view * glm::vec4(glm::vec3(glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p)) + offset, 1);
}

bool isBeyond(const glm::vec4& clip, int plane) {
    const float values[] = {clip.x - clip.w,  -clip.x - clip.w, clip.y - clip.w,
                            -clip.y - clip.w, clip.z - clip.w,  -clip.z};
    return values[plane] > 0;
}

struct Meshlets {
    Mesh mesh;
    MeshletMesh cut;
};

// Points in a small box, each moved by up to four of `joints` joints.
Meshlets randomPoints(FastRandom& random, uint32_t joints) {
    Meshlets made;
    const glm::vec3 center = random.inBox(1);
    for (uint32_t v = 0; v < 12; ++v) {
        made.mesh.positions.push_back(center + random.inBox(0.3f));
        Influences& own = made.mesh.influences.emplace_back();
        float sum = 0;
        const uint32_t count = 1 + random.below(std::min(joints, 4u));
        for (uint32_t k = 0; k < count; ++k) {
            own.joints[k] = static_cast<uint16_t>((v + k) % joints);
            own.weights[k] = random.between(0.05f, 1);
            sum += own.weights[k];
        }
        for (uint32_t k = 0; k < count; ++k) own.weights[k] /= sum;
        made.cut.vertices.push_back(v);
    }
    made.cut.triangles.push_back({0, 1, 2});
    made.cut.meshlets = {{.vertexCount = 12, .triangleCount = 1}};
    return made;
}

uint32_t jointsOf(const Mesh& mesh) {
    uint32_t joints = 0;
    for (const Influences& own : mesh.influences)
        for (int k = 0; k < kMaxInfluences; ++k)
            if (own.weights[k] > 0) joints = std::max(joints, own.joints[k] + 1u);
    return joints;
}

// The planes that the test says a cluster lies beyond, as cluster_tests.glsl finds them.
uint32_t beyondOf(const ClusterSet& set, const Cluster& cluster, const Palette& palette, const shader::ClipRows& view,
                  const glm::vec3& offset, float shrink) {
    uint32_t beyond = cluster.partCount ? 63 : 0;
    for (uint32_t i = 0; i < cluster.partCount && beyond; ++i) {
        const ClusterPart& part = set.parts[cluster.firstPart + i];
        const shader::Solid solid{part.center, part.extent * shrink, part.radius * shrink};
        const shader::JointRows rows = rowsOf(palette[part.joint]);
        beyond &=
            shader::planesBeyond(shader::jointClipRows(view, rows), solid, shader::doubtOf(view, rows, solid, offset));
    }
    return beyond;
}

struct Escapes {
    uint64_t tested = 0, culled = 0, escaped = 0;
};

// One palette and one camera over all meshlets.
Escapes tryPalette(FastRandom& random, const Meshlets& made, const ClusterSet& set, uint32_t joints, float shrink) {
    Escapes escapes;
    Palette palette(joints);
    for (PaletteEntry& joint : palette) joint = randomJoint(random);
    const glm::mat4 view = randomView(random);
    const glm::vec3 offset = random.inBox(4);
    const shader::ClipRows rows = shader::viewRows(view, offset);
    for (size_t m = 0; m < set.clusters.size(); ++m) {
        const uint32_t beyond = beyondOf(set, set.clusters[m], palette, rows, offset, shrink);
        ++escapes.tested;
        escapes.culled += beyond != 0;
        bool escaped = false;
        const Meshlet& meshlet = made.cut.meshlets[m];
        for (uint32_t i = 0; beyond && i < meshlet.vertexCount; ++i) {
            const glm::vec4 clip = clipOf(made.mesh, made.cut.vertices[meshlet.firstVertex + i], palette, view, offset);
            for (int plane = 0; plane < 6; ++plane)
                escaped = escaped || ((beyond >> plane & 1) && !isBeyond(clip, plane));
        }
        escapes.escaped += escaped;
    }
    return escapes;
}

// `of(random, tries)` on every core, `count` tries in all.
template <class Of>
Escapes onAllCores(uint64_t count, const Of& of) {
    const size_t workers = coreCount();
    std::vector<Escapes> parts(workers);
    parallelEach(workers, [&](size_t worker) {
        FastRandom random{0x9E3779B97F4A7C15u * (worker + 1)};
        for (uint64_t i = worker; i < count; i += workers) {
            const Escapes one = of(random);
            parts[worker].tested += one.tested, parts[worker].culled += one.culled;
            parts[worker].escaped += one.escaped;
        }
    });
    Escapes all;
    for (const Escapes& part : parts) all.tested += part.tested, all.culled += part.culled, all.escaped += part.escaped;
    return all;
}

constexpr ClusterBounds kPartKinds[] = {ClusterBounds::jointSpheres, ClusterBounds::oneSphere,
                                        ClusterBounds::jointBoxes};

}  // namespace

TEST_CASE("no skinned vertex leaves the bounds of its meshlet, whatever the palette: random meshlets") {
    for (ClusterBounds bounds : kPartKinds) {
        auto tries = [&](float shrink) {
            return [&, shrink](FastRandom& random) {
                const uint32_t joints = 1 + random.below(5);
                const Meshlets made = randomPoints(random, joints);
                return tryPalette(random, made, boundClusters(made.mesh, made.cut, bounds), joints, shrink);
            };
        };
        const Escapes right = onAllCores(150'000, tries(1));
        CHECK(right.escaped == 0);
        CHECK(right.culled * 4 > right.tested);
        CHECK(right.culled < right.tested);
        // Bounds that are too small are found out.
        CHECK(onAllCores(20'000, tries(0.5f)).escaped > 0);
    }
}

TEST_CASE("no skinned vertex leaves the bounds of its meshlet, whatever the palette: real meshlets") {
    Meshlets made;
    const auto prepared = prepareScene(tinyScene(), {});
    REQUIRE(prepared);
    made.mesh = prepared->mesh;
    made.cut = builders().back().build(made.mesh, {.vertices = 16, .triangles = 16});
    const uint32_t joints = jointsOf(made.mesh);
    for (ClusterBounds bounds : kPartKinds) {
        const ClusterSet set = boundClusters(made.mesh, made.cut, bounds);
        REQUIRE(set.weightError < shader::kWeightError);
        const Escapes all =
            onAllCores(20'000, [&](FastRandom& random) { return tryPalette(random, made, set, joints, 1); });
        CHECK(all.tested >= 550'000 / 3);
        CHECK(all.escaped == 0);
        CHECK(all.culled > 0);
    }
}

namespace {

// A few triangles of a curved patch that one joint moves, some of them much smaller than a pixel.
Meshlets randomPatch(FastRandom& random) {
    Meshlets made;
    const glm::vec3 center = random.inBox(1);
    const glm::mat3 turn(glm::rotate(glm::mat4(1), random.between(0, 6.28f), random.inBox(1) + glm::vec3(0, 0, 2)));
    const float size = 0.5f * std::exp2(-random.between(0, 12)), curve = random.between(0, 0.6f);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
            const glm::vec2 at(static_cast<float>(x - 1) + random.between(-0.3f, 0.3f),
                               static_cast<float>(y - 1) + random.between(-0.3f, 0.3f));
            made.mesh.positions.push_back(center + turn * glm::vec3(at, -curve * glm::dot(at, at)) * size);
            made.mesh.influences.emplace_back().weights[0] = 1;
            made.cut.vertices.push_back(static_cast<uint32_t>(made.cut.vertices.size()));
        }
    for (uint8_t y = 0; y < 2; ++y)
        for (uint8_t x = 0; x < 2; ++x) {
            const uint8_t a = static_cast<uint8_t>(y * 3 + x), b = static_cast<uint8_t>(a + 1),
                          c = static_cast<uint8_t>(a + 3), d = static_cast<uint8_t>(a + 4);
            made.cut.triangles.push_back({a, b, c});
            made.cut.triangles.push_back({b, d, c});
        }
    made.cut.meshlets = {{.vertexCount = 9, .triangleCount = 8}};
    return made;
}

// Twice the area in pixels, y down, with every position moved to one of the rasteriser's around it.
double roundedArea(FastRandom& random, const std::array<glm::vec4, 3>& clip) {
    std::array<glm::dvec2, 3> at;
    for (int i = 0; i < 3; ++i) {
        const glm::vec2 pixel = glm::vec2(clip[i]) / clip[i].w * 0.5f * glm::vec2(shader::kWidth, shader::kHeight);
        const glm::dvec2 steps = glm::dvec2(pixel) * double{shader::kSubpixels};
        at[i] = {random.below(2) ? std::round(steps.x) : std::floor(steps.x + 0.5), std::round(steps.y)};
    }
    const glm::dvec2 ab = at[1] - at[0], ac = at[2] - at[0];
    return ab.x * ac.y - ab.y * ac.x;
}

Escapes tryCone(FastRandom& random, bool trusting) {
    const Meshlets made = randomPatch(random);
    const ClusterSet set = boundClusters(made.mesh, made.cut, ClusterBounds::jointSpheres);
    ClusterCone cone = set.clusters[0].cone;
    if (trusting && cone.altitude > 0) cone.altitude = 1e6f;  // as if rounding turned no face
    const Palette palette{randomJoint(random)};
    const glm::mat4 view = randomView(random);
    const glm::vec3 offset = random.inBox(1);
    const shader::ClipRows rows = shader::jointClipRows(shader::viewRows(view, offset), rowsOf(palette[0]));
    Escapes escapes{.tested = 1};
    if (!shader::allFaceAway(rows, {cone.axis * cone.cosine, cone.altitude, cone.center, cone.radius})) return escapes;
    escapes.culled = 1;
    std::vector<glm::vec4> clip;
    for (uint32_t v = 0; v < 9; ++v) clip.push_back(clipOf(made.mesh, v, palette, view, offset));
    for (const auto& t : made.cut.triangles)
        if (roundedArea(random, {clip[t[0]], clip[t[1]], clip[t[2]]}) < 0) escapes.escaped = 1;
    return escapes;
}

}  // namespace

TEST_CASE("no face that the rasteriser may take for a front face lies in a culled cone, whatever the joint does") {
    const Escapes all = onAllCores(1'000'000, [](FastRandom& random) { return tryCone(random, false); });
    CHECK(all.escaped == 0);
    CHECK(all.culled * 20 > all.tested);
    // Without the margin for rounding some do.
    CHECK(onAllCores(400'000, [](FastRandom& random) { return tryCone(random, true); }).escaped > 0);
}

TEST_CASE("meshlets of more than sixteen joints are not tested, and cones need one joint and faces with an area") {
    FastRandom random{7};
    Meshlets many = randomPoints(random, 4);
    for (uint16_t v = 0; v < 12; ++v) {
        many.mesh.influences[v] = {};
        for (uint16_t k = 0; k < 2; ++k)
            many.mesh.influences[v].joints[k] = static_cast<uint16_t>(2 * v + k),
            many.mesh.influences[v].weights[k] = 0.5f;
    }
    const ClusterSet set = boundClusters(many.mesh, many.cut, ClusterBounds::jointSpheres);
    CHECK(set.clusters[0].partCount == 0);
    CHECK(set.clusters[0].cone.altitude == 0);
    CHECK(set.parts.empty());
    Meshlets patch = randomPatch(random);
    CHECK(boundClusters(patch.mesh, patch.cut, ClusterBounds::jointBoxes).clusters[0].cone.altitude > 0);
    Meshlets line = patch;
    line.mesh.positions[2] = line.mesh.positions[1] * 2.0f - line.mesh.positions[0];
    line.cut.triangles.resize(1);
    line.cut.triangles[0] = {0, 1, 2};
    line.cut.meshlets[0].triangleCount = 1;
    CHECK(boundClusters(line.mesh, line.cut, ClusterBounds::jointBoxes).clusters[0].cone.altitude < 1e-5f);
    // Two corners in one place are never drawn, so they say nothing.
    patch.mesh.positions[1] = patch.mesh.positions[0];
    CHECK(boundClusters(patch.mesh, patch.cut, ClusterBounds::jointBoxes).clusters[0].cone.altitude > 0);
    patch.mesh.influences[3].joints[0] = 1;
    CHECK(boundClusters(patch.mesh, patch.cut, ClusterBounds::jointBoxes).clusters[0].cone.altitude == 0);
}

TEST_CASE("the words of clusters: no half float is below its radius") {
    FastRandom random{5};
    for (int i = 0; i < 200; ++i) {
        const Meshlets made = randomPoints(random, 4);
        const ClusterSet set = boundClusters(made.mesh, made.cut, ClusterBounds::jointSpheres);
        const PackedClusters packed = packClusters(set, made.cut, ClusterBounds::jointSpheres);
        REQUIRE(packed.clusters.size() == 12);
        REQUIRE(packed.parts.size() == set.parts.size() * 4);
        CHECK(packed.clusters[1] == set.parts.size());
        CHECK((packed.clusters[3] & 0xFFFF) == 1);
        for (size_t part = 0; part < set.parts.size(); ++part) {
            const uint32_t word = packed.parts[part * 4 + 3];
            CHECK(word >> 16 == set.parts[part].joint);
            CHECK(glm::unpackHalf1x16(static_cast<uint16_t>(word)) * packed.scale >= set.parts[part].radius);
            CHECK(std::bit_cast<float>(packed.parts[part * 4]) == set.parts[part].center.x);
        }
    }
    const Meshlets made = randomPoints(random, 4);
    const ClusterSet boxes = boundClusters(made.mesh, made.cut, ClusterBounds::instance);
    CHECK(boxes.clusters[0].partCount == 0);
    CHECK(packClusters(boxes, made.cut, ClusterBounds::instance).parts.size() == boxes.parts.size() * 8);
}
