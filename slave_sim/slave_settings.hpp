// The slave's settings in a session's configuration file.
#pragma once

#include <chrono>
#include <cstdint>

#include "common/config.hpp"
#include "common/control/controller_ends.hpp"
#include "common/reduction/codec_settings.hpp"
#include "common/ros2_settings.hpp"
#include "common/time.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

// The slave's end of a controller that has two, as "wave" and "two-port" have, with what the master's table says of the handle.
struct SlaveControl {
    ControlSettings control{};
    HandleControlScale scale{};
};

enum class SlaveDevice : std::uint8_t { kSimulated, kRos2 };

// Limits of a robot that moves the needle.
struct RobotLimits {
    double shallowest_m = -0.05, deepest_m = 0.15;
    double speed_limit_m_per_s = 0.25;  // ISO 10218's beside a person
    double force_limit_N = 20;
};

struct SlaveSettings {
    SlaveDevice device = SlaveDevice::kSimulated;
    RobotLimits robot{};
    Ros2Settings ros2{};
    SceneDeclaration scene = paper_scene();
    TissueMaker make_tissue = solver_maker({});
    Duration contact_hold = std::chrono::seconds(5);
    // Without a command for this long the needle is held (the process watches it).
    Duration stale_after = std::chrono::milliseconds(20);
    // Between samples further apart than this, the needle's place is unknown.
    Duration longest_step = std::chrono::milliseconds(100);

    double fixture_position_m() const;  // of the scene's first forbidden region, which trials move
    SlaveControl control{};             // in HF
    CodecSettings codec{};              // of table [codec]
};

// Time to start the robot; zero for the simulated needle.
inline Duration user_limit(const SlaveSettings& settings) {
    return settings.device == SlaveDevice::kRos2 ? kRos2DriverLimit : Duration::zero();
}

// Tables [tissue], [fixture], [trial] and [slave_sim]. Throws Error (usage).
SlaveSettings read_slave_settings(const ConfigFile& file);

}  // namespace thimble
