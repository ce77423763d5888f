// A Scene in pixels: pure arithmetic, which painter.hpp draws. Pixels count from the
// top left corner of the framebuffer, y downwards. The inserted part of the needle and the fixture are not drawn, so
// they are in no Picture.
#pragma once

#include <optional>

#include "common/shared_values.hpp"
#include "visual_node/display.hpp"
#include "visual_node/window/image.hpp"

namespace thimble {

struct PictureSize {
    int width = 800;
    int height = 600;
    double content_scale = 1;  // how much larger lines, bar and text are than on a 96 dpi monitor
};

struct Picture {
    struct Bar {
        double left = 0, top = 0, height = 0;
        double length = 0;       // of the force now
        double full_length = 0;  // of full_N
        double full_N = kBarFullScale_N;
        double tick_N = 2;  // between two marks of the scale
    };
    // A fingertip whose nail bed turns pale. Only a drawing: straight up to kBlanched_N.
    struct Fingertip {
        double x = 0, y = 0, radius = 0;
        double blanching = 0;  // 0 to 1
    };

    PictureSize size;
    double pixels_per_m = 0;
    // The needle comes from the upper edge. Its axis, its end (on the axis, never beneath the surface), its width.
    double needle_x = 0, needle_tip_y = 0, needle_width = 0;
    // The tissue's surface on the needle's axis is dimple_depth beneath the one far away.
    double surface_y = 0, dimple_depth = 0, dimple_radius = 0;
    double block_half_width = 0, block_half_depth = 0, block_bottom = 0;
    std::optional<Bar> bar;
    std::optional<Fingertip> fingertip;
};

// Seen along the tissue's surface from a little above: what is 1 m further away stands this many metres higher.
inline constexpr double kTilt = 0.35;
// The radius of the punch that the dimple is drawn of.
inline constexpr double kDimple_m = 0.006;
// Of the axis z: from here to there the picture reaches (the bar's strip at the bottom not counted).
inline constexpr double kTop_m = -0.030;
inline constexpr double kBottom_m = 0.080;
// Where a drawn fingertip is as pale as it gets. A nail's colour ceases to change at a few newton.
inline constexpr double kBlanched_N = 4;

// Between two marks of a bar's scale.
double bar_tick_N(double full_N);
// `scene` with any numbers, NaN included: what cannot be drawn stays at the picture's edges.
Picture picture_of(const Scene& scene, const PictureSize& size);

}  // namespace thimble
