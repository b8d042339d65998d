// The implicit function of a body (surface.h), cut into segments that a block of the grid can list.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/builtin/surface.h"

namespace skinbench::builtin {

// One piece of a chain: a tapered tube whose radius is a cubic in t = 0..1.
struct Segment {
    glm::vec3 start{0};
    glm::vec3 axis{0};
    float inverseLength2 = 0;
    std::array<float, 4> radius{};
    glm::vec3 wideAxis{0};
    float squeeze = 0;  // 1 - 1 / wide^2
    float lipschitz = 1;
    float inverseBlend = 1;
    float reach = 0;       // beyond this distance neither shape nor skin sees the segment
    float alongStart = 0;  // arc length from the chain's first node
    float length = 0;
    uint16_t chain = 0;
};

struct Field {
    std::vector<Segment> segments;  // by chain
    glm::vec3 min{0};
    glm::vec3 max{0};
};

// A chain's distance is that of the segment whose axis is nearest, in the metric of its ellipses: taking the smallest
// distance instead would leave rings where the radius changes fast.
struct NearestPoint {
    float axisDistance = 0;
    float distance = 0;  // axisDistance less the radius
    float t = 0;
};

struct Sample {
    float value = 0;  // 1 - sqrt(F): negative inside
    glm::vec3 gradient{0};
};

using SegmentList = std::span<const uint16_t>;

// Radii and fillets that a grid of this spacing could not see are raised.
Field makeField(const Body& body, float spacing);

NearestPoint nearest(const Segment& segment, glm::vec3 p);

// F(p) >= 1
bool isInside(const Field& field, SegmentList list, glm::vec3 p);
float density(const Field& field, SegmentList list, glm::vec3 p);
Sample sampleField(const Field& field, SegmentList list, glm::vec3 p);

}  // namespace skinbench::builtin
