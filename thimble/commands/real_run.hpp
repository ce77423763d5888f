// Trials, or a participant's session, by real processes.
#pragma once

#include <memory>
#include <string>

#include "session/launch/node_starter.hpp"
#include "session/participant/run_participant.hpp"
#include "thimble/commands/run.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace thimble {

struct RealRunArguments {
    RunOptions run;              // out, command, overwrite and strict_rt as typed
    ParticipantRun participant;  // participant, person, resume and commands as typed
    std::string config, plotjuggler;
    int base_port = 0;
    CLI::Option* out_option = nullptr;
    bool json = false, monitor = false;
};

// Session file, --out, --base-port, --overwrite, --strict-rt, --json, --monitor, --plotjuggler and those of a participant session.
void add_real_run_options(CLI::App& command, RealRunArguments& arguments);

// Returns the exit code. Without a starter the nodes run already. Throws Error as run_session and run_participant do.
int run_for_real(const RealRunArguments& given, const SystemSettings& settings,
                 const std::shared_ptr<NodeStarter>& starter);

}  // namespace thimble
