// Where copies stand and how they are looked at. The same constants go to every route.
#pragma once

#include "common/frame/backend.h"
#include "common/scene/pose.h"

namespace skinbench {

struct Framing {
    Bounds bounds;  // of one posed copy
    uint32_t copies = 1;
    uint32_t width = 1920;
    uint32_t height = 1080;
    float yaw = 0;  // degrees around y: 0 looks at the character's front
};

// Copies fill a grid of about the image's shape, centred and just inside the view; row 0 of the image is its top.
// `frame` is the number that FrameConstants carries.
FrameConstants frameConstants(const Framing& framing, uint32_t frame);

}  // namespace skinbench
