// Plain CDR, little-endian, as ROS 2 writes messages (OMG DDSI-RTPS 2.5, 10.2; OMG CORBA 3.3 part 2, 9.3): four bytes that say so,
// then each number at a multiple of its own size, counted from behind those four.
#pragma once

#include <cstdint>
#include <string_view>

#include "common/log/mcap_bytes.hpp"

namespace thimble {

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

}  // namespace thimble
