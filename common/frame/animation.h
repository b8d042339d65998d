// Moving pictures as one file: animated WebP, where the library is there.
#pragma once

#include <memory>
#include <string>

#include "common/frame/backend.h"

namespace skinbench {

// Whether this build can write them.
bool hasAnimations();

// Frames of one size, one after the other, shown for ever. Colours lose a little; `quality` from 0 to 100.
class Animation {
public:
    Animation(uint32_t width, uint32_t height, int quality);
    ~Animation();

    // Shown for so many milliseconds.
    Result<void> add(const Image& image, int milliseconds);

    // What add() took so far, as a file; nothing may be added after it.
    Result<void> save(const std::string& path);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace skinbench
