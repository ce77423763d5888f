// Drives in real time: what programs with real or emulated ones share.
#pragma once

#include <memory>

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/can/socket_can_bus.hpp"
#include "cutaneous_node/drive_actuator.hpp"

namespace thimble {

// The bus that [cutaneous.drives] names. A frame that arrives wakes the program, as a datagram does. Throws Error (network).
inline std::unique_ptr<CanBus> open_bus(const DriveSettings& settings, Sockets& sockets) {
    if (settings.cannelloni) {
        const CannelloniAddress& address = *settings.cannelloni;
        return std::make_unique<CannelloniBus>(
            *sockets.device({"0.0.0.0", address.listen_port}, {address.host, address.port}));
    }
    auto bus = std::make_unique<SocketCanBus>(settings.bus);
    sockets.listen_to(*bus);
    return bus;
}

// Until every drive is in operation and every cable taut. Throws Error (run failed) in the words of the actuator, or if a stop is
// requested before.
inline void bring_up_drives(DriveActuator& actuator) {
    while (!actuator.ready()) {
        if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted while the drives were starting");
        actuator.tick(wall_now());
        if (!actuator.fault().empty()) throw Error(ExitCode::kRunFailed, std::string(actuator.fault()));
        wall_sleep(std::chrono::microseconds{200});
    }
}

inline nlohmann::ordered_json describe_drives(const DriveActuator& actuator) {
    const CanopenMaster& master = actuator.master();
    const CanCounters& frames = master.bus().counters();
    return {{"cycles", master.cycles()},
            {"incomplete_cycles", master.incomplete_cycles()},
            {"answered_within", quantiles(master.answered_within())},
            {"frames_sent", frames.sent},
            {"frames_received", frames.received},
            {"frames_send_failed", frames.send_failed},
            {"datagrams_malformed", frames.malformed},
            {"datagrams_repeated", frames.repeated},
            {"datagrams_late", frames.late},
            {"error_passive", master.passive_reports()},
            {"fault", actuator.fault()}};
}

}  // namespace thimble
