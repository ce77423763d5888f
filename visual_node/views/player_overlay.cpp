#include "visual_node/views/player_overlay.hpp"

#include "common/runtime/sockets.hpp"
#include "visual_node/views/player_panel.hpp"

namespace thimble {
namespace {

class PlayerOverlay final : public Overlay {
  public:
    PlayerOverlay(const NetworkSettings& network, std::uint64_t instance)
        : sockets_(network),
          panel_(instance, {sockets_.inlet(Port::kExperimenterMonitor, Role::kSession),
                            sockets_.outlet(Port::kSessionOrders)}) {}

    void tick(SessionTime now) override { panel_.tick(now); }
    void draw(SessionTime now, const OverlayFrame& frame) override { panel_.draw(now, frame); }

  private:
    Sockets sockets_;
    PlayerPanel panel_;
};

}  // namespace

std::unique_ptr<Overlay> make_player_overlay(const NetworkSettings& network, std::uint64_t instance) {
    return std::make_unique<PlayerOverlay>(network, instance);
}

}  // namespace thimble
