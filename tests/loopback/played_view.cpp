#include "tests/loopback/played_view.hpp"

#include <variant>

#include "tests/loopback/workbench.hpp"

namespace thimble {
PlayedView::PlayedView(std::uint16_t base_port, Ports ports, const SecuritySettings& security)
    : sockets_(network_at(base_port, security)),
      link_(ports == Ports::kPlayer ? sockets_.between(Port::kPlayerMonitor, Port::kSessionPlayerOrders)
                                    : sockets_.between(Port::kExperimenterMonitor, Port::kSessionOrders)),
      orders_(Role::kExperimenter, ports == Ports::kPlayer ? 201 : 200, {link_}) {}

void PlayedView::listen(SessionTime now) {
    sockets_.tick(now);
    while (const Message* message = heard_.receive(now, *link_)) {
        if (const auto* replay = std::get_if<ReplayState>(&message->body)) replay_ = *replay;
        const auto* monitor = std::get_if<Monitor>(&message->body);
        if (monitor == nullptr) continue;
        monitor_ = *monitor;
        trial_ = message->header.trial;
    }
}

}  // namespace thimble
