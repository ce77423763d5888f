// The panels of both views: plots of the last seconds, the readings, the controls of a recorded trial.
#pragma once

#include <imgui.h>
#include <span>
#include <vector>

#include "common/messages.hpp"
#include "visual_node/views/monitor_history.hpp"
#include "visual_node/views/player_model.hpp"
#include "visual_node/views/session_link.hpp"
#include "visual_node/views/view_layout.hpp"
#include "visual_node/window/image.hpp"

namespace thimble {

// The numbers of the newest Monitor in two columns, with its age. Greyed while the session is silent: they are old then.
void draw_readings(const Rect& rect, const SessionLink& link, SessionTime now);

// The controls of a recorded trial: a scrub bar with marks, steps, speeds. Within a window of ImGui, in its width.
void draw_replay(ReplayModel& model, const Monitor& monitor, double scale, SessionTime now);

// Besides their colour. Where a curve oscillates within a pixel, it is drawn whole whatever its dashes.
enum class Dash { kSolid, kDashed, kDotted };

struct Curve {
    Quantity quantity = Quantity::kNeedle_m;
    Colour colour{};
    Dash dash = Dash::kSolid;
    const char* name = "";
};

struct Band {
    Quantity low = Quantity::kOneWayLow_s, high = Quantity::kOneWayHigh_s;
    Colour colour{};
};

struct PlotSpec {
    const char* title;  // with the unit in which `factor` makes the numbers
    double factor;      // shown = factor x SI
    double span;        // the least that the axis shows, as shown
    std::span<const Curve> curves;
    const Band* band;  // null: none
};

// The four plots of the experimenter's view, and the player's one.
std::span<const PlotSpec, kPlotCount> experimenter_plots();
const PlotSpec& player_plot();

// A plot of the last seconds: curves drawn as one filled column per pixel from their smallest to their largest sample, so
// that nothing faster than a pixel is lost, and so that drawing costs the same whatever is shown.
class PlotPanel {
  public:
    // In `rect`, the newest history.window_s() up to now.
    void draw(ImDrawList& list, const Rect& rect, double scale, const PlotSpec& spec,
              const MonitorHistory& history, SessionTime now);

  private:
    struct Frame;
    void take(const PlotSpec& spec, const MonitorHistory& history, Frame& frame);
    void draw_axes(ImDrawList& list, const PlotSpec& spec, const Frame& frame) const;
    void draw_band(ImDrawList& list, const PlotSpec& spec, const Frame& frame) const;
    void draw_curve(ImDrawList& list, const Curve& curve, std::span<const Column> columns, const Frame& frame,
                    double factor) const;

    // Of every curve and of the two edges of the band; kept between frames for their memory.
    std::vector<std::vector<Column>> columns_;
};

}  // namespace thimble
