// The built-in characters: each makes a whole scene but for its name.
#pragma once

#include "common/scene/scene.h"

namespace skinbench::builtin {

Scene makeBiped(uint32_t vertices, uint32_t seed);
Scene makeRobot(uint32_t vertices, uint32_t seed);
Scene makeCreature(uint32_t vertices, uint32_t seed);

// The biped with four influences that weigh something for every vertex, which no test of weights can spare.
Scene makeBlended(uint32_t vertices, uint32_t seed);

}  // namespace skinbench::builtin
