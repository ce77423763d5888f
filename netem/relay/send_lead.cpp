#include "netem/relay/send_lead.hpp"

#include <arpa/inet.h>
#include <array>
#include <cstdint>

#include "common/error.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/datagram_batch.hpp"

namespace thimble {
namespace {

constexpr int kCalls = 100;
// A processor that was idle needs a while to be as fast as it will be.
constexpr Duration kLength = std::chrono::milliseconds{10};
constexpr std::size_t kBytes = 64;
constexpr Duration kDoubt = std::chrono::nanoseconds{500};
// More is no call but an interruption, or a step of the realtime clock.
constexpr Duration kLongest = std::chrono::microseconds{100};
// The kernel switches its stamps on in a thread of its own, which this one must let run.
constexpr Duration kBreak = std::chrono::microseconds{50};

Duration least_over_loopback() {
    const UdpSocket sink = UdpSocket::listening({htonl(INADDR_LOOPBACK), 0});
    const UdpSocket source = UdpSocket::connected(sink.local());
    EventWaiter watching(false);  // as the relay watches all its sockets, which makes each sending dearer
    watching.add(source.descriptor(), 0);
    const std::array<std::uint8_t, kBytes> bytes{};
    SendBatch batch;
    ReceiveBatch arrivals;
    Duration least = kLongest;
    const SessionTime end = wall_now() + kLength;
    for (int i = 0; i < kCalls || wall_now() < end; ++i) {
        const std::int64_t before_ns = read_clock_pair().realtime_ns;
        batch.add(bytes, nullptr);
        batch.send(source.descriptor());
        const std::int64_t after_ns = read_clock_pair().realtime_ns;
        if (arrivals.receive(sink.descriptor()) != 1) continue;
        const std::int64_t stamp_ns = arrivals[0].stamp_realtime_ns;
        if (stamp_ns > before_ns && stamp_ns <= after_ns) {
            least = std::min(least, Duration{stamp_ns - before_ns});
        } else {
            wall_sleep(kBreak);  // stamped when it was read
        }
    }
    return least == kLongest ? Duration::zero() : std::max(Duration::zero(), least - kDoubt);
}

}  // namespace

Duration measure_send_cost() {
    try {
        return least_over_loopback();
    } catch (const Error&) {  // a network namespace whose loopback is down relays as well
        return Duration::zero();
    }
}

}  // namespace thimble
