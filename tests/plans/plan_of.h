// What tests of plans look at.
#pragma once

#include <algorithm>

#include <catch2/catch_test_macros.hpp>

#include "common/plans/plans.h"
#include "tests/cases.h"

namespace skinbench {

inline FramePlan planOf(Workload& workload, const Case& c, const DeviceCaps& caps, bool capture = false) {
    auto input = planInput(workload, c);
    REQUIRE(input);
    input->capture = capture;
    auto plan = makePlan(c, *input, caps);
    if (!plan) FAIL(plan.error().text);
    return std::move(*plan);
}

inline const Pass& passOf(const FramePlan& plan, std::string_view label) {
    auto pass = std::ranges::find(plan.passes, label, &Pass::label);
    REQUIRE(pass != plan.passes.end());
    return *pass;
}

inline const Stream* streamOf(const FramePlan& plan, uint32_t slot) {
    auto stream = std::ranges::find(plan.streams, slot, &Stream::slot);
    return stream == plan.streams.end() ? nullptr : &*stream;
}

}  // namespace skinbench
