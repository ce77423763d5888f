// The machines that a session file's [launch] names, without a run: are they ready, and what do they need?
#pragma once

#include <filesystem>
#include <string>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "session/settings/launch_settings.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// Names the programs of nodes that speak ROS 2. Throws Error (usage) if one is missing, or if the session has other machines, or
// runs `as_services`.
void take_ros2_programs(const SystemSettings& settings, LaunchSettings& launch, bool as_services);

// Prints a systemd unit for each node, or writes it to FOLDER/MACHINE/ where `folder` is not empty.
void print_units(const std::filesystem::path& session, const LaunchSettings& launch,
                 const NetworkSettings& network, const std::filesystem::path& folder);

// Prints a line for each node: is its machine reached, and has it the program in this version? As JSON one object of machine and
// problem for each node. Logs go to `folder`. Returns the code of the first problem.
ExitCode check_machines(const LaunchSettings& launch, const std::filesystem::path& folder, bool json);

}  // namespace thimble
