// Kernel stamps of datagrams (SO_TIMESTAMPNS) count on the realtime clock, which people and daemons set. Here they
// become session time, and where that cannot be trusted the caller's `now` takes their place.
#pragma once

#include <cstdint>

#include "common/runtime/wall_clock.hpp"
#include "common/time.hpp"

namespace thimble {

class StampClock {
  public:
    // A fresh pair of readings, once per round of receiving. Pairs that an interruption has torn apart are left out.
    void update(const ClockPair& pair);

    // When the kernel had the datagram; never later than `now`.
    SessionTime to_session(std::int64_t stamp_realtime_ns, SessionTime now);

    std::uint64_t steps() const { return steps_; }          // of the realtime clock
    std::uint64_t untrusted() const { return untrusted_; }  // stamps replaced by `now`

  private:
    std::int64_t offset_ns_ = 0;  // session time minus realtime
    SessionTime read_at_{};
    SessionTime doubtful_until_ = kNever;  // until the first pair
    std::uint64_t steps_ = 0, untrusted_ = 0;
};

// For one datagram at a time; reads both clocks itself. A stamp (0: there is none) becomes session time that is never before
// the arrival, and at most a few microseconds after it.
class ArrivalClock {
  public:
    SessionTime arrival(std::int64_t stamp_realtime_ns);

  private:
    StampClock clock_;
};

}  // namespace thimble
