// The ROS 2 messages that logs are exported as: their definitions (common_interfaces, ROS 2 Humble to Jazzy: the same in all), and their bytes.
#pragma once

#include <string>
#include <string_view>

#include "thimble/log/cdr_output.hpp"

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
const char* ros2_name(Ros2Type type);
// As encoding "ros2msg" has it: the definition, and behind it those that it names.
std::string ros2_definition(Ros2Type type);

// One message. Everything stands on one axis, so z alone is not zero.
struct Ros2Value {
    std::int64_t stamp_ns = 0;  // since 1970
    std::string_view frame;
    double z = 0;                     // m, m/s or N; of a JointState its position, rad or m
    double velocity = 0, effort = 0;  // of a JointState
    std::string_view text{};          // of a String; of a JointState the joint's name
};
// Valid until the next call with this output.
Bytes ros2_bytes(Ros2Type type, const Ros2Value& value, CdrOutput& out);

}  // namespace thimble
