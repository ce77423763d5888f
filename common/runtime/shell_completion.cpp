#include "common/runtime/shell_completion.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace thimble {
namespace {

// Between single quotes. fish knows backslashes there, the others do not.
std::string quoted(const std::string& text, bool fish = false) {
    std::string out(1, '\'');
    for (const char c : text) {
        if (c == '\'') {
            out += fish ? "\\'" : "'\\''";
        } else {
            if (fish && c == '\\') out += c;
            out += c;
        }
    }
    out += '\'';
    return out;
}

std::string function_of(const CommandTree& tree) {
    std::string name = fmt::format("_{}", tree.front().path);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

// Patterns of a shell's `case`: paths of subcommands, as far as the words typed so far may have led.
std::string subcommand_patterns(const CommandTree& tree, const char* separator = " | ") {
    std::string patterns;
    for (std::size_t i = 1; i < tree.size(); ++i) {
        patterns += fmt::format("{}'{}'", i > 1 ? separator : "", tree[i].path);
    }
    return patterns.empty() ? "'/'" : patterns;  // none: a word that no path is
}

// "path option" of each name of the option.
std::string option_patterns(const CompletedCommand& command, const CompletedOption& option) {
    std::string patterns;
    for (const std::string& name : option.names) {
        patterns += fmt::format("{}'{} {}'", patterns.empty() ? "" : " | ", command.path, name);
    }
    return patterns;
}

// Branches of a `case` over the word before: what follows an option that takes a value.
std::string value_branches(const CommandTree& tree, const char* choices_form, const char* otherwise) {
    std::string branches;
    for (const CompletedCommand& command : tree) {
        for (const CompletedOption& option : command.options) {
            if (!option.takes_value) continue;
            const std::string action = option.choices.empty() ? otherwise
                                                              : fmt::format(fmt::runtime(choices_form),
                                                                            fmt::join(option.choices, " "));
            branches += fmt::format("        {}) {}; return ;;\n", option_patterns(command, option), action);
        }
    }
    return branches;
}

std::string words_of(const CompletedCommand& command) {
    std::vector<std::string> words = command.choices;
    for (const CompletedWord& subcommand : command.subcommands) words.push_back(subcommand.word);
    for (const CompletedOption& option : command.options) {
        words.insert(words.end(), option.names.begin(), option.names.end());
    }
    return fmt::format("{}", fmt::join(words, " "));
}

// An option's value may follow '=', which bash takes for a word of its own. Where nothing here matches, readline
// completes the names of files.
constexpr const char* kBash = R"(# Completion of {program} for bash.
{function}() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} at={program} i
    [ "$before" = = ] && before=${{COMP_WORDS[COMP_CWORD - 2]}}
    [ "$word" = = ] && word=
    for ((i = 1; i < COMP_CWORD; ++i)); do
        case "$at ${{COMP_WORDS[i]}}" in
        {subcommands}) at+=" ${{COMP_WORDS[i]}}" ;;
        esac
    done
    COMPREPLY=()
    case "$at $before" in
{values}    esac
    case "$at" in
{words}    esac
}}
complete -o default -F {function} {program}
)";

std::string bash(const CommandTree& tree) {
    std::string words;
    for (const CompletedCommand& command : tree) {
        words += fmt::format("        '{}') mapfile -t COMPREPLY < <(compgen -W {} -- \"$word\") ;;\n",
                             command.path, quoted(words_of(command)));
    }
    return fmt::format(
        fmt::runtime(kBash), fmt::arg("program", tree.front().path), fmt::arg("function", function_of(tree)),
        fmt::arg("subcommands", subcommand_patterns(tree)),
        fmt::arg("values",
                 value_branches(tree, "mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$word\")", ":")),
        fmt::arg("words", words));
}

// Loaded by zsh from a file _PROGRAM of its fpath, or with `source`.
constexpr const char* kZsh = R"(#compdef {program}
# Completion of {program} for zsh.
{function}() {{
    local at={program} i
    local -a commands options
    for ((i = 2; i < CURRENT; ++i)); do
        case "$at $words[i]" in
        {subcommands}) at+=" $words[i]" ;;
        esac
    done
    case "$at $words[CURRENT-1]" in
{values}    esac
    local choices= files=
    case "$at" in
{words}    esac
    if [[ $words[CURRENT] == -* ]]; then
        _describe -o option options
        return
    fi
    (( $#commands )) && _describe command commands
    [[ -n $choices ]] && compadd -- ${{=choices}}
    [[ -n $files ]] && _files
}}
if [[ $funcstack[1] == _{program} ]]; then
    {function} "$@"
else
    compdef {function} {program}
fi
)";

// "word:description"; a colon would end the word.
std::string described(std::string word, const std::string& description) {
    for (std::size_t at = word.find(':'); at != std::string::npos; at = word.find(':', at + 2))
        word.insert(at, 1, '\\');
    return quoted(fmt::format("{}:{}", word, description));
}

std::string zsh_branch(const CompletedCommand& command) {
    std::string commands, options;
    for (const CompletedWord& subcommand : command.subcommands) {
        commands += fmt::format(" {}", described(subcommand.word, subcommand.description));
    }
    for (const CompletedOption& option : command.options) {
        for (const std::string& name : option.names)
            options += fmt::format(" {}", described(name, option.description));
    }
    return fmt::format("        '{}') commands=({}) options=({}) choices='{}' files={} ;;\n", command.path,
                       commands, options, fmt::join(command.choices, " "),
                       command.takes_words && command.choices.empty() ? "1" : "");
}

std::string zsh(const CommandTree& tree) {
    std::string words;
    for (const CompletedCommand& command : tree) words += zsh_branch(command);
    return fmt::format(
        fmt::runtime(kZsh), fmt::arg("program", tree.front().path), fmt::arg("function", function_of(tree)),
        fmt::arg("subcommands", subcommand_patterns(tree)),
        fmt::arg("values", value_branches(tree, "compadd -- {}", "_files")), fmt::arg("words", words));
}

constexpr const char* kFish = R"(# Completion of {program} for fish.
function _{function}_at
    set -l at {program}
    for word in (commandline -opc)[2..-1]
        switch "$at $word"
            case {subcommands}
                set at "$at $word"
        end
    end
    test "$at" = "$argv"
end
)";

std::string fish_option(const std::string& start, const CompletedOption& option) {
    std::string line = start;
    for (const std::string& name : option.names) {
        const bool is_long = name.starts_with("--");
        line += fmt::format(" -{} {}", is_long ? 'l' : 's', name.substr(is_long ? 2 : 1));
    }
    if (option.takes_value) line += option.choices.empty() ? " -r" : " -x";
    if (!option.choices.empty()) line += fmt::format(" -a '{}'", fmt::join(option.choices, " "));
    return fmt::format("{} -d {}\n", line, quoted(option.description, true));
}

std::string fish(const CommandTree& tree) {
    const std::string function = function_of(tree), program = tree.front().path;
    std::string script =
        fmt::format(fmt::runtime(kFish), fmt::arg("program", program), fmt::arg("function", function),
                    fmt::arg("subcommands", subcommand_patterns(tree, " ")));
    for (const CompletedCommand& command : tree) {
        const std::string start =
            fmt::format("complete -c {} -n '_{}_at {}'", program, function, command.path);
        for (const CompletedWord& subcommand : command.subcommands) {
            script += fmt::format("{} -f -a {} -d {}\n", start, subcommand.word,
                                  quoted(subcommand.description, true));
        }
        if (!command.choices.empty())
            script += fmt::format("{} -f -a '{}'\n", start, fmt::join(command.choices, " "));
        if (!command.takes_words) script += fmt::format("{} -f\n", start);
        for (const CompletedOption& option : command.options) script += fish_option(start, option);
    }
    return script;
}

}  // namespace

std::string completion_script(const CommandTree& tree, std::string_view shell) {
    if (shell == "bash") return bash(tree);
    return shell == "zsh" ? zsh(tree) : fish(tree);
}

}  // namespace thimble
