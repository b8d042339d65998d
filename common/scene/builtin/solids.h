// Closed solids with rounded edges, meshed as near-square quads: the parts of machines.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "common/scene/scene.h"

namespace skinbench::builtin {

enum class Axis { x, y, z };

struct Solid {
    enum class Kind { box, lathe } kind = Kind::box;
    uint32_t joint = 0;
    glm::vec3 centre{0};
    glm::vec3 half{0};          // box: half the size
    Axis axis = Axis::y;        // lathe: a cone frustum about this axis
    float bottom = 0, top = 0;  // lathe: radii at the two ends
    float length = 0;           // lathe: half
    float bevel = 0;            // radius of the rounded edges; as large as the box gives a sphere or a capsule
    bool detail = false;        // left out where the spacing is too coarse for it
};

uint32_t countVertices(const Solid& solid, float spacing);

// Appends the solid, every vertex bound to its joint alone.
void addSolid(const Solid& solid, float spacing, Mesh& mesh);

}  // namespace skinbench::builtin
