#include "netem/relay/selftest_traffic.hpp"

#include <algorithm>
#include <cstring>

#include "common/runtime/event_waiter.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

std::vector<double> TrafficWay::delays_s() const {
    std::vector<double> delays;
    for (std::size_t i = 0; i < sent.size(); ++i) {
        if (arrived[i] != SessionTime{}) delays.push_back(to_seconds(arrived[i] - sent[i]));
    }
    return delays;
}

SelftestTraffic::SelftestTraffic(std::size_t packets, Duration drain, int server)
    : packets_(packets), drain_(drain), server_(server) {
    for (TrafficWay& way : ways_) {
        way.sent.reserve(2 * packets);
        way.arrived.reserve(2 * packets);
    }
}

SelftestTraffic::~SelftestTraffic() {
    abandoned_ = true;
    if (thread_.joinable()) thread_.join();
}

void SelftestTraffic::launch() {
    thread_ = std::thread([this] { run(); });
}

void SelftestTraffic::start(int client) {
    client_ = client;
    started_ = true;
}

void SelftestTraffic::run() {
    block_signals();
    while (!started_ && !abandoned_) wall_sleep(std::chrono::milliseconds{1});
    if (abandoned_) return;
    EventWaiter waiter(false);
    waiter.add(server_, static_cast<std::uint64_t>(RelayDirection::kUp));
    waiter.add(client_, static_cast<std::uint64_t>(RelayDirection::kDown));
    std::array<epoll_event, 2> room{};
    SessionTime next = wall_now() + kTrafficPeriod;
    SessionTime end = kNever;
    while (!abandoned_ && wall_now() < end) {
        const auto events = waiter.wait(next, next, room);
        stamps_.update(read_clock_pair());
        for (const epoll_event& event : events) receive(static_cast<RelayDirection>(event.data.u64));
        if (wall_now() < next) continue;
        next += kTrafficPeriod;
        const std::vector<SessionTime>& sent = way(RelayDirection::kUp).sent;
        if (sent.size() < packets_) send(RelayDirection::kUp, client_, nullptr);
        if (sent.size() == packets_ && end == kNever) end = wall_now() + drain_;
    }
    finished_ = true;
}

void SelftestTraffic::send(RelayDirection direction, int socket, const UdpAddress* to) {
    std::array<std::uint8_t, std::max(kUpBytes, kDownBytes)> bytes{};
    const std::uint64_t number = way(direction).sent.size();
    std::memcpy(bytes.data(), &number, sizeof number);
    way(direction).sent.push_back(wall_now());
    way(direction).arrived.emplace_back();
    out_.add({bytes.data(), direction == RelayDirection::kUp ? kUpBytes : kDownBytes}, to);
    out_.send(socket);
}

void SelftestTraffic::receive(RelayDirection direction) {
    const bool at_server = direction == RelayDirection::kUp;
    const std::size_t count = arrivals_.receive(at_server ? server_ : client_);
    const SessionTime now = wall_now();
    TrafficWay& arrivals = way(direction);
    for (std::size_t i = 0; i < count; ++i) {
        const auto datagram = arrivals_[i];
        std::uint64_t number = UINT64_MAX;
        if (datagram.bytes.size() >= sizeof number)
            std::memcpy(&number, datagram.bytes.data(), sizeof number);
        if (number >= arrivals.sent.size()) {
            ++arrivals.strangers;
        } else if (arrivals.arrived[number] == SessionTime{}) {  // else a second copy
            arrivals.arrived[number] = stamps_.to_session(datagram.stamp_realtime_ns, now);
        }
        if (at_server) send(RelayDirection::kDown, server_, &datagram.from);
    }
}

}  // namespace thimble
