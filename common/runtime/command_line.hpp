// What every program does with its command line.
#pragma once

#include <optional>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

// Nothing if the program is to go on, else its exit code: what was asked for (--help, --version) or is wrong has
// been said.
std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

}  // namespace thimble
