#include "thimble/log/ros2_messages.hpp"

#include <initializer_list>

namespace thimble {
namespace {

struct Definition {
    const char *name, *text;
};

constexpr Definition kTime{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"};
constexpr Definition kHeader{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"};
constexpr Definition kPoint{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr Definition kVector{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr Definition kQuaternion{"geometry_msgs/Quaternion",
                                 "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"};
constexpr Definition kPose{"geometry_msgs/Pose",
                           "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"};
constexpr Definition kTwist{"geometry_msgs/Twist",
                            "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"};
constexpr Definition kWrench{"geometry_msgs/Wrench",
                             "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"};

std::string with_parts(std::string text, std::initializer_list<Definition> parts) {
    for (const Definition& part : parts) {
        text += std::string(80, '=') + "\nMSG: " + part.name + '\n' + part.text;
    }
    return text;
}

void put_header(const Ros2Value& value, CdrOutput& out) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    out.i32(static_cast<std::int32_t>(value.stamp_ns / kSecond_ns));
    out.u32(static_cast<std::uint32_t>(value.stamp_ns % kSecond_ns));
    out.text(value.frame);
}

void put_numbers(std::initializer_list<double> numbers, CdrOutput& out) {
    for (const double number : numbers) out.f64(number);
}

void put_joint(const Ros2Value& value, CdrOutput& out) {
    out.u32(1);
    out.text(value.text);
    for (const double number : {value.z, value.velocity, value.effort}) {
        out.u32(1);
        out.f64(number);
    }
}

}  // namespace

std::string ros2_definition(Ros2Type type) {
    const std::string header = "std_msgs/Header header\n";
    switch (type) {
        case Ros2Type::kPoseStamped:
            return with_parts(header + "geometry_msgs/Pose pose\n",
                              {kHeader, kTime, kPose, kPoint, kQuaternion});
        case Ros2Type::kTwistStamped:
            return with_parts(header + "geometry_msgs/Twist twist\n", {kHeader, kTime, kTwist, kVector});
        case Ros2Type::kWrenchStamped:
            return with_parts(header + "geometry_msgs/Wrench wrench\n", {kHeader, kTime, kWrench, kVector});
        case Ros2Type::kJointState:
            return with_parts(
                header + "string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
                {kHeader, kTime});
        default:
            return "string data\n";
    }
}

Bytes ros2_bytes(Ros2Type type, const Ros2Value& value, CdrOutput& out) {
    out.begin();
    if (type == Ros2Type::kString) {
        out.text(value.text);
        return out.view();
    }
    put_header(value, out);
    if (type == Ros2Type::kJointState) {
        put_joint(value, out);
    } else if (type == Ros2Type::kPoseStamped) {
        put_numbers({0, 0, value.z, 0, 0, 0, 1}, out);
    } else {
        put_numbers({0, 0, value.z, 0, 0, 0}, out);
    }
    return out.view();
}

}  // namespace thimble
