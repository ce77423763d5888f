#include "common/runtime/core_choice.hpp"

#include <cerrno>
#include <cstring>
#include <sched.h>

#include <fmt/format.h>

namespace thimble {

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
