#include <algorithm>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"

namespace thimble {
namespace {

// bash takes the '=' between an option and its value for a word of its own.
constexpr const char* kBash = R"({function}() {{
    local program=${{COMP_WORDS[0]/#\~/$HOME}}
    type -P -- "$program" > /dev/null || program={program}
    mapfile -t COMPREPLY < <("$program" --complete "${{COMP_WORDS[@]:1:COMP_CWORD}}" 2> /dev/null | cut -f 1)
}}
complete -o default -F {function} {program}
)";

// zsh loads it from a file _PROGRAM of its fpath, or with `source`.
constexpr const char* kZsh = R"({function}() {{
    local -a lines
    if lines=("${{(@f)$($words[1] --complete "${{(@)words[2,CURRENT]}}" 2> /dev/null)}}"); then
        lines=("${{(@)lines/$'\t'/:}}")
        _describe word lines
    else
        _files
    fi
}}
if [[ $funcstack[1] == _{program} ]]; then
    {function} "$@"
else
    compdef {function} {program}
fi
)";

constexpr const char* kFish = R"(function {function}
    set -l before (commandline -opc)
    set -l word (commandline -ct)
    $before[1] --complete $before[2..-1] "$word" 2> /dev/null; or __fish_complete_path "$word"
end
complete -c {program} -f -a '({function})'
)";

struct Candidate {
    std::string word, description;
};

bool hidden(const std::string& group) { return group.empty(); }

// CLI11 lists them in braces in what it calls the type.
void add_choices(const CLI::Option& option, const std::string& before, std::vector<Candidate>& out) {
    const std::string type = option.get_type_name();
    const std::size_t open = type.find('{'), close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return;
    for (const std::string& choice : CLI::detail::split(type.substr(open + 1, close - open - 1), ','))
        out.push_back({before + choice, ""});
}

// The names of options if `named`, else commands and words. Those of option groups too, which have no name of their own.
void add_words(const CLI::App& app, bool named, std::vector<Candidate>& out) {
    for (const CLI::Option* option : app.get_options({})) {
        if (hidden(option->get_group())) continue;
        if (option->get_positional() && !named) add_choices(*option, "", out);
        if (option->get_positional() || !named) continue;
        for (const std::string& name : option->get_snames())
            out.push_back({"-" + name, option->get_description()});
        for (const std::string& name : option->get_lnames())
            out.push_back({"--" + name, option->get_description()});
    }
    for (const CLI::App* below : app.get_subcommands({})) {
        if (hidden(below->get_group())) continue;
        if (below->get_name().empty()) add_words(*below, named, out);
        if (!below->get_name().empty() && !named)
            out.push_back({below->get_name(), below->get_description()});
    }
}

const CLI::Option* option_with_value(const CLI::App& app, const std::string& name) {
    const CLI::Option* option = name.starts_with("-") ? app.get_option_no_throw(name) : nullptr;
    return option != nullptr && option->get_items_expected_max() > 0 ? option : nullptr;
}

const CLI::App& last_named(const CLI::App& app, const std::vector<std::string>& words) {
    const CLI::App* last = &app;
    for (const std::string& word : words) {
        const auto below =
            last->get_subcommands([&](const CLI::App* one) { return one->get_name() == word; });
        if (!word.empty() && !below.empty()) last = below.front();
    }
    return *last;
}

std::vector<Candidate> candidates(const CLI::App& app, std::vector<std::string> words) {
    std::string word = words.empty() || words.back() == "=" ? "" : words.back();
    if (!words.empty() && words.back() != "=") words.pop_back();
    std::erase(words, "=");
    const CLI::App& command = last_named(app, words);
    std::vector<Candidate> all;
    const std::size_t equals = word.find('=');
    const CLI::Option* option = words.empty() ? nullptr : option_with_value(command, words.back());
    if (option != nullptr) {
        add_choices(*option, "", all);
    } else if (equals != std::string::npos) {
        option = option_with_value(command, word.substr(0, equals));
        if (option != nullptr) add_choices(*option, word.substr(0, equals + 1), all);
    } else {
        add_words(command, word.starts_with("-"), all);
    }
    std::erase_if(all, [&word](const Candidate& one) { return !one.word.starts_with(word); });
    return all;
}

}  // namespace

std::string completion_script(const std::string& program, const std::string& shell) {
    const char* const script = shell == "bash" ? kBash : shell == "zsh" ? kZsh : shell == "fish" ? kFish : "";
    std::string function = "_complete_" + program;
    std::replace(function.begin(), function.end(), '-', '_');
    return fmt::format("{}# Completion of {} for {}.\n", shell == "zsh" ? "#compdef " + program + "\n" : "",
                       program, shell) +
           fmt::format(fmt::runtime(script), fmt::arg("program", program), fmt::arg("function", function));
}

std::optional<int> answer_shell(const CLI::App& app, int argc, char** argv) {
    const std::string_view call = argc > 1 ? argv[1] : "";
    const auto* const known = std::find(std::begin(kCompletedShells), std::end(kCompletedShells),
                                        std::string_view(argc > 2 ? argv[2] : ""));
    if (call == "--completion" && known != std::end(kCompletedShells)) {
        fmt::print("{}", completion_script(app.get_name(), *known));
        return static_cast<int>(ExitCode::kOk);
    }
    if (call != "--complete") return std::nullopt;
    const std::vector<Candidate> found = candidates(app, {argv + 2, argv + argc});
    for (const auto& [word, description] : found)
        fmt::print("{}\t{}\n", word, description.substr(0, description.find('\n')));
    return static_cast<int>(found.empty() ? ExitCode::kRunFailed : ExitCode::kOk);
}

}  // namespace thimble
