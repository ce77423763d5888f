// What `thimble run` and `thimble up` have in common: trials, or a participant's session, by real processes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "session/launch/node_starter.hpp"
#include "thimble/commands/participant_options.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace thimble {

struct RealRunArguments {
    std::string config, out, typed, plotjuggler;
    int base_port = 0;
    ParticipantArguments participant;
    CLI::Option* out_option = nullptr;
    bool overwrite = false, strict_rt = false, json = false, monitor = false;
};

// Session file, --out, --base-port, --overwrite, --strict-rt, --json, --monitor, --plotjuggler and those of a participant session.
void add_real_run_options(CLI::App& command, const std::string& default_out, RealRunArguments& arguments);

// The nodes' programs lie beside this one.
std::filesystem::path program_folder();
// [network] of the session file, with --base-port.
NetworkSettings network_of(const RealRunArguments& arguments);

// Returns the exit code. Without a starter the nodes run already. Throws Error as run_session and run_participant do.
int run_for_real(const RealRunArguments& arguments, const SystemSettings& settings,
                 const std::shared_ptr<NodeStarter>& starter);

}  // namespace thimble
