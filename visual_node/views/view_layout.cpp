#include "visual_node/views/view_layout.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thimble {
namespace {

// At content scale 1.
constexpr double kBannerHeight = 26, kSideViewHeight = 132, kColumnWidth = 330, kReadingsHeight = 316;
constexpr double kTitleHeight = 16, kNumberWidth = 44, kMargin = 6;
// Positions span most: an oscillation of millimetres in a way of 12 cm.
constexpr std::array kPlotShares{0.34, 0.24, 0.21, 0.21};
constexpr double kRowHeight = 30, kRowGap = 4;
constexpr double kSideViewStep_m = 0.02;

PlotScale around(double low, double high, double step) {
    return {std::floor(low / step) * step, std::ceil(high / step) * step, step};
}

}  // namespace

ExperimenterLayout experimenter_layout(double width, double height, double scale) {
    ExperimenterLayout layout;
    const double column = std::min(kColumnWidth * scale, width / 2);
    const double top = std::min(kBannerHeight * scale, height), left = width - column;
    const double side = std::min(kSideViewHeight * scale, height - top);
    const double readings = std::min(kReadingsHeight * scale, (height - top) * 0.6);
    layout.banner = {0, 0, width, top};
    layout.side_view = {0, top, left, side};
    layout.readings = {left, top, column, readings};
    layout.controls = {left, top + readings, column, height - top - readings};
    double y = top + side;
    for (std::size_t i = 0; i < kPlotCount; ++i) {
        layout.plots[i] = {0, y, left, (height - top - side) * kPlotShares[i]};
        y = layout.plots[i].bottom();
    }
    return layout;
}

Rect plot_box(const Rect& plot, double scale) {
    const double left = kNumberWidth * scale, title = kTitleHeight * scale, margin = kMargin * scale;
    // Whole pixels: a column of a curve is one pixel wide.
    return {std::floor(plot.x + left), std::floor(plot.y + title),
            std::max(1.0, std::floor(plot.width - left - margin)),
            std::max(1.0, std::floor(plot.height - title - margin))};
}

Rect control_cell(const Rect& controls, double scale, int row, int column, int columns) {
    const double margin = kMargin * scale, gap = kRowGap * scale, height = kRowHeight * scale;
    const double pitch = (controls.width - 2 * margin + gap) / columns;
    return {controls.x + margin + column * pitch, controls.y + margin + row * height, pitch - gap,
            height - gap};
}

SideViewScale side_view_scale(const Rect& box, double position_needle_m, double position_deepest_m) {
    const double low_m = std::min(position_needle_m, 0.0);
    const double high_m = std::max(position_needle_m, position_deepest_m);
    return {std::floor(low_m / kSideViewStep_m) * kSideViewStep_m - kSideViewStep_m,
            std::ceil(std::max(high_m, 0.0) / kSideViewStep_m) * kSideViewStep_m + kSideViewStep_m, box};
}

PlotScale round_scale(double low, double high, double span, int lines) {
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
