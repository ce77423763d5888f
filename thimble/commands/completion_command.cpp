// thimble completion: what a shell has to know to complete the command line.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/runtime/command_line.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {

Subcommand add_completion(CLI::App& app) {
    const auto shell = std::make_shared<std::string>();
    CLI::App* completion = app.add_subcommand(
        "completion", "print a script that lets bash, zsh or fish complete Thimble's commands");
    completion->add_option("shell", *shell, "your shell")
        ->required()
        ->check(CLI::IsMember(
            std::vector<std::string>(std::begin(kCompletedShells), std::end(kCompletedShells))));
    completion->footer(
        "Examples:\n"
        "  source <(thimble completion bash)\n"
        "  thimble completion zsh > ~/.zfunc/_thimble    # a folder of fpath\n"
        "  thimble completion fish > ~/.config/fish/completions/thimble.fish\n"
        "\n"
        "The Debian package installs it for all programs (docs/install.md).");
    return {completion, [&app, shell] {
                fmt::print("{}", completion_script(app.get_name(), *shell));
                return 0;
            }};
}

}  // namespace thimble
