// The channels of one program, by the names of network_settings.hpp. The table of flows there says who hears whom.
// Implemented by UDP (runtime/sockets.hpp) and by queues in virtual time (session/virtual/queue_network.hpp).
#pragma once

#include "common/channel.hpp"
#include "common/network_settings.hpp"
#include "common/stop_bus.hpp"

namespace thimble {

// A channel lives as long as what opened it. Each port is opened once.
class Ports {
  public:
    virtual ~Ports() = default;

    // Both ways between two ports (control channels, views). A program opens this first: it says whose ports these are.
    virtual Channel* between(Port local, Port remote) = 0;
    // Listens at `local` to the hosts that the table of flows names.
    virtual Channel* inlet(Port local) = 0;
    // Sends to `remote` and receives nothing.
    virtual Channel* outlet(Port remote) = 0;
};

// To the stop buses of all programs of the session.
inline StopOutlets stop_outlets(Ports& ports) {
    StopOutlets outlets{};
    for (std::size_t i = 0; i < outlets.size(); ++i) outlets[i] = ports.outlet(kStopPorts[i]);
    return outlets;
}

}  // namespace thimble
