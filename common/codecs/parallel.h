// Splits independent work over the cores. Every element is written by one thread only, so results do not depend on
// how many threads there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace skinbench {

// Calls body(begin, end) for disjoint ranges that cover [0, count). Small inputs stay on the calling thread.
template <class Body>
void parallelRanges(size_t count, const Body& body) {
    constexpr size_t kGrain = 16'384;
    const size_t cores = std::max(1u, std::thread::hardware_concurrency());
    const size_t threads = std::min(cores, (count + kGrain - 1) / kGrain);
    if (threads <= 1) {
        body(size_t{0}, count);
        return;
    }
    std::vector<std::jthread> workers;
    workers.reserve(threads - 1);
    for (size_t t = 1; t < threads; ++t) {
        workers.emplace_back([&body, count, threads, t] { body(count * t / threads, count * (t + 1) / threads); });
    }
    body(size_t{0}, count / threads);
}

}  // namespace skinbench
