// thimble-netem fit: a measured path becomes a profile.
#pragma once

#include <functional>
#include <string>
#include <utility>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct FitArguments {
    std::string up, down;  // traces (CSV); without `down` both directions are alike
    std::string out;       // profile (TOML); empty: only say what was found
    std::string table;     // .dist of the standardised delays upwards; empty: none
};

// Throws Error.
int fit_command(const FitArguments& arguments);

// Adds the subcommand. The function is what it does once the command line has been parsed; it returns the exit code.
std::pair<CLI::App*, std::function<int()>> add_fit(CLI::App& app);

}  // namespace thimble
