// --analysis, of every command that analyses trials.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace thimble {

// `name` gets "paper" or "full"; parse_analysis (analysis.hpp) reads both.
inline CLI::Option* add_analysis_option(CLI::App& command, std::string& name) {
    return command
        .add_option(
            "--analysis", name,
            "paper: its tests, chosen by its normality rule; full: also corrections, effect sizes and "
            "confidence intervals")
        ->default_val("full")
        ->check(CLI::IsMember({"paper", "full"}));
}

}  // namespace thimble
