// Table [runtime] of a session file: how the processes ask the machine for time.
#pragma once

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

}  // namespace thimble
