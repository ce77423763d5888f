#include "bench/network/relay_rounds.hpp"

#include <array>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <thread>

#include "bench/network/helper_thread.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/relay_engine.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::size_t kBytes = 144;  // a ForceFeedback
constexpr Duration kPeriod = milliseconds{1};
constexpr std::size_t kManyInFlight = 1'000'000;
constexpr Duration kSpin = std::chrono::microseconds{300};
constexpr Duration kWarmUp = milliseconds{200};  // in which a relay learns how late the timer is

double thread_cpu_s() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Measures the resources that this thread uses while the object lives.
class Usage {
  public:
    explicit Usage(LatenessRound& round) : round_(round) {}
    ~Usage() {
        round_.cpu_s = thread_cpu_s() - cpu_before_s_;
        round_.wall_s = to_seconds(wall_now() - start);
    }

  private:
    LatenessRound& round_;
    double cpu_before_s_ = thread_cpu_s();

  public:
    const SessionTime start = wall_now();
};

// The last core, for round trips "on one core".
void pin() {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(std::thread::hardware_concurrency() - 1), &cores);
    pthread_setaffinity_np(pthread_self(), sizeof cores, &cores);
}

class Unpinned {
  public:
    Unpinned() { pthread_getaffinity_np(pthread_self(), sizeof before_, &before_); }
    ~Unpinned() { pthread_setaffinity_np(pthread_self(), sizeof before_, &before_); }

  private:
    cpu_set_t before_{};
};

bool readable(int descriptor, int timeout_ms) {
    pollfd wanted{descriptor, POLLIN, 0};
    return poll(&wanted, 1, timeout_ms) > 0;
}

RelaySettings settings_for(Mode mode, Duration delay, const UdpAddress& to) {
    RelaySettings settings;
    settings.inlets = {{loopback(), to}};
    settings.links.up.delay = delay;
    settings.links.up.capacity = settings.links.down.capacity = kManyInFlight;
    settings.most_flows = 1;
    settings.precise = mode == Mode::kPrecise;
    return settings;
}

class DueTimes final : public PacketSink {
  public:
    explicit DueTimes(std::size_t room) { due.reserve(room); }
    void add(const PacketRecord& record) override { due.push_back(from_nanoseconds(record.due_ns)); }
    std::vector<SessionTime> due;
};

// About 1 kHz, so that due times fall midway between two sendings: the sender at work is not what is measured.
Duration period_beside(Duration delay) { return 2 * delay / (2 * (delay / kPeriod) + 1); }

// Sends numbered datagrams and notes when the kernel had them at the sink.
class Stream {
  public:
    Stream(const UdpSocket& sink, Duration period, std::size_t packets)
        : sink_(&sink), period_(period), arrived(packets) {}

    void run(const UdpAddress& relay, const std::atomic<bool>& stop) {
        be_ordinary();
        const UdpSocket client = UdpSocket::connected(relay);
        EventWaiter waiter(false);
        waiter.add(sink_->descriptor(), 0);
        std::array<epoll_event, 2> room{};
        for (SessionTime next = wall_now(); !stop;) {
            waiter.wait(next, next, room);
            receive();
            if (wall_now() < next) continue;
            next += period_;
            if (sent_ < arrived.size()) send(client, sent_++);
        }
    }

  private:
    void send(const UdpSocket& client, std::uint64_t number) {
        std::array<std::uint8_t, kBytes> bytes{};
        std::memcpy(bytes.data(), &number, sizeof number);
        ::send(client.descriptor(), bytes.data(), bytes.size(), 0);
    }
    void receive() {
        stamps_.update(read_clock_pair());
        const std::size_t count = in_.receive(sink_->descriptor());
        const SessionTime now = wall_now();
        for (std::size_t i = 0; i < count; ++i) {
            std::uint64_t number = 0;
            std::memcpy(&number, in_[i].bytes.data(), sizeof number);
            if (number < arrived.size()) arrived[number] = stamps_.to_session(in_[i].stamp_realtime_ns, now);
        }
    }

    const UdpSocket* sink_;
    Duration period_;
    ReceiveBatch in_;
    StampClock stamps_;
    std::uint64_t sent_ = 0;

  public:
    std::vector<SessionTime> arrived;
};

// As many as come, as fast as they come.
void flood(const UdpAddress& to, const std::atomic<bool>& stop) {
    be_ordinary();
    const UdpSocket client = UdpSocket::connected(to);
    const std::array<std::uint8_t, kBytes> bytes{};
    SendBatch batch;
    while (!stop) {
        while (!batch.full()) batch.add(bytes, nullptr);
        batch.send(client.descriptor());
    }
}

void echo(const UdpSocket& socket, const std::atomic<bool>& stop) {
    pin();
    std::array<std::uint8_t, 2048> bytes{};
    sockaddr_in from{};
    auto* raw = static_cast<sockaddr*>(static_cast<void*>(&from));
    while (!stop) {
        socklen_t size = sizeof from;
        const auto got = recvfrom(socket.descriptor(), bytes.data(), bytes.size(), 0, raw, &size);
        if (got > 0) sendto(socket.descriptor(), bytes.data(), static_cast<std::size_t>(got), 0, raw, size);
    }
}

void forward(const UdpSocket& inlet, const UdpSocket& out, const std::atomic<bool>& stop) {
    pin();
    EventWaiter waiter(false);
    waiter.add(inlet.descriptor(), 0);
    waiter.add(out.descriptor(), 1);
    std::array<epoll_event, 2> room{};
    UdpAddress client;
    ReceiveBatch in;
    SendBatch batch;
    while (!stop) {
        for (const epoll_event& event : waiter.wait(kNever, wall_now() + milliseconds{100}, room)) {
            const bool up = event.data.u64 == 0;
            if (in.receive((up ? inlet : out).descriptor(), 1) == 0) continue;
            if (up) client = in[0].from;
            batch.add(in[0].bytes, up ? nullptr : &client);
            batch.send((up ? out : inlet).descriptor());
        }
    }
}

// Blocks for at most 200 ms: a lost datagram must not hang the measurement.
void make_blocking(const UdpSocket& socket) {
    const int on = 0;
    const timeval patience{0, 200'000};
    setsockopt(socket.descriptor(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
    setsockopt(socket.descriptor(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    fcntl(socket.descriptor(), F_SETFL, 0);
}

class Server {
  public:
    Server() { make_blocking(socket_); }
    UdpAddress address() const { return socket_.local(); }

  private:
    UdpSocket socket_ = UdpSocket::listening(loopback());
    Helper echoing_{[this](const std::atomic<bool>& stop) { echo(socket_, stop); }};
};

std::vector<double> round_trips(const UdpAddress& to, int count) {
    const Unpinned before;
    pin();
    const UdpSocket client = UdpSocket::connected(to);
    make_blocking(client);
    std::array<std::uint8_t, kBytes> bytes{};
    std::vector<double> took_us;
    for (int i = 0; i < count; ++i) {
        wall_sleep(kPeriod);
        const SessionTime start = wall_now();
        ::send(client.descriptor(), bytes.data(), bytes.size(), 0);
        if (recv(client.descriptor(), bytes.data(), bytes.size(), 0) > 0)
            took_us.push_back(us(wall_now() - start));
    }
    return took_us;
}

}  // namespace

LatenessRound relay_lateness(Mode mode, Duration delay, Duration length) {
    const Duration period = period_beside(delay);
    const auto warm = static_cast<std::size_t>(kWarmUp / period);
    const auto packets = warm + static_cast<std::size_t>(length / period);
    const UdpSocket sink = UdpSocket::listening(loopback());
    DueTimes times(packets);
    RelayEngine engine(settings_for(mode, delay, sink.local()), &times);
    Stream stream(sink, period, packets);
    LatenessRound round;
    {
        Helper sender([&](const std::atomic<bool>& stop) { stream.run(engine.inlet_address(0), stop); });
        const Usage usage(round);
        const SessionTime end = usage.start + kWarmUp + length + delay + milliseconds{20};
        while (wall_now() < end) engine.step(end);
    }
    for (std::size_t i = warm; i < times.due.size(); ++i) {
        if (stream.arrived[i] != SessionTime{})
            round.errors_us.push_back(us(stream.arrived[i] - times.due[i]));
    }
    return round;
}

LatenessRound timer_lateness(Duration length) {
    LatenessRound round;
    EventWaiter waiter(false);
    std::array<epoll_event, 1> room{};
    const Usage usage(round);
    for (SessionTime due = usage.start + kPeriod; due < usage.start + length; due += kPeriod) {
        waiter.wait(due, due, room);
        round.errors_us.push_back(us(wall_now() - due));
    }
    return round;
}

LatenessRound spinner_lateness(Duration length) {
    LatenessRound round;
    const UdpSocket sink = UdpSocket::listening(loopback()), out = UdpSocket::connected(sink.local());
    const std::array<std::uint8_t, kBytes> bytes{};
    std::vector<SessionTime> dues;
    {
        const Usage usage(round);
        for (SessionTime due = usage.start + kPeriod; due < usage.start + length; due += kPeriod) {
            wall_sleep(due - kSpin - wall_now());
            while (wall_now() < due) {
            }
            ::send(out.descriptor(), bytes.data(), bytes.size(), 0);
            dues.push_back(due);
        }
    }
    StampClock stamps;
    stamps.update(read_clock_pair());
    ReceiveBatch in;
    const SessionTime now = wall_now();
    for (std::size_t done = 0, count = 0; (count = in.receive(sink.descriptor())) > 0; done += count) {
        for (std::size_t i = 0; i < count; ++i)
            round.errors_us.push_back(us(stamps.to_session(in[i].stamp_realtime_ns, now) - dues[done + i]));
    }
    return round;
}

double relay_throughput(Mode mode, Duration delay, Duration length) {
    const UdpSocket sink = UdpSocket::listening(loopback());
    RelayEngine engine(settings_for(mode, delay, sink.local()), nullptr);
    const Helper sender([&](const std::atomic<bool>& stop) { flood(engine.inlet_address(0), stop); });
    const auto sent = [&](SessionTime now) {
        return static_cast<double>(engine.totals(now)[RelayDirection::kUp].packets.delivered);
    };
    const auto run_until = [&](SessionTime end) {
        while (wall_now() < end) engine.step(end);
        return end;
    };
    const SessionTime warm = run_until(wall_now() + delay + milliseconds{50});
    const double before = sent(warm);
    const SessionTime start = wall_now();
    run_until(start + length);
    const SessionTime end = wall_now();
    return (sent(end) - before) / to_seconds(end - start);
}

double bare_throughput(Duration length) {
    const UdpSocket sink = UdpSocket::listening(loopback()), inlet = UdpSocket::listening(loopback());
    const UdpSocket out = UdpSocket::connected(sink.local());
    const Helper sender([&](const std::atomic<bool>& stop) { flood(inlet.local(), stop); });
    ReceiveBatch in;
    SendBatch batch;
    double sent = 0;
    const SessionTime start = wall_now(), end = start + length;
    while (wall_now() < end) {
        const std::size_t count = in.receive(inlet.descriptor());
        if (count == 0) readable(inlet.descriptor(), 1);
        for (std::size_t i = 0; i < count; ++i) batch.add(in[i].bytes, nullptr);
        for (const bool accepted : batch.send(out.descriptor())) sent += accepted ? 1 : 0;
    }
    return sent / to_seconds(wall_now() - start);
}

std::vector<double> relay_round_trips(int count) {
    const Server server;
    RelayEngine engine(settings_for(Mode::kSleeping, Duration::zero(), server.address()), nullptr);
    const Helper relaying([&](const std::atomic<bool>& stop) {
        pin();
        while (!stop) engine.step(kNever);
    });
    return round_trips(engine.inlet_address(0), count);
}

// Both ways through two watched sockets, as a relay has them, and nothing else.
std::vector<double> forwarder_round_trips(int count) {
    const Server server;
    const UdpSocket inlet = UdpSocket::listening(loopback()), out = UdpSocket::connected(server.address());
    const Helper forwarding([&](const std::atomic<bool>& stop) { forward(inlet, out, stop); });
    return round_trips(inlet.local(), count);
}

std::vector<double> bare_round_trips(int count) { return round_trips(Server().address(), count); }

}  // namespace thimble
