#include "visual_node/views/player_overlay.hpp"

namespace thimble {

PlayerOverlay::PlayerOverlay(std::uint64_t instance, const NetworkSettings& network)
    : sockets_(network),
      link_(sockets_.between(Port::kPlayerMonitor, Port::kSessionPlayerOrders)),
      panel_(instance, {link_, link_}) {}

void PlayerOverlay::tick(SessionTime now) {
    sockets_.tick(now);
    panel_.tick(now);
}

double PlayerOverlay::right_margin(const GlWindow& window) const {
    return PlayerPanel::place(window.width(), window.height(), window.content_scale()).width;
}

// The window is gone before the Monitor can show it, so it is not repeated.
void PlayerOverlay::closing(SessionTime now) {
    for (int i = 0; i < kUnseenOrderTimes; ++i) panel_.quit(now);
}

}  // namespace thimble
