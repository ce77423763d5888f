// Table [runtime] of a session file: how the processes ask the machine for time.
#pragma once

#include "common/config.hpp"

namespace thimble {

struct RuntimeSettings {
    bool realtime_scheduling = true;  // SCHED_FIFO if the system allows it; a warning, not an error, if not
    int priority = 60;
    double allowed_miss_fraction = 0.001;  // of all deadlines, under --strict-rt
};

RuntimeSettings read_runtime_settings(const ConfigFile& file);

}  // namespace thimble
