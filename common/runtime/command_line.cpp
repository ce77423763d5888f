#include "common/runtime/command_line.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/nearest_name.hpp"
#include "common/runtime/shell_completion.hpp"

namespace thimble {
namespace {

// Where the command line led to before it was not understood.
const CLI::App& last_command(const CLI::App& app) {
    const auto given = app.get_subcommands();
    return given.empty() ? app : last_command(*given.back());
}

std::string meant(const std::string& typed, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(typed, names);
    return nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest);
}

// Of the words that no option took, the one that explains most; "" if there is none.
std::string explain_word(const CLI::App& app, const std::vector<std::string>& words) {
    const auto option = std::find_if(words.begin(), words.end(),
                                     [](const std::string& word) { return word.starts_with("-"); });
    if (option != words.end()) {
        std::vector<std::string> names;
        for (const CLI::Option* known : app.get_options()) {
            if (known->get_group().empty()) continue;  // hidden
            for (const std::string& name : known->get_lnames()) names.push_back("--" + name);
        }
        return fmt::format("unknown option {}{}", *option, meant(*option, names));
    }
    std::vector<std::string> commands;
    for (const CLI::App* known : app.get_subcommands([](const CLI::App*) { return true; })) {
        commands.push_back(known->get_name());
    }
    if (commands.empty()) {
        return words.empty() ? "" : fmt::format("'{}' is one word too many", words.front());
    }
    const std::string list = fmt::format("Commands: {}", fmt::join(commands, ", "));
    if (words.empty()) return "name a command. " + list;
    const std::string instead = meant(words.front(), commands);
    return fmt::format("unknown command '{}'{} {}", words.front(), instead.empty() ? "." : instead, list);
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = last_command(app);
    const bool lacks_command = command.get_require_subcommand_min() > 0 && command.get_subcommands().empty();
    const bool has_extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    if (error.get_exit_code() == 0 || (!lacks_command && !has_extras)) return {};
    return explain_word(command, app.remaining(true));
}

// CLI11 reads counts by strtoull: -1 as 2^64 - 1, 010 as 8, and what is too large as 2^64 - 1.
std::string judge_count(const std::string& typed) {
    std::uint64_t value = 0;
    const char* const last = typed.data() + typed.size();
    const auto [end, error] = std::from_chars(typed.data(), last, value);
    if (error == std::errc{} && end == last && (typed == "0" || !typed.starts_with('0'))) return {};
    return fmt::format("'{}': write a whole number in digits alone (no sign, no 0 before them), at most {}",
                       typed, std::numeric_limits<std::uint64_t>::max());
}

// Ranges let nan through: it is neither below nor above.
std::string judge_number(const std::string& typed) {
    const bool finite = std::isfinite(std::strtod(typed.c_str(), nullptr));
    return finite ? std::string() : fmt::format("'{}' is not a finite number", typed);
}

// Of all options of `app` and its subcommands. Numbers are judged behind what they themselves check: a range names what is
// allowed. A list is one word with commas: of several words it would take the session file that follows.
void settle_options(CLI::App& app) {
    for (CLI::Option* option : app.get_options([](const CLI::Option*) { return true; })) {
        const std::string type = option->get_type_name();
        if (type.starts_with("UINT")) option->check(judge_count);
        if (type.starts_with("FLOAT")) option->check(judge_number);
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
        if (const std::string why = explain(app, error); !why.empty()) {
            fmt::print(stderr, "{}: error: {}\nRun with --help for more information.\n", app.get_name(), why);
            return static_cast<int>(ExitCode::kUsage);
        }
        return static_cast<int>(app.exit(error) == 0 ? ExitCode::kOk : ExitCode::kUsage);
    }
    return std::nullopt;
}

}  // namespace thimble
