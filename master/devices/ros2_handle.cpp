#include "master/devices/ros2_handle.hpp"

#include <array>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/ros2/ros2_values.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

// As many as the reader keeps. A flood costs no more than this in a tick.
constexpr std::size_t kMostAtOnce = 5;
constexpr Duration kRecently = std::chrono::milliseconds{100};

}  // namespace

Ros2Handle::Ros2Handle(const Ros2HandleSettings& settings, double force_limit_N)
    : RemoteHandle(force_limit_N),
      interface_(settings.interface),
      bus_(domain_, interface_),
      positions_(bus_.reader(kPositions, geometry_msgs_msg_dds__PoseStamped__desc, Ros2Quality::kSensorData)),
      forces_(bus_.writer(kForces, geometry_msgs_msg_dds__WrenchStamped__desc, Ros2Quality::kSensorData)),
      others_(bus_.reader(kForces, geometry_msgs_msg_dds__WrenchStamped__desc, Ros2Quality::kSensorData)) {}

Ros2Handle::~Ros2Handle() { tell_force(0); }

std::string Ros2Handle::name() const {
    return fmt::format("ROS 2, {} and {} in domain {} at {}", kPositions, kForces, domain_, interface_);
}

std::string Ros2Handle::awaits() {
    const SessionTime now = wall_now();
    hear(now);
    if (dds_get_matched_publications(others_, nullptr, 0) > 1)  // forces_ is one
        throw Error(ExitCode::kUsage,
                    "another program sends forces on {} (domain {} at {}), so a device would obey both: end "
                    "the other session, or give each session a domain of its own by ROS_DOMAIN_ID",
                    kForces, domain_, interface_);
    if (heard_within(now, kRecently)) {
        dds_delete(others_);  // it would take time of each force
        return {};
    }
    return fmt::format("waiting for positions on {} (PoseStamped, domain {} at {})", kPositions, domain_,
                       interface_);
}

void Ros2Handle::listen(SessionTime now) {
    std::array<void*, kMostAtOnce> samples{};
    std::array<dds_sample_info_t, kMostAtOnce> infos{};
    const int taken = dds_take(positions_, samples.data(), infos.data(), kMostAtOnce, kMostAtOnce);
    for (std::size_t i = 0; taken > 0 && i < static_cast<std::size_t>(taken); ++i) {
        if (!infos.at(i).valid_data) continue;
        const auto* pose = static_cast<const Ros2Pose*>(samples.at(i));
        take_position(now, infos.at(i).publication_handle, pose->pose.position.z);
    }
    if (taken > 0) dds_return_loan(positions_, samples.data(), taken);
}

void Ros2Handle::tell_force(double force_hand_N) {
    const Ros2Wrench wrench = ros2_wrench(read_clock_pair().realtime_ns, "handle", -force_hand_N);
    bus_.write(forces_, &wrench);
}

}  // namespace thimble
