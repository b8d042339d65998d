#include "common/scene/builtin/field.h"

#include <algorithm>
#include <cmath>

namespace skinbench::builtin {

namespace {

float radiusAt(const Segment& s, float t) {
    return s.radius[0] + t * (s.radius[1] + t * (s.radius[2] + t * s.radius[3]));
}

float radiusSlope(const Segment& s, float t) { return s.radius[1] + t * (2 * s.radius[2] + t * 3 * s.radius[3]); }

// 1 - cosine of the angle between the pieces that meet at node i.
float bend(const std::vector<ShapeNode>& nodes, size_t i) {
    if (i == 0 || i + 1 >= nodes.size()) return 0;
    const glm::vec3 in = nodes[i].position - nodes[i - 1].position, out = nodes[i + 1].position - nodes[i].position;
    return 1 - glm::dot(in, out) / std::sqrt(glm::dot(in, in) * glm::dot(out, out));
}

// A Catmull-Rom curve through the nodes, so that bends leave no crease.
std::vector<ShapeNode> refine(const std::vector<ShapeNode>& nodes) {
    if (nodes.size() < 3) return nodes;
    std::vector<ShapeNode> result;
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
        const ShapeNode &a = nodes[i], &b = nodes[i + 1];
        const ShapeNode &before = nodes[i > 0 ? i - 1 : 0], &after = nodes[std::min(i + 2, nodes.size() - 1)];
        const float most = std::max(bend(nodes, i), bend(nodes, i + 1));
        const int pieces = most < 0.0006f ? 1 : most < 0.01f ? 2 : 3;  // 2 and 8 degrees
        for (int k = 0; k < pieces; ++k) {
            const float t = float(k) / float(pieces);
            const auto curve = [t](auto p0, auto p1, auto p2, auto p3) {
                return p1 + 0.5f * t *
                                ((p2 - p0) +
                                 t * ((2.0f * p0 - 5.0f * p1 + 4.0f * p2 - p3) + t * (3.0f * (p1 - p2) + p3 - p0)));
            };
            result.push_back({curve(before.position, a.position, b.position, after.position),
                              curve(before.radius, a.radius, b.radius, after.radius)});
        }
    }
    result.push_back(nodes.back());
    return result;
}

// Hermite slopes per unit length: flat at both ends of the chain, so that the caps join without a crease.
std::vector<float> radiusSlopes(const Chain& chain, std::span<const float> radii) {
    std::vector<float> slopes(radii.size(), 0.0f);
    for (size_t i = 1; i + 1 < radii.size(); ++i) {
        const glm::vec3 in = chain.nodes[i].position - chain.nodes[i - 1].position;
        const glm::vec3 out = chain.nodes[i + 1].position - chain.nodes[i].position;
        const float lengths = std::sqrt(glm::dot(in, in)) + std::sqrt(glm::dot(out, out));
        slopes[i] = (radii[i + 1] - radii[i - 1]) / lengths;
    }
    return slopes;
}

// The radius' derivative is a quadratic in t: largest at an end or at its vertex.
float steepest(const Segment& s) {
    float slope = std::max(std::fabs(radiusSlope(s, 0)), std::fabs(radiusSlope(s, 1)));
    if (s.radius[3] != 0) {
        const float vertex = -s.radius[2] / (3 * s.radius[3]);
        if (vertex > 0 && vertex < 1) slope = std::max(slope, std::fabs(radiusSlope(s, vertex)));
    }
    return slope;
}

Segment makeSegment(const Chain& chain, size_t i, std::span<const float> radii, std::span<const float> slopes,
                    float blend) {
    Segment s;
    const size_t next = std::min(i + 1, chain.nodes.size() - 1);
    s.start = chain.nodes[i].position;
    s.axis = chain.nodes[next].position - s.start;
    const float length2 = glm::dot(s.axis, s.axis);
    s.length = std::sqrt(length2);
    s.inverseLength2 = length2 > 0 ? 1 / length2 : 0;
    const float m0 = slopes[i] * s.length, m1 = slopes[next] * s.length, rise = radii[next] - radii[i];
    s.radius = {radii[i], m0, 3 * rise - 2 * m0 - m1, m0 + m1 - 2 * rise};
    if (chain.wide > 1) {
        const glm::vec3 across = chain.wideAxis - s.axis * (glm::dot(chain.wideAxis, s.axis) * s.inverseLength2);
        s.wideAxis = across / std::sqrt(glm::dot(across, across));
        s.squeeze = 1 - 1 / (chain.wide * chain.wide);
    }
    s.lipschitz = s.length > 0 ? 1 + steepest(s) / s.length : 1;
    s.inverseBlend = 1 / blend;
    s.reach = std::max(blend, chain.skinBlend);
    return s;
}

}  // namespace

Field makeField(const Body& body, float spacing) {
    const float smallestRadius = 0.75f * spacing, smallestBlend = 1.6f * spacing;
    Field field;
    field.min = glm::vec3(1e9f);
    field.max = glm::vec3(-1e9f);
    for (size_t c = 0; c < body.chains.size(); ++c) {
        Chain chain = body.chains[c];
        chain.nodes = refine(chain.nodes);
        std::vector<float> radii;
        for (const ShapeNode& node : chain.nodes) {
            radii.push_back(std::max(node.radius, smallestRadius));
            const glm::vec3 size(radii.back() * chain.wide + std::max(chain.blend, smallestBlend));
            field.min = glm::min(field.min, node.position - size);
            field.max = glm::max(field.max, node.position + size);
        }
        const std::vector<float> slopes = radiusSlopes(chain, radii);
        float along = 0;
        for (size_t i = 0; i < std::max<size_t>(chain.nodes.size() - 1, 1); ++i) {
            Segment segment = makeSegment(chain, i, radii, slopes, std::max(chain.blend, smallestBlend));
            segment.chain = uint16_t(c);
            segment.alongStart = along;
            along += segment.length;
            field.segments.push_back(segment);
        }
    }
    return field;
}

namespace {

struct AxisPoint {
    float distance2 = 1e18f;
    float t = 0;
};

AxisPoint nearestOnAxis(const Segment& s, glm::vec3 p) {
    glm::vec3 q = p - s.start;
    const float t = std::clamp(glm::dot(q, s.axis) * s.inverseLength2, 0.0f, 1.0f);
    q -= s.axis * t;
    const float side = glm::dot(q, s.wideAxis);
    return {std::max(glm::dot(q, q) - s.squeeze * side * side, 0.0f), t};
}

NearestPoint withRadius(const Segment& s, AxisPoint at) {
    const float axisDistance = std::sqrt(at.distance2);
    return {axisDistance, axisDistance - radiusAt(s, at.t), at.t};
}

struct ChainPoint {
    const Segment* segment = nullptr;
    NearestPoint at;
};

// The chain that list[i] belongs to; `i` moves on to the next chain.
ChainPoint nearestOnChain(const Field& field, SegmentList list, size_t& i, glm::vec3 p) {
    const Segment* closest = &field.segments[list[i]];
    AxisPoint at;
    for (const uint16_t chain = closest->chain; i < list.size() && field.segments[list[i]].chain == chain; ++i) {
        const AxisPoint candidate = nearestOnAxis(field.segments[list[i]], p);
        if (candidate.distance2 >= at.distance2) continue;
        at = candidate;
        closest = &field.segments[list[i]];
    }
    return {closest, withRadius(*closest, at)};
}

}  // namespace

NearestPoint nearest(const Segment& s, glm::vec3 p) { return withRadius(s, nearestOnAxis(s, p)); }

float density(const Field& field, SegmentList list, glm::vec3 p) {
    float sum = 0;
    for (size_t i = 0; i < list.size();) {
        const ChainPoint chain = nearestOnChain(field, list, i, p);
        const float g = 1 - chain.at.distance * chain.segment->inverseBlend;
        if (g > 0) sum += g * g;
    }
    return sum;
}

bool isInside(const Field& field, SegmentList list, glm::vec3 p) { return density(field, list, p) >= 1; }

namespace {

glm::vec3 distanceGradient(const Segment& s, glm::vec3 p, NearestPoint at) {
    const glm::vec3 q = p - s.start - s.axis * at.t;
    const glm::vec3 stretched = q - s.wideAxis * (s.squeeze * glm::dot(q, s.wideAxis));
    const float norm = std::max(at.axisDistance, 1e-6f);
    const glm::vec3 gradient = stretched / norm;
    // Kept where t is clamped: at an inner node the next segment goes on with this slope, at the chain's ends it is 0.
    return gradient - s.axis * (radiusSlope(s, at.t) * s.inverseLength2);
}

}  // namespace

Sample sampleField(const Field& field, SegmentList list, glm::vec3 p) {
    float sum = 0;
    glm::vec3 gradient(0);  // of sum / 2
    for (size_t i = 0; i < list.size();) {
        const ChainPoint chain = nearestOnChain(field, list, i, p);
        const float g = 1 - chain.at.distance * chain.segment->inverseBlend;
        if (g <= 0) continue;
        sum += g * g;
        gradient -= distanceGradient(*chain.segment, p, chain.at) * (g * chain.segment->inverseBlend);
    }
    const float root = std::sqrt(sum);
    return {1 - root, root > 0 ? gradient / -root : glm::vec3(0)};
}

}  // namespace skinbench::builtin
