// A needle that a robot moves, without that robot: start, ramp, limits, silence, nonsense, a second sender, stop.
#include "slave_sim/remote_needle.hpp"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slave_sim/slave_process.hpp"
#include "tests/unit/queue_ports.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

constexpr Duration kTick = std::chrono::milliseconds{1};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// It stands where it was put, unless it obeys.
class PlayedNeedle final : public RemoteNeedle {
  public:
    explicit PlayedNeedle(const RobotLimits& limits = {}) : RemoteNeedle(limits) {}
    // In a trial, led to this place for so long.
    PlayedNeedle(std::chrono::milliseconds time, double command_m) : PlayedNeedle() {
        start_trial(now);
        tick_for(time, command_m);
    }
    std::string awaits() override { return {}; }
    std::string name() const override { return "played"; }

    // A tick, in which the robot sends unless it is silent, and then a command comes.
    void tick(std::optional<double> command_m = {}) {
        now += kTick;
        hear(now);
        if (command_m) command(now, *command_m);
        if (obeys && !told_m.empty()) at_m = told_m.back();
    }
    void tick_for(Duration time, std::optional<double> command_m = {}) {
        for (Duration passed{}; passed < time; passed += kTick) tick(command_m);
    }
    nlohmann::ordered_json counted() const {
        nlohmann::ordered_json report;
        describe(report);
        return report.at("robot");
    }

    SessionTime now{std::chrono::seconds{1}};
    std::vector<double> told_m;
    bool obeys = true, sends_position = true, sends_force = true;
    double at_m = 0, feels_N = -0.5;
    std::uint64_t writer = 1;

  private:
    void listen(SessionTime at) override {
        if (sends_position) take_position(at, writer, at_m);
        if (sends_force) take_force(at, writer, feels_N);
    }
    void tell_position(double position_m) override { told_m.push_back(position_m); }
    std::string place_sender() const override { return "the robot's place"; }
    std::string force_sender() const override { return "the robot's force"; }
};

TEST(RemoteNeedle, IsToldNothingBeforeItSaysWhereItIs) {
    PlayedNeedle needle;
    needle.sends_position = false;
    needle.start_trial(needle.now);
    needle.tick_for(std::chrono::milliseconds{15}, 0.05);
    EXPECT_TRUE(needle.told_m.empty());
    EXPECT_FALSE(needle.is_felt());
    needle.sends_position = true;
    needle.at_m = 0.02;
    needle.tick(0.05);
    ASSERT_EQ(needle.told_m.size(), 1U);
    EXPECT_EQ(needle.told_m[0], 0.02) << "from where it is";
    EXPECT_TRUE(needle.is_felt());
    EXPECT_EQ(needle.force_N(), -0.5);
}

TEST(RemoteNeedle, RampsToTheCommandAndThenKeepsToItsSpeed) {
    PlayedNeedle needle;
    needle.start_trial(needle.now);
    needle.tick(0.01);
    needle.tick(0.01);
    EXPECT_DOUBLE_EQ(needle.told_m.back(), 0.05 * 0.001);
    needle.tick_for(std::chrono::milliseconds{200}, 0.01);
    EXPECT_EQ(needle.told_m.back(), 0.01);
    needle.tick(0.05);
    EXPECT_DOUBLE_EQ(needle.told_m.back(), 0.01 + 0.25 * 0.001);
    EXPECT_EQ(needle.counted().at("slowed"), 1);
}

TEST(RemoteNeedle, StaysInItsWorkspaceAndPassesOnSoMuchForce) {
    RobotLimits limits;
    limits.shallowest_m = -0.001;
    limits.deepest_m = 0.001;
    limits.force_limit_N = 2;
    PlayedNeedle needle(limits);
    needle.feels_N = -30;
    needle.start_trial(needle.now);
    needle.tick_for(std::chrono::milliseconds{100}, 0.5);
    EXPECT_EQ(needle.told_m.back(), 0.001);
    EXPECT_EQ(needle.force_N(), -2);
    EXPECT_EQ(needle.counted().at("outside"), 100);
    EXPECT_EQ(needle.counted().at("clipped"), 100);
    needle.tick_for(std::chrono::seconds{1}, -0.05);
    EXPECT_EQ(needle.told_m.back(), -0.001);
}

TEST(RemoteNeedle, SilenceOfEitherInputTakesForceThenTheTrial) {
    for (const bool place : {true, false}) {
        PlayedNeedle needle(std::chrono::milliseconds{50}, 0.001);
        (place ? needle.sends_position : needle.sends_force) = false;
        needle.tick_for(RemoteInput::kStaleAfter, 0.002);
        EXPECT_TRUE(needle.is_felt());
        needle.tick(0.002);
        EXPECT_FALSE(needle.is_felt());
        const std::size_t before = needle.told_m.size();
        needle.tick_for(std::chrono::milliseconds{9}, 0.003);
        EXPECT_EQ(needle.told_m.size(), before) << "no new place";
        EXPECT_EQ(needle.fault(), "");
        needle.tick_for(RemoteInput::kLostAfter - RemoteInput::kStaleAfter, 0.003);
        EXPECT_THAT(std::string(needle.fault()),
                    HasSubstr(place ? "the robot's place has sent no usable position"
                                    : "the robot's force has sent no usable force"));
        needle.sends_position = needle.sends_force = true;
        needle.end_trial(needle.now);
        needle.start_trial(needle.now);
        needle.tick(0.003);
        EXPECT_EQ(needle.fault(), "");
        EXPECT_TRUE(needle.is_felt());
    }
}

// It may have moved meanwhile, and the hand as well.
TEST(RemoteNeedle, ComesBackFromASilenceByARampFromWhereItIs) {
    PlayedNeedle needle(std::chrono::milliseconds{100}, 0.004);
    needle.sends_position = false;
    needle.tick_for(std::chrono::milliseconds{100}, 0.02);
    needle.sends_position = true;
    needle.at_m = 0.003;
    needle.tick(0.02);
    EXPECT_EQ(needle.told_m.back(), 0.003);
    needle.tick(0.02);
    EXPECT_LE(needle.told_m.back(), 0.003 + 0.05 * 0.001 + 1e-12);
}

TEST(RemoteNeedle, LostInAMotionAndStoppedItIsHeldWhereItIsFound) {
    PlayedNeedle needle(std::chrono::milliseconds{100}, 0.02);
    needle.obeys = needle.sends_position = false;
    needle.tick_for(std::chrono::milliseconds{30}, 0.02);
    needle.end_trial(needle.now);
    const std::size_t before = needle.told_m.size();
    needle.tick_for(std::chrono::milliseconds{30});
    EXPECT_EQ(needle.told_m.size(), before) << "nothing is repeated meanwhile";
    needle.sends_position = true;
    for (needle.at_m = 0.003; needle.at_m < 0.0035; needle.at_m += 1e-5) needle.tick();
    EXPECT_GT(needle.told_m.size(), before + 3);
    for (std::size_t i = before; i < needle.told_m.size(); ++i) EXPECT_EQ(needle.told_m[i], 0.003);
}

TEST(RemoteNeedle, RefusesAndCountsWhatNoRobotSends) {
    PlayedNeedle needle(std::chrono::milliseconds{50}, 0.001);
    needle.obeys = false;
    for (const double nonsense : {kNaN, std::numeric_limits<double>::infinity(), 7.0, 0.5}) {
        needle.at_m = nonsense;
        needle.feels_N = 1e4 * nonsense;
        needle.tick(0.001);
        EXPECT_EQ(needle.position_m(), 0.001);
        EXPECT_EQ(needle.force_N(), -0.5);
        EXPECT_EQ(needle.told_m.back(), 0.001);
    }
    EXPECT_EQ(needle.counted().at("position").at("not_numbers"), 3);
    EXPECT_EQ(needle.counted().at("position").at("jumps"), 1);
    EXPECT_EQ(needle.counted().at("force").at("not_numbers"), 4);
}

TEST(RemoteNeedle, ASecondSenderEndsTheTrial) {
    PlayedNeedle needle(std::chrono::milliseconds{50}, 0.001);
    needle.writer = 2;
    needle.tick(0.001);
    EXPECT_THAT(std::string(needle.fault()), HasSubstr("a second program sends beside the robot's place"));
    EXPECT_FALSE(needle.is_felt());
    EXPECT_EQ(needle.counted().at("position").at("other_writers"), 1);
}

TEST(RemoteNeedle, HoldsWhereItIsSaysSoForAWhileAndFallsSilent) {
    PlayedNeedle needle(std::chrono::milliseconds{300}, 0.01);
    needle.obeys = false;
    needle.at_m = 0.009;  // it lags, as tissue resists
    needle.tick(0.01);
    needle.end_trial(needle.now);
    EXPECT_EQ(needle.told_m.back(), 0.009);
    needle.at_m = 0.0085;
    const std::size_t before = needle.told_m.size();
    needle.tick_for(RemoteNeedle::kSaysHold);
    EXPECT_EQ(needle.told_m.size(), before + 29) << "each 10 ms";
    EXPECT_EQ(needle.told_m.back(), 0.009) << "no drift after the measurement";
    needle.tick_for(std::chrono::seconds{1});
    EXPECT_EQ(needle.told_m.size(), before + 29);
    EXPECT_EQ(needle.next_look(), kNever);
}

TEST(RemoteNeedle, TheHoldIsSaidAgainUntilTheSenderFallsSilent) {
    PlayedNeedle needle;
    EXPECT_FALSE(needle.repeat_hold(needle.now));
    needle.start_trial(needle.now);
    needle.tick_for(std::chrono::milliseconds{50}, 0.001);
    const std::size_t before = needle.told_m.size();
    EXPECT_FALSE(needle.repeat_hold(needle.now)) << "it follows";
    needle.at_m = 0.0009;
    needle.obeys = false;
    needle.tick();
    needle.end_trial(needle.now);
    needle.at_m = 0.0008;
    needle.tick();
    EXPECT_TRUE(needle.repeat_hold(needle.now));
    EXPECT_EQ(needle.told_m.size(), before + 2);
    EXPECT_EQ(needle.told_m.back(), 0.0009);
    EXPECT_FALSE(needle.repeat_hold(needle.now + RemoteNeedle::kSaysHold));
    needle.start_trial(needle.now);
    EXPECT_FALSE(needle.repeat_hold(needle.now)) << "no place of an earlier trial";
}

// The slave around it, with [runtime] overrun = "rest". The tissue pushes the needle a little further in each tick.
TEST(RemoteNeedle, IsLedByNoCommandWhileTheSlaveRests) {
    PlayedNeedle needle;
    QueuePorts ports;
    SlaveProcess slave(7, SlaveSettings{}, ports, &needle);
    OutboundFlow session(Role::kSession, 1, {ports.far_end(Port::kSlaveControl)});
    OutboundFlow master(Role::kMaster, 1, {ports.far_end(Port::kSlaveNeedle)});
    SessionControl start;
    start.kind = ControlKind::kTrialStart;
    session.send(needle.now, 1, start);
    slave.tick(needle.now);
    const auto tick_for = [&](int ms) {
        for (int i = 0; i < ms; ++i) {
            needle.now += kTick;
            NeedleCommand command;
            command.position_needle_m = 0.01;
            master.send(needle.now, 1, command);
            slave.tick(needle.now);
            needle.at_m += 1e-5;
        }
    };
    tick_for(50);
    slave.set_overrun(OverrunPolicy::kRest, 3);
    slave.deadlines_missed(needle.now, 3);
    const std::size_t before = needle.told_m.size();
    const double held_m = needle.at_m;
    EXPECT_GT(before, 40U);
    tick_for(100);
    EXPECT_GT(needle.told_m.size(), before + 5);
    for (std::size_t i = before; i < needle.told_m.size(); ++i) EXPECT_EQ(needle.told_m[i], held_m);
    slave.deadlines_missed(needle.now, 0);
    const double found_m = needle.at_m;
    tick_for(1);
    EXPECT_EQ(needle.told_m.back(), found_m) << "and then goes on from where it is";
}

}  // namespace
}  // namespace thimble
