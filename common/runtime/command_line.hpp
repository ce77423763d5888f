// The part of the command line that all programs share.
#pragma once

#include <optional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

// Nothing if the program is to go on, else its exit code: what was asked for (--help, --version) or is wrong has
// been said. Counts are digits alone, without a sign, and numbers finite, whatever else their options allow. Every program
// also takes --completion SHELL, which its --help does not list.
std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

// The completion script of a shell (one of kCompletedShells) for this program. `app` has all its options and subcommands.
std::string completion_of(const CLI::App& app, const std::string& shell);

}  // namespace thimble
