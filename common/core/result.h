// Errors as values. A function that can fail on input or on a device returns Result<T>; a broken invariant of our own
// aborts with file and line (SKINBENCH_ASSERT) instead, because no caller could do anything about it.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <expected>
#include <string>
#include <utility>

namespace skinbench {

enum class Fault {
    input,    // a file, a flag or a value that the user can change: exit status 2
    device,   // a driver, a device or the machine (memory, disk) said no: exit status 1
    program,  // a shader, a cut or a plan of the program's own is wrong, and no case may hide it: exit status 1
};

// One sentence without a final stop that says what, where and what to do, such as
// "hero.glb: mesh 2: JOINTS_0 has no WEIGHTS_0". Callers may put a place in front of it, never a second sentence.
struct Error {
    Fault fault = Fault::input;
    std::string text;
};

template <class T>
using Result = std::expected<T, Error>;

inline std::unexpected<Error> inputError(std::string text) {
    return std::unexpected(Error{Fault::input, std::move(text)});
}

inline std::unexpected<Error> deviceError(std::string text) {
    return std::unexpected(Error{Fault::device, std::move(text)});
}

inline std::unexpected<Error> programError(std::string text) {
    return std::unexpected(Error{Fault::program, std::move(text)});
}

// The same error with the place in front of it.
inline std::unexpected<Error> errorAt(const std::string& place, const Error& error) {
    return std::unexpected(Error{error.fault, place + ": " + error.text});
}

}  // namespace skinbench

// Hands an error on to the caller: SKINBENCH_TRY(check(x)); or, where the value is needed, after auto y = make(x);
// SKINBENCH_TRY(y);
#define SKINBENCH_TRY(expression)                                                                  \
    do {                                                                                           \
        if (auto&& tried = (expression); !tried) return std::unexpected(std::move(tried.error())); \
    } while (0)

// Stays on in release builds: a benchmark that goes on after a broken invariant publishes wrong numbers.
#define SKINBENCH_ASSERT(condition)                                                                 \
    do {                                                                                            \
        if (!(condition)) {                                                                         \
            std::fprintf(stderr, "skinbench: %s:%d: broken: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                                           \
        }                                                                                           \
    } while (0)
