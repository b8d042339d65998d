#include "apps/completion.h"

#include <algorithm>
#include <format>
#include <ranges>
#include <vector>

#include "apps/selectors.h"
#include "common/meshlets/partition.h"

namespace skinbench {
namespace {

// The words of a list in a help text: "a, b, c".
std::vector<std::string> wordsIn(const std::string& list) {
    std::vector<std::string> words;
    for (const auto part : std::views::split(list, std::string_view(", ")))
        words.emplace_back(part.begin(), part.end());
    return words;
}

// What an option may be given, by its longest name; none where it is a number, a name or a file.
std::vector<std::string> valuesOf(std::string name) {
    const auto axis = std::ranges::find_if(axes(), [&](const Axis& row) {
        std::string key = row.name;
        std::ranges::replace(key, '_', '-');
        return name == row.option.name || name == key || std::ranges::contains(row.option.aliases, name);
    });
    if (axis != axes().end()) {
        std::vector<std::string> words = axis->words;
        if (axis->name == "route") words.push_back("auto");
        return words;
    }
    static const std::map<std::string, std::vector<std::string>> others = {
        {"camera", cameraNames()},
        {"pose", {"frozen", "animated"}},
        {"shape", {"given", "auto"}},
        {"placement", {"kept", "fresh"}},
        {"geometry", wordsIn(geometryWords())},
        {"preset", wordsIn(presetWords())},
        {"hardware", wordsIn(tableNames(paletteHardware()))},
        {"solver", wordsIn(tableNames(partitionSolvers()))},
        {"order", wordsIn(tableNames(groupOrders()))},
        {"shell", {"bash", "zsh", "fish"}},
        {"thesis", {"torabi", "kimmersdorfer"}},
    };
    const auto other = others.find(name);
    return other == others.end() ? std::vector<std::string>() : other->second;
}

struct Option {
    std::vector<std::string> names;    // "--routes", "-o"
    std::vector<std::string> aliases;  // which are understood and not offered
    std::string help;
    bool takesValue = false;
    std::vector<std::string> values;
};

struct Command {
    std::string name;  // empty: the program itself
    std::string help;
    std::vector<Option> options;
    std::vector<std::string> words;  // that may follow its name; none: files
};

Command commandOf(const CLI::App& app, const std::string& name) {
    Command command{name, app.get_description(), {}, {}};
    for (const CLI::App* inner : app.get_subcommands({})) command.words.push_back(inner->get_name());
    for (const CLI::Option* known : app.get_options()) {
        if (known->get_lnames().empty() && known->get_snames().empty()) {
            for (const std::string& word : valuesOf(known->get_name())) command.words.push_back(word);
            continue;
        }
        if (known->get_group().empty()) continue;
        Option option{{}, {}, known->get_description(), known->get_items_expected_max() > 0, {}};
        for (const std::string& word : known->get_lnames())
            (option.names.empty() ? option.names : option.aliases).push_back("--" + word);
        for (const std::string& word : known->get_snames()) option.names.push_back("-" + word);
        if (option.takesValue && !known->get_lnames().empty()) option.values = valuesOf(known->get_lnames().front());
        command.options.push_back(std::move(option));
    }
    return command;
}

std::string joinedBy(const std::vector<std::string>& words, const std::string& between) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
    return text;
}

// The cases "COMMAND OPTION" of a shell's `case`, each with a line that gives the values.
std::string valueCases(const std::vector<Command>& commands, const std::string& before, const std::string& after) {
    std::string text;
    for (const Command& command : commands)
        for (const Option& option : command.options) {
            if (option.values.empty()) continue;
            std::vector<std::string> patterns;
            for (const auto* names : {&option.names, &option.aliases})
                for (const std::string& name : *names) patterns.push_back("'" + command.name + " " + name + "'");
            text += std::format("        {}) {}{}{} ;;\n", joinedBy(patterns, " | "), before,
                                joinedBy(option.values, " "), after);
        }
    return text;
}

std::string optionCases(const std::vector<Command>& commands, const std::string& before, const std::string& after) {
    std::string text;
    for (const Command& command : commands) {
        std::vector<std::string> names;
        for (const Option& option : command.options)
            names.insert(names.end(), option.names.begin(), option.names.end());
        text += std::format("        '{}') {}{}{} ;;\n", command.name, before, joinedBy(names, " "), after);
    }
    return text;
}

std::string wordCases(const std::vector<Command>& commands, const std::string& before, const std::string& after) {
    std::string text;
    for (const Command& command : commands)
        if (!command.words.empty())
            text += std::format("        '{}') {}{}{} ;;\n", command.name, before, joinedBy(command.words, " "), after);
    return text;
}

// Lists of values with commas between them are completed behind the last comma.
std::string bashScript(const std::vector<Command>& commands) {
    const std::vector<std::string>& names = commands.front().words;
    return "# What bash completes of skinbench; made by `skinbench completion bash`.\n"
           "_skinbench() {\n"
           "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} command= values= head= word\n"
           "    for word in \"${COMP_WORDS[@]:1:COMP_CWORD - 1}\"; do\n"
           "        case $word in " +
           joinedBy(names, " | ") +
           ") command=$word && break ;; esac\n"
           "    done\n"
           "    if [ \"$cur\" = = ]; then cur=; elif [ \"$prev\" = = ]; then prev=${COMP_WORDS[COMP_CWORD - 2]}; fi\n"
           "    COMPREPLY=()\n"
           "    case \"$command $prev\" in\n" +
           valueCases(commands, "values='", "'") +
           "    esac\n"
           "    if [ -n \"$values\" ]; then\n"
           "        case $cur in *,*) head=${cur%,*}, ;; esac\n"
           "        mapfile -t COMPREPLY < <(compgen -P \"$head\" -W \"$values\" -- \"${cur#\"$head\"}\")\n"
           "        return\n"
           "    fi\n"
           "    case $cur in\n"
           "        -*) case $command in\n" +
           optionCases(commands, "values='", "'") +
           "        esac ;;\n"
           "        *) case $command in\n" +
           wordCases(commands, "values='", "'") +
           "        esac ;;\n"
           "    esac\n"
           "    [ -z \"$values\" ] || mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$cur\")\n"
           "}\n"
           "complete -o bashdefault -o default -F _skinbench skinbench\n";
}

std::string zshScript(const std::vector<Command>& commands) {
    const std::vector<std::string>& names = commands.front().words;
    return "#compdef skinbench\n"
           "# What zsh completes of skinbench; made by `skinbench completion zsh`.\n"
           "_skinbench() {\n"
           "    local cur=${words[CURRENT]} prev=${words[CURRENT - 1]} command= word\n"
           "    for word in ${words[2,CURRENT - 1]}; do\n"
           "        case $word in (" +
           joinedBy(names, " | ") +
           ") command=$word; break ;; esac\n"
           "    done\n"
           "    if [[ $cur == --*=* ]]; then prev=${cur%%=*}; compset -P '*='; fi\n"
           "    case \"$command $prev\" in\n" +
           valueCases(commands, "compset -P '*,'; compadd -- ", "; return") +
           "    esac\n"
           "    if [[ $cur == -* ]]; then\n"
           "        case $command in\n" +
           optionCases(commands, "compadd -- ", "") +
           "        esac\n"
           "    else\n"
           "        case $command in\n" +
           wordCases(commands, "compadd -- ", "") +
           "        *) _files ;;\n"
           "        esac\n"
           "    fi\n"
           "}\n"
           "_skinbench \"$@\"\n";
}

std::string quotedForFish(const std::string& text) {
    std::string quoted;
    for (const char c : text) quoted += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return "'" + quoted + "'";
}

std::string fishScript(const std::vector<Command>& commands) {
    std::string text = "# What fish completes of skinbench; made by `skinbench completion fish`.\n";
    for (const Command& command : commands) {
        const std::string when =
            command.name.empty() ? "__fish_use_subcommand" : "'__fish_seen_subcommand_from " + command.name + "'";
        if (!command.name.empty())
            text += std::format("complete -c skinbench -n __fish_use_subcommand -f -a {} -d {}\n", command.name,
                                quotedForFish(command.help));
        if (!command.name.empty() && !command.words.empty())
            text += "complete -c skinbench -n " + when + " -f -a '" + joinedBy(command.words, " ") + "'\n";
        for (const Option& option : command.options) {
            text += "complete -c skinbench -n " + when;
            for (const auto* names : {&option.names, &option.aliases})
                for (const std::string& name : *names)
                    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
            if (!option.values.empty())
                text += " -x -a '(__fish_append , " + joinedBy(option.values, " ") + ")'";
            else if (option.takesValue)
                text += " -r";
            text += " -d " + quotedForFish(option.help.substr(0, option.help.find(" (default"))) + "\n";
        }
    }
    return text;
}

}  // namespace

Result<std::string> completionScript(const CLI::App& program, const std::string& shell) {
    std::vector<Command> commands{commandOf(program, "")};
    for (const CLI::App* command : program.get_subcommands({}))
        commands.push_back(commandOf(*command, command->get_name()));
    if (shell == "bash") return bashScript(commands);
    if (shell == "zsh") return zshScript(commands);
    if (shell == "fish") return fishScript(commands);
    return inputError("no shell '" + shell + "'; there is bash, zsh, fish");
}

}  // namespace skinbench
