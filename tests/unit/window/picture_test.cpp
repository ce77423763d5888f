#include "visual_node/window/picture.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace thimble {
namespace {

Scene scene_with(double needle_m, double surface_m, double bar_N = 0) {
    return {.position_needle_m = needle_m,
            .position_surface_m = surface_m,
            .bar_N = bar_N,
            .position_surface_rest_m = 0.02,
            .bar_shown = true};
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

TEST(Picture, DimpleIsAsDeepAsTheSurfaceIsPressedIn) {
    const Picture picture = picture_of(scene_with(0.03, 0.03), {});
    EXPECT_NEAR(picture.dimple_depth, 0.01 * picture.pixels_per_m, 1e-9);
}

// Each edge of the picture, and what lies beyond it.
TEST(Picture, WhatCannotBeDrawnStaysAtTheEdges) {
    const PictureSize size{800, 600, 1};
    const auto tip = [&](double needle_m) { return picture_of(scene_with(needle_m, 1), size).needle_tip_y; };
    EXPECT_EQ(tip(kTop_m), 0);
    EXPECT_EQ(tip(-1), 0);
    EXPECT_EQ(tip(std::numeric_limits<double>::quiet_NaN()), 0);
    EXPECT_DOUBLE_EQ(tip(kBottom_m), 600 - 92);
    EXPECT_DOUBLE_EQ(tip(1), 600 - 92);
    EXPECT_DOUBLE_EQ(tip(0.5 * (kTop_m + kBottom_m)), (600 - 92) / 2.0);
    EXPECT_DOUBLE_EQ(picture_of(scene_with(0.05, 0.03), size).needle_tip_y,
                     picture_of(scene_with(0.03, 0.03), size).needle_tip_y)
        << "nothing beneath the surface";
}

TEST(Picture, PlacesEverythingInItsWindow) {
    const Picture picture = picture_of(scene_with(0, 0.02), {801, 642, 1});
    EXPECT_DOUBLE_EQ(picture.pixels_per_m, 5000);  // 550 pixels above the strip show 110 mm
    EXPECT_DOUBLE_EQ(picture.block_bottom, 550);
    EXPECT_DOUBLE_EQ(picture.surface_y, 250);
    EXPECT_EQ(picture.dimple_depth, 0);
    EXPECT_DOUBLE_EQ(picture.dimple_radius, 30);
    EXPECT_EQ(picture.needle_x, 400);
    EXPECT_EQ(picture.needle_width, 7);
    EXPECT_DOUBLE_EQ(picture.block_half_width, 375);
    EXPECT_DOUBLE_EQ(picture.block_half_depth, 150);
    const Picture narrow = picture_of(scene_with(0, 0.02), {400, 50, 0.25});
    EXPECT_DOUBLE_EQ(narrow.block_bottom, 27);
    EXPECT_EQ(narrow.needle_width, 3) << "never thinner";
    EXPECT_DOUBLE_EQ(picture_of(scene_with(0, 0.02), {400, 642, 1}).block_half_width, 188);
    EXPECT_DOUBLE_EQ(picture_of(scene_with(0, 0.02), {400, 50, 1}).block_bottom, 1) << "no room at all";
    EXPECT_EQ(picture_of(scene_with(0, 0.02), {800, 600, 3}).needle_width, 21);
    EXPECT_EQ(picture_of(scene_with(0, 0.02), {800, 600, 1.25}).needle_width, 9) << "whole pixels";
}

TEST(Picture, TheBarIsProportionalAndFitsItsWindow) {
    struct Case {
        double force_N;
        int width;
        double scale, length, full_length;
    };
    for (const Case& c : {Case{0, 800, 1, 0, 400},
                          {3, 800, 1, 100, 400},
                          {12, 800, 1, 400, 400},
                          {100, 800, 1, 400, 400},
                          {-3, 800, 1, 0, 400},
                          {std::numeric_limits<double>::quiet_NaN(), 800, 1, 0, 400},
                          {12, 448, 1, 400, 400},
                          {12, 447, 1, 399, 399},
                          {12, 447, 2, 351, 351},
                          {12, 10, 1, 1, 1},  // never none
                          {6, 1600, 2, 400, 800},
                          {12, 2000, 2.5, 1000, 1000}}) {
        const auto bar = picture_of(scene_with(0, 0.02, c.force_N), {c.width, 600, c.scale}).bar.value();
        EXPECT_EQ(bar.length, c.length) << c.width;
        EXPECT_EQ(bar.full_length, c.full_length) << c.width;
        EXPECT_EQ(bar.height, 26 * c.scale);
        EXPECT_EQ(bar.top, 600 - 80 * c.scale);
        EXPECT_EQ(bar.full_N, 12);
    }
    EXPECT_EQ(picture_of(scene_with(0, 0.02, 12), {801, 600, 1}).bar->left, 200);
    for (const double none_N : {-1.0, 0.0}) {
        Scene scene = scene_with(0, 0.02, 12);
        scene.bar_full_scale_N = none_N;
        EXPECT_FALSE(picture_of(scene, {}).bar);
    }
}

TEST(Picture, MarksAreOneTwoOrFiveOfADecade) {
    const std::vector<std::pair<double, double>> marks{{0.75, 0.1}, {5, 1},  {9.9, 1},  {10, 2},
                                                       {24.9, 2},   {25, 5}, {49.9, 5}, {50, 10}};
    for (const auto& [full_N, mark_N] : marks) {
        Scene scene = scene_with(0, 0.02);
        scene.bar_full_scale_N = full_N;
        EXPECT_DOUBLE_EQ(picture_of(scene, {}).bar->tick_N, mark_N) << full_N;
    }
}

TEST(Picture, AFingertipIsNoPalerThanPale) {
    const auto fingertip = [](double force_N) {
        return picture_of({.fingertip_N = force_N, .fingertip_shown = true}, {800, 600, 2}).fingertip.value();
    };
    EXPECT_EQ(fingertip(1).blanching, 0.25);
    EXPECT_EQ(fingertip(kBlanched_N).blanching, 1);
    EXPECT_EQ(fingertip(5 * kBlanched_N).blanching, 1);
    EXPECT_EQ(fingertip(-1).blanching, 0);
    EXPECT_EQ(fingertip(std::numeric_limits<double>::quiet_NaN()).blanching, 0);
    EXPECT_EQ(fingertip(0).radius, 88);
    EXPECT_EQ(fingertip(0).x, 800 - 176);
    EXPECT_DOUBLE_EQ(fingertip(0).y, 193.6);
}

TEST(Picture, NothingWithoutItsModality) {
    Scene scene{.bar_N = 5, .fingertip_N = 3};
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
