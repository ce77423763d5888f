// A needle whose robot is a ROS 2 program: it publishes position (PoseStamped, z in m) and force (WrenchStamped, z in
// N) and obeys positions.
#pragma once

#include <string>

#include <fmt/format.h>

#include "common/ros2/ros2_device.hpp"
#include "slave_sim/remote_needle.hpp"

namespace thimble {

class Ros2Needle final : public RemoteNeedle {
  public:
    static constexpr const char* kOrders = "/thimble/slave/servo_cp";
    static constexpr const char* kPositions = "/thimble/slave/measured_cp";
    static constexpr const char* kForces = "/thimble/slave/measured_cf";

    // Throws Error as Ros2Bus does.
    Ros2Needle(const Ros2Settings& settings, const RobotLimits& limits);
    ~Ros2Needle() override;

    std::string name() const override;
    // Throws Error (usage) where another program sends orders.
    std::string awaits() override;
    void describe(nlohmann::ordered_json& report) const override;

  private:
    void listen(SessionTime now) override;
    void tell_position(double position_m) override;
    std::string place_sender() const override { return fmt::format("the ROS 2 robot at {}", kPositions); }
    std::string force_sender() const override { return fmt::format("the ROS 2 robot at {}", kForces); }

    Ros2Device device_;
    dds_entity_t positions_, forces_;
};

}  // namespace thimble
