#include "visual_node/window/picture.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace thimble {
namespace {

Scene scene_with(double needle_m, double surface_m, double bar_N = 0) {
    Scene scene;
    scene.position_needle_m = needle_m;
    scene.position_surface_m = surface_m;
    scene.position_surface_rest_m = 0.02;
    scene.bar_N = bar_N;
    scene.bar_shown = true;
    return scene;
}

TEST(Picture, NeedleNeverEndsBeneathTheSurface) {
    EXPECT_TRUE(rc::check([] {
        const double needle_m = 1e-3 * *rc::gen::inRange(-500, 500);
        const double surface_m = 1e-3 * *rc::gen::inRange(-500, 500);
        const PictureSize size{*rc::gen::inRange(1, 4000), *rc::gen::inRange(1, 3000),
                               1 + 0.25 * *rc::gen::inRange(0, 12)};
        const Picture picture = picture_of(scene_with(needle_m, surface_m), size);
        RC_ASSERT(picture.needle_tip_y <= picture.surface_y + picture.dimple_depth + 1e-9);
        RC_ASSERT(picture.needle_tip_y >= 0);
    }));
}

TEST(Picture, BarIsProportionalAndEndsAtFullScale) {
    const auto length = [](double force_N) {
        return picture_of(scene_with(0, 0.02, force_N), {}).bar.value().length;
    };
    EXPECT_EQ(length(0), 0);
    EXPECT_EQ(length(3), 100);
    EXPECT_EQ(length(12), 400);
    EXPECT_EQ(length(100), 400);
    EXPECT_EQ(length(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(Picture, ScalesWithTheMonitor) {
    const Picture::Bar plain = picture_of(scene_with(0, 0.02, 6), {800, 600, 1}).bar.value();
    const Picture::Bar large = picture_of(scene_with(0, 0.02, 6), {1600, 1200, 2}).bar.value();
    EXPECT_EQ(large.full_length, 2 * plain.full_length);
    EXPECT_EQ(large.height, 2 * plain.height);
}

TEST(Picture, ScaleHasFewRoundMarks) {
    for (const double full_N : {0.1, 0.5, 1.0, 3.0, 12.0, 20.0, 100.0}) {
        Scene scene = scene_with(0, 0.02);
        scene.bar_full_scale_N = full_N;
        const double marks = full_N / picture_of(scene, {}).bar.value().tick_N;
        EXPECT_GE(marks, 4.9) << full_N;
        EXPECT_LE(marks, 12.1) << full_N;
    }
}

TEST(Picture, DimpleIsDeepestAtTheNeedleAndFlatFarAway) {
    const Picture picture = picture_of(scene_with(0.03, 0.03), {});
    EXPECT_NEAR(picture.dimple_depth, 0.01 * picture.pixels_per_m, 1e-9);
    EXPECT_EQ(dimple_at(picture, 0), picture.dimple_depth);
    // (2 / pi) arcsin(1 / 2) = 1 / 3 at twice the punch's radius.
    EXPECT_NEAR(dimple_at(picture, 2 * picture.dimple_radius), picture.dimple_depth / 3, 1e-9);
    double last = picture.dimple_depth;
    for (double r = picture.dimple_radius; r < 400; r += 5) {
        EXPECT_LE(dimple_at(picture, r), last);
        last = dimple_at(picture, r);
    }
}

TEST(Picture, NothingWithoutItsModality) {
    Scene scene;
    scene.bar_N = 5;
    scene.fingertip_N = 3;
    EXPECT_FALSE(picture_of(scene, {}).bar);
    EXPECT_FALSE(picture_of(scene, {}).fingertip);
    scene.fingertip_shown = true;
    EXPECT_EQ(picture_of(scene, {}).fingertip.value().blanching, 0.75);
}

// Grey values of the three that must be told apart without any colour at all (Rec. 709 weights).
TEST(Picture, ColoursDifferInLightness) {
    const auto grey = [](const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
    EXPECT_GT(grey(colours::kNeedle) - grey(colours::kTissue), 40);
    EXPECT_GT(grey(colours::kTissue) - grey(colours::kBackground), 100);
    EXPECT_GT(grey(colours::kBar) - grey(colours::kBarGround), 80);
}

}  // namespace
}  // namespace thimble
