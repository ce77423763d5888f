// `thimble link-test --listen`: an EchoResponder behind every UDP port of a session.
#pragma once

#include <atomic>

#include "common/time.hpp"
#include "thimble/link_test/echo_responder.hpp"

namespace thimble {

struct EchoPlan {
    std::uint16_t base_port = 0;
    std::vector<Port> ports;
    Duration limit = std::chrono::minutes{10};  // ends by itself
    const std::atomic<bool>* stop = nullptr;
};

// Until the limit or a stop. Throws Error (network) if a port is taken.
EchoCounters serve_echoes(const EchoPlan& plan);

}  // namespace thimble
