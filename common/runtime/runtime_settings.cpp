#include "common/runtime/runtime_settings.hpp"

#include <cerrno>
#include <cstring>
#include <sched.h>

#include <fmt/format.h>

namespace thimble {

RuntimeSettings read_runtime_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("runtime");
    RuntimeSettings s;
    s.realtime_scheduling = table.boolean("realtime_scheduling", s.realtime_scheduling);
    s.priority = static_cast<int>(table.integer("priority", s.priority, 1, 98));
    s.allowed_miss_fraction = table.number("allowed_miss_fraction", s.allowed_miss_fraction, 0, 1);
    s.overrun = static_cast<OverrunPolicy>(table.choice("overrun", 0, {"warn", "rest", "stop"}));
    read_core(file);  // each reader of this table must know all its keys
    s.overrun_limit = static_cast<unsigned>(table.integer("overrun_limit", s.overrun_limit, 1, 100'000));
    return s;
}

int read_core(const ConfigFile& file) {
    return static_cast<int>(file.table("runtime").integer("core", kAnyCore, kAnyCore, CPU_SETSIZE - 1));
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
