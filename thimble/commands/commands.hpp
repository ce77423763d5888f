// The subcommands of `thimble`, one file each: options and action.
#pragma once

#include <functional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct Subcommand {
    CLI::App* subcommand;      // lives as long as the app it was added to
    std::function<int()> run;  // once the command line has been parsed; returns the exit code
    bool by_ranks = false;     // under mpirun each rank runs it; any other command the first one alone
};

// Each adds its subcommand to `app`. `typed` is the whole command line, for the report's provenance.
Subcommand add_run(CLI::App& app, const std::string& typed);
Subcommand add_stop(CLI::App& app);
Subcommand add_study(CLI::App& app);
Subcommand add_fit(CLI::App& app);
Subcommand add_power(CLI::App& app, const std::string& typed);
Subcommand add_play(CLI::App& app);
Subcommand add_replay(CLI::App& app);
Subcommand add_report(CLI::App& app, const std::string& typed);
Subcommand add_analyse(CLI::App& app);
Subcommand add_check(CLI::App& app);
Subcommand add_config(CLI::App& app);
Subcommand add_doctor(CLI::App& app);
Subcommand add_dataset(CLI::App& app);
Subcommand add_compensators(CLI::App& app);
Subcommand add_board(CLI::App& app);
Subcommand add_link_test(CLI::App& app);
Subcommand add_stability(CLI::App& app);
Subcommand add_swarm(CLI::App& app);
Subcommand add_sweep(CLI::App& app);
Subcommand add_log(CLI::App& app);
Subcommand add_keygen(CLI::App& app);
Subcommand add_completion(CLI::App& app);

}  // namespace thimble
