// Starts the program as a user would and keeps what it said, for tests.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <sstream>
#include <thread>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/core/file.h"
#include "tests/scene/gltf_fixture.h"

extern char** environ;

namespace program {

using Words = std::vector<std::string>;

struct Outcome {
    int status = -1;  // 128 + the signal that ended it
    std::string out, err;
};

inline std::string pathOf(const std::string& name) { return (fixture::temporaryFolder() / name).string(); }

struct Running {
    pid_t pid = 0;
    std::string outFile, errFile;
};

// Starts the program in the temporary folder. `environment` holds NAME=VALUE words that replace inherited ones.
inline Running start(const Words& words, const Words& environment = {}, const std::string& out = "",
                     const char* path = SKINBENCH_PROGRAM) {
    static int number = 0;
    ++number;
    Running running{0, out.empty() ? pathOf("out." + std::to_string(number)) : out,
                    pathOf("err." + std::to_string(number))};
    std::vector<std::string> arguments = {path};
    arguments.insert(arguments.end(), words.begin(), words.end());
    std::vector<std::string> variables = environment;
    for (char** variable = environ; *variable; ++variable) {
        const std::string name = std::string(*variable).substr(0, std::string(*variable).find('=') + 1);
        if (std::ranges::none_of(environment, [&](const std::string& given) { return given.starts_with(name); }))
            variables.push_back(*variable);
    }
    auto pointers = [](std::vector<std::string>& texts) {
        std::vector<char*> list;
        for (std::string& text : texts) list.push_back(text.data());
        list.push_back(nullptr);
        return list;
    };
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, running.outFile.c_str(), flags, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, running.errFile.c_str(), flags, 0600);
    posix_spawn_file_actions_addchdir_np(&actions, fixture::temporaryFolder().c_str());
    const int failed =
        posix_spawn(&running.pid, path, &actions, nullptr, pointers(arguments).data(), pointers(variables).data());
    posix_spawn_file_actions_destroy(&actions);
    REQUIRE(failed == 0);
    return running;
}

// Waits for three minutes at the most.
inline Outcome finish(const Running& running) {
    int status = 0;
    for (int tries = 0; waitpid(running.pid, &status, WNOHANG) == 0; ++tries) {
        if (tries == 90'000) kill(running.pid, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    Outcome outcome;
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (std::filesystem::is_regular_file(running.outFile))
        outcome.out = skinbench::readWholeFile(running.outFile).value_or("unreadable");
    outcome.err = skinbench::readWholeFile(running.errFile).value_or("unreadable");
    return outcome;
}

inline Outcome call(const Words& words, const Words& environment = {}) { return finish(start(words, environment)); }

inline std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

// One line "skinbench: …" beside warnings, nothing on standard output.
inline void checkRefused(const Outcome& outcome, int status, const std::string& part) {
    INFO("standard error: " << outcome.err);
    CHECK(outcome.status == status);
    CHECK(outcome.out == "");
    std::vector<std::string> lines = linesOf(outcome.err);
    std::erase_if(lines, [](const std::string& line) { return line.starts_with("skinbench: warning: "); });
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].starts_with("skinbench: "));
    CHECK(lines[0].size() < 620);
    CHECK_THAT(lines[0], Catch::Matchers::ContainsSubstring(part));
}

struct BadCall {
    Words words;
    int status;
    const char* part;  // of the message
};

inline void checkRefused(const std::vector<BadCall>& calls) {
    for (const BadCall& bad : calls) {
        std::string line;
        for (const std::string& word : bad.words) line += " " + word;
        INFO("skinbench" << line);
        checkRefused(call(bad.words), bad.status, bad.part);
    }
}

}  // namespace program
