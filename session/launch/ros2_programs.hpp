// Nodes that speak ROS 2, which are programs of their own (THIMBLE_ROS2): of the handle and of the slave.
#pragma once

#include <filesystem>
#include <vector>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

struct Ros2Program {
    Role role = Role::kMaster;
    const char* table = "";  // of the session file, whose `device` asks for it
    const char* name = "";
};

// Those that the session asks for.
inline std::vector<Ros2Program> ros2_programs(const SystemSettings& settings) {
    std::vector<Ros2Program> programs;
    programs.reserve(2);
    if (settings.handle.kind == HandleKind::kRos2)
        programs.push_back({Role::kMaster, "[handle]", "thimble-ros2-master"});
    if (settings.slave.device == SlaveDevice::kRos2)
        programs.push_back({Role::kSlaveSim, "[slave_sim]", "thimble-ros2-slave"});
    return programs;
}

// The program's file, in the folder of this program. Throws Error (usage) if it is missing.
inline std::filesystem::path path_of(const Ros2Program& ros2) {
    auto path = program_folder() / ros2.name;
    if (std::filesystem::exists(path)) return path;
    throw Error(ExitCode::kUsage,
                "{} device = \"ros2\" needs {}, which is missing: install the package thimble-ros2, or "
                "build with -DTHIMBLE_ROS2=ON",
                ros2.table, path.string());
}

}  // namespace thimble
