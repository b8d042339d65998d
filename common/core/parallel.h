// Splits independent work over the cores. Every element is written by one thread only, so results do not depend on
// how many threads there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>
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

// What body(begin, end) returns for each range, by the range's begin. The same count has the same ranges again.
template <class Body>
auto parallelParts(size_t count, const Body& body) {
    std::map<size_t, std::invoke_result_t<Body, size_t, size_t>> parts;
    std::mutex lock;
    parallelRanges(count, [&](size_t begin, size_t end) {
        auto part = body(begin, end);
        const std::scoped_lock held(lock);
        parts.emplace(begin, std::move(part));
    });
    return parts;
}

}  // namespace skinbench
