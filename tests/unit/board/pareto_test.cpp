// Contestants that dominate others, and the fronts.
#include "study/board/pareto.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

BoardValue about(double mean) { return {mean, 0.99 * mean, 1.01 * mean}; }

BoardRow board_row(const std::string& controller, double depth_m, double felt,
                   std::uint32_t oscillating = 0) {
    BoardRow row;
    row.controller = controller;
    row.codec = "every-sample";
    row.trials = 30;
    const double share = oscillating / 30.0;
    row.values[kOscillating] = {share, share, share};
    row.values[kNotCompleted] = {0, 0, 0};
    row.values[kPenetrationMax] = about(depth_m);
    row.values[kStiffnessFelt] = about(felt);
    row.values[kPackets] = about(2000);
    return row;
}

TEST(Pareto, BetterIsBeyondTheIntervalsAndByMoreThanALeastDifference) {
    EXPECT_TRUE(is_better({1, 0.9, 1.1}, {2, 1.9, 2.1}, kDepth));
    EXPECT_FALSE(is_better({2, 1.9, 2.1}, {1, 0.9, 1.1}, kDepth));
    EXPECT_TRUE(is_better({2, 1.9, 2.1}, {1, 0.9, 1.1}, kFelt));
    EXPECT_FALSE(is_better({1, 0.9, 1.95}, {2, 1.9, 2.1}, kDepth));
    EXPECT_FALSE(is_better({1e-3, 1e-3, 1e-3}, {1.05e-3, 1.05e-3, 1.05e-3}, kDepth));
    EXPECT_TRUE(is_better({1000, 999, 1001}, {2000, 1999, 2001}, kSent));
    EXPECT_FALSE(is_better({}, {2, 2, 2}, kDepth));
}

TEST(Pareto, FrontsFollowEachOther) {
    const auto ranked = rank_contestants(
        {board_row("stiff", 0.001, 1), board_row("soft", 0.005, 0.2), board_row("deep", 0.006, 0.1)});
    ASSERT_EQ(ranked.size(), 3U);
    EXPECT_EQ(ranked[0].front, 1U);
    EXPECT_EQ(ranked[1].front, 2U);
    EXPECT_EQ(ranked[2].front, 3U);
    EXPECT_THAT(ranked[0].dominated_by, IsEmpty());
    EXPECT_THAT(ranked[2].dominated_by, ElementsAre("stiff", "soft"));
}

TEST(Pareto, NoWeightDecidesBetweenDepthAndOscillation) {
    const auto ranked = rank_contestants({board_row("stiff", 0.001, 1, 20), board_row("stable", 0.005, 0)});
    EXPECT_EQ(ranked[0].front, 1U);
    EXPECT_EQ(ranked[1].front, 1U);
    EXPECT_EQ(ranked[0].stable_rows, 0U);
    EXPECT_NEAR(ranked[0].values[kUnstable].mean, 2.0 / 3, 1e-12);
}

TEST(Pareto, AContestantWithARowWithoutMeasuresIsNotRanked) {
    BoardRow crashed = board_row("crashes", 0.001, 1);
    crashed.status = "signal 11";
    const auto ranked =
        rank_contestants({crashed, board_row("crashes", 0.001, 1), board_row("soft", 0.005, 0)});
    EXPECT_EQ(ranked[0].front, 0U);
    EXPECT_EQ(ranked[0].failed_rows, 1U);
    EXPECT_EQ(ranked[1].front, 1U);
    EXPECT_THAT(ranked[1].dominated_by, IsEmpty());
}

TEST(Pareto, SeveralCodecsMakeSeveralContestants) {
    BoardRow other = board_row("wave", 0.001, 1);
    other.codec = "deadband";
    const auto ranked = rank_contestants({board_row("wave", 0.001, 1), other});
    EXPECT_EQ(ranked[0].name, "wave / every-sample");
    EXPECT_EQ(ranked[1].name, "wave / deadband");
}

}  // namespace
}  // namespace thimble
