// The subcommands of `thimble`, each in a file of its own: what it takes, and what it does.
#pragma once

#include <functional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct Command {
    CLI::App* subcommand;      // lives as long as the app it was added to
    std::function<int()> run;  // once the command line has been parsed; returns the exit code
};

// Each adds its subcommand to `app`. `typed` is the whole command line, for the report's provenance.
Command add_run(CLI::App& app, const std::string& typed);
Command add_up(CLI::App& app, const std::string& typed);
Command add_study(CLI::App& app);
Command add_play(CLI::App& app);
Command add_replay(CLI::App& app);
Command add_report(CLI::App& app, const std::string& typed);
Command add_analyse(CLI::App& app);
Command add_check(CLI::App& app);
Command add_doctor(CLI::App& app);
Command add_exclude(CLI::App& app);
Command add_link_test(CLI::App& app);

}  // namespace thimble
