// The part of ROS 2 that is no DDS, so that every program can read and check it.
#pragma once

#include <charconv>
#include <string>

#include "common/config.hpp"
#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/time.hpp"

namespace thimble {

// For the program on the other side to be started.
inline constexpr Duration kRos2DriverLimit = std::chrono::seconds{60};

// Tables [handle.ros2] and, among others, [slave_sim.ros2] of a session file.
struct Ros2Settings {
    std::string interface = "127.0.0.1";
};

inline Ros2Settings read_ros2_settings(const ConfigTable& table) {
    Ros2Settings settings;
    table.read("interface", settings.interface,
               "Address of the one network interface that DDS uses (docs/ros2.md).");
    return settings;
}

// DDSI-RTPS 2.5, 9.6.2: the ports of a higher domain end beyond 65535.
inline constexpr unsigned kLastRos2Domain = 232;

// ROS_DOMAIN_ID as ROS 2 reads it; 0 where it is not set. Throws Error (usage).
inline unsigned ros2_domain() {
    const std::string text = environment_text("ROS_DOMAIN_ID");
    if (text.empty()) return 0;
    unsigned domain = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, domain);
    if (read.ec == std::errc() && read.ptr == end && domain <= kLastRos2Domain) return domain;
    throw Error(ExitCode::kUsage, "ROS_DOMAIN_ID is '{}': it must be a number from 0 to {}", text,
                kLastRos2Domain);
}

}  // namespace thimble
