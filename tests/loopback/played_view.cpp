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

PlayedView::PlayedView(std::uint16_t base_port, Ports ports)
    : sockets_(viewed_network(base_port)),
      in_(sockets_.inlet(ports == Ports::kPlayer ? Port::kPlayerMonitor : Port::kExperimenterMonitor,
                         Role::kSession)),
      orders_(
          Role::kExperimenter, ports == Ports::kPlayer ? 201 : 200,
          {sockets_.outlet(ports == Ports::kPlayer ? Port::kSessionPlayerOrders : Port::kSessionOrders)}) {}

void PlayedView::listen(SessionTime now) {
    while (const Message* message = heard_.receive(now, *in_)) {
        if (const auto* replay = std::get_if<ReplayState>(&message->body)) replay_ = *replay;
        const auto* monitor = std::get_if<Monitor>(&message->body);
        if (monitor == nullptr) continue;
        monitor_ = *monitor;
        trial_ = message->header.trial;
    }
}

}  // namespace thimble
