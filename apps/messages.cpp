// What is said on the terminal.
#include <sys/ioctl.h>
#include <unistd.h>

#include <iostream>

#include "apps/apps.h"
#include "common/core/text.h"

namespace skinbench {

static std::string programName = "skinbench";

void nameProgram(const std::string& name) { programName = name; }

void say(const std::string& text) {
    std::cerr << terminalText(programName + ": " + text, kLongestMessage) + "\n" << std::flush;
}

void warn(const std::string& text) { say("warning: " + text); }

int reportError(const Error& error) {
    say(error.text);
    return error.fault == Fault::input ? kExitBadInput : kExitFailed;
}

int flushOutput() {
    std::cout.flush();
    if (std::cout) return kExitDone;
    return reportError({Fault::device, "standard output cannot be written"});
}

size_t terminalWidth() {
    winsize size{};
    return isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace skinbench
