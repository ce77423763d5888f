// The session that a program shows to others: which one it is, and in which person's role, as its command line says.
#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include "common/network_settings.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

struct ObservedSession {
    std::string config, role = "experimenter";
    int base_port = 0;

    void add_options(CLI::App& app) {
        app.add_option("session", config,
                       "session file (TOML) of the running session, for its ports and its lab key");
        app.add_option("--base-port", base_port, "first UDP port, instead of [network] base_port")
            ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
            ->type_name("PORT");
        app.add_option("--role", role,
                       "connect in place of this person's view: experimenter (thimble run --monitor), or "
                       "player (if an experimenter's view is open as well)")
            ->check(CLI::IsMember({"experimenter", "player"}))
            ->default_val(role);
    }
    NetworkSettings network() const {
        return observed_network(config, static_cast<std::uint16_t>(base_port));
    }
    // Opens the Monitor of one view. Throws Error (network) if another view uses the port.
    Channel& monitor(Sockets& sockets) const {
        return role == "player" ? *sockets.between(Port::kPlayerMonitor, Port::kSessionPlayerOrders)
                                : *sockets.between(Port::kExperimenterMonitor, Port::kSessionOrders);
    }
};

}  // namespace thimble
