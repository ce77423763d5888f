#include "common/runtime/command_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/decimal_text.hpp"
#include "common/duration_text.hpp"
#include "common/error.hpp"
#include "common/nearest_name.hpp"

namespace thimble {
namespace {

// The deepest command that was understood.
const CLI::App& last_command(const CLI::App& app) {
    const auto given = app.get_subcommands();
    return given.empty() ? app : last_command(*given.back());
}

std::string meant(const std::string& typed, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(typed, names);
    return nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest);
}

bool is_option(std::string_view word) { return word.starts_with("-"); }

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> options_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* known : app.get_options()) {
        if (known->get_group().empty()) continue;  // hidden
        for (const std::string& name : known->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

std::string explain_option(const CLI::App& app, const std::string& typed) {
    const std::string option = typed.substr(0, typed.find('='));
    const std::vector<std::string> known = options_of(app);
    // It stood before the command.
    if (std::find(known.begin(), known.end(), option) != known.end())
        return fmt::format("{0} is an option of {1}: write it after {1}", option, app.get_name());
    return fmt::format("unknown option {}{}", option, meant(option, known));
}

// The word that stands for a command: one that is like a command, else the first, if no option stands before it.
std::string misspelt_command(const std::vector<std::string>& words,
                             const std::vector<std::string>& commands) {
    for (const std::string& word : words)
        if (!is_option(word) && !nearest_name(word, commands).empty()) return word;
    return words.empty() || is_option(words.front()) ? "" : words.front();
}

// Of the words that no option took, the one that explains most; "" if there is none.
std::string explain_word(const CLI::App& app, const std::vector<std::string>& words) {
    std::vector<std::string> commands;
    for (const CLI::App* known : commands_of(app)) commands.push_back(known->get_name());
    const std::string list = fmt::format("Commands: {}", fmt::join(commands, ", "));
    const std::string command = commands.empty() ? "" : misspelt_command(words, commands);
    if (!command.empty()) {
        const std::string instead = meant(command, commands);
        return fmt::format("unknown command '{}'{} {}", command, instead.empty() ? "." : instead, list);
    }
    const auto option = std::find_if(words.begin(), words.end(), is_option);
    if (option != words.end()) return explain_option(app, *option);
    if (!commands.empty()) return "name a command. " + list;
    return words.empty() ? "" : fmt::format("'{}' is one argument too many", words.front());
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = last_command(app);
    const bool lacks_command = command.get_require_subcommand_min() > 0 && command.get_subcommands().empty();
    const bool has_extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    std::vector<std::string> words = app.remaining(true);
    if (error.get_exit_code() == 0) {
        // --help of a command that does not exist is a misspelt command, too.
        std::erase_if(words, is_option);
        return lacks_command && !words.empty() ? explain_word(command, words) : "";
    }
    return lacks_command || has_extras ? explain_word(command, words) : "";
}

// CLI11 reads an empty number as 0, and each program an empty word as none.
std::string judge_word(const std::string& typed) {
    return typed.empty() ? "is empty: write a value, or leave the option out" : std::string();
}

// CLI11 reads counts by strtoull: -1 as 2^64 - 1, 010 as 8, and what is too large as 2^64 - 1.
std::string judge_count(const std::string& typed) {
    if (parse_whole<std::uint64_t>(typed) && (typed == "0" || !typed.starts_with('0'))) return {};
    return fmt::format("'{}': write a whole number with digits only (no sign, no leading 0), at most {}",
                       typed, std::numeric_limits<std::uint64_t>::max());
}

// Ranges let nan through: it is neither below nor above.
std::string judge_number(const std::string& typed) {
    const bool finite = std::isfinite(std::strtod(typed.c_str(), nullptr));
    return finite ? std::string() : fmt::format("'{}' is not a finite number", typed);
}

// CLI11 names a type and each of its checks: "INT:INT in [1 - 64]". The user needs the range only.
class PlainFormatter final : public CLI::Formatter {
  public:
    PlainFormatter() {
        label("Needs", "needs");
        label("Excludes", "not with");
        label("REQUIRED", "(required)");
    }
    std::string make_option_opts(const CLI::Option* option) const override {
        static constexpr std::array<std::array<std::string_view, 2>, 8> kPlain{{{":INT in [", " in ["},
                                                                                {":UINT in [", " in ["},
                                                                                {":FLOAT in [", " in ["},
                                                                                {":POSITIVE", " > 0"},
                                                                                {":NONNEGATIVE", " >= 0"},
                                                                                {"TEXT:{", "{"},
                                                                                {"UINT", "INT"},
                                                                                {"FLOAT", "NUMBER"}}};
        std::string text = CLI::Formatter::make_option_opts(option);
        for (const auto& [from, to] : kPlain) {
            const std::size_t at = text.find(from);
            if (at != std::string::npos) text.replace(at, from.size(), to);
        }
        return text;
    }
};

// Of all options of `app` and its subcommands. Numbers are judged behind what they themselves check: a range names what is
// allowed. Seconds may have a unit. A list is one word with commas: of several words it would take the session file that follows.
void settle_options(CLI::App& app) {
    app.formatter(std::make_shared<PlainFormatter>());
    for (CLI::Option* option : app.get_options([](const CLI::Option*) { return true; })) {
        const std::string type = option->get_type_name(), name = option->get_name();
        // Types of whole numbers; no option takes a negative one.
        for (const char* whole : {"UINT", "INT", "PORT", "ID"})
            if (type.starts_with(whole)) option->check(judge_count);
        if (type.starts_with("FLOAT")) option->check(judge_number);
        if (option->nonpositional() && option->get_items_expected_max() > 0) option->check(judge_word);
        if (holds_seconds(name)) {
            if (type.starts_with("FLOAT")) option->type_name("SECONDS|50ms");
            // In front of what the option itself checks.
            option->transform(
                CLI::Validator([name](std::string& word) { return settle_durations(name, word); }, ""));
        }
        if (option->get_delimiter() != '\0') option->allow_extra_args(false);
    }
    for (CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; })) settle_options(*below);
}

// `thimble help study` is `thimble study --help`, and `thimble version` is `thimble --version`. CLI11 wants the last word first.
std::vector<std::string> reversed_words(int argc, char** argv) {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (words.size() == 1 && words.front() == "version") words.front() = "--version";
    if (!words.empty() && words.front() == "help") {
        words.erase(words.begin());
        words.emplace_back("--help");
    }
    std::reverse(words.begin(), words.end());
    return words;
}

}  // namespace

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
    if (const auto exit_code = answer_shell(app, argc, argv)) return exit_code;
    settle_options(app);
    try {
        app.parse(reversed_words(argc, argv));
    } catch (const CLI::ParseError& error) {
        const std::string why = explain(app, error);
        if (why.empty() && error.get_exit_code() == 0) return app.exit(error);
        fmt::print(stderr, "{}: error: {}\nRun with --help for more information.\n", app.get_name(),
                   printable(why.empty() ? error.what() : why));
        return static_cast<int>(ExitCode::kUsage);
    }
    return std::nullopt;
}

void add_flag(CLI::App& command, const char* name, bool& value, const char* help) {
    command.add_flag(name, value, help);
}

void add_word_option(CLI::App& command, const char* name, std::string& word,
                     const std::vector<std::string>& allowed, const char* help, const char* needs) {
    CLI::Option* option =
        command.add_option(name, word, help)->check(CLI::IsMember(allowed))->default_val(word);
    if (needs != nullptr) option->needs(needs);
}

void add_file_option(CLI::App& command, const char* name, std::string& file, const char* help) {
    command.add_option(name, file, help)->type_name("FILE");
}

void add_jobs_option(CLI::App& command, unsigned& jobs) {
    command
        .add_option("-j,--jobs", jobs,
                    "number of worker threads; 0: one for each core. The results are the same")
        ->check(CLI::Range(0, 1024));
}

CLI::Option* add_resume_options(CLI::App& command, IfExists& if_exists, const std::string& work) {
    CLI::Option* replaces = command.add_flag_callback(
        "--overwrite", [&if_exists] { if_exists = IfExists::kReplace; },
        fmt::format("replace an earlier {} in the folder of --out", work));
    return command
        .add_flag_callback(
            "--resume", [&if_exists] { if_exists = IfExists::kContinue; },
            fmt::format("continue an interrupted {} with the same settings; the result has the same bytes",
                        work))
        ->excludes(replaces);
}

}  // namespace thimble
