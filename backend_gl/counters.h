// Pipeline statistics of one frame at a time.
#pragma once

#include <array>

#include "backend_gl/plan.h"

namespace skinbench {

// One query a statistic, made with the object and gone with it.
class GlCounterQueries {
public:
    GlCounterQueries();
    ~GlCounterQueries();
    GlCounterQueries(const GlCounterQueries&) = delete;

    void begin() const;
    // Waits for the commands since begin(). What the plan's passes cannot have is left empty.
    Counters end(const GlPlan& plan) const;

private:
    std::array<GLuint, 7> ids_{};
};

}  // namespace skinbench
