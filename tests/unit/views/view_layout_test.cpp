#include "visual_node/views/view_layout.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace thimble {
namespace {

TEST(ViewLayout, NothingOverlapsAndNothingLeavesTheWindow) {
    EXPECT_TRUE(rc::check("at any size and scale", [] {
        const double width = *rc::gen::inRange(200, 4000), height = *rc::gen::inRange(150, 3000);
        const double scale = 0.25 * *rc::gen::inRange(4, 13);
        const ExperimenterLayout layout = experimenter_layout(width, height, scale);
        std::vector<Rect> all{layout.banner, layout.scene, layout.readings, layout.controls};
        all.insert(all.end(), layout.plots.begin(), layout.plots.end());
        constexpr double kRounding = 1e-6;
        for (const Rect& a : all) {
            RC_ASSERT(a.x >= 0 && a.y >= 0 && a.width >= 0 && a.height >= -kRounding);
            RC_ASSERT(a.right() <= width + kRounding && a.bottom() <= height + kRounding);
            for (const Rect& b : all) {
                if (&a == &b) continue;
                const bool beside = a.right() <= b.x + kRounding || b.right() <= a.x + kRounding;
                const bool above = a.bottom() <= b.y + kRounding || b.bottom() <= a.y + kRounding;
                RC_ASSERT(beside || above);
            }
        }
    }));
}

TEST(ViewLayout, EverythingHasRoomAt800x600) {
    const ExperimenterLayout layout = experimenter_layout(800, 600, 1);
    for (const Rect& plot : layout.plots) {
        const Rect box = plot_box(plot, 1);
        EXPECT_GT(box.width, 220);
        EXPECT_GT(box.height, 60);
        EXPECT_GE(box.x, plot.x);
        EXPECT_LE(box.right(), plot.right());
        EXPECT_LE(box.bottom(), plot.bottom());
    }
    EXPECT_GT(layout.scene.width, 220);
    constexpr int kNotice = 7;  // the last row, a line of text: no scroll bar
    EXPECT_LE(control_cell(layout.controls, 1, kNotice, 0, 1).y + 25, layout.controls.bottom());
}

TEST(PlotScale, RoundNumbersAroundTheValues) {
    const PlotScale scale = round_scale(0.3, 9.2, 1, 5);
    EXPECT_EQ(scale.low, 0);
    EXPECT_EQ(scale.high, 10);
    EXPECT_EQ(scale.step, 2);
    EXPECT_EQ(scale.fraction(5), 0.5);
}

TEST(PlotScale, NothingSeenAndNothingMovingStillMakeAScale) {
    EXPECT_EQ(round_scale(1e9, -1e9, 2, 4).low, 0);
    EXPECT_GE(round_scale(1e9, -1e9, 2, 4).high, 2);
    const PlotScale still = round_scale(7, 7, 0.5, 4);
    EXPECT_LE(still.low, 7);
    EXPECT_GE(still.high, 7.5);
}

TEST(PlotScale, HoldsAllValuesInAFewSteps) {
    EXPECT_TRUE(rc::check("between 1 and lines + 1 steps that hold everything", [] {
        const double low = 1e-3 * *rc::gen::inRange(-100000, 100000);
        const double high = low + 1e-3 * *rc::gen::inRange(0, 100000);
        const int lines = *rc::gen::inRange(1, 9);
        const PlotScale scale = round_scale(low, high, 0.01, lines);
        const double rounding = 1e-9 * scale.step;
        RC_ASSERT(scale.low <= low + rounding);
        RC_ASSERT(scale.high >= high - rounding);
        const double steps = (scale.high - scale.low) / scale.step;
        RC_ASSERT(std::abs(steps - std::round(steps)) < 1e-6);
        RC_ASSERT(steps > 0.5);
        RC_ASSERT(steps < lines + 1.5);
    }));
}

}  // namespace
}  // namespace thimble
