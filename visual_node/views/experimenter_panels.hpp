// The whole of the experimenter's view, over an empty window: banner, side view, plots, readings, controls.
#pragma once

#include <array>

#include "visual_node/views/experimenter_model.hpp"
#include "visual_node/views/plot_panel.hpp"
#include "visual_node/window/overlay.hpp"

namespace thimble {

class ExperimenterPanels final : public Overlay {
  public:
    // `instance`: random per program start. The channels outlive the panels.
    ExperimenterPanels(std::uint64_t instance, const SessionLink::Channels& channels)
        : model_(instance, channels) {}

    void tick(SessionTime now) override { model_.update(now); }
    void draw(SessionTime now, const OverlayFrame& frame) override;

  private:
    void draw_banner(const Rect& rect, double scale, SessionTime now) const;
    void draw_fault(const Rect& rect, double scale) const;

    ExperimenterModel model_;
    std::array<PlotPanel, kPlotCount> plots_;
};

}  // namespace thimble
