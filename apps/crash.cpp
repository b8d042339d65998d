// What the program says when a driver, or the program itself, crashes. The handler runs on whatever thread crashed and
// allocates nothing.
#include <dlfcn.h>
#include <signal.h>
#include <sys/resource.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <format>

#include "apps/apps.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

std::array<char, 160> doing{};                  // what Progress::what says
std::array<char, 512> kept{};                   // the result file
std::array<char, 80> little{};                  // that the address space is limited
alignas(16) std::array<char, 1 << 16> stack{};  // a stack that overflowed cannot hold the handler

// A crash in the middle of it shows a mixture of both texts, no more.
template <size_t size>
void keep(std::array<char, size>& place, const std::string& text) {
    const size_t length = std::min(text.size(), size - 1);
    std::memcpy(place.data(), text.data(), length);
    std::fill(place.begin() + static_cast<std::ptrdiff_t>(length), place.end(), '\0');
}

void append(std::array<char, 1024>& line, const char* text) {
    std::strncat(line.data(), text, line.size() - std::strlen(line.data()) - 1);
}

// The name of the library, or of the program, whose code was running; null where it is none's: what a driver compiled.
const char* crashedIn(const void* context) {
#ifdef __x86_64__
    const auto place = static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP];
    Dl_info found{};
    if (dladdr(reinterpret_cast<void*>(place), &found) == 0 || !found.dli_fname) return nullptr;
    const char* const name = std::strrchr(found.dli_fname, '/');
    return name ? name + 1 : found.dli_fname;
#else
    static_cast<void>(context);
    return nullptr;
#endif
}

void onCrash(int signal, siginfo_t*, void* context) {
    static std::atomic_flag begun;
    while (begun.test_and_set()) pause();  // another thread's crash, which ends them all
    alarm(5);                              // should the loader's lock be taken
    std::array<char, 1024> line{};
    append(line, "skinbench: crashed (SIG");
    append(line, sigabbrev_np(signal));
    const char* const where = crashedIn(context);
    append(line, where ? ") in " : ") in what a driver compiled");
    append(line, where ? where : "");
    for (const auto& [before, text] : {std::pair(" at ", doing.data()), std::pair("; ", little.data()),
                                       std::pair("; what was measured until then is in ", kept.data())}) {
        if (!text[0]) continue;
        append(line, before);
        append(line, text);
    }
    append(line, "\n");
    const ssize_t written = write(STDERR_FILENO, line.data(), std::strlen(line.data()));
    static_cast<void>(written);
    _exit(kExitFailed);
}

}  // namespace

void catchCrashes() {
    rlimit space{};
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
        keep(little, std::format("ulimit -v leaves it {} MiB of address space", space.rlim_cur >> 20));
    const stack_t other{.ss_sp = stack.data(), .ss_flags = 0, .ss_size = stack.size()};
    sigaltstack(&other, nullptr);
    for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT}) {
        struct sigaction action = {}, before = {};
        sigaction(signal, nullptr, &before);
        if (before.sa_handler != SIG_DFL) continue;  // a sanitizer's
        action.sa_sigaction = onCrash;
        action.sa_flags = SA_SIGINFO | SA_ONSTACK;
        sigaction(signal, &action, nullptr);
    }
}

void noteDoing(const std::string& what) { keep(doing, terminalText(what, doing.size() / 4)); }

void noteKept(const std::string& path) { keep(kept, terminalText(path, kept.size() / 4)); }

}  // namespace skinbench
