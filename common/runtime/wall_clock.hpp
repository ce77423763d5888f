// The only place in Thimble that asks what time it is.
#pragma once

#include "common/time.hpp"

namespace thimble {

// CLOCK_MONOTONIC: the same for all processes of one machine since it booted, never set back.
SessionTime wall_now();

// The realtime clock (ns since 1970, may be set) between two readings of the monotonic one. Kernel stamps of
// datagrams count on the former (stamp_clock.hpp).
struct ClockPair {
    SessionTime before, after;
    std::int64_t realtime_ns = 0;
};
ClockPair read_clock_pair();

// Lets a timerfd of CLOCK_MONOTONIC become readable at `when`, at once if that is past.
void set_timer(int timer, SessionTime when);

// Sleeps this thread; for launchers and measurements, never for nodes.
void wall_sleep(Duration duration);

// Random bits from the operating system, for instance numbers (never for anything that a seed should
// reproduce).
std::uint64_t system_entropy();

}  // namespace thimble
