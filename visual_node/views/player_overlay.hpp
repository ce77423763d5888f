// The player's panel with sockets of its own, as `thimble-visual --view player` puts it over the scene. Closing the window ends the game: the session gets Quit.
#pragma once

#include "common/runtime/sockets.hpp"
#include "visual_node/views/player_panel.hpp"

namespace thimble {

class PlayerOverlay final : public Overlay {
  public:
    // `instance`: random per program start. Throws Error (network) if the port of Monitors is taken.
    PlayerOverlay(std::uint64_t instance, const NetworkSettings& network);

    void tick(SessionTime now) override;
    void draw(SessionTime now, const OverlayFrame& frame) override { panel_.draw(now, frame); }
    double right_margin(const GlWindow& window) const override;
    void closing(SessionTime now) override;

  private:
    Sockets sockets_;
    Channel* link_;
    PlayerPanel panel_;
};

}  // namespace thimble
