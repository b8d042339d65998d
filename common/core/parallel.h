// Splits independent work over the cores. Every element is written by one thread only, so results do not depend on
// how many threads there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace skinbench {

// Calls body(part) once for each of `parts` parts, all at the same time. Where the system has no more threads, this one
// does what is left. What a part throws (a lack of memory) is thrown again when all have ended.
template <class Body>
void parallelEach(size_t parts, const Body& body) {
    std::exception_ptr thrown;
    std::mutex lock;
    auto guarded = [&](size_t part) {
        try {
            body(part);
        } catch (...) {
            const std::scoped_lock held(lock);
            thrown = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> workers;
        workers.reserve(parts);
        size_t started = 1;
        try {
            for (; started < parts; ++started) workers.emplace_back(guarded, started);
        } catch (const std::system_error&) {
        }
        if (parts > 0) guarded(0);
        for (; started < parts; ++started) guarded(started);
    }
    if (thrown) std::rethrow_exception(thrown);
}

inline size_t coreCount() { return std::max(1u, std::thread::hardware_concurrency()); }

// Calls body(begin, end) for disjoint ranges that cover [0, count). Small inputs stay on the calling thread.
template <class Body>
void parallelRanges(size_t count, const Body& body) {
    constexpr size_t kGrain = 16'384;
    const size_t threads = std::max<size_t>(1, std::min(coreCount(), (count + kGrain - 1) / kGrain));
    parallelEach(threads, [&](size_t t) { body(count * t / threads, count * (t + 1) / threads); });
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
