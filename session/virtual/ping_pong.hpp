// The time that this machine takes for one datagram there and back between two bare processes. The round trip through
// all five is compared with it.
#pragma once

#include "common/histogram.hpp"
#include "common/runtime/runtime_settings.hpp"

namespace thimble {

// Two processes on loopback, blocking, one exchange per millisecond, datagrams as long as ours, scheduled as
// the nodes are. Must be called while this program has a single thread (it forks). Throws Error (network).
Histogram measure_ping_pong(const RuntimeSettings& settings, int exchanges = 1000);

}  // namespace thimble
