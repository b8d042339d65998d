// Where copies stand and how they are looked at. The same constants go to every route.
#pragma once

#include <string>
#include <vector>

#include "common/frame/backend.h"
#include "common/scene/pose.h"

namespace skinbench {

// crowd:  every copy is in the view.
// half:   the view is half of crowd's area: about half of the copies lie outside, and many are cut by its edges.
// inside: from the middle of the crowd along its rows, or towards their end where they are short: near copies are
//         larger than the view, of a large crowd most are outside.
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

// Where the eye is and how it looks, in units of the scene.
struct Look {
    glm::vec3 eye{0}, target{0};
    float fieldOfView = 0;  // vertical, radians
    float nearest = 0, farthest = 0;
};

// That of Framing::camera; of the main view.
Look lookOf(const Framing& framing);

// From the right and above, with every copy of every camera inside, as large as the image allows.
Look overviewOf(const Framing& framing);

// How an eye has moved from where it usually is; as it is made: not at all.
struct CameraMove {
    float turn = 0, pitch = 0;  // degrees around the target; positive: to the right, up
    float zoom = 1;             // distance to the target, over the usual one
    glm::vec3 moved{0};         // of eye and target, in usual distances
    bool operator==(const CameraMove&) const = default;
};
Look movedLook(const Look& usual, const CameraMove& move);

// Turns by shares of the image's height that a pointer was dragged by: around the target, or, flying, around the eye.
CameraMove dragged(CameraMove move, const Look& usual, const glm::vec2& drag, bool flying);

// Goes along the view, in usual distances. x: right, y: up, z: ahead.
CameraMove gone(CameraMove move, const Look& usual, const glm::vec3& by);

// Copies fill a grid of about the image's shape; row 0 of the image is its top. The camera `crowd` has it centred and
// just inside the view. The other views look at the same grid from other sides, those of `crowd` and `close` with every
// copy inside. `move` is how all of them moved, `overview` how overviewOf() did. `frame` is the number that
// FrameConstants carries.
FrameConstants frameConstants(const Framing& framing, uint32_t frame, const CameraMove& move = {},
                              const CameraMove& overview = {});

}  // namespace skinbench
