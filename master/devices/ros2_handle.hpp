// A handle whose driver is a ROS 2 program: it publishes positions (PoseStamped, z in m) and obeys forces (WrenchStamped, z in N).
#pragma once

#include <string>

#include "common/ros2/ros2_device.hpp"
#include "master/devices/remote_handle.hpp"

namespace thimble {

class Ros2Handle final : public RemoteHandle {
  public:
    static constexpr const char* kPositions = "/thimble/handle/measured_cp";
    static constexpr const char* kForces = "/thimble/handle/servo_cf";

    // Throws Error as Ros2Bus does.
    Ros2Handle(const Ros2Settings& settings, double force_limit_N);
    ~Ros2Handle() override;

    std::string name() const override;
    // Throws Error (usage) where another program sends forces.
    std::string awaits() override;
    void describe(nlohmann::ordered_json& report) const override;

  private:
    void listen(SessionTime now) override;
    void tell_force(double force_hand_N) override;
    std::string driver() const override;

    Ros2Device device_;
    dds_entity_t positions_;
};

}  // namespace thimble
