// Frames out, frames in, never blocking. Real: SocketCAN, or a bus elsewhere through cannelloni; in tests a queue.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

// Flags of an identifier, as in linux/can.h.
inline constexpr std::uint32_t kCanExtended = 0x80000000U;
inline constexpr std::uint32_t kCanRemote = 0x40000000U;
inline constexpr std::uint32_t kCanError = 0x20000000U;  // made by the kernel, never on a wire

// A classic CAN frame (ISO 11898-1, at most 8 bytes).
struct CanFrame {
    std::uint32_t id = 0;
    std::uint8_t length = 0;
    std::array<std::uint8_t, 8> data{};
    // Increases along the order of sending, for a bus that may deliver out of order; equal for all frames of a wire.
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

// The state of the bus as the controller reports it, worst last. Off: it has withdrawn after too many errors of its own.
enum class BusTrouble : std::uint8_t { kNone, kPassive, kOff, kDown };

struct CanCounters {
    std::uint64_t sent = 0, received = 0;
    std::uint64_t send_failed = 0;  // buffer full, interface down
    std::uint64_t malformed = 0;    // datagrams that are no frames
    std::uint64_t repeated = 0;     // datagrams that came before, and are ignored
    std::uint64_t late = 0;         // datagrams that came after a later one
};

class CanBus : boost::noncopyable {
  public:
    virtual ~CanBus() = default;

    // May wait for flush(), which sends what waits. A frame that cannot be sent is lost and counted.
    virtual void send(const CanFrame& frame) = 0;
    virtual void flush() = 0;
    // False: none is there. Error frames come too, with kCanError.
    virtual bool receive(SessionTime now, CanFrame& frame) = 0;
    // True if the interface is gone. Errors on the wire come as error frames.
    virtual bool down() const = 0;
    const CanCounters& counters() const { return counters_; }

  protected:
    CanCounters counters_;
};

// Of an error frame, by linux/can/error.h: bus-off, or a controller that is error-passive.
constexpr BusTrouble trouble_of(const CanFrame& frame) {
    constexpr std::uint32_t kController = 0x04, kBusOff = 0x40;
    if ((frame.id & kCanError) == 0) return BusTrouble::kNone;
    if ((frame.id & kBusOff) != 0) return BusTrouble::kOff;
    const bool passive = (frame.id & kController) != 0 && (frame.data[1] & 0x30) != 0;
    return passive ? BusTrouble::kPassive : BusTrouble::kNone;
}

}  // namespace thimble
