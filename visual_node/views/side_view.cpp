#include "visual_node/views/side_view.hpp"

#include <algorithm>
#include <cmath>

#include "visual_node/views/drawing.hpp"

namespace thimble {
namespace {

constexpr double kLine_m = 0.02;  // grid

struct SideFrame {
    SideViewScale z;
    double pixels = 1;
    double middle = 0;  // y of the needle
};

void draw_depths(ImDrawList& list, const SideFrame& frame) {
    const Rect& box = frame.z.box;
    for (double depth_m = frame.z.low_m; depth_m < frame.z.high_m + kLine_m / 2; depth_m += kLine_m) {
        const double x = std::min(std::floor(frame.z.x(depth_m)), box.right() - 1);
        list.AddRectFilled(point(x, box.y), point(x + 1, box.bottom()), paint(kGrid));
        if (depth_m + kLine_m > frame.z.high_m) continue;
        const TextLine number = TextLine::of("{:.0f}", depth_m * 1e3 + 0.0);
        draw_text(list, point(x + 2 * frame.pixels, box.bottom() - small_text_height() - 1), kWhite,
                  number.c_str());
    }
}

// Pressed in by the needle until it breaks; the rest of the surface is drawn where the contact point is as well, because
// nobody models it.
void draw_tissue(ImDrawList& list, const SideFrame& frame, const Monitor& monitor) {
    const Rect& box = frame.z.box;
    const double x = std::clamp(frame.z.x(monitor.position_surface_m), box.x, box.right());
    list.AddRectFilled(point(x, box.y), far_corner(box), paint(kSkyBlue, 0.25));
    const double width = 2 * frame.pixels;
    list.AddRectFilled(point(std::floor(x - width / 2), box.y),
                       point(std::floor(x + width / 2), box.bottom()), paint(kSkyBlue));
}

void draw_needle(ImDrawList& list, const SideFrame& frame, const Monitor& monitor) {
    const Rect& box = frame.z.box;
    const double tip = std::clamp(frame.z.x(monitor.position_needle_m), box.x, box.right());
    const bool inside = monitor.phase == TissuePhase::kPenetrated;
    const double entry = inside ? std::clamp(frame.z.x(monitor.position_surface_m), box.x, tip) : tip;
    const double half = 2 * frame.pixels;
    list.AddRectFilled(point(box.x, frame.middle - half), point(entry, frame.middle + half), paint(kWhite));
    if (inside) {
        list.AddRectFilled(point(entry, frame.middle - half), point(tip, frame.middle + half),
                           paint(kOrange));
    }
    const double tip_length = 8 * frame.pixels;
    list.AddTriangleFilled(point(tip - tip_length, frame.middle - 2 * half), point(tip, frame.middle),
                           point(tip - tip_length, frame.middle + 2 * half),
                           paint(inside ? kOrange : kWhite));
}

void draw_fixture(ImDrawList& list, const SideFrame& frame, const Monitor& monitor) {
    if (!monitor.fixture_present) return;
    const Rect& box = frame.z.box;
    const double x = frame.z.x(monitor.position_fixture_m);
    draw_dashed_vertical(list, x, box.y, box.bottom(), 3 * frame.pixels, 4 * frame.pixels, kReddishPurple);
    // min(needle, fixture): what the hand feels as if it were there.
    const double proxy_m = std::min(monitor.position_needle_m, monitor.position_fixture_m);
    const double radius = 5 * frame.pixels;
    list.AddCircle(point(frame.z.x(proxy_m), frame.middle), static_cast<float>(radius), paint(kYellow), 16,
                   static_cast<float>(1.5 * frame.pixels));
}

void draw_legend(ImDrawList& list, const Rect& rect, const SideFrame& frame, const Monitor& monitor) {
    struct Entry {
        Colour colour{};
        const char* name = "";
        bool shown = false;
    };
    const double y = frame.z.box.y - small_text_height() - 2;
    double x = rect.x + 8 * frame.pixels;
    x += draw_text(list, point(x, y), kWhite, "side view, mm");
    const bool inside = monitor.phase == TissuePhase::kPenetrated;
    for (const Entry& entry : {Entry{kSkyBlue, "surface", true}, Entry{kOrange, "inserted", inside},
                               Entry{kReddishPurple, "fixture", monitor.fixture_present},
                               Entry{kYellow, "god-object", monitor.fixture_present}}) {
        if (!entry.shown) continue;
        x += 16 * frame.pixels;
        x += draw_text(list, point(x, y), entry.colour, entry.name);
    }
}

}  // namespace

void draw_side_view(ImDrawList& list, const Rect& rect, double scale, const Monitor& monitor) {
    SideFrame frame;
    const double deepest_m = std::max(monitor.position_surface_m, monitor.position_fixture_m);
    frame.z = side_view_scale(plot_box(rect, scale), monitor.position_needle_m, deepest_m);
    frame.pixels = std::max(1.0, scale);
    frame.middle = std::floor(frame.z.box.y + frame.z.box.height / 2);
    list.PushClipRect(corner(frame.z.box), far_corner(frame.z.box), true);
    draw_tissue(list, frame, monitor);
    draw_depths(list, frame);
    draw_fixture(list, frame, monitor);
    draw_needle(list, frame, monitor);
    list.PopClipRect();
    draw_legend(list, rect, frame, monitor);
}

}  // namespace thimble
