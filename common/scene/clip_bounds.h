// The space that a clip needs, so that an animated character stays in view.
#pragma once

#include "common/scene/pose.h"

namespace skinbench {

// Of the skinned vertices, exact at each moment that is looked at: all key times of the clip, and sixty moments a
// second from its beginning on. Of more than 4,096 moments, or of more than 2^25 nodes in all of them, evenly chosen
// ones. Of the rest pose for a null clip. Weights must be clean (prepareScene).
Bounds clipBounds(const Scene& scene, const Clip* clip);

}  // namespace skinbench
