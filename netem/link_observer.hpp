// A link's reports about single packets, for logs. Counters stand in link_model.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/channel.hpp"
#include "common/time.hpp"

namespace thimble {

// The reason why a packet, or its second copy, never leaves.
enum class DropReason : std::uint8_t {
    kLost,        // the loss model, or a trace
    kOutage,      // pushed while nothing gets through
    kOversized,   // empty, or larger than any UDP datagram
    kQueueFull,   // the transmitter's queue: the newest, or with head drop the oldest
    kOverflowed,  // LinkSettings::capacity packets are in flight already
};

class LinkObserver {
  public:
    virtual ~LinkObserver() = default;
    // `packet`: its number since the last restart. `received`: when it was pushed, which with head drop was before the
    // push that decided it. Called twice for a packet if both copies are dropped.
    virtual void on_drop(std::uint64_t packet, SessionTime received, std::size_t bytes,
                         DropReason reason) = 0;
};

// A packet that leaves; its lateness is (time of the pop) - due.
struct Departure {
    std::uint64_t packet = 0;  // its number since the last restart
    SessionTime received{};    // when it was pushed
    SessionTime due{};
    Bytes bytes{};                   // empty: nothing is due. Valid until the next push, restart or change
    bool copy = false;               // the second of two
    bool corrupted = false;          // bits were flipped
    std::uint8_t traffic_class = 0;  // as pushed; "congestion experienced" if it was marked
};

}  // namespace thimble
