// Pipeline statistics of one pass at a time.
#pragma once

#include <array>

#include <glad/gl.h>

#include "common/frame/backend.h"

namespace skinbench {

// One query a statistic, made with the object and gone with it.
class GlCounterQueries {
public:
    GlCounterQueries();
    ~GlCounterQueries();
    GlCounterQueries(const GlCounterQueries&) = delete;

    void begin() const;
    // Waits for the commands since begin(), and adds what a pass of this kind can have.
    void end(PassKind kind, Counters& sum) const;

private:
    std::array<GLuint, 7> ids_{};
};

}  // namespace skinbench
