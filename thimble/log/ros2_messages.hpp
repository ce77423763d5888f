// The ROS 2 messages that logs are exported as: their definitions (common_interfaces, ROS 2 Humble to Jazzy: the same
// in all), and their bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/log/mcap_bytes.hpp"
#include "session/log/ros2_topics.hpp"

namespace thimble {

// Plain CDR, little-endian, as ROS 2 writes messages (OMG DDSI-RTPS 2.5, 10.2; OMG CORBA 3.3 part 2, 9.3): four bytes that say so,
// then each number at a multiple of its own size, counted from behind those four.
class CdrOutput {
  public:
    // Begins a message.
    void begin() {
        out_.clear();
        out_.u32(0x00000100);  // CDR_LE, no options
    }
    void u32(std::uint32_t value) {
        align(4);
        out_.u32(value);
    }
    void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
    void f64(double value) {
        align(8);
        out_.u64(std::bit_cast<std::uint64_t>(value));
    }
    // Its length counts the zero behind it.
    void text(std::string_view text) {
        u32(static_cast<std::uint32_t>(text.size() + 1));
        for (const char letter : text) out_.u8(static_cast<std::uint8_t>(letter));
        out_.u8(0);
    }
    Bytes view() const { return out_.view(); }

  private:
    void align(std::size_t size) {
        while ((out_.size() - 4) % size != 0) out_.u8(0);
    }

    McapOutput out_;
};

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
