#include "common/runtime/sockets.hpp"

#include "common/runtime/log/message_log.hpp"
#include "common/runtime/protection.hpp"

namespace thimble {

Sockets::Sockets(NetworkSettings settings) : settings_(std::move(settings)) {
    require_protection(settings_);
    security_ = make_security(settings_);
}

UdpChannel* Sockets::open(const std::optional<Endpoint>& local, const Endpoint& remote) {
    channels_.push_back(std::make_unique<UdpChannel>(local, remote));
    if (local) listeners_.push_back(channels_.back().get());
    return channels_.back().get();
}

void Sockets::count(UdpChannel& channel, std::optional<Port> local, std::optional<Port> remote) {
    if (limit_ == Duration::zero()) return;
    if (local) {
        at_.at(static_cast<std::size_t>(*local)) = &channel;
        channel.await_announced(*local, settings_.base_port, limit_);
    }
    if (!local) channel.send_from(*channels_.front());  // a program opens a port of its own first
    if (remote) channel.count_sent(*remote, sent_.at(static_cast<std::size_t>(*remote)));
}

void Sockets::announce(std::span<const std::uint16_t> datagrams) {
    for (std::size_t i = 0; i < at_.size(); ++i) {
        if (datagrams[i] > 0 && at_[i] != nullptr) at_[i]->announce(datagrams[i]);
    }
}

Channel* Sockets::between(Port local, Port remote) {
    Endpoint here = settings_.at(local);
    const bool moves = security_ && limit_ == Duration::zero();
    // At all addresses of its machine, also those to come.
    if (moves && may_move(local) && leaves_this_machine(here.host)) here.host = "0.0.0.0";
    UdpChannel* channel = open(here, settings_.at(remote));
    if (moves && may_move(remote)) channel->let_peer_move();
    count(*channel, local, remote);
    if (limit_ == Duration::zero()) channel->stamp_arrivals();
    return log_control(security_ ? security_->pair(*channel, local, remote) : channel, local, remote);
}

Channel* Sockets::inlet(Port local) {
    const Flow& heard = flow(local);
    const Role sender = heard.from_all ? heard.listens : heard.hears;
    UdpChannel* channel = open(settings_.at(local), {settings_.host(sender), 0});
    count(*channel, local, std::nullopt);
    if (heard.from_all) channel->listen_also_to({settings_.hosts.begin(), settings_.hosts.end()});
    // A view that has moved may stop too: the seal proves each order, and the channel only answers.
    if (heard.from_all && security_ && limit_ == Duration::zero()) channel->let_peer_move();
    if (!security_) return log_data(channel, local);
    return log_data(
        heard.from_all ? stop_end(*channel, local, StopEnd::kListens) : security_->inlet(*channel, local),
        local);
}

Channel* Sockets::outlet(Port remote) {
    UdpChannel* channel = open(std::nullopt, settings_.at(remote));
    count(*channel, std::nullopt, remote);
    if (!security_) return log_data(channel, remote);
    return log_data(flow(remote).from_all ? stop_end(*channel, remote, StopEnd::kSpeaks)
                                          : security_->outlet(*channel, remote),
                    remote);
}

Channel* Sockets::stop_end(Channel& channel, Port port, StopEnd end) {
    return security_->stop_end(channel, settings_.at(port).port, end);
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
