#include "common/runtime/sockets.hpp"

namespace thimble {

Channel* Sockets::open(const std::optional<Endpoint>& local, const Endpoint& remote) {
    channels_.push_back(std::make_unique<UdpChannel>(local, remote));
    if (local) descriptors_.push_back(channels_.back()->file_descriptor());
    return channels_.back().get();
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
