// Joints and clips of the built-in characters. At rest no joint is rotated, so that local axes are the model's axes:
// x to the character's left, y up, z forward.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/scene/builtin/exact.h"
#include "common/scene/scene.h"

namespace skinbench::builtin {

struct Rig {
    Skeleton skeleton;                 // one joint a node, in the same order
    std::vector<glm::vec3> positions;  // at rest, by joint

    uint32_t add(const std::string& name, int32_t parent, glm::vec3 position);
    uint32_t find(const std::string& name) const;  // the joint must exist
};

// Values over one cycle of a looping clip; phase runs from 0 to 1.
using RotationCycle = std::function<glm::quat(double phase)>;
using OffsetCycle = std::function<glm::vec3(double phase)>;

struct ClipMaker {
    const Rig& rig;
    Clip clip;
    int keys = 16;  // per cycle; the last repeats the first

    ClipMaker(const Rig& theRig, const std::string& name, float duration) : rig(theRig) {
        clip.name = name;
        clip.duration = duration;
    }
    void rotate(const std::string& joint, const RotationCycle& cycle,
                Interpolation interpolation = Interpolation::linear);
    // Offset from the rest position.
    void move(const std::string& joint, const OffsetCycle& cycle, Interpolation interpolation = Interpolation::linear);
    void scale(const std::string& joint, const OffsetCycle& cycle, Interpolation interpolation = Interpolation::linear);

private:
    void add(uint32_t node, ChannelPath path, Interpolation interpolation, std::vector<glm::vec4> cycle);
};

// "LeftHand" on the side of +x, else "RightHand".
inline std::string sided(float side, const std::string& name) { return (side > 0 ? "Left" : "Right") + name; }

inline constexpr glm::vec3 kLeft{1, 0, 0}, kUp{0, 1, 0}, kForward{0, 0, 1};

}  // namespace skinbench::builtin
