#include "visual_node/views/monitor_history.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Monitor running_at(double time_s, double needle_m = 0) {
    return {.time_s = time_s,
            .position_needle_m = needle_m,
            .position_fixture_m = 0.12,
            .state = NodeState::kRunning};
}

// `samples` at 250 Hz from 0.004 s on, the needle as `needle_m` says.
template <class Needle>
void fill(MonitorHistory& history, int samples, Needle&& needle_m) {
    for (int i = 1; i <= samples; ++i) {
        history.add(at(i * milliseconds{4}), 1, running_at(i * 0.004, needle_m(i * 0.004)));
    }
}

std::vector<Column> columns_of(const MonitorHistory& history, Quantity quantity, double begin_s,
                               double column_s, std::size_t count) {
    std::vector<Column> columns(count);
    history.decimate(quantity, begin_s, column_s, columns);
    return columns;
}

TEST(MonitorHistory, EverySampleLiesInItsColumnsRange) {
    EXPECT_TRUE(rc::check("no sample outside the envelope, none of it invented", [] {
        MonitorHistory history(4);
        std::vector<double> values;
        const int samples = *rc::gen::inRange(1, 1000);
        for (int i = 1; i <= samples; ++i) {
            values.push_back(1e-3 * *rc::gen::inRange(-100, 100));
            history.add(at(i * milliseconds{4}), 1, running_at(i * 0.004, values.back()));
        }
        const double column_s = 0.004 * *rc::gen::inRange(1, 40);
        const auto columns = columns_of(history, Quantity::kNeedle_m, 0, column_s, 4000);
        for (int i = 1; i <= samples; ++i) {
            const auto& column = columns[static_cast<std::size_t>(std::floor(i * 0.004 / column_s))];
            RC_ASSERT(column.present);
            RC_ASSERT(column.low <= values[static_cast<std::size_t>(i - 1)]);
            RC_ASSERT(column.high >= values[static_cast<std::size_t>(i - 1)]);
        }
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        for (const Column& column : columns)
            RC_ASSERT(!column.present || (column.low >= *least && column.high <= *most));
    }));
}

TEST(MonitorHistory, ColumnsFinerThanSamplesAreJoinedByALine) {
    MonitorHistory history(10);
    fill(history, 3, [](double time_s) { return time_s; });
    // Columns of 1 ms from 4 to 12 ms: samples in the first, fifth and ninth.
    const auto columns = columns_of(history, Quantity::kNeedle_m, 0.0035, 0.001, 9);
    for (std::size_t i = 0; i < columns.size(); ++i) {
        ASSERT_TRUE(columns[i].present) << i;
        EXPECT_NEAR(columns[i].low, 0.004 + 0.001 * static_cast<double>(i), 1e-9);
        EXPECT_EQ(columns[i].joined, i > 0);
    }
}

TEST(MonitorHistory, SilenceIsAGapAndNotALine) {
    MonitorHistory history(10);
    history.add(at(milliseconds{100}), 1, running_at(0.100));
    history.add(at(milliseconds{140}), 1, running_at(0.140));  // 40 ms: joined
    history.add(at(milliseconds{240}), 1, running_at(0.240));  // 100 ms: not
    const auto columns = columns_of(history, Quantity::kNeedle_m, 0.095, 0.01, 20);
    EXPECT_TRUE(columns[0].present);
    EXPECT_TRUE(columns[2].present);
    EXPECT_TRUE(columns[4].present && columns[4].joined);
    for (std::size_t i = 5; i < 14; ++i) EXPECT_FALSE(columns[i].present) << i;
    EXPECT_TRUE(columns[14].present);
    EXPECT_FALSE(columns[14].joined);
}

TEST(MonitorHistory, WhatIsNotKnownIsAGap) {
    MonitorHistory history(10);
    Monitor monitor = running_at(0.004);
    history.add(at(milliseconds{4}), 1, monitor);
    monitor.time_s = 0.008;
    monitor.fixture_present = false;
    monitor.round_trip_s = 0.05;
    monitor.one_way_s = 0.03;
    monitor.one_way_bound_s = 0.04;
    history.add(at(milliseconds{8}), 1, monitor);
    const auto count = [&](Quantity quantity) {
        int present = 0;
        for (const Column& column : columns_of(history, quantity, 0, 0.004, 4)) present += column.present;
        return present;
    };
    EXPECT_EQ(count(Quantity::kNeedle_m), 2);
    EXPECT_EQ(count(Quantity::kFixture_m), 1);                                      // gone with the second
    EXPECT_EQ(count(Quantity::kRoundTrip_s), 1);                                    // 0 is "not yet"
    EXPECT_EQ(count(Quantity::kOneWay_s), 1);                                       // negative is "not known"
    EXPECT_EQ(columns_of(history, Quantity::kOneWayLow_s, 0, 0.004, 4)[2].low, 0);  // no delay is negative
    EXPECT_NEAR(columns_of(history, Quantity::kOneWayHigh_s, 0, 0.004, 4)[2].high, 0.07, 1e-12);
}

TEST(MonitorHistory, ANewTrialAndATimeThatGoesBackStartAnew) {
    MonitorHistory history(10);
    fill(history, 10, [](double) { return 0.0; });
    EXPECT_EQ(history.size(), 10U);
    history.add(at(seconds{1}), 2, running_at(0.5));
    EXPECT_EQ(history.size(), 1U);
    EXPECT_EQ(history.trial(), 2U);
    history.add(at(seconds{2}), 2, running_at(0.6));
    history.add(at(seconds{3}), 2, running_at(0.1));
    EXPECT_EQ(history.size(), 1U);
    EXPECT_NEAR(history.end_s(at(seconds{3})), 0.1, 1e-12);
}

TEST(MonitorHistory, BetweenTrialsNothingIsAddedAndTimeStands) {
    MonitorHistory history(10);
    history.add(at(seconds{1}), 0, Monitor{});
    EXPECT_EQ(history.size(), 0U);
    history.add(at(seconds{2}), 1, running_at(0.004));
    EXPECT_NEAR(history.end_s(at(seconds{3})), 1.004, 1e-9);  // running: silence grows into a gap
    Monitor ended = running_at(0.004);
    ended.state = NodeState::kIdle;
    history.add(at(seconds{4}), 1, ended);
    EXPECT_EQ(history.size(), 1U);
    EXPECT_NEAR(history.end_s(at(seconds{9})), 0.004, 1e-9);
}

TEST(MonitorHistory, OneForceHasOneSignInHandAndNeedle) {
    MonitorHistory history(10);
    Monitor monitor = running_at(0.004);
    monitor.force_total_N = -0.4;
    monitor.force_hand_N = 0.4;
    history.add(at(milliseconds{4}), 1, monitor);
    for (const Quantity quantity : {Quantity::kForceTotal_N, Quantity::kForceHand_N})
        EXPECT_EQ(columns_of(history, quantity, 0, 0.004, 4)[1].last, 0.4);
}

TEST(MonitorHistory, AReplayThatStandsStillKeepsItsPlot) {
    MonitorHistory history(10);
    for (int i = 0; i < 2500; ++i) history.add(at(i * milliseconds{4}), 1, running_at(2.5), true);
    EXPECT_EQ(history.size(), 1U);
    EXPECT_EQ(history.end_s(at(seconds{10})), 2.5);
    history.add(at(seconds{10}), 1, running_at(2.504), true);
    EXPECT_NEAR(history.end_s(at(seconds{11})), 3.504, 1e-9);  // it goes on, and then it is silent
}

TEST(MonitorHistory, ASlowReplayFillsItsWindow) {
    MonitorHistory history(10);
    for (int i = 0; i <= 30'000; ++i) history.add(at(i * milliseconds{4}), 1, running_at(i * 0.0004), true);
    EXPECT_NEAR(history.end_s(at(seconds{120})), 12, 1e-9);
    for (const Column& column : columns_of(history, Quantity::kNeedle_m, 2, 0.1, 100))
        EXPECT_TRUE(column.present);
}

TEST(MonitorHistory, HoldsItsWindowAndForgetsWhatIsOlder) {
    MonitorHistory history(2);
    fill(history, 5000, [](double time_s) { return time_s; });
    EXPECT_EQ(history.size(), 750U);  // (2 + 1) s at 250 Hz
    const auto columns = columns_of(history, Quantity::kNeedle_m, 18, 0.1, 20);
    for (std::size_t i = 0; i < 20; ++i) {
        ASSERT_TRUE(columns[i].present);
        EXPECT_NEAR(columns[i].low, 18 + 0.1 * static_cast<double>(i), 0.005);
    }
    EXPECT_FALSE(columns_of(history, Quantity::kNeedle_m, 10, 0.1, 20)[0].present);
}

TEST(MonitorHistory, ColumnsStandStillWhileTheWindowMoves) {
    EXPECT_NEAR(column_begin(10.0149, 0.01, 100), 9.02, 1e-9);
    EXPECT_NEAR(column_begin(10.0151, 0.01, 100), 9.02, 1e-9);
    EXPECT_NEAR(column_begin(10.0201, 0.01, 100), 9.03, 1e-9);
}

}  // namespace
}  // namespace thimble
