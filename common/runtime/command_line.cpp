#include "common/runtime/command_line.hpp"

#include <CLI/CLI.hpp>

#include "common/error.hpp"

namespace thimble {

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return static_cast<int>(app.exit(error) == 0 ? ExitCode::kOk : ExitCode::kUsage);
    }
    return std::nullopt;
}

}  // namespace thimble
