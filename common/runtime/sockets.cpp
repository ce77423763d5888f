#include "common/runtime/sockets.hpp"

#include "common/runtime/log/message_log.hpp"

namespace thimble {

UdpChannel* Sockets::open(const std::optional<Endpoint>& local, const Endpoint& remote) {
    channels_.push_back(std::make_unique<UdpChannel>(local, remote));
    if (local) listeners_.push_back(channels_.back().get());
    return channels_.back().get();
}

Channel* Sockets::between(Port local, Port remote) {
    UdpChannel* channel = open(settings_.at(local), settings_.at(remote));
    channel->stamp_arrivals();
    return log_ == nullptr ? channel : log_->tap(*channel, remote, local);
}

// One way only: the other is never used.
Channel* Sockets::data(Channel& channel, Port port) {
    return log_all_ ? log_->tap(channel, port, port) : &channel;
}

Channel* Sockets::inlet_for_all(Port local) {
    UdpChannel* channel = open(settings_.at(local), {settings_.host(owner(local)), 0});
    channel->listen_also_to({settings_.hosts.begin(), settings_.hosts.end()});
    return channel;
}

std::array<Channel*, kStopPorts.size()> Sockets::stop_outlets() {
    std::array<Channel*, kStopPorts.size()> outlets{};
    for (std::size_t i = 0; i < outlets.size(); ++i) outlets[i] = outlet(kStopPorts[i]);
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
