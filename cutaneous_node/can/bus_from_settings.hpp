// The bus that [cutaneous.drives] names, opened.
#pragma once

#include <memory>

#include "common/runtime/sockets.hpp"
#include "cutaneous_node/can/can_bus.hpp"
#include "cutaneous_node/drive_settings.hpp"

namespace thimble {

// A frame that arrives wakes the program, as a datagram does. Throws Error (network).
std::unique_ptr<CanBus> open_bus(const DriveSettings& settings, Sockets& sockets);

}  // namespace thimble
