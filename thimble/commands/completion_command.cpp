// thimble completion: what a shell has to know to complete the command line.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/runtime/shell_completion.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {

Subcommand add_completion(CLI::App& app) {
    const auto shell = std::make_shared<std::string>();
    CLI::App* completion =
        app.add_subcommand("completion", "print what bash, zsh or fish needs to complete this command");
    completion->add_option("shell", *shell, "which shell")
        ->required()
        ->check(CLI::IsMember(
            std::vector<std::string>(std::begin(kCompletedShells), std::end(kCompletedShells))));
    completion->footer(
        "Examples:\n  source <(thimble completion bash)\n"
        "  thimble completion zsh > ~/.zfunc/_thimble    # a folder of fpath\n"
        "  thimble completion fish > ~/.config/fish/completions/thimble.fish\n\n"
        "The Debian package brings it for all programs (docs/install.md).");
    return {completion, [&app, shell] {
                fmt::print("{}", completion_script(app.get_name(), *shell));
                return 0;
            }};
}

}  // namespace thimble
