// Moving pictures as one file: animated WebP, where the library is there.
#pragma once

#include <memory>
#include <string>

#include "common/frame/backend.h"

namespace skinbench {

// Whether this build can write them.
bool hasAnimations();

// Whether a WebP file takes pictures of that size: 16383 pixels each way at the most. An error names both sizes.
Result<void> checkWebpSize(uint64_t width, uint64_t height);

// Frames of one size that checkWebpSize lets pass, one after the other, shown for ever. Colours lose a little;
// `quality` from 0 to 100.
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
