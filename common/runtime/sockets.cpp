#include "common/runtime/sockets.hpp"

#include "common/runtime/log/message_log.hpp"
#include "common/runtime/protection.hpp"

namespace thimble {

Sockets::Sockets(NetworkSettings settings) : settings_(std::move(settings)) {
    require_protection(settings_);
    security_ = make_security(settings_.security);
}

UdpChannel* Sockets::open(const std::optional<Endpoint>& local, const Endpoint& remote) {
    channels_.push_back(std::make_unique<UdpChannel>(local, remote));
    if (local) listeners_.push_back(channels_.back().get());
    return channels_.back().get();
}

Channel* Sockets::between(Port local, Port remote) {
    UdpChannel* channel = open(settings_.at(local), settings_.at(remote));
    channel->stamp_arrivals();
    return log_control(security_ ? security_->pair(*channel, local, remote) : channel, local, remote);
}

Channel* Sockets::inlet(Port local, Role sender) {
    UdpChannel* channel = open(settings_.at(local), {settings_.host(sender), 0});
    return log_data(security_ ? security_->inlet(*channel, local) : channel, local);
}

Channel* Sockets::outlet(Port remote) {
    UdpChannel* channel = open(std::nullopt, settings_.at(remote));
    return log_data(security_ ? security_->outlet(*channel, remote) : channel, remote);
}

// As they were before they were sealed, and after they were opened.
Channel* Sockets::log_control(Channel* channel, Port local, Port remote) {
    return log_ == nullptr ? channel : log_->tap(*channel, remote, local);
}

// One way only: the other is never used.
Channel* Sockets::log_data(Channel* channel, Port port) {
    return log_all_ ? log_->tap(*channel, port, port) : channel;
}

Channel* Sockets::device(const Endpoint& local, const Endpoint& remote) {
    require_protection_of_device(settings_.security, remote.host);
    return open(local, remote);
}

Channel* Sockets::inlet_for_all(Port local) {
    UdpChannel* channel = open(settings_.at(local), {settings_.host(owner(local)), 0});
    channel->listen_also_to({settings_.hosts.begin(), settings_.hosts.end()});
    if (!security_) return log_data(channel, local);
    return log_data(security_->stop_end(*channel, settings_.at(local).port, StopEnd::kListens), local);
}

std::array<Channel*, kStopPorts.size()> Sockets::stop_outlets() {
    std::array<Channel*, kStopPorts.size()> outlets{};
    for (std::size_t i = 0; i < outlets.size(); ++i) {
        const Endpoint there = settings_.at(kStopPorts[i]);
        Channel* channel = open(std::nullopt, there);
        if (security_) channel = security_->stop_end(*channel, there.port, StopEnd::kSpeaks);
        outlets[i] = log_data(channel, kStopPorts[i]);
    }
    return outlets;
}

UdpCounters Sockets::counters() const {
    UdpCounters sum;
    for (const auto& channel : channels_) {
        const UdpCounters& one = channel->counters();
        sum.sent += one.sent;
        sum.received += one.received;
        sum.send_failed += one.send_failed;
        sum.foreign_source += one.foreign_source;
        sum.too_long += one.too_long;
    }
    return sum;
}

}  // namespace thimble
