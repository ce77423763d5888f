// The part of the command line that all programs share.
#pragma once

#include <optional>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

// Nothing if the program is to go on, else its exit code: what was asked for (--help, --version) or is wrong has
// been said. Counts are digits alone, without a sign, and numbers finite, whatever else their options allow. Every program
// also answers a shell that completes its words (shell_completion.hpp), and takes `help [COMMAND...]` and `version` as first words.
std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

}  // namespace thimble
