#include <algorithm>
#include <cmath>

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/panels.hpp"

namespace thimble {
namespace {

constexpr std::array kPositionCurves{
    Curve{Quantity::kSurface_m, kSurfaceOnDark, Dash::kDashed, "surface"},
    Curve{Quantity::kNeedle_m, kNeedleOnDark, Dash::kSolid, "needle"},
    Curve{Quantity::kFixture_m, kReddishPurple, Dash::kDotted, "fixture"},
};
constexpr std::array kForceCurves{
    Curve{Quantity::kForceHand_N, kYellow, Dash::kDashed, "handle"},
    Curve{Quantity::kForceTotal_N, kBluishGreen, Dash::kSolid, "needle"},
};
constexpr std::array kDelayCurves{
    Curve{Quantity::kOneWay_s, kSkyBlue, Dash::kDashed, "one way"},
    Curve{Quantity::kRoundTrip_s, kOrange, Dash::kSolid, "round trip"},
};
constexpr std::array kEnergyCurves{
    Curve{Quantity::kEnergy_J, kYellow, Dash::kSolid, "into the handle"},
};
constexpr std::array kPlayerCurves{
    Curve{Quantity::kSurface_m, kSurfaceOnDark, Dash::kDashed, "surface"},
    Curve{Quantity::kNeedle_m, kNeedleOnDark, Dash::kSolid, "needle"},
};
constexpr Band kOneWayBand{Quantity::kOneWayLow_s, Quantity::kOneWayHigh_s, kSkyBlue};

constexpr std::array<PlotSpec, kPlotCount> kExperimenterPlots{{
    {"depth, mm", 1e3, 20, kPositionCurves, nullptr},
    {"force on the hand, N", 1, 1, kForceCurves, nullptr},
    {"delay, ms", 1e3, 10, kDelayCurves, &kOneWayBand},
    {"energy, mJ", 1e3, 1, kEnergyCurves, nullptr},
}};
constexpr PlotSpec kPlayerPlot{"mm", 1e3, 20, kPlayerCurves, nullptr};

// Lengths in pixels at scale 1; time lines every so many seconds.
constexpr double kSample = 16;         // of a curve, beside its name
constexpr double kRoomForNames = 270;  // a narrower plot sets them closer together
constexpr double kLineWidth = 2, kLinePitch = 24, kSteepPitch = 3;
constexpr double kTimeLine_s = 1;

// Whether a dash covers this column; numbered from the trial's start, so that dashes move with their curve.
bool covered(Dash dash, std::int64_t column, std::int64_t scale) {
    column /= scale;
    switch (dash) {
        case Dash::kSolid:
            return true;
        case Dash::kDashed:
            return column % 12 < 8;
        case Dash::kDotted:
            return column % 5 < 2;
    }
    return true;
}

}  // namespace

std::span<const PlotSpec, kPlotCount> experimenter_plots() { return kExperimenterPlots; }
const PlotSpec& player_plot() { return kPlayerPlot; }

struct PlotPanel::Frame {
    Rect box;
    double pixels = 1;  // content scale
    PlotScale scale;
    double begin_s = 0, column_s = 0;
    std::int64_t first_column = 0;

    double y(double shown) const { return box.bottom() - scale.fraction(shown) * box.height; }
};

void PlotPanel::take(const PlotSpec& spec, const MonitorHistory& history, Frame& frame) {
    const auto width = static_cast<std::size_t>(frame.box.width);
    columns_.resize(spec.curves.size() + 2);
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        columns_[i].resize(width);
        const bool curve = i < spec.curves.size();
        if (!curve && spec.band == nullptr) break;
        const bool lower = i == spec.curves.size();
        const Quantity quantity =
            curve ? spec.curves[i].quantity : (lower ? spec.band->low : spec.band->high);
        history.decimate(quantity, frame.begin_s, frame.column_s, columns_[i]);
        // A wide bound must not flatten the curves: the axis is the curves'.
        for (const Column& column : columns_[i]) {
            if (!curve || !column.present) continue;
            low = std::min(low, column.low * spec.factor);
            high = std::max(high, column.high * spec.factor);
        }
    }
    // Zero belongs to every one of these quantities: a curve that stands high is seen to stand high.
    const int lines = std::max(1, static_cast<int>(frame.box.height / (kLinePitch * frame.pixels)) - 1);
    frame.scale = round_scale(std::min(low, 0.0), std::max(high, 0.0), spec.span, lines);
}

void PlotPanel::draw_axes(ImDrawList& list, const PlotSpec& spec, const Frame& frame) const {
    const Rect& box = frame.box;
    const double margin = 4 * frame.pixels;
    const auto steps = std::lround((frame.scale.high - frame.scale.low) / frame.scale.step);
    for (std::int64_t i = 0; i <= steps; ++i) {
        const double value = frame.scale.low + static_cast<double>(i) * frame.scale.step;
        const double y = std::min(std::floor(frame.y(value)), box.bottom() - 1);
        list.AddRectFilled(point(box.x, y), point(box.right(), y + 1), paint(kGrid));
        const TextLine number = TextLine::of("{:.6g}", std::abs(value) < frame.scale.step / 2 ? 0 : value);
        draw_text_left_of(list, point(box.x - margin, y - small_text_height() / 2), kWhite, number.c_str());
    }
    const double end_s = frame.begin_s + box.width * frame.column_s;
    for (double time_s = std::ceil(frame.begin_s / kTimeLine_s) * kTimeLine_s; time_s < end_s;
         time_s += kTimeLine_s) {
        const double x = box.x + std::floor((time_s - frame.begin_s) / frame.column_s);
        list.AddRectFilled(point(x, box.y), point(x + 1, box.bottom()), paint(kGrid, 0.6));
    }
    double x = box.x + draw_text(list, point(box.x, box.y - small_text_height() - 2), kWhite, spec.title);
    const double closer = box.width < kRoomForNames * frame.pixels ? 0.5 : 1;
    const double sample = closer * kSample * frame.pixels;
    for (const Curve& curve : spec.curves) {
        x += 3 * closer * margin;
        const double middle = box.y - small_text_height() / 2 - 1, width = kLineWidth * frame.pixels;
        for (std::int64_t i = 0; i < static_cast<std::int64_t>(sample); ++i) {
            if (!covered(curve.dash, i, static_cast<std::int64_t>(frame.pixels))) continue;
            const double left = x + static_cast<double>(i);
            list.AddRectFilled(point(left, middle), point(left + 1, middle + width), paint(curve.colour));
        }
        x += sample + margin;
        x += draw_text(list, point(x, box.y - small_text_height() - 2), kWhite, curve.name);
    }
}

void PlotPanel::draw_band(ImDrawList& list, const PlotSpec& spec, const Frame& frame) const {
    if (spec.band == nullptr) return;
    const auto& low = columns_[spec.curves.size()];
    const auto& high = columns_[spec.curves.size() + 1];
    for (std::size_t i = 0; i < low.size(); ++i) {
        if (!low[i].present || !high[i].present) continue;
        const double x = frame.box.x + static_cast<double>(i);
        list.AddRectFilled(point(x, frame.y(high[i].high * spec.factor)),
                           point(x + 1, frame.y(low[i].low * spec.factor)), paint(spec.band->colour, 0.3));
    }
}

void PlotPanel::draw_curve(ImDrawList& list, const Curve& curve, std::span<const Column> columns,
                           const Frame& frame, double factor) const {
    const double width = kLineWidth * frame.pixels;
    const auto pitch = static_cast<std::int64_t>(frame.pixels);
    const ImU32 colour = paint(curve.colour);
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const Column& column = columns[i];
        if (!column.present) continue;
        double low = column.low, high = column.high;
        if (column.joined && i > 0 && columns[i - 1].present) {  // up to where the line came from
            low = std::min(low, columns[i - 1].last);
            high = std::max(high, columns[i - 1].last);
        }
        const double top = frame.y(high * factor), bottom = frame.y(low * factor);
        const bool steep = bottom - top > kSteepPitch * frame.pixels;
        if (!steep && !covered(curve.dash, frame.first_column + static_cast<std::int64_t>(i), pitch))
            continue;
        const double x = frame.box.x + static_cast<double>(i);
        list.AddRectFilled(point(x, std::floor(top - width / 2)), point(x + 1, std::ceil(bottom + width / 2)),
                           colour);
    }
}

void PlotPanel::draw(ImDrawList& list, const Rect& rect, double scale, const PlotSpec& spec,
                     const MonitorHistory& history, SessionTime now) {
    Frame frame;
    frame.box = plot_box(rect, scale);
    frame.pixels = std::max(1.0, scale);
    frame.column_s = history.window_s() / frame.box.width;
    frame.begin_s =
        column_begin(history.end_s(now), frame.column_s, static_cast<std::size_t>(frame.box.width));
    frame.first_column = std::max<std::int64_t>(0, std::llround(frame.begin_s / frame.column_s) + (1 << 20));
    take(spec, history, frame);
    draw_axes(list, spec, frame);
    list.PushClipRect(corner(frame.box), far_corner(frame.box), true);
    draw_band(list, spec, frame);
    for (std::size_t i = 0; i < spec.curves.size(); ++i) {
        draw_curve(list, spec.curves[i], columns_[i], frame, spec.factor);
    }
    list.PopClipRect();
}

}  // namespace thimble
