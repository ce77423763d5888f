// The commands of thimble-netem, each in a file of its own.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct NetemCommand {
    CLI::App* subcommand;      // lives as long as the app it was added to
    std::function<int()> run;  // once the command line has been parsed; returns the exit code
};

// The relay itself, with --listen and --to or with --selftest: options of `app`, no subcommand.
std::function<int()> add_relay(CLI::App& app);
// Each adds its subcommand to `app`.
NetemCommand add_import(CLI::App& app);
NetemCommand add_fit(CLI::App& app);
NetemCommand add_set(CLI::App& app);
NetemCommand add_show(CLI::App& app);
NetemCommand add_watch(CLI::App& app);
NetemCommand add_log(CLI::App& app);
// `programs`: the command line from its first "--" on.
NetemCommand add_shell(CLI::App& app, const std::vector<std::string>& programs);
NetemCommand add_pair(CLI::App& app, const std::vector<std::string>& programs);

// Before a command writes. Throws Error (usage) if a file of `written` is one of `read`, or is named twice. Empty names are none.
void refuse_same_file(const std::vector<std::string>& read, const std::vector<std::string>& written);

// A node of a session, between master and slave_sim: a program of its own with its own command line.
int run_node(int argc, char** argv);

}  // namespace thimble
