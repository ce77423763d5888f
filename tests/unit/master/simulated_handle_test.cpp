// The device: encoder, force limit, time grid. Callers and their times do not matter.
#include "master/devices/simulated_handle.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/allocation_count.hpp"
#include "tests/unit/master/operator_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

struct HandleInTrial {
    explicit HandleInTrial(SessionTime start = {}) { handle.start_trial(start, task_of(Modality::kHF)); }
    SimulatedHandle* operator->() { return &handle; }
    SimulatedHandle handle{HandleSettings{}, OperatorParameters{}};
};

class SimulatedHandleTest : public testing::Test {
  protected:
    HandleInTrial in_trial_;
    SimulatedHandle& handle = in_trial_.handle;
};

TEST_F(SimulatedHandleTest, StartsAtRestAtZeroAndMovesIn) {
    EXPECT_EQ(handle.read(at(Duration{0})).position_hand_m, 0);
    EXPECT_FALSE(handle.finished());
    EXPECT_GT(handle.read(at(seconds{1})).position_hand_m, 0.010);
}

TEST_F(SimulatedHandleTest, ReadsWholeEncoderCountsNearestToTheHand) {
    for (int ms = 0; ms < 1000; ++ms) {
        const double read_m = handle.read(at(milliseconds{ms})).position_hand_m;
        EXPECT_LE(std::fabs(read_m - handle.position_hand_m()), 0.5e-5 + 1e-15);
        EXPECT_NEAR(read_m / 1e-5, std::round(read_m / 1e-5), 1e-9);
    }
}

TEST_F(SimulatedHandleTest, ClipsTheForceAndTellsWhatItApplies) {
    handle.command_force(at(milliseconds{1}), 50);
    EXPECT_EQ(handle.read(at(milliseconds{2})).force_hand_N, 12);
    handle.command_force(at(milliseconds{2}), -50);
    EXPECT_EQ(handle.read(at(milliseconds{3})).force_hand_N, -12);
    handle.command_force(at(milliseconds{3}), 1.5);
    EXPECT_EQ(handle.read(at(milliseconds{900})).force_hand_N, 1.5);
}

TEST_F(SimulatedHandleTest, AForceThatIsNoNumberIsZeroAndCounted) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    int ms = 0;
    for (const double force_N : {kNan, kInfinity, -kInfinity}) {
        handle.command_force(at(milliseconds{++ms}), 3);
        handle.command_force(at(milliseconds{ms}), force_N);
        EXPECT_EQ(handle.read(at(milliseconds{ms})).force_hand_N, 0);
    }
    EXPECT_EQ(handle.refused_forces(), 3U);
    EXPECT_TRUE(std::isfinite(handle.read(at(milliseconds{100})).position_hand_m));
}

TEST_F(SimulatedHandleTest, APositiveForcePushesTheHandOut) {
    HandleInTrial pushed;
    pushed->command_force(at(Duration{0}), 3);
    EXPECT_LT(pushed->read(at(milliseconds{200})).position_hand_m,
              handle.read(at(milliseconds{200})).position_hand_m - 0.005);
}

TEST_F(SimulatedHandleTest, AFewMoreReadsInBetweenChangeNoBit) {
    EXPECT_TRUE(rc::check("time grid", [] {
        HandleInTrial regular(at(milliseconds{5})), irregular(at(milliseconds{5}));
        for (int ms = 6; ms < 60; ++ms) {
            for (int extra = *rc::gen::inRange(0, 3), from = 0; extra > 0; --extra) {
                from = *rc::gen::inRange(from, 1000);
                irregular->read(at(milliseconds{ms - 1} + microseconds{from}));
            }
            const auto now = at(milliseconds{ms});
            RC_ASSERT(irregular->read(now).position_hand_m == regular->read(now).position_hand_m);
            RC_ASSERT(irregular->position_hand_m() == regular->position_hand_m());
            const double force_N = *rc::gen::inRange(-12, 13);
            regular->command_force(now, force_N);
            irregular->command_force(now, force_N);
        }
    }));
}

TEST_F(SimulatedHandleTest, AForceActsFromTheGridPointItIsCommandedAt) {
    HandleInTrial late, later;
    late->command_force(at(microseconds{510}), 12);
    later->command_force(at(microseconds{590}), 12);
    handle.command_force(at(microseconds{600}), 12);
    late->read(at(milliseconds{1})), later->read(at(milliseconds{1})), handle.read(at(milliseconds{1}));
    EXPECT_EQ(late->position_hand_m(), later->position_hand_m());
    EXPECT_LT(later->position_hand_m(), handle.position_hand_m());
}

TEST_F(SimulatedHandleTest, WhatIsPerceivedAtATickCountsInItWhateverTheOrder) {
    HandleInTrial read_first;
    const auto now = at(milliseconds{300});
    handle.perceive(now, {.touching_shown = true});
    handle.command_force(now, 0.3);
    read_first->read(now);
    read_first->command_force(now, 0.3);
    read_first->perceive(now, {.touching_shown = true});
    for (int ms = 301; ms < 1500; ++ms) {
        ASSERT_EQ(handle.read(at(milliseconds{ms})).position_hand_m,
                  read_first->read(at(milliseconds{ms})).position_hand_m);
    }
    HandleInTrial untouched;
    untouched->command_force(now, 0.3);
    untouched->read(at(milliseconds{900}));  // no gap is too long
    EXPECT_NE(untouched->read(at(milliseconds{1499})).position_hand_m, handle.position_hand_m());
}

TEST_F(SimulatedHandleTest, ABriefTouchBetweenTwoTicksIsNotForgotten) {
    handle.perceive(at(microseconds{300'200}), {.touching_shown = true});
    handle.perceive(at(microseconds{300'400}), {});
    HandleInTrial untouched;
    for (const int ms : {600, 1200}) handle.read(at(milliseconds{ms})), untouched->read(at(milliseconds{ms}));
    EXPECT_NE(handle.read(at(milliseconds{1500})).position_hand_m,
              untouched->read(at(milliseconds{1500})).position_hand_m);
}

TEST_F(SimulatedHandleTest, ALongSilenceIsSkippedNotIntegrated) {
    handle.read(at(milliseconds{500}));
    HandleInTrial patient;
    patient->read(at(milliseconds{500}));
    const double after_a_second_m = patient->read(at(milliseconds{1500})).position_hand_m;
    EXPECT_EQ(handle.read(at(seconds{3600})).position_hand_m, after_a_second_m);
}

// Wherever it begins, also between two ticks, and whatever was before.
TEST_F(SimulatedHandleTest, TheSameTaskGivesTheSameTrialAgain) {
    std::vector<std::vector<double>> runs;
    for (const Duration begun : {Duration{0}, Duration{seconds{7}}, Duration{microseconds{9'000'300}}}) {
        const SessionTime start = at(begun);
        handle.read(start);  // in the middle of a tick, the last time
        handle.start_trial(start, task_of(Modality::kCF));
        handle.perceive(start, {.touching_shown = true});
        auto& positions_m = runs.emplace_back();
        for (int ms = 0; ms < 2000; ++ms)
            positions_m.push_back(handle.read(start + milliseconds{ms}).position_hand_m);
    }
    EXPECT_EQ(runs[0], runs[1]);
    EXPECT_EQ(runs[0], runs[2]);
}

TEST_F(SimulatedHandleTest, FinishesAfterTheBeepAndComesToRest) {
    handle.read(at(milliseconds{900}));
    handle.perceive(at(milliseconds{900}), {.touching_shown = true, .beep = true});
    int ms = 900;
    while (!handle.finished() && ms < 10000) handle.read(at(milliseconds{++ms}));
    EXPECT_TRUE(handle.finished());
    EXPECT_NEAR(handle.read(at(milliseconds{ms + 900})).position_hand_m, 0, 0.002);
    EXPECT_TRUE(handle.finished());
    handle.start_trial(at(seconds{20}), task_of(Modality::kHF));
    EXPECT_FALSE(handle.finished());
}

TEST_F(SimulatedHandleTest, ATickDoesNotAllocate) {
    handle.read(at(milliseconds{1}));
    const std::uint64_t before = allocation_count();
    for (int ms = 2; ms < 3000; ++ms) {
        handle.perceive(at(milliseconds{ms}), {.touching_shown = ms > 500, .beep = ms > 2000});
        handle.command_force(at(milliseconds{ms}), ms > 1500 ? 3.0 : 0.0);
        handle.read(at(milliseconds{ms}));
    }
    EXPECT_EQ(allocation_count(), before);
}

TEST(SimulatedHandle, BeforeATrialItLiesStillAndOnlyHoldsItsForce) {
    SimulatedHandle handle(HandleSettings{}, OperatorParameters{});
    handle.command_force(at(milliseconds{1}), 20);
    const HandleSample sample = handle.read(at(seconds{5}));
    EXPECT_EQ(sample.position_hand_m, 0);
    EXPECT_EQ(sample.force_hand_N, 12);
    EXPECT_FALSE(handle.finished());
}

}  // namespace
}  // namespace thimble::test
