#include "cutaneous_node/can/bus_from_settings.hpp"

#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/can/socket_can_bus.hpp"

namespace thimble {

std::unique_ptr<CanBus> open_bus(const DriveSettings& settings, Sockets& sockets) {
    if (settings.cannelloni) {
        const CannelloniAddress& address = *settings.cannelloni;
        return std::make_unique<CannelloniBus>(
            *sockets.device({"0.0.0.0", address.listen_port}, {address.host, address.port}));
    }
    auto bus = std::make_unique<SocketCanBus>(settings.bus);
    sockets.listen_to(*bus);
    return bus;
}

}  // namespace thimble
