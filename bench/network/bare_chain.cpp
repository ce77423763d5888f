#include "bench/network/bare_chain.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <netinet/in.h>
#include <span>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "bench/network/helper_thread.hpp"
#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kSamplePeriod = milliseconds{1};
constexpr Duration kLastAnswer = milliseconds{50};
constexpr int kNobodyAsks_ms = 2000;  // after which a relaying process ends by itself

using Datagram = std::array<std::uint8_t, kForceBytes>;

[[noreturn]] void fail(const char* what) {
    throw Error(ExitCode::kNetwork,
                fmt::format("cannot measure a bare chain on loopback: {}: {}", what, std::strerror(errno)));
}

// A descriptor that closes itself.
class Descriptor {
  public:
    Descriptor(int number, const char* what) : number_(number) {
        if (number_ < 0) fail(what);
    }
    ~Descriptor() { close(number_); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    operator int() const { return number_; }  // NOLINT(google-explicit-constructor): it stands for the number

  private:
    int number_;
};

// Listens on a port of the kernel's choice.
class Inlet {
  public:
    Inlet() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "socket") {
        address_.sin_family = AF_INET;
        address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t length = sizeof address_;
        auto* raw = static_cast<sockaddr*>(static_cast<void*>(&address_));
        if (bind(socket_, raw, length) != 0 || getsockname(socket_, raw, &length) != 0) fail("bind");
    }

    int descriptor() const { return socket_; }
    // The size of the next datagram, nothing if none waits.
    std::size_t receive(Datagram& into) const {
        sockaddr_in source{};
        socklen_t length = sizeof source;
        const auto size = recvfrom(socket_, into.data(), into.size(), MSG_DONTWAIT,
                                   static_cast<sockaddr*>(static_cast<void*>(&source)), &length);
        return size > 0 ? static_cast<std::size_t>(size) : 0;
    }
    void send_to(const Inlet& there, std::span<const std::uint8_t> bytes) const {
        sendto(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
               static_cast<const sockaddr*>(static_cast<const void*>(&there.address_)),
               sizeof there.address_);
    }

  private:
    Descriptor socket_;
    sockaddr_in address_{};
};

// The four sockets, made before there are several processes so that each knows where to send.
struct Way {
    Inlet master, outward, slave, homeward;
};

class Events {
  public:
    Events() : epoll_(epoll_create1(EPOLL_CLOEXEC), "epoll") {}
    void add(int descriptor) {
        epoll_event event{};
        event.events = EPOLLIN;
        event.data.fd = descriptor;
        if (epoll_ctl(epoll_, EPOLL_CTL_ADD, descriptor, &event) != 0) fail("epoll_ctl");
    }
    // Descriptors that are readable; none after the timeout.
    std::span<const epoll_event> wait(int timeout_ms) {
        const int found = epoll_wait(epoll_, room_.data(), static_cast<int>(room_.size()), timeout_ms);
        return {room_.data(), static_cast<std::size_t>(std::max(found, 0))};
    }

  private:
    Descriptor epoll_;
    std::array<epoll_event, 4> room_{};
};

// One hop: what arrives at `from` leaves for `to`, cut or stretched to `bytes`.
struct Hop {
    const Inlet* from;
    const Inlet* to;
    std::size_t bytes;
};

void relay(std::span<const Hop> hops, Events& events) {
    Datagram datagram{};
    for (auto ready = events.wait(kNobodyAsks_ms); !ready.empty(); ready = events.wait(kNobodyAsks_ms)) {
        for (const epoll_event& event : ready) {
            for (const Hop& hop : hops) {
                if (hop.from->descriptor() != event.data.fd) continue;
                if (hop.from->receive(datagram) > 0) hop.from->send_to(*hop.to, {datagram.data(), hop.bytes});
            }
        }
    }
}

// A process that relays until this object goes.
class Relaying {
  public:
    Relaying(const RuntimeSettings& settings, std::span<const Hop> hops)
        : launcher_(getpid()), process_(fork()) {
        if (process_ < 0) fail("fork");
        if (process_ == 0) work(settings, hops);
    }
    ~Relaying() {
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
    Relaying(const Relaying&) = delete;
    Relaying& operator=(const Relaying&) = delete;

  private:
    // Nothing may be thrown past a fork: the caller's caller would run twice.
    [[noreturn]] void work(const RuntimeSettings& settings, std::span<const Hop> hops) const noexcept {
        prctl(PR_SET_PDEATHSIG, SIGKILL, 0UL, 0UL, 0UL);
        if (getppid() != launcher_) _exit(0);  // it had died before
        ask_for_realtime(settings);
        Events events;
        for (const Hop& hop : hops) events.add(hop.from->descriptor());
        relay(hops, events);
        _exit(0);
    }

    pid_t launcher_, process_;
};

// The master's work, without handle, codec and operator.
class Sampler {
  public:
    Sampler(const Way& way, Duration length)
        : way_(&way),
          length_(length),
          timer_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC), "timer") {
        events_.add(timer_);
        events_.add(way.master.descriptor());
        took_us_.reserve(static_cast<std::size_t>(length / kSamplePeriod) + 1);
    }

    void run() {
        next_ = wall_now() + kSamplePeriod;
        const SessionTime last = next_ + length_, end = last + kLastAnswer;
        for (SessionTime now{}; now < end;) {
            arm(next_ < last ? next_ : end);
            events_.wait(-1);
            now = wall_now();
            // Not both in one turn: an answer that came since would have taken no time.
            if (next_ < last && now >= next_) {
                sample(now);
            } else {
                take_answer(now);
            }
        }
    }
    std::vector<double> take() { return std::move(took_us_); }

  private:
    void arm(SessionTime when) {
        if (when != armed_) set_timer(timer_, when);
        armed_ = when;
    }
    void sample(SessionTime now) {
        const std::int64_t stamp_ns = to_nanoseconds(now);
        std::memcpy(datagram_.data(), &stamp_ns, sizeof stamp_ns);
        way_->master.send_to(way_->outward, {datagram_.data(), kNeedleBytes});
        while (next_ <= now) next_ += kSamplePeriod;  // those missed in a stall are gone
    }
    void take_answer(SessionTime now) {
        if (way_->master.receive(datagram_) == 0) return;
        std::int64_t stamp_ns = 0;
        std::memcpy(&stamp_ns, datagram_.data(), sizeof stamp_ns);
        took_us_.push_back(us(now - from_nanoseconds(stamp_ns)));
    }

    const Way* way_;
    Duration length_;
    Descriptor timer_;
    Events events_;
    Datagram datagram_{};
    SessionTime next_{}, armed_{};
    std::vector<double> took_us_;
};

}  // namespace

std::vector<double> bare_chain_round_trips(const RuntimeSettings& settings, Duration length) {
    const Way way;
    const std::array relay_hops{Hop{&way.outward, &way.slave, kNeedleBytes},
                                Hop{&way.homeward, &way.master, kForceBytes}};
    const std::array slave_hops{Hop{&way.slave, &way.homeward, kForceBytes}};
    const Relaying relaying(settings, relay_hops), answering(settings, slave_hops);
    Sampler sampler(way, length);
    // A thread of its own, so that this program keeps its scheduling.
    std::thread([&] {
        ask_for_realtime(settings);
        sampler.run();
    }).join();
    return sampler.take();
}

}  // namespace thimble
