#include "visual_node/window/picture.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

constexpr double kStrip_px = 92;  // at content scale 1, at the bottom: bar and its scale
constexpr double kBar_px = 400;
constexpr double kBarHeight_px = 26;
constexpr double kNeedle_px = 7;
constexpr double kBlockHalfWidth_m = 0.075;
constexpr double kBlockHalfDepth_m = 0.030;
constexpr double kMargin_px = 24;

// NaN: the lower end.
double within(double value, double low, double high) { return value > low ? std::min(value, high) : low; }

Picture::Bar bar_of(const Scene& scene, const PictureSize& size) {
    Picture::Bar bar;
    const double scale = size.content_scale;
    bar.full_N = scene.bar_full_scale_N;
    bar.full_length = std::floor(std::min(kBar_px * scale, size.width - 2 * kMargin_px * scale));
    bar.full_length = std::max(bar.full_length, 1.0);
    bar.length = std::round(within(scene.bar_N / bar.full_N, 0, 1) * bar.full_length);
    bar.height = std::round(kBarHeight_px * scale);
    bar.left = std::floor((size.width - bar.full_length) / 2);
    bar.top = std::round(size.height - (kStrip_px - kMargin_px / 2) * scale);
    bar.tick_N = bar_tick_N(bar.full_N);
    return bar;
}

Picture::Fingertip fingertip_of(const Scene& scene, const PictureSize& size) {
    const double radius = 44 * size.content_scale;
    return {size.width - 2 * radius, 2.2 * radius, radius, within(scene.fingertip_N / kBlanched_N, 0, 1)};
}

}  // namespace

// Five to ten marks of 1, 2 or 5 in a decade.
double bar_tick_N(double full_N) {
    const double decade = std::pow(10, std::floor(std::log10(full_N / 5)));
    const double steps = full_N / 5 / decade;
    return decade * (steps < 2 ? 1 : steps < 5 ? 2 : 5);
}

Picture picture_of(const Scene& scene, const PictureSize& size) {
    Picture picture;
    picture.size = size;
    const double strip = kStrip_px * size.content_scale;
    const double room = std::max(size.height - strip, 1.0);
    const double per_m = picture.pixels_per_m = room / (kBottom_m - kTop_m);
    const auto y_of = [&](double z_m) { return (within(z_m, kTop_m, kBottom_m) - kTop_m) * per_m; };
    picture.needle_x = std::floor(size.width / 2.0);
    picture.needle_width = std::max(3.0, std::round(kNeedle_px * size.content_scale));
    picture.surface_y = y_of(scene.position_surface_rest_m);
    const double surface_y = y_of(scene.position_surface_m);
    picture.dimple_depth = surface_y - picture.surface_y;
    picture.dimple_radius = kDimple_m * per_m;
    // Clipped again, although a Scene is clipped already: a subject must never see the inserted needle.
    picture.needle_tip_y = std::min(y_of(scene.position_needle_m), surface_y);
    picture.block_half_width = std::min(kBlockHalfWidth_m * per_m, size.width / 2.0 - kMargin_px / 2);
    picture.block_half_depth = kBlockHalfDepth_m * per_m;
    picture.block_bottom = room;
    if (scene.bar_shown && scene.bar_full_scale_N > 0) picture.bar = bar_of(scene, size);
    if (scene.fingertip_shown) picture.fingertip = fingertip_of(scene, size);
    return picture;
}

}  // namespace thimble
