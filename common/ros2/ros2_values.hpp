// ROS 2's messages (ros2.idl) from numbers of one axis. Cyclone DDS copies a text when it writes a message, so it may belong to others.
#pragma once

#include <cstdint>
#include <ros2.h>
#include <string_view>

namespace thimble {

using Ros2Pose = geometry_msgs_msg_dds__PoseStamped_;
using Ros2Wrench = geometry_msgs_msg_dds__WrenchStamped_;
using Ros2Transform = geometry_msgs_msg_dds__TransformStamped_;
using Ros2Transforms = tf2_msgs_msg_dds__TFMessage_;
using Ros2String = std_msgs_msg_dds__String_;
using Ros2Clock = rosgraph_msgs_msg_dds__Clock_;

// Of a message to be written: the type in C has no const.
inline char* ros2_text(std::string_view text) { return const_cast<char*>(text.data()); }  // NOLINT

inline auto ros2_time(std::int64_t date_ns) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    return builtin_interfaces_msg_dds__Time_{static_cast<std::int32_t>(date_ns / kSecond_ns),
                                             static_cast<std::uint32_t>(date_ns % kSecond_ns)};
}

inline Ros2Pose ros2_pose(std::int64_t date_ns, std::string_view frame, double z_m) {
    return {{ros2_time(date_ns), ros2_text(frame)}, {{0, 0, z_m}, {0, 0, 0, 1}}};
}

inline Ros2Wrench ros2_wrench(std::int64_t date_ns, std::string_view frame, double z_N) {
    return {{ros2_time(date_ns), ros2_text(frame)}, {{0, 0, z_N}, {0, 0, 0}}};
}

inline Ros2Transform ros2_transform(std::int64_t date_ns, std::string_view frame, std::string_view child,
                                    double z_m) {
    return {{ros2_time(date_ns), ros2_text(frame)}, ros2_text(child), {{0, 0, z_m}, {0, 0, 0, 1}}};
}

}  // namespace thimble
