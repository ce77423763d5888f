// The player's panel over the scene of `thimble play`. It has delay and network, each modality with what to expect of it, the last
// seconds, the measured round trip, and the emergency stop, which nothing covers. Of a recorded trial it has the controls of
// draw_replay(). The next step stands in the scene. The panel never draws the fixture.
#pragma once

#include <initializer_list>

#include "common/runtime/sockets.hpp"
#include "visual_node/views/panels.hpp"
#include "visual_node/views/player_model.hpp"
#include "visual_node/views/stop_control.hpp"
#include "visual_node/window/overlay.hpp"

namespace thimble {

class PlayerPanel final : public Overlay {
  public:
    // `instance`: random per program start. Monitors come in at Port::kPlayerMonitor, orders go to
    // Port::kSessionPlayerOrders; the channels outlive the panel and belong to it alone.
    PlayerPanel(std::uint64_t instance, const SessionLink::Channels& channels, StopControl* stops = nullptr)
        : model_(instance, channels), stops_(stops) {}

    void tick(SessionTime now) override { model_.update(now); }
    void draw(SessionTime now, const OverlayFrame& frame) override;

    void press(SessionTime now, Command command) { model_.press(now, command); }
    // Asks the session to end.
    void quit(SessionTime now) { model_.quit(now); }

    // Where it stands in a window of this size, so that the scene can keep out of its way.
    static Rect place(double width, double height, double scale);

  private:
    void draw_row(std::initializer_list<Command> commands, double scale, SessionTime now);
    void draw_delay(double scale, SessionTime now);
    void draw_modalities(double scale, SessionTime now);
    void draw_words(SessionTime now) const;
    void draw_rows(double scale, SessionTime now);
    void draw_hint(const Rect& scene, double scale) const;
    void draw_plot(double scale, SessionTime now);

    PlayerModel model_;
    StopControl* stops_;  // null: no button
    PlotPanel plot_;
};

// The player's panel with sockets of its own, as `thimble-visual --role player` puts it over the scene. Closing the window ends the
// game: the session gets Quit.
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
    StopControl stops_;
    PlayerPanel panel_;
};

}  // namespace thimble
