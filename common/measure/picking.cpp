#include "common/measure/picking.h"

#include <algorithm>
#include <format>
#include <limits>
#include <set>

#include "common/measure/verify.h"
#include "common/plans/plan_parts.h"

namespace skinbench {
namespace {

struct Hit {
    double depth = std::numeric_limits<double>::max();
    uint32_t copy = 0;
    size_t triangle = 0;
    size_t corner = 0;  // the one that is nearest on the screen
};

// A vertex on the screen: x and y from 0 to 1, z the depth; w not above 0: behind the eye.
glm::dvec4 onScreen(const FrameConstants& constants, uint32_t copy, const glm::dvec3& position) {
    const glm::dvec4 clip = clipPosition(constants, copy, position);
    if (clip.w <= 0) return clip;
    return {(clip.x / clip.w + 1) / 2, (clip.y / clip.w + 1) / 2, clip.z / clip.w, clip.w};
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

void hitTriangle(const std::array<glm::dvec4, 3>& corners, const glm::dvec2& at, Hit& hit, uint32_t copy,
                 size_t triangle) {
    const glm::dvec2 a(corners[0]), b(corners[1]), c(corners[2]);
    const double area = cross(b - a, c - a);
    if (area == 0) return;
    const glm::dvec3 share(cross(b - at, c - at) / area, cross(c - at, a - at) / area, cross(a - at, b - at) / area);
    if (share.x < 0 || share.y < 0 || share.z < 0) return;
    const double depth = share.x * corners[0].z + share.y * corners[1].z + share.z * corners[2].z;
    if (depth < 0 || depth > 1 || depth >= hit.depth) return;
    const size_t corner = share.x >= share.y && share.x >= share.z ? 0 : share.y >= share.z ? 1 : 2;
    hit = {depth, copy, triangle, corner};
}

std::optional<Hit> findHit(const PlanInput& input, const FrameConstants& constants,
                           const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& sources,
                           const FrameData& frame, const glm::dvec2& at, bool posed) {
    const Mesh& mesh = input.scene->mesh;
    Hit hit;
    std::map<uint32_t, SkinnedReference> phases;
    std::vector<glm::dvec4> screen(mesh.positions.size());
    for (uint32_t copy = 0; copy < input.copies; ++copy) {
        SkinnedReference& skinned = phases[copy % kPhases];
        if (skinned.positions.empty()) {
            const Palette& palette = paletteOfCopy(frame, copy);
            if (posed)
                skinned = skinnedReference(input, mesh, palette);
            else
                skinned.positions.assign(mesh.positions.begin(), mesh.positions.end());
        }
        for (size_t v = 0; v < screen.size(); ++v) screen[v] = onScreen(constants, copy, skinned.positions[v]);
        for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
            const std::array corners{screen[sources[triangles[i]]], screen[sources[triangles[i + 1]]],
                                     screen[sources[triangles[i + 2]]]};
            if (corners[0].w > 0 && corners[1].w > 0 && corners[2].w > 0) hitTriangle(corners, at, hit, copy, i / 3);
        }
    }
    return hit.depth <= 1 ? std::optional(hit) : std::nullopt;
}

std::string influencesText(const Influences& influences) {
    std::string text;
    for (int k = 0; k < kMaxInfluences; ++k)
        if (influences.weights[k] != 0)
            text += std::format("{}{} x {:.4f}", text.empty() ? "" : ", ", influences.joints[k], influences.weights[k]);
    return text;
}

size_t meshletOf(const MeshletMesh& mesh, size_t triangle) {
    const auto after =
        std::ranges::upper_bound(mesh.meshlets, static_cast<uint32_t>(triangle), {}, &Meshlet::firstTriangle);
    return static_cast<size_t>(after - mesh.meshlets.begin()) - 1;
}

// What the test of a meshlet said.
std::string verdictText(uint32_t verdict) {
    return verdict == VERDICT_DRAWN    ? "drawn: no test of its bounds leaves it out"
           : verdict == VERDICT_BEYOND ? "left out: its bounds are outside of the view"
                                       : "left out: the cone of its normals faces away";
}

std::string meshletText(const PlanInput& input, const std::vector<uint32_t>& sources, size_t number) {
    const MeshletMesh& mesh = *input.meshlets;
    const Meshlet& meshlet = mesh.meshlets[number];
    std::set<uint32_t> joints;
    std::set<std::vector<uint32_t>> tuples;
    for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
        const Influences& own = input.scene->mesh.influences[sources[mesh.vertices[meshlet.firstVertex + i]]];
        std::vector<uint32_t> tuple;
        for (int k = 0; k < kMaxInfluences; ++k)
            if (own.weights[k] != 0) tuple.push_back(own.joints[k]);
        joints.insert(tuple.begin(), tuple.end());
        tuples.insert(tuple);
    }
    std::string text =
        std::format("meshlet {} of {}: {} vertices, {} triangles, {} joints, {} tuples", number, mesh.meshlets.size(),
                    meshlet.vertexCount, meshlet.triangleCount, joints.size(), tuples.size());
    if (number < input.encoded->blendBytes.size())
        text += std::format(", {} bits of blend data a vertex", input.encoded->blendBytes[number] * 8);
    if (input.records && input.records->commonRecords > 0)
        text += number < input.records->commonMeshlets ? ", one joint list for all" : ", joint ids in every vertex";
    return text;
}

}  // namespace

std::vector<std::string> pickLines(const Case& c, const PlanInput& input, const FrameData& frame, glm::vec2 at,
                                   std::span<const uint32_t> verdicts) {
    const std::vector<uint32_t> sources = sourcesOf(input);
    const Mesh& drawn = input.records ? input.records->mesh : input.scene->mesh;
    const std::vector<uint32_t> triangles = input.meshlets ? triangleList(*input.meshlets) : drawn.indices;
    FrameConstants constants = frame.constants;
    if (c.view == View::culled) constants.viewProjection = constants.overview;
    const auto hit = findHit(input, constants, triangles, sources, frame, at, posesVertices(c));
    if (!hit) return {};
    const uint32_t vertex = triangles[hit->triangle * 3 + hit->corner], source = sources[vertex];
    const Mesh& mesh = input.scene->mesh;
    const Mesh decoded = decodedMesh(input);
    const glm::vec3 p = mesh.positions[source], q = decoded.positions[vertex];
    std::vector<std::string> lines{std::format("copy {}, triangle {}", hit->copy, hit->triangle)};
    const size_t meshlet = input.meshlets ? meshletOf(*input.meshlets, hit->triangle) : 0;
    if (input.meshlets) lines.push_back(meshletText(input, sources, meshlet));
    if (c.clusterCull != ClusterCull::off && !verdicts.empty())
        lines.push_back("  " + verdictText(verdicts[hit->copy * input.meshlets->meshlets.size() + meshlet]));
    lines.push_back(std::format("codec {}: {} bytes of vertices in all", c.codec->name,
                                input.encoded->vertices ? input.encoded->vertices->size() : 0));
    lines.push_back(std::format("vertex {} at ({:.5g}, {:.5g}, {:.5g})", vertex, p.x, p.y, p.z));
    lines.push_back(
        std::format("  decoded ({:.5g}, {:.5g}, {:.5g}), off by {:.2g}", q.x, q.y, q.z, glm::distance(p, q)));
    lines.push_back("  joint x weight " + influencesText(mesh.influences[source]));
    if (input.encoded->blendText) lines.push_back("  stored as " + input.encoded->blendText(vertex, meshlet));
    lines.push_back("  decoded " + influencesText(decoded.influences[vertex]));
    return lines;
}

}  // namespace skinbench
