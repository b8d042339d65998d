// Organic surfaces: a body is a union of chains, tubes of varying radius around polylines, with a fillet where chains
// meet. Its surface is the set of points where
//
//   F(p) = sum over chains of max(0, 1 - d_c(p) / blend_c)^2 = 1,
//
// d_c being the distance to the chain. A chain that is farther than its blend radius adds exactly nothing, so any
// superset of the chains near a point gives the same bits.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "common/scene/scene.h"

namespace skinbench::builtin {

struct ShapeNode {
    glm::vec3 position{0};
    float radius = 0;
};

// A joint takes over from the one before it where the chain passes it, over `softness` units to either side.
struct ChainJoint {
    uint32_t joint = 0;
    float softness = 0;
};

struct Chain {
    std::vector<ShapeNode> nodes;
    float blend = 0;      // fillet radius against the other chains
    float skinBlend = 0;  // distance within which the chain's joints pull at other chains' skin
    glm::vec3 wideAxis{1, 0, 0};
    float wide = 1;  // cross-sections are ellipses, this much wider (>= 1) along wideAxis
    std::vector<ChainJoint> joints;
};

struct Body {
    std::vector<Chain> chains;
    std::vector<glm::vec3> jointPositions;  // by joint
    int influences = 4;                     // kept per vertex
    float smallestWeight = 0.02f;           // less than this is dropped
};

// Positions, normals, influences and indices; uvs stay empty. About `vertices` vertices of about uniform spacing.
Mesh meshBody(const Body& body, uint32_t vertices);

}  // namespace skinbench::builtin
