// Means, intervals and lines of rows.
#include "study/board/board_row.hpp"

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "analysis/statistics/descriptive.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

std::vector<BoardTrial> trials(const std::vector<double>& depths_m, std::size_t oscillating) {
    std::vector<BoardTrial> list(depths_m.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        list[i].completed = true;
        list[i].values.fill(std::nan(""));
        list[i].values[kOscillating] = i < oscillating ? 1 : 0;
        list[i].values[kNotCompleted] = 0;
        list[i].values[kPenetrationMax] = depths_m[i];
    }
    return list;
}

TEST(BoardRow, SharesHaveWilsonsIntervalAndMeansTheBootstraps) {
    BoardRow row;
    condense(trials({0.001, 0.002, 0.003, 0.004, 0.005, std::nan("")}, 2), 7, row);
    EXPECT_EQ(row.trials, 6U);
    EXPECT_DOUBLE_EQ(row.values[kOscillating].mean, 1.0 / 3);
    EXPECT_EQ(row.values[kOscillating].low, wilson_interval(2, 6, 0.9).low);
    EXPECT_EQ(row.values[kNotCompleted].mean, 0);
    const BoardValue& depth = row.values[kPenetrationMax];
    EXPECT_DOUBLE_EQ(depth.mean, 0.003);
    EXPECT_NEAR(depth.low, 0.0020, 0.0003);  // 1.64 standard errors of 0.00063
    EXPECT_NEAR(depth.high, 0.0040, 0.0003);
    EXPECT_TRUE(std::isnan(row.values[kDrift].mean));
    BoardRow again;
    condense(trials({0.001, 0.002, 0.003, 0.004, 0.005, std::nan("")}, 2), 7, again);
    EXPECT_EQ(board_line(again), board_line(row));
}

TEST(BoardRow, ALineReadsBackToTheSameRow) {
    BoardRow row;
    row.controller = "wave";
    row.codec = "every-sample";
    row.condition = "50ms+jitter";
    row.network = row.hands = row.tissue = row.scene = "x";
    row.delay_s = 0.05;
    condense(trials({0.001, 0.1 / 3}, 1), 1, row);
    row.subject = 1;
    const TemporaryDirectory directory;
    const auto file = directory / "board.csv";
    std::ofstream(file) << board_header() << board_line(row);
    const std::vector<BoardRow> rows = read_board_rows(file);
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(board_line(rows[0]), board_line(row));
    EXPECT_FALSE(rows[0].stable());
}

// An interrupted --overwrite leaves no page of the earlier board.
TEST(RunBoard, ATableThatBeginsAnewHasNoPage) {
    const TemporaryDirectory directory;
    for (const char* page : {"board.html", "board.json", "board_cost.csv"})
        std::ofstream(directory / page) << "earlier\n";
    BoardPlan plan = read_board(board_folder());
    keep_only(plan, {"CF", "every-sample", "0ms"});
    const std::atomic<bool> stopped = true;
    EXPECT_FALSE(run_board(plan, {directory.path(), IfExists::kReplace, 1, &stopped}));
    for (const char* page : {"board.html", "board.json", "board_cost.csv"})
        EXPECT_FALSE(std::filesystem::exists(directory / page)) << page;
    EXPECT_TRUE(std::filesystem::exists(directory / "board.csv"));
}

}  // namespace
}  // namespace thimble
