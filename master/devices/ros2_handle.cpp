#include "master/devices/ros2_handle.hpp"

#include <fmt/format.h>

#include "common/ros2/ros2_values.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kRecently = std::chrono::milliseconds{100};

}  // namespace

Ros2Handle::Ros2Handle(const Ros2Settings& settings, double force_limit_N)
    : RemoteHandle(force_limit_N),
      device_(settings, kForces, geometry_msgs_msg_dds__WrenchStamped__desc),
      positions_(device_.hears(kPositions, geometry_msgs_msg_dds__PoseStamped__desc)) {}

Ros2Handle::~Ros2Handle() { tell_force(0); }

std::string Ros2Handle::name() const {
    return fmt::format("ROS 2, {} and {} in {}", kPositions, kForces, device_.where());
}

std::string Ros2Handle::awaits() {
    const SessionTime now = wall_now();
    hear(now);
    if (device_.found_alone(now, heard_within(now, kRecently), "device")) return {};
    return fmt::format("waiting for positions on {} (PoseStamped, {}){}", kPositions, device_.where(),
                       device_.wrong_types());
}

void Ros2Handle::describe(nlohmann::ordered_json& report) const {
    RemoteHandle::describe(report);
    device_.describe(report["remote"]);
}

std::string Ros2Handle::driver() const { return fmt::format("the ROS 2 driver at {}", kPositions); }

void Ros2Handle::listen(SessionTime now) {
    device_.open(now);
    device_.take<Ros2Pose>(positions_, [&](std::uint64_t writer, const Ros2Pose& pose) {
        take_position(now, writer, pose.pose.position.z);
    });
}

void Ros2Handle::tell_force(double force_hand_N) {
    const Ros2Wrench wrench = ros2_wrench(read_clock_pair().realtime_ns, "handle", -force_hand_N);
    device_.tell(&wrench);
}

}  // namespace thimble
