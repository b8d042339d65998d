#include "common/meshlets/cluster_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include <glm/gtc/packing.hpp>

namespace skinbench {
namespace {

// A bound in single precision of what was computed in double precision.
float roundedUp(double value) {
    const auto rounded = static_cast<float>(value);
    return rounded < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
}

glm::dvec3 centerOfBox(const std::vector<glm::dvec3>& points, glm::dvec3& extent) {
    glm::dvec3 low = points.front(), high = low;
    for (const glm::dvec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
    extent = (high - low) * 0.5;
    return (low + high) * 0.5;
}

// Bădoiu and Clarkson, "Smaller core-sets for balls", SODA 2003: from the center of the box towards the farthest point,
// in steps that shrink.
ClusterPart sphereAround(const std::vector<glm::dvec3>& points) {
    constexpr int kSteps = 24;
    glm::dvec3 extent, center = centerOfBox(points, extent), best = center;
    double least = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kSteps; ++step) {
        glm::dvec3 farthest = center;
        for (const glm::dvec3& p : points)
            if (glm::distance(p, center) > glm::distance(farthest, center)) farthest = p;
        const double radius = glm::distance(farthest, center);
        if (radius < least) least = radius, best = center;
        center += (farthest - center) / (step + 2.0);
    }
    ClusterPart part;
    part.center = glm::vec3(best);
    for (const glm::dvec3& p : points)
        part.radius = std::max(part.radius, roundedUp(glm::distance(p, glm::dvec3(part.center))));
    return part;
}

ClusterPart boxAround(const std::vector<glm::dvec3>& points) {
    glm::dvec3 extent;
    ClusterPart part;
    part.center = glm::vec3(centerOfBox(points, extent));
    for (const glm::dvec3& p : points)
        for (int axis = 0; axis < 3; ++axis)
            part.extent[axis] = std::max(part.extent[axis], roundedUp(std::abs(p[axis] - double{part.center[axis]})));
    return part;
}

using PointsOfJoints = std::map<uint32_t, std::vector<glm::dvec3>>;

void addVertex(PointsOfJoints& points, const Mesh& mesh, uint32_t vertex) {
    const Influences& own = mesh.influences[vertex];
    for (int k = 0; k < kMaxInfluences; ++k)
        if (own.weights[k] > 0 && own.joints[k] != kNoJoint) points[own.joints[k]].emplace_back(mesh.positions[vertex]);
}

double weightErrorOf(const Influences& own) {
    double sum = 0;
    for (float weight : own.weights) sum += weight;
    return std::abs(sum - 1);
}

// Whether one joint carries the whole weight of the vertex.
bool isRigid(const Influences& own) {
    constexpr double kRounding = 1e-5;
    int carrying = 0;
    for (float weight : own.weights) carrying += weight > 0;
    return carrying == 1 && weightErrorOf(own) <= kRounding;
}

// Twice the triangle's area as a vector along its normal, and its longest edge; front faces are counter-clockwise.
struct Face {
    glm::dvec3 normal{0};
    double longest = 0;
};

using Corners = std::array<glm::dvec3, 3>;

Corners cornersOf(const Mesh& mesh, const MeshletMesh& meshlets, const Meshlet& meshlet, uint32_t triangle) {
    Corners p;
    for (int corner = 0; corner < 3; ++corner)
        p[corner] = mesh.positions[meshlets.vertices[meshlet.firstVertex +
                                                     meshlets.triangles[meshlet.firstTriangle + triangle][corner]]];
    return p;
}

Face faceOf(const Corners& p) {
    return {glm::cross(p[1] - p[0], p[2] - p[0]),
            std::max({glm::distance(p[0], p[1]), glm::distance(p[1], p[2]), glm::distance(p[2], p[0])})};
}

// A triangle with two corners in one place is never drawn; one whose corners lie in a line may be, by rounding.
bool isDrawable(const Corners& p) { return p[0] != p[1] && p[1] != p[2] && p[2] != p[0]; }

ClusterCone coneOf(const Mesh& mesh, const MeshletMesh& meshlets, const Meshlet& meshlet,
                   const std::vector<glm::dvec3>& points) {
    ClusterCone cone;
    glm::dvec3 sum(0);
    double altitude = std::numeric_limits<double>::infinity();
    std::vector<glm::dvec3> normals;
    for (uint32_t t = 0; t < meshlet.triangleCount; ++t) {
        const Corners corners = cornersOf(mesh, meshlets, meshlet, t);
        if (!isDrawable(corners)) continue;
        const Face face = faceOf(corners);
        const double length = glm::length(face.normal);
        altitude = std::min(altitude, length / face.longest);
        if (length == 0) return cone;
        normals.push_back(face.normal / length);
        sum += normals.back();
    }
    if (normals.empty() || glm::length(sum) < 1e-3) return cone;
    cone.axis = glm::vec3(glm::normalize(sum));
    double cosine = 1;
    for (const glm::dvec3& normal : normals) cosine = std::min(cosine, glm::dot(normal, glm::dvec3(cone.axis)));
    if (cosine <= 0.05) return cone;
    const ClusterPart sphere = sphereAround(points);
    cone.center = sphere.center;
    cone.radius = sphere.radius;
    cone.cosine = static_cast<float>(cosine * (1 - 1e-6));
    cone.altitude = static_cast<float>(altitude * (1 - 1e-6));
    return cone;
}

void addParts(ClusterSet& set, const PointsOfJoints& points, ClusterBounds bounds) {
    std::vector<glm::dvec3> all;
    if (bounds == ClusterBounds::oneSphere)
        for (const auto& [joint, moved] : points) all.insert(all.end(), moved.begin(), moved.end());
    const ClusterPart whole = all.empty() ? ClusterPart{} : sphereAround(all);
    for (const auto& [joint, moved] : points) {
        set.parts.push_back(bounds == ClusterBounds::oneSphere    ? whole
                            : bounds == ClusterBounds::jointBoxes ? boxAround(moved)
                                                                  : sphereAround(moved));
        set.parts.back().joint = joint;
    }
}

}  // namespace

ClusterSet boundClusters(const Mesh& mesh, const MeshletMesh& meshlets, ClusterBounds bounds) {
    ClusterSet set;
    PointsOfJoints everywhere;
    for (const Meshlet& meshlet : meshlets.meshlets) {
        Cluster& cluster = set.clusters.emplace_back();
        PointsOfJoints points;
        bool rigid = true;
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
            const uint32_t vertex = meshlets.vertices[meshlet.firstVertex + i];
            addVertex(points, mesh, vertex);
            if (bounds == ClusterBounds::instance) addVertex(everywhere, mesh, vertex);
            rigid = rigid && isRigid(mesh.influences[vertex]);
            set.weightError = std::max(set.weightError, weightErrorOf(mesh.influences[vertex]));
        }
        if (rigid && points.size() == 1) {
            cluster.cone = coneOf(mesh, meshlets, meshlet, points.begin()->second);
            cluster.cone.joint = points.begin()->first;
        }
        if (bounds == ClusterBounds::instance || points.size() > kMostClusterJoints) continue;
        cluster.firstPart = static_cast<uint32_t>(set.parts.size());
        cluster.partCount = static_cast<uint32_t>(points.size());
        addParts(set, points, bounds);
    }
    if (bounds == ClusterBounds::instance) addParts(set, everywhere, ClusterBounds::jointBoxes);
    return set;
}

// The half float that is not below `value`, which is not above 1.
static uint32_t halfUp(float value) {
    uint16_t half = glm::packHalf1x16(value);
    while (glm::unpackHalf1x16(half) < value) ++half;
    return half;
}

PackedClusters packClusters(const ClusterSet& set, const MeshletMesh& meshlets, ClusterBounds bounds) {
    PackedClusters packed;
    auto put = [](std::vector<uint32_t>& words, const glm::vec3& v, uint32_t last) {
        for (int axis = 0; axis < 3; ++axis) words.push_back(std::bit_cast<uint32_t>(v[axis]));
        words.push_back(last);
    };
    for (size_t i = 0; i < set.clusters.size(); ++i) {
        const Cluster& cluster = set.clusters[i];
        const Meshlet& meshlet = meshlets.meshlets[i];
        for (uint32_t word : {cluster.firstPart, cluster.partCount, meshlet.firstTriangle,
                              cluster.cone.joint << 16 | meshlet.triangleCount})
            packed.clusters.push_back(word);
    }
    for (const Cluster& cluster : set.clusters) {
        const ClusterCone& cone = cluster.cone;
        put(packed.clusters, cone.axis * cone.cosine, std::bit_cast<uint32_t>(cone.altitude));
        put(packed.clusters, cone.center, std::bit_cast<uint32_t>(cone.radius));
    }
    packed.scale = std::numeric_limits<float>::min();
    for (const ClusterPart& part : set.parts) packed.scale = std::max(packed.scale, part.radius);
    const bool boxes = bounds == ClusterBounds::jointBoxes || bounds == ClusterBounds::instance;
    for (const ClusterPart& part : set.parts) {
        put(packed.parts, part.center, part.joint << 16 | (boxes ? 0 : halfUp(part.radius / packed.scale)));
        if (boxes) put(packed.parts, part.extent, 0);
    }
    return packed;
}

}  // namespace skinbench
