// Where everything of the experimenter's view stands, in pixels from the window's top left corner. Pure, so that tests know
// where to look and to click.
#pragma once

#include <array>
#include <cstddef>

namespace thimble {

struct Rect {
    double x = 0, y = 0, width = 0, height = 0;
    double right() const { return x + width; }
    double bottom() const { return y + height; }
};

inline constexpr std::size_t kPlotCount = 4;

struct ExperimenterLayout {
    Rect banner;  // what the session does; the alarm
    Rect side_view;
    std::array<Rect, kPlotCount> plots;  // positions, forces, delays, energy
    Rect readings;
    Rect controls;
};

// `scale`: the monitor's content scale. A small window cuts the plots. Readings and controls scroll.
ExperimenterLayout experimenter_layout(double width, double height, double scale);

// The drawn box of a plot or of the side view in its rectangle, without title and numbers.
Rect plot_box(const Rect& plot, double scale);

// A button among `columns` of the same width in a row of the controls.
Rect control_cell(const Rect& controls, double scale, int row, int column, int columns);

// Between depths and pixels of the side view: z to the right, into the tissue.
struct SideViewScale {
    double low_m = 0, high_m = 0;
    Rect box;

    double x(double position_m) const { return box.x + (position_m - low_m) / (high_m - low_m) * box.width; }
};
// Holds z = 0, the needle and `position_deepest_m` with 20 mm to spare, in steps of 20 mm so that the picture stands still.
SideViewScale side_view_scale(const Rect& box, double position_needle_m, double position_deepest_m);

// From values to pixels, with round numbers at the grid lines: [low, high] are multiples of step, which is 1, 2 or 5 times a power of ten.
struct PlotScale {
    double low = 0, high = 1, step = 1;

    // 0 at low, 1 at high; beyond them beyond.
    double fraction(double value) const { return (value - low) / (high - low); }
};

// The tightest scale that holds both values and at least `span` with at most `lines` + 1 steps. `low` > `high` (nothing was
// seen): [0, span]. `span` > 0, `lines` >= 1.
PlotScale round_scale(double low, double high, double span, int lines);

}  // namespace thimble
