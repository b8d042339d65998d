// Work that is split over the cores.
#include <atomic>
#include <new>
#include <vector>

#include <catch2/catch_test_macros.hpp>

#include "common/core/host_memory.h"
#include "common/core/parallel.h"

using namespace skinbench;

TEST_CASE("every part runs once, and ranges cover all of it") {
    std::vector<std::atomic<int>> runs(7);
    parallelEach(runs.size(), [&](size_t part) { ++runs[part]; });
    for (const auto& run : runs) CHECK(run == 1);
    parallelEach(0, [](size_t) { std::abort(); });
    std::vector<uint8_t> seen(100'000);
    parallelRanges(seen.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) ++seen[i];
    });
    CHECK(seen == std::vector<uint8_t>(seen.size(), 1));
}

TEST_CASE("what one part throws reaches the caller, after all parts") {
    for (size_t thrower : {0u, 3u}) {
        std::atomic<int> ended = 0;
        auto run = [&] {
            parallelEach(4, [&](size_t part) {
                if (part == thrower) throw std::bad_alloc();
                ++ended;
            });
        };
        CHECK_THROWS_AS(run(), std::bad_alloc);
        CHECK(ended == 3);
    }
}

TEST_CASE("the host says how much memory is free") { CHECK(freeHostMemory() > 1'000'000); }
