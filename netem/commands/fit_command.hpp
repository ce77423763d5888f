// thimble-netem fit: a measured path becomes a profile.
#pragma once

#include <functional>
#include <string>

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

// Adds the subcommand. When it was given, `run` is what it does; it returns the exit code.
void add_fit(CLI::App& app, std::function<int()>& run);

}  // namespace thimble
