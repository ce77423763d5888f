// The Falcon as a handle: positions from legs, forces to motors, and every way to lose it. The exchange is turned by hand, once each
// millisecond of a time that the test makes.
#include "master/devices/falcon/falcon_handle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/devices/falcon/falcon_exchange.hpp"
#include "master/guarded_handle.hpp"
#include "tests/unit/handles/falcon_emulator.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

class FalconHandleTest : public testing::Test {
  protected:
    FalconHandleTest() {
        device.running = true;
        link.control(3, 0x0002);
        device.put_hand_at({0, 0, 0.115});
        exchange.turn();
    }
    // One millisecond: the handle is read and pushes, then a packet goes and one comes.
    HandleSample step(double force_hand_N = 0) {
        now += milliseconds{1};
        const HandleSample sample = handle.read(now);
        handle.command_force(now, force_hand_N);
        exchange.turn();
        return sample;
    }
    bool motors_still() const { return device.commanded.motors == FalconTriple{}; }
    // Breaks it in a trial with force; how many reads were still good.
    template <class Break>
    int good_reads_after(Break&& break_it) {
        handle.enable_force(now, true);
        for (int i = 0; i < 5; ++i) step(2);
        EXPECT_FALSE(motors_still());
        break_it();
        int good = 0;
        while (good < 200 && step(2).valid) ++good;
        return good;
    }
    void expect_gone_for_good(const char* words) {
        EXPECT_THAT(std::string(handle.fault()), testing::StartsWith("Novint Falcon, serial F1: "));
        EXPECT_THAT(std::string(handle.fault()), HasSubstr(words));
        EXPECT_LT(handle.fault().size(), DeviceFault{}.text.size());
        handle.enable_force(now, true);
        EXPECT_FALSE(step(5).valid);
        EXPECT_EQ(step(5).force_hand_N, 0);
    }

    FalconEmulator device;
    EmulatedFalconLink link{device};
    FalconMailbox mailbox;
    FalconExchange exchange{link, mailbox};
    FalconHandle handle{FalconSettings{}, 8, "Novint Falcon, serial F1", mailbox};
    SessionTime now = at(milliseconds{7});
};

TEST_F(FalconHandleTest, ZIsTowardsTheBaseFromTheMiddle) {
    EXPECT_TRUE(handle.fault().empty());
    EXPECT_NEAR(step().position_hand_m, 0.010, 5e-5);  // a count is 48 um there
    device.put_hand_at({0, 0, 0.13});
    step();
    EXPECT_NEAR(step().position_hand_m, -0.005, 5e-5);
}

// The sensors cannot show it: the grip is then elsewhere around z, which is the needle's axis, and along it within a count (48 um).
TEST_F(FalconHandleTest, SwappedEncodersAreTheSameAlongTheNeedle) {
    device.put_hand_at({0.01, -0.02, 0.115});
    step();
    const double position_m = step().position_hand_m;
    for (const auto& [one, other] : {std::pair{1, 2}, std::pair{0, 1}}) {
        std::swap(device.report.encoders[static_cast<std::size_t>(one)],
                  device.report.encoders[static_cast<std::size_t>(other)]);
        step();
        EXPECT_NEAR(step().position_hand_m, position_m, 4.8e-5);
    }
    EXPECT_EQ(handle.fault(), "");
}

TEST_F(FalconHandleTest, AForceBecomesMotorCounts) {
    device.put_hand_at({0, 0, 0.110});
    exchange.turn();
    handle.enable_force(now, true);
    step(1);
    // 1 N outwards is +z of the device; the golden vector is for inwards.
    for (const std::int16_t counts : device.commanded.motors) EXPECT_NEAR(counts, -241, 2);
    EXPECT_EQ(step(1).force_hand_N, 1);
    step(100);
    for (const std::int16_t counts : device.commanded.motors) EXPECT_NEAR(counts, -8 * 241, 12);
    EXPECT_EQ(step(100).force_hand_N, 8);  // its limit
}

TEST_F(FalconHandleTest, WithoutForceItIsAnEncoder) {
    handle.enable_force(now, false);
    for (int i = 0; i < 20; ++i) {
        EXPECT_TRUE(step(5).valid);
        EXPECT_TRUE(motors_still());
    }
    handle.enable_force(now, true);
    step(5);
    EXPECT_FALSE(motors_still());
    step(std::numeric_limits<double>::quiet_NaN());
    EXPECT_TRUE(motors_still());
    handle.enable_force(now, false);
    exchange.turn();
    EXPECT_TRUE(motors_still());
}

TEST_F(FalconHandleTest, ForcesBeyondTheMotorsAreCountedAndCut) {
    FalconSettings strong;
    strong.motor_gain_per_Nm = 1e5;
    FalconHandle hard(strong, 12, "strong", mailbox);
    hard.enable_force(now, true);
    hard.command_force(now, 12);
    exchange.turn();
    EXPECT_EQ(hard.saturated(), 1U);
    for (const std::int16_t counts : device.commanded.motors) EXPECT_LE(std::abs(counts), kFalconMotorLimit);
}

TEST_F(FalconHandleTest, UnpluggedItIsGoneAtOnce) {
    EXPECT_LE(good_reads_after([this] { device.unplugged = true; }), 1);
    expect_gone_for_good("unplugged");
    device.unplugged = false;  // plugged in again: a hand may be anywhere by now
    EXPECT_FALSE(step(5).valid);
}

TEST_F(FalconHandleTest, WithoutReportsTheForceIsGoneInTwoTicksAndBackWithThem) {
    handle.enable_force(now, true);
    for (bool FalconEmulator::*fault : {&FalconEmulator::silent, &FalconEmulator::garbled_reports}) {
        for (int i = 0; i < 5; ++i) step(2);
        EXPECT_FALSE(motors_still());
        device.*fault = true;
        step(2);
        EXPECT_EQ(step(2).force_hand_N, 0);
        EXPECT_TRUE(motors_still());
        device.*fault = false;
        step(2);
        EXPECT_EQ(step(2).force_hand_N, 0) << "the guard must know that it begins at zero";
        EXPECT_EQ(step(2).force_hand_N, 2) << "a report that is lost is no fault";
        EXPECT_FALSE(motors_still());
    }
}

// 1 N in a millisecond. The exchange also turns between the handle's reading and its command.
TEST_F(FalconHandleTest, AForceThatWasWithheldGrowsFromZeroAsTheGuardSays) {
    GuardSettings limits;
    limits.force_rate_limit_N_per_s = 1000;
    GuardedHandle guard(limits, milliseconds{1}, handle);
    int before = 0, most = 0;  // motor counts
    const auto turn = [&] {
        exchange.turn();
        const int counts = std::abs(device.commanded.motors[0]);
        most = std::max(most, counts - before);
        before = counts;
    };
    const auto tick = [&] {
        guard.read(now += milliseconds{1});
        turn();
        guard.command_force(now, 6);
        turn();
    };
    handle.enable_force(now, true);
    for (const bool stalled : {false, true}) {
        for (int i = 0; i < 20; ++i) tick();
        EXPECT_GT(before, 5 * 241);
        device.silent = !stalled;
        for (int i = 0; i < 3; ++i) tick();
        device.silent = false;
        for (int i = 0; stalled && i < FalconExchange::kUnattendedReads + 2; ++i) turn();
        EXPECT_EQ(before, 0);
        tick();
        EXPECT_LT(before, 260);
    }
    for (int i = 0; i < 20; ++i) tick();
    guard.read(now += milliseconds{1});
    for (int i = 0; i < FalconExchange::kUnattendedReads + 2; ++i) turn();
    guard.command_force(now, 6);  // a master that was stopped after its reading
    turn();
    EXPECT_EQ(before, 0);
    EXPECT_LT(most, 260) << "1 N is 241 counts";
}

TEST_F(FalconHandleTest, UntilItIsHomedThereIsNoForceAndTheWordsSayWhatToDo) {
    EXPECT_EQ(handle.awaits(), "");
    FalconMailbox empty;
    FalconExchange fresh(link, empty);
    FalconHandle waiting(FalconSettings{}, 8, "Falcon", empty);
    EXPECT_EQ(waiting.awaits(), "Falcon: no report yet");
    waiting.enable_force(now, true);
    for (const auto& [legs, words] :
         {std::pair{0, "Falcon: 0 of 3 legs homed; pull the grip all the way out"},
          std::pair{5, "Falcon: 2 of 3 legs homed; pull the grip all the way out"}}) {
        device.report.homed_legs = static_cast<std::uint8_t>(legs);
        fresh.turn();
        EXPECT_THAT(waiting.awaits(), testing::StartsWith(words));
        EXPECT_THAT(std::string(waiting.fault()), HasSubstr("pull the grip all the way out"));
        EXPECT_FALSE(waiting.read(now += milliseconds{1}).valid);
        waiting.command_force(now, 5);
        fresh.turn();
        EXPECT_TRUE(motors_still());
    }
    device.report.homed_legs = 7;  // the person has done it
    fresh.turn();
    EXPECT_EQ(waiting.awaits(), "");
    EXPECT_EQ(waiting.fault(), "");
    EXPECT_TRUE(waiting.read(now += milliseconds{1}).valid);
    device.report.homed_legs = 0;
    device.unplugged = true;
    fresh.turn();
    EXPECT_EQ(waiting.awaits(), "");
    EXPECT_THAT(std::string(waiting.fault()), HasSubstr("unplugged"));
}

TEST_F(FalconHandleTest, OnlyTheButtonsThatTheSettingsNameStop) {
    FalconSettings named;
    named.stop_buttons = kFalconCentre;
    FalconHandle one(named, 8, "one", mailbox);
    named.stop_buttons = 0;
    FalconHandle none(named, 8, "none", mailbox);
    for (const std::uint8_t button : {kFalconPlus, kFalconForward, kFalconCentre, kFalconMinus}) {
        EXPECT_FALSE(handle.take_stop(now));
        device.report.buttons = button;
        exchange.turn();
        EXPECT_TRUE(handle.take_stop(now)) << int{button};
        EXPECT_EQ(one.take_stop(now), button == kFalconCentre) << int{button};
        EXPECT_FALSE(none.take_stop(now));
        device.report.buttons = 0;
        exchange.turn();
    }
}

struct FalconFault {
    const char* name;
    const char* words;
    int most_reads;  // that are still good
    void (*befall)(FalconEmulator& device);
};

// Two ticks for what a report tells, 20 ms for one that does not come.
class FalconFaults : public FalconHandleTest, public testing::WithParamInterface<FalconFault> {};

TEST_P(FalconFaults, EndTheTrialAndTheForceForGood) {
    EXPECT_LE(good_reads_after([this] { GetParam().befall(device); }), GetParam().most_reads);
    expect_gone_for_good(GetParam().words);
    EXPECT_TRUE(motors_still());
}

INSTANTIATE_TEST_SUITE_P(Each, FalconFaults,
                         testing::Values(FalconFault{"Stalled", "no report for 20 ms", 22,
                                                     [](FalconEmulator& d) { d.silent = true; }},
                                         FalconFault{"Garbled", "no report", 22,
                                                     [](FalconEmulator& d) { d.garbled_reports = true; }},
                                         FalconFault{"HomingLost", "no longer knows the position of its legs",
                                                     1, [](FalconEmulator& d) { d.report.homed_legs = 0; }},
                                         FalconFault{"Impossible", "impossible encoder counts 32767 0 -32768",
                                                     1,
                                                     [](FalconEmulator& d) {
                                                         d.report.encoders = {32767, 0, -32768};
                                                     }}),
                         [](const auto& fault) { return fault.param.name; });

}  // namespace
}  // namespace thimble
