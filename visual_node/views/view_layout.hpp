// Where everything of the experimenter's view stands, in pixels from the window's top left corner. Pure, so that tests know
// where to look and to click.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "visual_node/window/mesh.hpp"

namespace thimble {

// At content scale 1.
inline constexpr double kBannerHeight = 26, kReadingsHeight = 280;
// The column takes a share of the window between these. Plots and scene: at least, as far as there is room.
inline constexpr double kColumnShare = 0.36, kColumnLeast = 300, kColumnMost = 330;
inline constexpr double kPlotsWidth = 270, kSceneWidth = 120;

inline constexpr double kStopHeight = 56;
inline constexpr double kTitleHeight = 16, kNumberWidth = 44, kMargin = 6;

// Positions span most: an oscillation of millimetres in a way of 12 cm.
inline constexpr std::array kPlotShares{0.34, 0.24, 0.21, 0.21};

inline constexpr double kRowHeight = 28, kRowGap = 4;

inline constexpr std::size_t kPlotCount = 4;

struct ExperimenterLayout {
    Rect banner;                         // what the session does; the alarm
    Rect scene;                          // the cut-away view, at the left
    std::array<Rect, kPlotCount> plots;  // positions, forces, delays, energy
    Rect readings;
    Rect controls;
    Rect stop;  // beneath the controls
};

// `scale`: the monitor's content scale. From 800x600 on the scene has 0.45 of what the column leaves. In a smaller window readings and
// controls scroll.
inline ExperimenterLayout experimenter_layout(double width, double height, double scale) {
    ExperimenterLayout layout;
    const double column =
        std::min(std::clamp(kColumnShare * width, kColumnLeast * scale, kColumnMost * scale), width / 2);
    const double top = std::min(kBannerHeight * scale, height), left = width - column;
    const double scene =
        std::floor(std::min(std::max(left - kPlotsWidth * scale, kSceneWidth * scale), 0.45 * left));
    const double readings = std::min(kReadingsHeight * scale, (height - top) * 0.6);
    layout.banner = {0, 0, width, top};
    layout.scene = {0, top, scene, height - top};
    layout.readings = {left, top, column, readings};
    const double stop = std::min(kStopHeight * scale, (height - top - readings) / 3);
    layout.controls = {left, top + readings, column, height - top - readings - stop};
    layout.stop = {left, layout.controls.bottom(), column, stop};
    double y = top;
    for (std::size_t i = 0; i < kPlotCount; ++i) {
        layout.plots[i] = {scene, y, left - scene, (height - top) * kPlotShares[i]};
        y = layout.plots[i].bottom();
    }
    return layout;
}

// The drawn box of a plot in its rectangle, without title and numbers.
inline Rect plot_box(const Rect& plot, double scale) {
    const double left = kNumberWidth * scale, title = kTitleHeight * scale, margin = kMargin * scale;
    // Whole pixels: a column of a curve is one pixel wide.
    return {std::floor(plot.x + left), std::floor(plot.y + title),
            std::max(1.0, std::floor(plot.width - left - margin)),
            std::max(1.0, std::floor(plot.height - title - margin))};
}

// A button among `columns` of the same width in a row of the controls.
inline Rect control_cell(const Rect& controls, double scale, int row, int column, int columns) {
    const double margin = kMargin * scale, gap = kRowGap * scale, height = kRowHeight * scale;
    const double pitch = (controls.width - 2 * margin + gap) / columns;
    return {controls.x + margin + column * pitch, controls.y + margin + row * height, pitch - gap,
            height - gap};
}

// From values to pixels, with round numbers at the grid lines: [low, high] are multiples of step, which is 1, 2 or 5 times a power of ten.
struct PlotScale {
    double low = 0, high = 1, step = 1;

    // 0 at low, 1 at high; beyond them beyond.
    double fraction(double value) const { return (value - low) / (high - low); }
};

inline PlotScale around(double low, double high, double step) {
    return {std::floor(low / step) * step, std::ceil(high / step) * step, step};
}

// The tightest scale that holds both values and at least `span` with at most `lines` + 1 steps. `low` > `high` (nothing was
// seen): [0, span]. `span` > 0, `lines` >= 1.
inline PlotScale round_scale(double low, double high, double span, int lines) {
    assert(span > 0 && lines >= 1);
    if (low > high) low = high = 0;
    if (high - low < span) high = low + span;
    // Rounding outwards adds up to two steps, so the first power to try is one that is too fine.
    double power = std::pow(10, std::floor(std::log10((high - low) / lines)));
    for (;; power *= 10) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            const PlotScale scale = around(low, high, factor * power);
            if (std::lround((scale.high - scale.low) / scale.step) <= lines + 1) return scale;
        }
    }
}

}  // namespace thimble
