#include "common/runtime/command_line.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/nearest_name.hpp"

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

// Of the words that nobody took, the one that explains most; "" if there is none.
std::string explain_word(const CLI::App& app, const std::vector<std::string>& words) {
    const auto option = std::find_if(words.begin(), words.end(),
                                     [](const std::string& word) { return word.starts_with("-"); });
    if (option != words.end()) {
        std::vector<std::string> names;
        for (const CLI::Option* known : app.get_options()) {
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

}  // namespace

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
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
