// A relay from start to Ctrl-C: engine, log, control socket, scheduling.
#pragma once

#include <filesystem>
#include <optional>

#include "common/runtime/runtime_settings.hpp"
#include "netem/relay/relay_settings.hpp"
#include "netem/relay/relay_totals.hpp"

namespace thimble {

struct ServiceSettings {
    RelaySettings relay;
    RuntimeSettings runtime;
    std::filesystem::path log;            // "": none
    std::filesystem::path control;        // "": none
    std::optional<UdpAddress> metrics{};  // where Prometheus asks (TCP)
    Duration length{};                    // 0: until a stop is requested
};

// Asks for real-time scheduling and says what came of it; whether precise waiting may be used. Needs one thread that
// relays; threads made before keep the default scheduling.
bool ask_for_precision(const RuntimeSettings& runtime, bool wanted);

// Room for so many sockets, as far as the system allows.
void allow_descriptors(std::size_t wanted);

// Throws Error (network: a port is taken; data: the log).
RelayState run_relay(const ServiceSettings& settings);

}  // namespace thimble
