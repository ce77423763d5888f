// Table [runtime] of a session file: how the processes ask the machine for time.
#pragma once

#include <string>

#include "common/config.hpp"
#include "common/node_process.hpp"

namespace thimble {

struct RuntimeSettings {
    bool realtime_scheduling = true;  // SCHED_FIFO if the system allows it; a warning, not an error, if not
    int priority = 60;
    double allowed_miss_fraction = 0.001;  // of all deadlines, under --strict-rt
    OverrunPolicy overrun =
        OverrunPolicy::kWarn;  // what a node does that is late for overrun_limit deadlines in a row
    unsigned overrun_limit = 20;
};

RuntimeSettings read_runtime_settings(const ConfigFile& file);

// One processor core for the programs of the haptic loop (`core` of [runtime]): a datagram then wakes its receiver without a call
// to another core.

inline constexpr int kAnyCore = -1;

// Throws Error (usage) for what is no number of a core.
int read_core(const ConfigFile& file);

// From now on the calling thread runs on this core only. Returns "" or what to tell the user.
std::string keep_to_core(int core);

}  // namespace thimble
