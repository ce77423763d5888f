#include "tests/kernel/path_traffic.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/datagram_batch.hpp"

namespace thimble {
namespace {

constexpr std::size_t kBytes = 104;         // as long as a NeedleCommand
constexpr std::uint64_t kWarmUp = 1 << 30;  // numbers of what does not count begin here
constexpr std::size_t kWarmUps = 3;

// A socket stays in the namespace in which it was made, so that one thread can have some in several.
void enter_namespace(const std::string& name) {
    const std::string path = "/run/netns/" + name;
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool entered = descriptor >= 0 && setns(descriptor, CLONE_NEWNET) == 0;
    const int reason = errno;
    if (descriptor >= 0) close(descriptor);
    if (entered) return;
    throw Error(ExitCode::kNetwork,
                fmt::format("cannot enter the network namespace {}: {}; it is made by `ip "
                            "netns add {}`, and entering it needs root",
                            path, std::strerror(reason), name));
}

class PathRun {
  public:
    explicit PathRun(const PathTraffic& traffic) : traffic_(traffic), sent_(traffic.packets) {
        sample_.packets.resize(traffic.packets);
        enter_namespace(traffic.sender_namespace);
        sender_ = UdpSocket::connected(traffic.to);
        enter_namespace(traffic.receiver_namespace);
        receiver_ = UdpSocket::listening(traffic.listen);
        waiter_.add(receiver_.descriptor(), 0);
    }

    PathSample run() {
        for (std::size_t i = 0; i < kWarmUps; ++i) send(kWarmUp + i);
        receive_until(wall_now() + traffic_.drain);
        SessionTime next = wall_now();
        for (std::size_t number = 0; number < traffic_.packets; ++number) {
            sent_[number] = wall_now();
            send(number);
            next += traffic_.period;
            receive_until(next);
        }
        receive_until(wall_now() + traffic_.drain);
        sample_.untrusted = stamps_.untrusted();
        return std::move(sample_);
    }

  private:
    void send(std::uint64_t number) {
        std::array<std::uint8_t, kBytes> bytes{};
        std::memcpy(bytes.data(), &number, sizeof number);
        out_.add(bytes, nullptr);
        if (!out_.send(sender_.descriptor())[0]) {
            throw Error(ExitCode::kNetwork,
                        fmt::format("the kernel did not take packet {} for {}; is there a route?", number,
                                    to_string(traffic_.to)));
        }
    }

    void receive_until(SessionTime end) {
        while (wall_now() < end) {
            if (!waiter_.wait(end, end, events_).empty()) receive();
        }
    }

    void receive() {
        stamps_.update(read_clock_pair());
        const std::size_t count = arrivals_.receive(receiver_.descriptor());
        const SessionTime now = wall_now();
        for (std::size_t i = 0; i < count; ++i) take(arrivals_[i], now);
    }

    void take(const ReceiveBatch::Datagram& datagram, SessionTime now) {
        std::uint64_t number = UINT64_MAX;
        if (datagram.bytes.size() == kBytes) std::memcpy(&number, datagram.bytes.data(), sizeof number);
        if (number >= kWarmUp && number < kWarmUp + kWarmUps) return;
        if (number >= sent_.size()) {
            ++sample_.strangers;
        } else if (sample_.packets[number].arrived) {
            ++sample_.copies;
        } else {
            const Duration delay = stamps_.to_session(datagram.stamp_realtime_ns, now) - sent_[number];
            sample_.packets[number] = {true, number < latest_, delay};
            latest_ = std::max(latest_, number);
        }
    }

    const PathTraffic& traffic_;
    std::vector<SessionTime> sent_;
    PathSample sample_;
    UdpSocket sender_, receiver_;
    EventWaiter waiter_{false};
    std::array<epoll_event, 2> events_{};
    ReceiveBatch arrivals_;
    SendBatch out_;
    StampClock stamps_;
    std::uint64_t latest_ = 0;  // highest number that has arrived
};

}  // namespace

PathSample run_path_traffic(const PathTraffic& traffic) { return PathRun(traffic).run(); }

}  // namespace thimble
