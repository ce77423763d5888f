#include "common/runtime/sockets.hpp"

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
    return security_ ? security_->pair(*channel, local, remote) : channel;
}

Channel* Sockets::inlet(Port local, Role sender) {
    UdpChannel* channel = open(settings_.at(local), {settings_.host(sender), 0});
    return security_ ? security_->inlet(*channel, local) : channel;
}

Channel* Sockets::outlet(Port remote) {
    UdpChannel* channel = open(std::nullopt, settings_.at(remote));
    return security_ ? security_->outlet(*channel, remote) : channel;
}

Channel* Sockets::device(const Endpoint& local, const Endpoint& remote) {
    require_protection_of_device(settings_.security, remote.host);
    return open(local, remote);
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
