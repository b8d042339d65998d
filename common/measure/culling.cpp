#include "common/measure/culling.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <format>

#include "common/core/parallel.h"
#include "common/measure/verify.h"
#include "common/plans/plan_parts.h"

namespace skinbench {
namespace {

using Place = glm::dvec4;
using Corners = std::array<Place, 3>;

// How far a place lies within each plane of the view volume; below 0: beyond it.
constexpr int kPlanes = 6;
double within(const Place& p, int plane) {
    switch (plane) {
        case 0:
            return p.w - p.x;
        case 1:
            return p.w + p.x;
        case 2:
            return p.w - p.y;
        case 3:
            return p.w + p.y;
        case 4:
            return p.w - p.z;
        default:
            return p.z;
    }
}

uint32_t planesBeyond(const Place& p) {
    uint32_t bits = 0;
    for (int plane = 0; plane < kPlanes; ++plane) bits |= uint32_t{within(p, plane) < 0} << plane;
    return bits;
}

// Sutherland and Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974.
bool meetsView(const Corners& corners) {
    std::vector<Place> polygon(corners.begin(), corners.end()), clipped;
    for (int plane = 0; plane < kPlanes && !polygon.empty(); ++plane) {
        clipped.clear();
        for (size_t i = 0; i < polygon.size(); ++i) {
            const Place &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
            const double a = within(from, plane), b = within(to, plane);
            if (a >= 0) clipped.push_back(from);
            if ((a < 0) != (b < 0)) clipped.push_back(from + (to - from) * (a / (a - b)));
        }
        polygon.swap(clipped);
    }
    return !polygon.empty();
}

// The sign of the area on the screen, y down; right for corners behind the eye too.
bool facesAway(const Corners& p) {
    return glm::determinant(glm::dmat3(glm::dvec3(p[0].x, p[0].y, p[0].w), glm::dvec3(p[1].x, p[1].y, p[1].w),
                                       glm::dvec3(p[2].x, p[2].y, p[2].w))) >= 0;
}

// Whether a centre of a pixel lies in the triangle; of one with a corner behind the eye or of many pixels it is taken
// for granted.
bool coversSample(const Corners& p, uint32_t width, uint32_t height) {
    constexpr double kMany = 64;
    std::array<glm::dvec2, 3> at;
    for (int i = 0; i < 3; ++i) {
        if (p[i].w <= 0) return true;
        at[i] = (glm::dvec2(p[i]) / p[i].w * 0.5 + 0.5) * glm::dvec2(width, height) - 0.5;  // centres: whole numbers
    }
    const glm::dvec2 low = glm::max(glm::ceil(glm::min(glm::min(at[0], at[1]), at[2])), glm::dvec2(0));
    const glm::dvec2 high =
        glm::min(glm::floor(glm::max(glm::max(at[0], at[1]), at[2])), glm::dvec2(width - 1.0, height - 1.0));
    if (high.x - low.x > kMany || high.y - low.y > kMany) return true;
    auto side = [&](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& s) {
        return (b.x - a.x) * (s.y - a.y) - (b.y - a.y) * (s.x - a.x);
    };
    for (glm::dvec2 s = low; s.y <= high.y; ++s.y)
        for (s.x = low.x; s.x <= high.x; ++s.x) {
            const double a = side(at[0], at[1], s), b = side(at[1], at[2], s), c = side(at[2], at[0], s);
            if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) return true;
        }
    return false;
}

// Whether SLOT_VERDICT says how many triangles the case leaves out.
bool countsTriangles(const Case& c) { return c.variant->listsTriangles || storedTriangles(c) > 0; }

// One copy: where its vertices are, and the triangles of its meshlets or, without meshlets, all of them as one.
struct Tester {
    const Case& c;
    const PlanInput& input;
    const std::vector<Meshlet>& meshlets;
    const std::vector<uint32_t>& indices;

    void addTriangle(Culling& culling, const Corners& corners, bool beyond, bool away) const {
        const uint32_t own = triangleTestsOf(c);
        const bool frustum = own & TEST_FRUSTUM, back = own & TEST_BACK;
        if (frustum && beyond) ++culling.triangleFrustum.possible;
        if (frustum && beyond) return;
        if (back && away) ++culling.triangleBack.possible;
        if (back && away) return;
        if ((own & TEST_SMALL) && !coversSample(corners, input.width, input.height)) ++culling.triangleSmall.possible;
    }

    Culling operator()(std::span<const Place> places, std::span<const uint32_t> planes,
                       std::span<const uint32_t> verdicts) const {
        Culling culling;
        const bool tests = c.clusterCull != ClusterCull::off, each = countsTriangles(c);
        for (size_t m = 0; m < meshlets.size(); ++m) {
            const uint32_t verdict = tests ? verdicts[m] : VERDICT_DRAWN;
            bool allBeyond = true, allAway = true, anySeen = false;
            for (uint32_t t = 0; t < meshlets[m].triangleCount; ++t) {
                const uint32_t* v = &indices[(size_t{meshlets[m].firstTriangle} + t) * 3];
                const Corners corners{places[v[0]], places[v[1]], places[v[2]]};
                const uint32_t all = planes[v[0]] & planes[v[1]] & planes[v[2]];
                const uint32_t any = planes[v[0]] | planes[v[1]] | planes[v[2]];
                const bool beyond = all || (any && !meetsView(corners)), away = facesAway(corners);
                allBeyond = allBeyond && beyond;
                allAway = allAway && away;
                anySeen = anySeen || (!beyond && !away);
                if (each && verdict == VERDICT_DRAWN) addTriangle(culling, corners, beyond, away);
            }
            if (!tests) continue;
            const bool frustum = c.clusterTests & CLUSTER_TEST_FRUSTUM;
            if (frustum && allBeyond)
                ++culling.frustum.possible;
            else if ((c.clusterTests & CLUSTER_TEST_CONE) && allAway)
                ++culling.cone.possible;
            culling.wrong += (verdict == VERDICT_BEYOND && !allBeyond) || (verdict == VERDICT_AWAY && anySeen);
        }
        return culling;
    }
};

// Of the oracle.
void add(Culling& sum, const Culling& more) {
    sum.wrong += more.wrong;
    for (LeftOut Culling::*test : {&Culling::frustum, &Culling::cone, &Culling::triangleFrustum, &Culling::triangleBack,
                                   &Culling::triangleSmall})
        (sum.*test).possible += (more.*test).possible;
}

}  // namespace

Culling cullingOf(const Case& c, const PlanInput& input, const FrameData& frame, std::span<const uint32_t> verdicts) {
    const std::vector<uint32_t> indices = drawnIndices(input);
    std::vector<Meshlet> meshlets{{.triangleCount = static_cast<uint32_t>(indices.size() / 3)}};
    if (input.meshlets) meshlets = input.meshlets->meshlets;
    const Mesh decoded = decodedMesh(input);
    std::vector<SkinnedReference> posed(std::min(input.copies, kPhases));
    for (uint32_t phase = 0; phase < posed.size(); ++phase)
        posed[phase] = skinnedReference(input, decoded, paletteOfCopy(frame, phase));
    const Tester tester{c, input, meshlets, indices};
    const size_t workers = std::min<size_t>(coreCount(), input.copies);
    std::vector<Culling> sums(workers);
    parallelEach(workers, [&](size_t worker) {
        std::vector<Place> places(decoded.positions.size());
        std::vector<uint32_t> planes(places.size());
        for (auto copy = static_cast<uint32_t>(worker); copy < input.copies; copy += static_cast<uint32_t>(workers)) {
            const SkinnedReference& pose = posed[copy % posed.size()];
            for (size_t v = 0; v < places.size(); ++v) {
                places[v] = clipPosition(frame.constants, copy, pose.positions[v]);
                planes[v] = planesBeyond(places[v]);
            }
            const bool tests = c.clusterCull != ClusterCull::off;
            add(sums[worker],
                tester(places, planes, tests ? verdicts.subspan(copy * meshlets.size(), meshlets.size()) : verdicts));
        }
    });
    Culling culling = countVerdicts(c, input, verdicts);
    for (const Culling& sum : sums) add(culling, sum);
    return culling;
}

Culling countVerdicts(const Case& c, const PlanInput& input, std::span<const uint32_t> verdicts) {
    Culling counts;
    const bool tests = c.clusterCull != ClusterCull::off, each = countsTriangles(c);
    const size_t meshlets = input.meshlets ? input.meshlets->meshlets.size() : 0;
    const std::span<const uint32_t> counted = verdicts.subspan(tests ? meshlets * input.copies : 0);
    const size_t words = storedTriangles(c) / 4;
    for (size_t i = 0; i < meshlets * input.copies; ++i) {
        const uint32_t verdict = tests ? verdicts[i] : VERDICT_DRAWN;
        counts.meshlets += tests;
        counts.frustum.count += verdict == VERDICT_BEYOND;
        counts.cone.count += verdict == VERDICT_AWAY;
        if (verdict != VERDICT_DRAWN || !each) continue;
        const uint32_t triangles = input.meshlets->meshlets[i % meshlets].triangleCount;
        counts.triangles += triangles;
        if (words == 0) continue;
        counts.triangleBack.count += triangles;
        for (uint32_t drawn : counted.subspan(COUNTED_WORDS + i * words, (triangles + 3) / 4))
            counts.triangleBack.count -= static_cast<uint64_t>(std::popcount(drawn));
    }
    if (!c.variant->listsTriangles) return counts;
    if (meshlets == 0) counts.triangles = uint64_t{input.copies} * (input.scene->mesh.indices.size() / 3);
    counts.triangleFrustum.count = counted[0];
    counts.triangleBack.count = counted[VERDICT_TRIANGLE_AWAY - VERDICT_TRIANGLE_BEYOND];
    counts.triangleSmall.count = counted[VERDICT_TRIANGLE_SMALL - VERDICT_TRIANGLE_BEYOND];
    return counts;
}

static std::string shareText(uint64_t part, uint64_t whole, const char* things) {
    const double share = whole ? static_cast<double>(part) / static_cast<double>(whole) : 0;
    return std::format("{} of {} {} ({:.1f} %)", part, whole, things, share * 100);
}

std::vector<LegendRow> legendOf(const Case& c, const Culling& culling) {
    struct Kind {
        glm::vec3 color;
        const char *name, *what;
        LeftOut Culling::*test;
    };
    static const Kind kinds[VERDICT_COUNT] = {
        {{COLOR_DRAWN}, "green", "drawn", nullptr},
        {{COLOR_BEYOND}, "dark blue", "bounds outside of the view", &Culling::frustum},
        {{COLOR_AWAY}, "orange", "by their cones", &Culling::cone},
        {{COLOR_TRIANGLE_BEYOND}, "light blue", "corners outside of the view", &Culling::triangleFrustum},
        {{COLOR_TRIANGLE_AWAY}, "yellow", "back faces", &Culling::triangleBack},
        {{COLOR_TRIANGLE_SMALL}, "pink", "too small", &Culling::triangleSmall},
    };
    const bool each = countsTriangles(c), tests = culling.meshlets > 0;
    std::vector<LegendRow> rows;
    for (uint32_t verdict : verdictsOf(c)) {
        const Kind& kind = kinds[verdict];
        const bool ofMeshlets = verdict <= VERDICT_AWAY;
        uint64_t part = kind.test ? (culling.*kind.test).count : 0;
        std::string text = std::string(kind.what) + ": ";
        const uint64_t drawnMeshlets = culling.meshlets - culling.frustum.count - culling.cone.count;
        if (verdict == VERDICT_DRAWN && each) {
            part = culling.triangles - culling.triangleFrustum.count - culling.triangleBack.count -
                   culling.triangleSmall.count;
            text += shareText(part, culling.triangles, "triangles");
            if (tests) text += ", of " + shareText(drawnMeshlets, culling.meshlets, "meshlets");
        } else {
            if (verdict == VERDICT_DRAWN) part = drawnMeshlets;
            text += ofMeshlets ? shareText(part, culling.meshlets, "meshlets")
                               : shareText(part, culling.triangles, "triangles");
        }
        rows.push_back({kind.color, kind.name, std::move(text)});
    }
    return rows;
}

std::vector<char> verticesLeftOut(const Case& c, const PlanInput& input, std::span<const uint32_t> verdicts) {
    // A pass of compute-cull skins all vertices.
    if (c.clusterCull == ClusterCull::off || c.variant->listsTriangles || c.view == View::culled) return {};
    const size_t vertices = input.encoded->vertexCount, meshlets = input.meshlets->meshlets.size();
    std::vector<char> left(2 * vertices, 1);
    for (size_t half = 0; half < 2; ++half)
        for (size_t m = 0; m < meshlets; ++m) {
            if (verdicts[(half ? input.copies - 1 : 0) * meshlets + m] != VERDICT_DRAWN) continue;
            const Meshlet& meshlet = input.meshlets->meshlets[m];
            for (uint32_t i = 0; i < meshlet.vertexCount; ++i)
                left[half * vertices + input.meshlets->vertices[meshlet.firstVertex + i]] = 0;
        }
    return left;
}

}  // namespace skinbench
