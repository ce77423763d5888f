// The plug-ins that the tests are built with, and the faults of bad_plugin.c.
#pragma once

#include <filesystem>
#include <string>

#include "common/control/control_settings.hpp"

namespace thimble::test {

// As in bad_plugin.c.
enum class Fault {
    kNone,
    kCrash,
    kNotANumber,
    kHang,
    kAllocate,
    kClock,
    kRange,
    kLeave,
    kRefuse,
    kGlobal,
    kActive,
    kRemember,
    kAbort,
    kRandom,
    kFar,  // from here on: of the slave's end, in two_ends.so
    kEcho,
    kSharedSlave,
    kOldSlave,
    kHangInCreate,
    kHangInDestroy,
    kSlowInCreate  // 10 ms, as an interpreter that starts
};

inline std::filesystem::path plugin_file(const std::string& name) {
    return std::filesystem::path(THIMBLE_PLUGINS) / (name + ".so");
}

inline ControlSettings control_by(const std::filesystem::path& file) {
    ControlSettings control;
    control.compensator = Compensator::kPlugin;
    control.plugin = load_plugin(file);
    return control;
}

inline ControlSettings control_of(const std::string& name) { return control_by(plugin_file(name)); }

inline ControlSettings bad(Fault fault) {
    ControlSettings control = control_of("bad");
    control.plugin.values = {static_cast<double>(fault)};
    return control;
}

}  // namespace thimble::test
