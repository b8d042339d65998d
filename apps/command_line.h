// What the programs' main functions share: checks of values, wrong words in one line, the last resort for exceptions.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <format>
#include <optional>
#include <string>
#include <vector>

namespace skinbench {

// A finite number of the kind; CLI::Range lets NaN through.
template <class Number>
CLI::Validator numberFrom(Number least, Number most) {
    return CLI::Validator(
        [least, most](std::string& text) {
            Number value{};
            const bool right = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return right
                       ? ""
                       : std::format("'{}' is not a number from {:.10g} to {:.10g}", text, double(least), double(most));
        },
        "");
}

inline CLI::Validator atLeastZero(bool above = false) {
    return CLI::Validator(
        [above](std::string& text) {
            double value = 0;
            const bool number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
            const bool right = number && (above ? value > 0 : value >= 0);
            return right ? "" : std::format("'{}' is not a number {}", text, above ? "above 0" : "of at least 0");
        },
        "");
}

inline CLI::Validator oneOf(const std::vector<std::string>& words) {
    return CLI::Validator(
        [words](std::string& text) {
            std::string there;
            for (const std::string& word : words) there += (there.empty() ? "" : ", ") + word;
            return std::ranges::contains(words, text) ? "" : std::format("no '{}'; there is {}", text, there);
        },
        "");
}

// Behind the name of an option that was given "".
inline constexpr const char* kEmptyValue = "the value is empty";

// Makes `--help` a page of a manual, of the program and of subcommands that are added later: name, synopsis, a
// paragraph for each option by its group, commands, and the footer as it is. Of several long names of an option the
// page has the first; options of a group without a name are not on it.
void writeManual(CLI::App& program);

// The exit status where the words end the program: help, version, or one line about what is wrong. No option takes an
// empty value, one of its own names or another one's.
std::optional<int> parseWords(CLI::App& program, int argc, char** argv);

// The word as a shell takes it.
std::string shellWord(const std::string& word);

// Runs a program whose exceptions, full files and closed standard streams end in one line.
int guarded(int (*program)(int argc, char** argv), int argc, char** argv);

}  // namespace skinbench
