// What this machine charges for the way of a sample through the processes of the haptic loop if nobody does anything
// with it: the yardstick of thimble-bench chain.
#pragma once

#include <cstddef>
#include <vector>

#include "common/runtime/runtime_settings.hpp"
#include "common/time.hpp"

namespace thimble {

inline constexpr std::size_t kNeedleBytes = 104, kForceBytes = 144;  // as docs/protocol.md says

// Three processes on loopback, A -> B -> C -> B -> A: B relays, C answers a needle command with a force. A sends at
// 1 kHz and takes its answers as the master does (absolute timerfd, epoll, stamps taken on waking); all use epoll,
// recvfrom and sendto and are scheduled as nodes are. Returns the round trips of A in microseconds, in order, as many
// as came back. Must be called while this program has a single thread (it forks). Throws Error (network; run failed).
std::vector<double> bare_chain_round_trips(const RuntimeSettings& settings, Duration length);

}  // namespace thimble
