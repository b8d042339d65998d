// Where copies stand and how they are looked at. The same constants go to every route.
#pragma once

#include <string>
#include <vector>

#include "common/frame/backend.h"
#include "common/scene/pose.h"

namespace skinbench {

// crowd:  every copy is in the view.
// half:   the view is half of crowd's area: about half of the copies lie outside, and many are cut by its edges.
// inside: from the middle of the crowd along its rows: near copies are larger than the view, most are outside.
// close:  all copies at one place, which fills the view.
enum class Camera { crowd, half, inside, close };

// The words of --camera, in the order of the enumeration.
const std::vector<std::string>& cameraNames();

struct Framing {
    Bounds bounds;  // of one posed copy
    uint32_t copies = 1;
    uint32_t width = 1920;
    uint32_t height = 1080;
    float yaw = 0;  // degrees around y: 0 looks at the character's front
    Camera camera = Camera::crowd;
    float characterPixels = 0;  // of crowd: how tall a character is drawn, whether or not all are in view then; 0: as
                                // large as the view allows
};

// Copies fill a grid of about the image's shape; row 0 of the image is its top. The camera `crowd` has it centred and
// just inside the view. The other views look at the same grid from other sides, those of `crowd` and `close` with every
// copy inside. `frame` is the number that FrameConstants carries.
FrameConstants frameConstants(const Framing& framing, uint32_t frame);

}  // namespace skinbench
