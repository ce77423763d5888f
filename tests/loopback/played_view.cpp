#include "tests/loopback/played_view.hpp"

#include <variant>

namespace thimble {
namespace {

NetworkSettings viewed_network(std::uint16_t base_port) {
    NetworkSettings network;
    network.base_port = base_port;
    return network;
}

}  // namespace

PlayedView::PlayedView(std::uint16_t base_port)
    : sockets_(viewed_network(base_port)),
      in_(sockets_.inlet(Port::kExperimenterMonitor, Role::kSession)),
      orders_(Role::kExperimenter, 200, {sockets_.outlet(Port::kSessionOrders)}) {}

void PlayedView::listen(SessionTime now) {
    while (const Message* message = heard_.receive(now, *in_)) {
        const auto* monitor = std::get_if<Monitor>(&message->body);
        if (monitor == nullptr) continue;
        monitor_ = *monitor;
        trial_ = message->header.trial;
    }
}

}  // namespace thimble
