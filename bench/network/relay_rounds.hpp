// One measurement of a relay, and of the plain mechanism that it is compared with. Each call is one round. Rounds of
// both alternate, so that disturbances of the machine affect both.
#pragma once

#include <vector>

#include "bench/network/window_errors.hpp"
#include "common/time.hpp"

namespace thimble {

enum class Mode { kSleeping, kPrecise };

struct LatenessRound {
    std::vector<double> errors_us;  // of each packet or deadline, in the order of time
    double cpu_s = 0;               // of the thread that relays or waits
    double wall_s = 0;
};

// About 1 kHz of session-sized datagrams through a relay with this delay, one way; error from due time to the kernel's stamp
// at the receiver, after a warm-up. The sender is a thread with default scheduling.
LatenessRound relay_lateness(Mode mode, Duration delay, Duration length);
// Deadlines at 1 kHz by timerfd and epoll.
LatenessRound timer_lateness(Duration length);
// The same by spinning. Each deadline sends one datagram, and the error ends at the kernel's stamp at the receiver. No relay that
// begins when a packet is due can be faster.
LatenessRound spinner_lateness(Duration length);

// Datagrams per second that come out where more are offered than can be forwarded.
double relay_throughput(Mode mode, Duration delay, Duration length);
double bare_throughput(Duration length);  // recvmmsg, sendmmsg and nothing else

// Round trips at 1 kHz, in microseconds.
std::vector<double> relay_round_trips(int count);
std::vector<double> bare_round_trips(int count);
std::vector<double> forwarder_round_trips(int count);  // epoll, recvmmsg and sendmmsg both ways

}  // namespace thimble
