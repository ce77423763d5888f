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
               "Ask for SCHED_FIFO, the session one step below the nodes; if the system refuses, a warning.");
    table.read("priority", s.priority, 1, 98, "The nodes' priority in SCHED_FIFO.");
    table.read("allowed_miss_fraction", s.allowed_miss_fraction, 0, 1,
               "Of deadlines missed by more than 1 ms, under --strict-rt.");
    table.read(
        "overrun", s.overrun, {"warn", "rest", "stop"},
        "Say so (warn); also keep the outputs at rest until it is in time again; also stop everything.");
    read_core(file);  // each reader of this table must know all its keys
    table.read("overrun_limit", s.overrun_limit, 1, 100'000,
               "So many deadlines missed in a row: the node does what overrun says (docs/safety.md).");
    return s;
}

int read_core(const ConfigFile& file) {
    int core = kAnyCore;
    file.table("runtime").read(
        "core", core, kAnyCore, CPU_SETSIZE - 1,
        "The processor core that all nodes of this machine share but one with a window; -1: any.");
    return core;
}

std::string keep_to_core(int core) {
    if (core == kAnyCore) return "";
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(core), &cores);
    if (sched_setaffinity(0, sizeof cores, &cores) == 0) return "";
    return fmt::format("cannot keep to core {} ({}): it runs on any. See core in [runtime], and nproc", core,
                       std::strerror(errno));
}

}  // namespace thimble
