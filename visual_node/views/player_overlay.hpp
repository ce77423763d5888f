// The player's panel with sockets of its own, for the window of `thimble-visual --view player`.
#pragma once

#include <memory>

#include "common/network_settings.hpp"
#include "visual_node/window/overlay.hpp"

namespace thimble {

// Listens at Port::kExperimenterMonitor, sends to Port::kSessionOrders: the experimenter's view cannot run on the same base
// port at the same time. Throws Error (network) if the port is taken.
std::unique_ptr<Overlay> make_player_overlay(const NetworkSettings& network, std::uint64_t instance);

}  // namespace thimble
