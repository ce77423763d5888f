#include "netem/relay/selftest_traffic.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <csignal>
#include <cstring>

#include "common/runtime/event_waiter.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

enum Tag : std::uint64_t { kServer, kClient };

UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }

}  // namespace

std::vector<double> TrafficWay::delays_s() const {
    std::vector<double> delays;
    for (std::size_t i = 0; i < sent.size(); ++i) {
        if (arrived[i] != SessionTime{}) delays.push_back(to_seconds(arrived[i] - sent[i]));
    }
    return delays;
}

SelftestTraffic::SelftestTraffic(std::size_t packets, Duration drain)
    : packets_(packets), drain_(drain), server_(UdpSocket::listening(loopback())) {
    for (TrafficWay& way : ways_) {
        way.sent.reserve(2 * packets);
        way.arrived.reserve(2 * packets);
    }
}

SelftestTraffic::~SelftestTraffic() {
    abandoned_ = true;
    if (thread_.joinable()) thread_.join();
}

UdpAddress SelftestTraffic::address() const { return server_.local(); }

void SelftestTraffic::launch() {
    thread_ = std::thread([this] { run(); });
}

void SelftestTraffic::start(const UdpAddress& relay) {
    relay_ = relay;
    started_ = true;
}

void SelftestTraffic::run() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    while (!started_ && !abandoned_) wall_sleep(std::chrono::milliseconds{1});
    if (abandoned_) return;
    client_ = UdpSocket::connected(relay_);
    EventWaiter waiter(false);
    waiter.add(server_.descriptor(), kServer);
    waiter.add(client_.descriptor(), kClient);
    std::array<epoll_event, 2> room{};
    SessionTime next = wall_now() + kTrafficPeriod;
    SessionTime end = kNever;
    while (!abandoned_ && wall_now() < end) {
        const auto events = waiter.wait(next, next, room);
        stamps_.update(read_clock_pair());
        for (const epoll_event& event : events)
            event.data.u64 == kServer ? receive_at_server() : receive_at_client();
        if (wall_now() < next) continue;
        next += kTrafficPeriod;
        TrafficWay& up = ways_[static_cast<std::size_t>(RelayDirection::kUp)];
        if (up.sent.size() < packets_) send(RelayDirection::kUp, client_.descriptor(), nullptr);
        if (up.sent.size() == packets_ && end == kNever) end = wall_now() + drain_;
    }
    finished_ = true;
}

void SelftestTraffic::send(RelayDirection direction, int socket, const UdpAddress* to) {
    TrafficWay& way = ways_[static_cast<std::size_t>(direction)];
    std::array<std::uint8_t, std::max(kUpBytes, kDownBytes)> bytes{};
    const std::uint64_t number = way.sent.size();
    std::memcpy(bytes.data(), &number, sizeof number);
    const std::size_t size = direction == RelayDirection::kUp ? kUpBytes : kDownBytes;
    way.sent.push_back(wall_now());
    way.arrived.emplace_back();
    out_.add({bytes.data(), size}, to);
    out_.send(socket);
}

void SelftestTraffic::take(RelayDirection direction, const ReceiveBatch::Datagram& datagram,
                           SessionTime now) {
    TrafficWay& way = ways_[static_cast<std::size_t>(direction)];
    std::uint64_t number = UINT64_MAX;
    if (datagram.bytes.size() >= sizeof number) std::memcpy(&number, datagram.bytes.data(), sizeof number);
    if (number >= way.sent.size()) {
        ++way.strangers;
    } else if (way.arrived[number] != SessionTime{}) {
        ++way.copies;
    } else {
        way.arrived[number] = stamps_.to_session(datagram.stamp_realtime_ns, now);
    }
}

void SelftestTraffic::receive_at_server() {
    const std::size_t count = arrivals_.receive(server_.descriptor());
    const SessionTime now = wall_now();
    for (std::size_t i = 0; i < count; ++i) {
        const auto datagram = arrivals_[i];
        take(RelayDirection::kUp, datagram, now);
        send(RelayDirection::kDown, server_.descriptor(), &datagram.from);
    }
}

void SelftestTraffic::receive_at_client() {
    const std::size_t count = arrivals_.receive(client_.descriptor());
    const SessionTime now = wall_now();
    for (std::size_t i = 0; i < count; ++i) take(RelayDirection::kDown, arrivals_[i], now);
}

}  // namespace thimble
