#include "common/runtime/command_line.hpp"

#include <iterator>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "common/runtime/shell_completion.hpp"

namespace thimble {
namespace {

// CLI11 lists them in braces in what it calls the type.
std::vector<std::string> choices_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t open = type.find('{'), close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

void add_option(CompletedCommand& command, const CLI::Option& option) {
    if (option.get_group().empty()) return;  // hidden
    if (option.get_positional()) {
        command.takes_words = true;
        command.choices = choices_of(option);
        return;
    }
    CompletedOption completed{
        {}, first_line(option.get_description()), option.get_items_expected_max() > 0, choices_of(option)};
    for (const std::string& name : option.get_snames())
        completed.names.push_back(std::string("-").append(name));
    for (const std::string& name : option.get_lnames())
        completed.names.push_back(std::string("--").append(name));
    command.options.push_back(completed);
}

// Options and subcommands of `app` and of its option groups, which have no name of their own.
void add_own(CompletedCommand& command, const CLI::App& app) {
    for (const CLI::Option* option : app.get_options({})) add_option(command, *option);
    for (const CLI::App* below : app.get_subcommands({})) {
        if (below->get_group().empty()) continue;
        if (below->get_name().empty()) {
            add_own(command, *below);
        } else {
            command.subcommands.push_back({below->get_name(), first_line(below->get_description())});
        }
    }
}

void add_command(CommandTree& tree, const CLI::App& app, const std::string& path) {
    CompletedCommand command{path};
    add_own(command, app);
    tree.push_back(command);
    for (const CompletedWord& word : command.subcommands) {
        add_command(tree, *app.get_subcommand(word.word), path + " " + word.word);
    }
}

}  // namespace

std::string completion_of(const CLI::App& app, const std::string& shell) {
    CommandTree tree;
    add_command(tree, app, app.get_name());
    return completion_script(tree, shell);
}

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
    // Hidden: whoever makes packages asks for it, of every program.
    app.add_option_function<std::string>("--completion",
                                         [&app](const std::string& shell) {
                                             throw CLI::CallForVersion(completion_of(app, shell),
                                                                       CLI::ExitCodes::Success);
                                         })
        ->check(
            CLI::IsMember(std::vector<std::string>(std::begin(kCompletedShells), std::end(kCompletedShells))))
        ->group("");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return static_cast<int>(app.exit(error) == 0 ? ExitCode::kOk : ExitCode::kUsage);
    }
    return std::nullopt;
}

}  // namespace thimble
