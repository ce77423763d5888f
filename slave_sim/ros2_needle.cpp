#include "slave_sim/ros2_needle.hpp"

#include <poll.h>

#include <fmt/format.h>

#include "common/ros2/ros2_values.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kRecently = std::chrono::milliseconds{100};
constexpr int kLastHolds = 5, kBetweenHolds_ms = 2;

}  // namespace

Ros2Needle::Ros2Needle(const Ros2Settings& settings, const RobotLimits& limits)
    : RemoteNeedle(limits),
      device_(settings, kOrders, geometry_msgs_msg_dds__PoseStamped__desc),
      positions_(device_.hears(kPositions, geometry_msgs_msg_dds__PoseStamped__desc)),
      forces_(device_.hears(kForces, geometry_msgs_msg_dds__WrenchStamped__desc)) {}

// A program that ends in a trial, or soon after, holds the needle, too. DDS may lose an order, so it is said again.
Ros2Needle::~Ros2Needle() {
    hold(wall_now());
    for (int more = 0; more < kLastHolds && repeat_hold(wall_now()); ++more)
        poll(nullptr, 0, kBetweenHolds_ms);
}

std::string Ros2Needle::name() const {
    return fmt::format("ROS 2, {}, {} and {} in {}", kOrders, kPositions, kForces, device_.where());
}

std::string Ros2Needle::awaits() {
    const SessionTime now = wall_now();
    hear(now);
    if (device_.found_alone(now, heard_within(now, kRecently), "robot")) return {};
    return fmt::format("waiting for a robot on {} (PoseStamped) and {} (WrenchStamped), {}{}", kPositions,
                       kForces, device_.where(), device_.wrong_types());
}

void Ros2Needle::describe(nlohmann::ordered_json& report) const {
    RemoteNeedle::describe(report);
    device_.describe(report["robot"]);
}

void Ros2Needle::listen(SessionTime now) {
    device_.open(now);
    device_.take<Ros2Pose>(positions_, [&](std::uint64_t writer, const Ros2Pose& pose) {
        take_position(now, writer, pose.pose.position.z);
    });
    device_.take<Ros2Wrench>(forces_, [&](std::uint64_t writer, const Ros2Wrench& wrench) {
        take_force(now, writer, wrench.wrench.force.z);
    });
}

void Ros2Needle::tell_position(double position_m) {
    const Ros2Pose pose = ros2_pose(read_clock_pair().realtime_ns, "tissue", position_m);
    device_.tell(&pose);
}

}  // namespace thimble
