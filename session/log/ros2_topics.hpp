// A session's topics in ROS 2, in a file (thimble log export --ros2) and live (thimble-ros2): CRTK's names, types, frames.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "common/messages.hpp"

namespace thimble {

enum class Ros2Type : std::uint8_t {
    kPoseStamped,
    kTwistStamped,
    kWrenchStamped,
    kJointState,
    kString,
    kCount
};

// "geometry_msgs/msg/PoseStamped".
constexpr const char* ros2_name(Ros2Type type) {
    constexpr std::array<const char*, static_cast<std::size_t>(Ros2Type::kCount)> kNames{
        "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TwistStamped", "geometry_msgs/msg/WrenchStamped",
        "sensor_msgs/msg/JointState", "std_msgs/msg/String"};
    return kNames.at(static_cast<std::size_t>(type));
}

struct Ros2Topic {
    const char* name = "";
    Ros2Type type = Ros2Type::kString;
    std::string_view frame{};
};

// Frames: `tissue` (where the needle is), `handle` (where the hand is) and `finger` (its pad), z positive into the tissue, into the
// handle's way of insertion, and into the pad.
inline constexpr std::string_view kTissueFrame = "tissue", kHandleFrame = "handle", kFingerFrame = "finger";

namespace ros2 {

using enum Ros2Type;
inline constexpr Ros2Topic kHandPlace{"/master/measured_cp", kPoseStamped, kHandleFrame},
    kHandVelocity{"/master/measured_cv", kTwistStamped, kHandleFrame},
    kHandForce{"/master/measured_cf", kWrenchStamped, kHandleFrame},
    kHandJoint{"/master/measured_js", kJointState, kHandleFrame},
    kMasterRequest{"/master/servo_cf", kWrenchStamped, kTissueFrame},
    kFingerRequest{"/cutaneous/servo_cf", kWrenchStamped, kTissueFrame},
    kFingerForce{"/cutaneous/measured_cf", kWrenchStamped, kFingerFrame},
    kNeedleRequest{"/slave_sim/servo_cp", kPoseStamped, kTissueFrame},
    kNeedleVelocityRequest{"/slave_sim/servo_cv", kTwistStamped, kTissueFrame},
    kNeedlePlace{"/slave_sim/measured_cp", kPoseStamped, kTissueFrame},
    kTotalForce{"/slave_sim/measured_cf", kWrenchStamped, kTissueFrame},
    kTissueForce{"/slave_sim/tissue/measured_cf", kWrenchStamped, kTissueFrame},
    kFixtureForce{"/slave_sim/fixture/measured_cf", kWrenchStamped, kTissueFrame},
    kSurfacePlace{"/slave_sim/surface/measured_cp", kPoseStamped, kTissueFrame},
    kSurfaceVelocity{"/slave_sim/surface/measured_cv", kTwistStamped, kTissueFrame},
    kProxyPlace{"/slave_sim/proxy/measured_cp", kPoseStamped, kTissueFrame},
    kEvent{"/session/event", kString, {}};

}  // namespace ros2

// "trial start 1 CF", "beep 1", "network change 1 lte 0.0205 s".
inline std::string ros2_event(ControlKind kind, std::uint32_t trial, Modality modality,
                              const NetworkName& network, double network_delay_s) {
    constexpr std::array kNames{"trial start", "beep",     "fixture change",
                                "trial end",   "shutdown", "network change"};
    std::string text = fmt::format("{} {}", kNames.at(static_cast<std::size_t>(kind)), trial);
    if (kind == ControlKind::kTrialStart) text += fmt::format(" {}", to_string(modality));
    if (kind == ControlKind::kNetworkChange) {
        if (!network.empty()) text += fmt::format(" {}", network.view());
        text += fmt::format(" {} s", network_delay_s);
    }
    return text;
}

}  // namespace thimble
