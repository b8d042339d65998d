#include "apps/command_line.h"

#include <fcntl.h>
#include <unistd.h>

#include <cctype>
#include <csignal>
#include <new>

#include "apps/selectors.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

// The subcommand that the words led to.
const CLI::App& innermost(const CLI::App& program) {
    const auto inner = program.get_subcommands();
    return inner.empty() ? program : innermost(*inner.front());
}

std::string callOf(const CLI::App& command) {
    return (command.get_parent() ? callOf(*command.get_parent()) + " " : "") + command.get_name();
}

constexpr size_t kPageWidth = 100, kIndent = 4;

std::string paragraph(const std::string& text, size_t indent) {
    const size_t width = terminalWidth() ? std::clamp<size_t>(terminalWidth(), 40, kPageWidth) : kPageWidth;
    return std::string(indent, ' ') + wrapText(text, width - indent, indent) + "\n";
}

std::string upper(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

bool isPositional(const CLI::Option& option) { return option.get_lnames().empty() && option.get_snames().empty(); }

std::string optionText(const CLI::Option& option) {
    std::string names;
    for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
    if (!option.get_lnames().empty()) names += (names.empty() ? "--" : ", --") + option.get_lnames().front();
    if (isPositional(option)) names = upper(option.get_name());
    if (!isPositional(option) && option.get_items_expected_max() > 0)
        names += option.get_delimiter() ? " WORD,..." : " " + option.get_type_name();
    std::string what = option.get_description();
    if (!option.get_default_str().empty()) what += " (default: " + option.get_default_str() + ")";
    if (option.get_required()) what += " (required)";
    return paragraph(names, kIndent) + paragraph(what, 2 * kIndent);
}

std::string synopsisOf(const CLI::App& command) {
    std::string text = callOf(command) + " [OPTIONS]";
    for (const CLI::Option* option : command.get_options()) {
        if (!isPositional(*option)) continue;
        const std::string name = upper(option->get_name()) + (option->get_items_expected_max() > 1 ? "..." : "");
        text += option->get_required() ? " " + name : " [" + name + "]";
    }
    return text + (command.get_subcommands({}).empty() ? "" : " COMMAND");
}

std::string manualPage(const CLI::App* command, std::string, CLI::AppFormatMode) {
    std::string page = "NAME\n" + paragraph(callOf(*command) + " - " + command->get_description(), kIndent);
    page += "\nSYNOPSIS\n" + paragraph(synopsisOf(*command), kIndent);
    for (const std::string& group : command->get_groups())
        for (bool positional : {true, false}) {
            std::string options;
            for (const CLI::Option* option : command->get_options())
                if (!group.empty() && option->get_group() == group && isPositional(*option) == positional)
                    options += optionText(*option);
            if (!options.empty()) page += "\n" + (positional ? "ARGUMENTS" : upper(group)) + "\n" + options;
        }
    if (const auto commands = command->get_subcommands({}); !commands.empty()) page += "\nCOMMANDS\n";
    for (const CLI::App* inner : command->get_subcommands({}))
        page += paragraph(inner->get_name(), kIndent) + paragraph(inner->get_description(), 2 * kIndent);
    const std::string footer = command->get_footer();
    return page + (footer.empty() ? "" : "\n" + footer + "\n");
}

// The text of a word that the command does not know.
std::string unknownText(const CLI::App& command, const std::string& word) {
    const bool option = word.starts_with("-");
    const std::string name = word.substr(0, word.find('='));
    if (option && command.get_option_no_throw(name)) return std::format("{} goes behind {}", name, command.get_name());
    std::vector<std::string> words;
    for (const CLI::Option* known : command.get_options())
        for (const std::string& name : known->get_lnames()) words.push_back("--" + name);
    if (!option) {
        words.clear();
        for (const CLI::App* inner : command.get_subcommands({})) words.push_back(inner->get_name());
        if (words.empty()) return std::format("'{}' is one word too many", word);
        if (word == "view") return "the window is the program skinview beside this one, ./run view in a clone";
    }
    const std::string nearest = nearestWord(name, words);
    std::string there;
    if (!option)
        for (const std::string& other : words) there += (there.empty() ? "; there is " : ", ") + other;
    return std::format("no {} {}{}", option ? "option" : "subcommand", option ? word : "'" + word + "'",
                       nearest.empty() ? there : "; did you mean " + nearest + "?");
}

// What CLI11 says of options and arguments that are missing or too many, in the words of the synopsis.
std::string countText(const CLI::App& command, const std::string& text) {
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = isPositional(*option) ? upper(option->get_name()) : option->get_name();
        if (text == option->get_name() + " is required")
            return name + (option->get_items_expected_max() > 1 ? " are required" : " is required");
        if (text.starts_with(option->get_name() + ":") && option->count() > 1)
            return name + " is given " + (option->count() == 2 ? "twice" : std::to_string(option->count()) + " times");
    }
    if (const size_t end = text.find(" was given a disallowed"); end != std::string::npos)
        return "--" + text.substr(0, end) + " takes no value";
    return text.contains(':') ? text.substr(0, text.find(':')) + " needs a value" : text;
}

std::string usageText(const CLI::App& program, const CLI::ParseError& error) {
    const CLI::App& command = innermost(program);
    const std::vector<std::string> unknown = program.remaining(true);
    std::string text = error.what();
    // An unknown subcommand leaves its word over and is otherwise reported as a missing one.
    const bool extra = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError) ||
                       error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError);
    if (extra && !unknown.empty())
        text = unknownText(command, unknown.front());
    else if (extra || error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ArgumentMismatch))
        text = countText(command, text);
    std::ranges::replace(text, '\n', ' ');
    return text + (text.ends_with("?") ? " See " : "; see ") + callOf(command) + " --help";
}

// A driver would be given the number of a standard stream that is closed, and what is printed would land in its memory.
// What is opened for reading alone refuses what is written to it.
void openStandardStreams() {
    for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(stream, F_GETFD) < 0) open("/dev/null", O_RDONLY);
}

// Before anything else is asked of a value. A word that is an option of the command was meant as one.
void checkValues(CLI::App& command) {
    const auto fault = [&command](const std::string& value) -> std::string {
        if (value.empty()) return kEmptyValue;
        const bool option = value.starts_with("-") && command.get_option_no_throw(value);
        return option ? "a value is missing before " + value : "";
    };
    for (CLI::Option* option : command.get_options()) {
        if (isPositional(*option)) continue;
        if (option->get_items_expected_max() == 0)
            option->disable_flag_override();
        else
            option->transform(CLI::Validator([fault](std::string& value) { return fault(value); }, ""));
    }
    for (CLI::App* inner : command.get_subcommands({})) checkValues(*inner);
}

// The words, the last one first. CLI11 would take the next word for the value of "--out=", and a list of nothing but
// commas for one that was not given.
std::vector<std::string> parsedWords(int argc, char** argv) {
    const auto isEmpty = [](const std::string& value) { return value.find_first_not_of(',') == std::string::npos; };
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
        const bool nothing = equals != std::string::npos && isEmpty(word.substr(equals + 1));
        words.push_back(isEmpty(word) ? "" : nothing ? word.substr(0, equals) : word);
        if (nothing) words.push_back("");
    }
    std::ranges::reverse(words);
    return words;
}

}  // namespace

void writeManual(CLI::App& program) {
    program.formatter_fn(manualPage);
    program.get_help_ptr()->description("this page");
}

std::optional<int> parseWords(CLI::App& program, int argc, char** argv) {
    checkValues(program);
    try {
        program.parse(parsedWords(argc, argv));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) return reportError({Fault::input, usageText(program, error)});
        program.exit(error);
        return flushOutput();
    }
    return std::nullopt;
}

std::string shellWord(const std::string& word) {
    constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%^";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
    std::string quoted;
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return "'" + quoted + "'";
}

int guarded(int (*program)(int argc, char** argv), int argc, char** argv) {
    openStandardStreams();
    catchCrashes();
    catchEarlyInterrupts();
    // A write past the limit of a file's size fails like any other.
    signal(SIGXFSZ, SIG_IGN);
    try {
        return program(argc, argv);
    } catch (const std::bad_alloc&) {
        return reportError({Fault::device, "out of memory; use fewer copies or a smaller scene"});
    } catch (const std::exception& error) {
        return reportError({Fault::device, std::string("unexpected: ") + error.what()});
    }
}

}  // namespace skinbench
