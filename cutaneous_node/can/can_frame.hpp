// A classic CAN frame (ISO 11898-1, at most 8 bytes), its identifier with the flags of linux/can.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace thimble {

inline constexpr std::uint32_t kCanExtended = 0x80000000U;
inline constexpr std::uint32_t kCanRemote = 0x40000000U;
inline constexpr std::uint32_t kCanError = 0x20000000U;  // made by the kernel, never on a wire

struct CanFrame {
    std::uint32_t id = 0;
    std::uint8_t length = 0;
    std::array<std::uint8_t, 8> data{};
    // A bus that may bring a frame after a later one counts up here; on a wire all are equal.
    std::uint64_t order = 0;

    bool operator==(const CanFrame& other) const {
        return id == other.id && length == other.length && data == other.data;
    }
};

// CANopen is little-endian. `at + bytes` <= 8.
constexpr std::uint32_t load(const CanFrame& frame, std::size_t at, std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value |= std::uint32_t{frame.data[at + i]} << (8 * i);
    return value;
}
constexpr void store(CanFrame& frame, std::size_t at, std::size_t bytes, std::uint32_t value) {
    for (std::size_t i = 0; i < bytes; ++i) frame.data[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace thimble
