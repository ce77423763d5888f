// The whole of the experimenter's view, over an empty window: banner, cut-away view, plots, readings, controls.
#pragma once

#include <array>

#include "visual_node/views/experimenter_model.hpp"
#include "visual_node/views/panels.hpp"
#include "visual_node/views/stop_control.hpp"
#include "visual_node/views/view_layout.hpp"
#include "visual_node/window/overlay.hpp"

namespace thimble {

class ExperimenterPanels final : public Overlay {
  public:
    // `instance`: random per program start. The channels outlive the panels.
    ExperimenterPanels(std::uint64_t instance, const SessionLink::Channels& channels,
                       StopControl* stops = nullptr)
        : model_(instance, channels), stops_(stops) {}

    void tick(SessionTime now) override { model_.update(now); }
    void draw(SessionTime now, const OverlayFrame& frame) override;
    // For experimenter_layout().scene, painted before draw(); nothing before a session was heard.
    std::optional<Scene> scene() const { return model_.scene(); }

  private:
    void draw_banner(const Rect& rect, double scale, SessionTime now) const;
    void draw_fault(const Rect& rect, double scale) const;

    ExperimenterModel model_;
    StopControl* stops_;  // null: no button
    std::array<PlotPanel, kPlotCount> plots_;
};

// The experimenter's buttons, in rows of control_cell().
enum ControlRow : int {
    kSliderRow,
    kStepRow,
    kNetworkRow,  // and the next one
    kModalityRow = kNetworkRow + 2,
    kTrialRow,
    kAfterRow,
    kNoticeRow
};
inline constexpr int kNetworksPerRow = 3;

void draw_controls(const Rect& rect, double scale, ExperimenterModel& model, SessionTime now);
// The question that excluding asks, over everything; nothing while there is none.
void draw_question(double scale, ExperimenterModel& model, SessionTime now);

// `thimble-visual --role experimenter`: a window of its own, which hears the session and asks it. It is no node of the session: both may
// come and go while the other runs.

// Whether the command line asks for this view, before it is parsed.
bool asks_for_experimenter_view(int argc, char** argv);
// Until the window is closed, SIGINT or SIGTERM; returns the exit code.
int run_experimenter_view(int argc, char** argv);

}  // namespace thimble
