#include "slave_sim/slave_node.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "slave_sim/contact_timer.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SessionControl trial(double fixture_m = 0.123, bool present = true) {
    SessionControl order;
    order.fixture_position_m = fixture_m;
    order.fixture_present = present;
    return order;
}

NeedleCommand needle(double position_m) {
    NeedleCommand command;
    command.position_needle_m = position_m;
    command.position_needle_estimate_m = position_m;
    return command;
}

// A node in a trial and a master that sends one command per millisecond.
struct Bench {
    SlaveNode node{SlaveSettings{}};
    SessionTime time{seconds(1)};
    std::uint32_t sequence = 0;

    Bench() { node.start_trial(trial()); }
    ForceFeedback send(const NeedleCommand& command, Duration after = milliseconds(1)) {
        time += after;
        return node.on_needle(time, ++sequence, command);
    }
    ForceFeedback stay(double position_m, int samples) {
        ForceFeedback last;
        for (int i = 0; i < samples; ++i) last = send(needle(position_m));
        return last;
    }
};

TEST(SlaveNode, AnswersWithTheCommandsStamps) {
    Bench bench;
    const ForceFeedback f = bench.send(needle(0.01));
    EXPECT_EQ(f.echo_time, bench.time);
    EXPECT_EQ(f.echo_sequence, 1u);
    EXPECT_EQ(f.position_needle_m, 0.01);
    EXPECT_EQ(f.position_surface_m, 0.02);
    EXPECT_FALSE(f.needle_held);
}

TEST(SlaveNode, FirstCommandOnlySetsTheNeedle) {
    Bench bench;
    bench.stay(0.0, 3);
    bench.node.start_trial(trial());
    const ForceFeedback f = bench.send(needle(0.019), seconds(3));
    EXPECT_EQ(f.phase, TissuePhase::kFree);
    EXPECT_EQ(bench.node.events().size(), 0u);
    EXPECT_EQ(bench.send(needle(0.0199)).phase, TissuePhase::kFree);
}

TEST(SlaveNode, TissueFollowsTheEstimateAndTheFixtureTheReading) {
    Bench bench;
    bench.stay(0.122, 1);
    NeedleCommand command = needle(0.122);
    command.position_needle_m = 0.124;
    const ForceFeedback still = bench.send(command);
    EXPECT_EQ(still.force_tissue_N, 0);  // the estimate rests
    EXPECT_NEAR(still.force_fixture_N, -3, 1e-9);
    EXPECT_EQ(still.position_proxy_m, 0.123);
    EXPECT_EQ(still.force_total_N, still.force_fixture_N + still.force_tissue_N);
    command = needle(0.1221);
    const ForceFeedback moving = bench.send(command);
    EXPECT_NEAR(moving.force_tissue_N, -0.7 * 0.1, 1e-3);  // 0.1 m/s, the surface hardly follows yet
    EXPECT_EQ(moving.force_fixture_N, 0);
}

TEST(SlaveNode, ReportsTransitionsOfTheStep) {
    Bench bench;
    bench.stay(0.0199, 1);
    EXPECT_EQ(bench.send(needle(0.0201)).phase, TissuePhase::kPenetrated);
    ASSERT_EQ(bench.node.events().size(), 2u);
    EXPECT_NEAR(bench.node.events()[0].offset_s, 0.0005, 1e-12);
    bench.send(needle(0.0204));
    EXPECT_EQ(bench.node.events().size(), 0u);
}

TEST(SlaveNode, BeepsExactlyOnceAfterFiveSecondsOfContact) {
    Bench bench;
    bench.stay(0.122, 10);
    const ForceFeedback before = bench.stay(0.124, 5000);
    EXPECT_NEAR(before.contact_time_s, 4.999, 1e-12);
    EXPECT_FALSE(bench.node.take_beep());
    EXPECT_EQ(bench.stay(0.124, 1).contact_time_s, 5);
    EXPECT_TRUE(bench.node.take_beep());
    EXPECT_FALSE(bench.node.take_beep());
    bench.stay(0.124, 6000);
    EXPECT_FALSE(bench.node.take_beep());
    bench.node.end_trial();
    bench.node.start_trial(trial());
    bench.stay(0.124, 5000);
    EXPECT_FALSE(bench.node.take_beep());
    bench.stay(0.124, 1);
    EXPECT_TRUE(bench.node.take_beep()) << "each trial has a beep";
}

TEST(SlaveNode, HoldZeroesForcesAndBreaksContact) {
    Bench bench;
    bench.stay(0.124, 3000);
    const ForceFeedback held = bench.node.hold();
    EXPECT_TRUE(held.needle_held);
    EXPECT_EQ(held.force_total_N, 0);
    EXPECT_EQ(held.force_fixture_N, 0);
    EXPECT_EQ(held.force_tissue_N, 0);
    EXPECT_EQ(held.contact_time_s, 0);
    EXPECT_EQ(held.position_needle_m, 0.124);
    EXPECT_EQ(held.echo_sequence, bench.sequence);
    EXPECT_EQ(held.echo_time, bench.time);
    const ForceFeedback resumed = bench.stay(0.124, 1);
    EXPECT_FALSE(resumed.needle_held);
    EXPECT_NEAR(resumed.force_fixture_N, -3, 1e-9);
    EXPECT_EQ(resumed.contact_time_s, 0);
    bench.stay(0.124, 4999);
    EXPECT_FALSE(bench.node.take_beep());
    bench.stay(0.124, 1);
    EXPECT_TRUE(bench.node.take_beep());
}

// The tissue is the robot's own, and only the fixture is computed.
TEST(SlaveNode, FollowsARobotAndFeelsItsForceBesideTheFixture) {
    Bench bench;
    ForceFeedback f = bench.node.on_robot(bench.time, 1, 0.05, -0.4);
    f = bench.node.on_robot(bench.time + milliseconds(1), 2, 0.124, -0.75);
    EXPECT_EQ(f.position_needle_m, 0.124);
    EXPECT_EQ(f.force_tissue_N, -0.75);
    EXPECT_NEAR(f.force_fixture_N, -3, 1e-9);
    EXPECT_EQ(f.force_total_N, f.force_tissue_N + f.force_fixture_N);
    EXPECT_EQ(f.phase, TissuePhase::kFree) << "no tissue is simulated";
    EXPECT_EQ(f.position_surface_m, 0.02);
    EXPECT_EQ(bench.node.still(bench.time).force_tissue_N, -0.75);
    EXPECT_EQ(bench.node.hold().force_total_N, 0);
    bench.node.start_trial(trial());
    EXPECT_EQ(bench.send(needle(0.01)).force_tissue_N, 0);
}

TEST(SlaveNode, OnlyALongGapBreaksContact) {
    Bench bench;
    bench.stay(0.124, 1000);
    EXPECT_NEAR(bench.send(needle(0.124), milliseconds(100)).contact_time_s, 1.099, 1e-12);
    EXPECT_EQ(bench.send(needle(0.124), milliseconds(101)).contact_time_s, 0);
}

// After a long gap the needle has waited, then moved: the drag force is that of the last 100 ms, not of the
// gap.
TEST(SlaveNode, NeedleWaitsThroughALongGapAndTheTissueRests) {
    Bench bench;
    bench.stay(0.05, 1);
    EXPECT_NEAR(bench.send(needle(0.06), seconds(60)).force_tissue_N, -0.7 * 0.1, 0.005);
    EXPECT_GT(bench.send(needle(0.08), milliseconds(50)).position_surface_m, 0.0201);
    EXPECT_NEAR(bench.send(needle(0.08), seconds(60)).position_surface_m, 0.02, 1e-12);
}

// The swarm found it: a solver that steps went through all of the time until a stamp with a flipped bit.
TEST(SlaveNode, AStampYearsAheadIsARestOfSeconds) {
    SolverChoice choice;
    choice.name = "semi_implicit_euler";
    choice.longest_step_s = 1e-4;
    SlaveSettings settings;
    settings.make_tissue = solver_maker(choice);
    SlaveNode node(settings);
    node.start_trial(trial());
    node.on_needle(SessionTime{seconds(1)}, 1, needle(0.01));
    const ForceFeedback f = node.on_needle(SessionTime{std::chrono::hours{24 * 365 * 50}}, 2, needle(0.02));
    EXPECT_EQ(f.position_needle_m, 0.02);
    EXPECT_EQ(f.contact_time_s, 0);
}

TEST(SlaveNode, ASampleThatIsNotNewerMovesNothing) {
    Bench bench;
    bench.stay(0.05, 10);
    const ForceFeedback before = bench.send(needle(0.051));
    const ForceFeedback again = bench.node.on_needle(bench.time, 99, needle(0.2));
    EXPECT_EQ(again.position_needle_m, 0.051);
    EXPECT_EQ(again.position_surface_m, before.position_surface_m);
    EXPECT_EQ(again.force_total_N, before.force_total_N);
    EXPECT_EQ(again.echo_sequence, 99u);
    EXPECT_EQ(bench.node.on_needle(bench.time - milliseconds(5), 100, needle(0.2)).position_needle_m, 0.051);
}

// Another master took over, with a clock that started later.
TEST(SlaveNode, AfterAHoldAnEarlierClockIsAccepted) {
    Bench bench;
    bench.stay(0.05, 10);
    bench.node.hold();
    const ForceFeedback f = bench.node.on_needle(SessionTime{milliseconds(3)}, 1, needle(0.052));
    EXPECT_EQ(f.position_needle_m, 0.052);
    EXPECT_NEAR(f.force_tissue_N, -0.7 * 0.02, 0.002);
    EXPECT_EQ(bench.node.on_needle(SessionTime{milliseconds(4)}, 2, needle(0.053)).position_needle_m, 0.053);
}

// A repeated stamp means that no time has passed; after a hold the node accepts it once.
TEST(SlaveNode, AfterAHoldTheSameStampIsAcceptedOnce) {
    Bench bench;
    bench.stay(0.05, 10);
    bench.node.hold();
    EXPECT_EQ(bench.node.on_needle(bench.time, 1, needle(0.052)).position_needle_m, 0.052);
    EXPECT_EQ(bench.node.on_needle(bench.time, 2, needle(0.053)).position_needle_m, 0.052);
}

TEST(SlaveNode, ATrialsFirstCommandMayHaveAnEarlierClock) {
    Bench bench;
    bench.stay(0.05, 10);
    bench.node.start_trial(trial());
    const ForceFeedback f = bench.node.on_needle(SessionTime{milliseconds(3)}, 1, needle(0.06));
    EXPECT_EQ(f.position_needle_m, 0.06);
    EXPECT_EQ(f.force_tissue_N, 0) << "it was placed there";
}

TEST(SlaveNode, RefusesPositionsThatAreNone) {
    Bench bench;
    bench.stay(0.05, 10);
    const double inf = std::numeric_limits<double>::infinity();
    for (const double bad_m : {std::nan(""), inf, -inf, 1e300, 10.1}) {
        NeedleCommand command = needle(0.05);
        command.position_needle_m = bad_m;
        bench.send(command);
        command = needle(0.05);
        command.position_needle_estimate_m = bad_m;
        const ForceFeedback f = bench.send(command);
        EXPECT_EQ(f.echo_time, bench.time) << "its own stamp";
        EXPECT_EQ(f.position_needle_m, 0.05);
        EXPECT_TRUE(std::isfinite(f.force_total_N));
    }
    EXPECT_EQ(bench.node.refused(), 10u);
    bench.node.on_needle(SessionTime{Duration::min()}, 1, needle(0.1));
    EXPECT_EQ(bench.node.refused(), 11u);
    EXPECT_EQ(bench.stay(0.06, 1).position_needle_m, 0.06);
    bench.node.start_trial(trial());
    EXPECT_EQ(bench.send(needle(std::nan(""))).force_total_N, 0) << "a first command that is refused";
}

TEST(SlaveNode, RemovedFixtureIsGoneAtTheNextSample) {
    Bench bench;
    bench.stay(0.124, 100);
    bench.node.change_fixture(trial(0.123, false));
    const ForceFeedback f = bench.stay(0.124, 1);
    EXPECT_FALSE(f.fixture_present);
    EXPECT_EQ(f.force_fixture_N, 0);
    EXPECT_EQ(f.position_proxy_m, 0.124);
    EXPECT_EQ(f.contact_time_s, 0);
}

TEST(SlaveNode, MovedFixtureKeepsUnbrokenContact) {
    Bench bench;
    bench.stay(0.124, 101);
    bench.node.change_fixture(trial(0.1235));
    const ForceFeedback kept = bench.stay(0.124, 1);
    EXPECT_NEAR(kept.contact_time_s, 0.101, 1e-12);
    EXPECT_NEAR(kept.force_fixture_N, -1.5, 1e-9);
    bench.node.change_fixture(trial(0.125));
    EXPECT_EQ(bench.stay(0.124, 1).contact_time_s, 0);
}

TEST(SlaveNode, NoForceAndNoBeepOutsideATrial) {
    Bench bench;
    bench.stay(0.124, 4000);
    bench.node.end_trial();
    const ForceFeedback f = bench.stay(0.126, 6000);
    EXPECT_EQ(f.force_total_N, 0);
    EXPECT_EQ(f.contact_time_s, 0);
    EXPECT_FALSE(f.needle_held);
    EXPECT_FALSE(bench.node.take_beep());

    SlaveNode fresh{SlaveSettings{}};
    EXPECT_EQ(fresh.on_needle(SessionTime{seconds(1)}, 1, needle(0.2)).force_total_N, 0);
}

// A third of a millisecond has no exact decimal: integers neither gain nor lose a sample over five seconds.
TEST(ContactTimer, CountsNanoseconds) {
    ContactTimer timer{seconds(5)};
    EXPECT_FALSE(timer.update(SessionTime(Duration{7}), true));
    EXPECT_FALSE(timer.update(SessionTime(Duration{7 + 4'999'999'999}), true));
    EXPECT_TRUE(timer.update(SessionTime(Duration{7 + 5'000'000'000}), true));
}

}  // namespace
}  // namespace thimble
