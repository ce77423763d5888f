// One measurement of a relay, and of the bare thing it is weighed against. Each call is one round; rounds of both are
// alternated, so that the machine's moods fall on both.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/network/window_errors.hpp"
#include "common/runtime/runtime_settings.hpp"
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
// The same by spinning, each with the sending of one datagram, to the kernel's stamp at the receiver: the least a relay could do
// that begins when a packet is due, and a witness of the machine's stalls.
LatenessRound spinner_lateness(Duration length);

// So many numbered datagrams, 100 each millisecond, through a relay with 50 ms of delay and 10 ms of jitter that keeps the order.
struct CarriedRound {
    std::uint64_t sent = 0, arrived = 0, early = 0, overtaken = 0;
    std::uint64_t full =
        0;  // found no room in a socket while this machine did not run the program that empties it
};
CarriedRound relay_carries(Mode mode, std::uint64_t packets);

// Datagrams per second that come out where more are offered than can be forwarded.
double relay_throughput(Mode mode, Duration delay, Duration length);
double bare_throughput(Duration length);  // recvmmsg, sendmmsg and nothing else

// Round trips at 1 kHz, in microseconds.
std::vector<double> relay_round_trips(Mode mode, int count);
std::vector<double> bare_round_trips(int count);
std::vector<double> forwarder_round_trips(int count);  // epoll, recvmmsg and sendmmsg both ways

}  // namespace thimble
