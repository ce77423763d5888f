#include "common/runtime/runtime_settings.hpp"

#include <cerrno>
#include <cstring>
#include <sched.h>

#include <fmt/format.h>

namespace thimble {

RuntimeSettings read_runtime_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("runtime");
    RuntimeSettings s;
    table.read("realtime_scheduling", s.realtime_scheduling,
               "Use SCHED_FIFO, for the session one priority below the nodes; a warning if the system does "
               "not allow it.");
    table.read("priority", s.priority, 1, 98, "SCHED_FIFO priority of the nodes.");
    table.read("allowed_miss_fraction", s.allowed_miss_fraction, 0, 1,
               "Allowed fraction of deadlines missed by more than 1 ms, with --strict-rt.");
    table.read("overrun", s.overrun, {"warn", "rest", "stop"},
               "Reaction to missed deadlines. warn: a message; rest: also outputs at rest (no force, needle "
               "held) until the program is in time again; stop: also stop everything.");
    read_core(file);  // each reader of this table must know all its keys
    table.read(
        "overrun_limit", s.overrun_limit, 1, 100'000,
        "Number of deadlines missed in a row before the node does what overrun says (docs/safety.md).");
    return s;
}

int read_core(const ConfigFile& file) {
    int core = kAnyCore;
    file.table("runtime").read(
        "core", core, kAnyCore, CPU_SETSIZE - 1,
        "Processor core of all nodes on this machine except those with a window; -1: any.");
    return core;
}

std::string keep_to_core(int core) {
    if (core == kAnyCore) return "";
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(core), &cores);
    if (sched_setaffinity(0, sizeof cores, &cores) == 0) return "";
    return fmt::format(
        "cannot use core {} ({}): the program runs on any core. See core in [runtime], and nproc", core,
        std::strerror(errno));
}

}  // namespace thimble
