// The effect of deflections on the handle, and their settings.
#include "master/devices/hid/hid_hand.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/allocation_count.hpp"
#include "tests/unit/hid/fake_hid.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kFarReach_m = 10;

HidHandSettings position_control() {
    HidHandSettings settings;
    settings.control = HidControl::kPosition;
    return settings;
}

double rate_after(double deflection, Duration time, double reach_m = kFarReach_m) {
    HidHandSettings settings;
    settings.travel_hand_m = 1;
    HidMapping mapping(settings);
    mapping.start(at(seconds{1}));
    HandInput hand;
    for (Duration t{}; t <= time; t += milliseconds{1}) {
        hand = mapping.hand(at(seconds{1} + t), deflection, 0, reach_m);
    }
    EXPECT_TRUE(hand.engaged);
    return hand.position_hand_m;
}

TEST(HidMapping, RateIntegratesBeyondTheDeadZone) {
    EXPECT_NEAR(rate_after(1, seconds{1}), 0.03, 1e-9);
    EXPECT_NEAR(rate_after(-1, seconds{1}), -0.03, 1e-9);
    EXPECT_EQ(rate_after(0.08, seconds{1}), 0);
    EXPECT_NEAR(rate_after(0.54, seconds{1}), 0.015, 1e-9);  // half way from the dead zone to full
}

TEST(HidMapping, AWishStaysWithinReach) { EXPECT_EQ(rate_after(1, seconds{1}, 0.01), 0.01); }

TEST(HidMapping, PositionIsAPlace) {
    HidMapping mapping(position_control());
    mapping.start(at(seconds{1}));
    EXPECT_DOUBLE_EQ(mapping.hand(at(seconds{1}), 1.0, 0, 0).position_hand_m, 0.06);
    EXPECT_EQ(mapping.hand(at(seconds{2}), 0.0, 0, 0).position_hand_m, 0);
}

TEST(HidMapping, AStallMovesNoFurtherThanATenthOfASecond) {
    HidMapping mapping{HidHandSettings{}};
    mapping.start(at(seconds{1}));
    EXPECT_NEAR(mapping.hand(at(seconds{9}), 1.0, 0, kFarReach_m).position_hand_m, 0.003, 1e-9);
}

TEST(HidMapping, WithoutADeviceTheHandHasLetGoAndComesBackWhereTheHandleIs) {
    HidMapping mapping{HidHandSettings{}};
    mapping.start(at(seconds{1}));
    mapping.hand(at(seconds{1} + milliseconds{50}), 1.0, 0, kFarReach_m);
    EXPECT_FALSE(mapping.hand(at(seconds{2}), std::nullopt, 0.02, kFarReach_m).engaged);
    const HandInput back = mapping.hand(at(seconds{3}), 0.0, 0.02, kFarReach_m);
    EXPECT_TRUE(back.engaged);
    EXPECT_DOUBLE_EQ(back.position_hand_m, 0.02);
}

// The device, the thread's half and the handle together, without the thread.
class HidHandleTest : public testing::Test {
  protected:
    HidHandleTest() {
        hand.attach(compact_cap(), {}, trouble);
        handle.start_trial(now, {});
    }
    void say(std::uint8_t low, std::uint8_t high) {
        cable.said.push_back({1, 0, 0, low, high, 0, 0});
        hand.turn(now, link);
    }
    double run(Duration time, double force_hand_N = 0) {
        double position_hand_m = 0;
        for (const SessionTime end = now + time; now < end; now += milliseconds{1}) {
            handle.command_force(now, force_hand_N);
            position_hand_m = handle.read(now).position_hand_m;
        }
        return position_hand_m;
    }
    std::string trouble;
    SessionTime now = at(seconds{5});
    FakeCable cable;
    FakeLink link{cable};
    HidHand hand{HidHandSettings{}};
    HidHandle handle{HandleSettings{}, HidHandSettings{}, hand};
};

TEST_F(HidHandleTest, OneReportMovesItUntilTheNext) {
    say(0x5e, 0x01);
    EXPECT_NEAR(run(seconds{1}), 0.03, 0.004);
    say(0, 0);
    const double stopped_m = run(seconds{1});
    EXPECT_NEAR(run(seconds{1}), stopped_m, 1e-4);
}

TEST_F(HidHandleTest, UnpluggedItYieldsToAnyForceAndReplacesNothing) {
    say(0x5e, 0x01);
    run(seconds{1});
    hand.detach();
    const double let_go_m = run(seconds{1});
    EXPECT_LT(run(milliseconds{500}, 3.0), let_go_m - 0.01);  // pushed out, nothing holds it
    hand.attach(compact_cap(), {}, trouble);
    const double taken_m = run(milliseconds{10});
    EXPECT_NEAR(run(seconds{1}), taken_m, 0.01);
}

TEST_F(HidHandleTest, AWallIsNotWoundUpAgainst) {
    say(0x5e, 0x01);
    run(seconds{5}, 6.0);  // half of what the handle may pull with holds it back
    say(0xa2, 0xfe);       // full deflection outwards
    const double pressed_m = run(milliseconds{1}, 6.0);
    EXPECT_LT(run(milliseconds{700}, 6.0), pressed_m - 0.005);
}

TEST_F(HidHandleTest, TheNamedButtonIsAnEmergencyStop) {
    HidHandSettings settings;
    settings.stop_button = 1;
    HidHand careful{settings};
    HidHandle stoppable{HandleSettings{}, settings, careful};
    ASSERT_TRUE(careful.attach(compact_cap(), {}, trouble)) << trouble;
    const auto buttons = [&](std::uint8_t bits) {
        cable.said.push_back({3, bits, 0});
        careful.turn(now, link);
        hand.turn(now, link);
    };
    buttons(2);
    EXPECT_FALSE(stoppable.take_stop(now));
    buttons(1);
    EXPECT_TRUE(stoppable.take_stop(now));
    EXPECT_FALSE(handle.take_stop(now)) << "no button is named";
    careful.detach();
    EXPECT_FALSE(stoppable.take_stop(now));
    // A pad with eight has no ninth.
    settings.stop_button = 9;
    HidHand wrong{settings};
    EXPECT_FALSE(wrong.attach({"/dev/hidraw0", "Pad", "", 0x054c, 0x0ce6, 1, kGamepadUsage},
                              kGamepadDescriptor, trouble));
    EXPECT_NE(trouble.find("has no button 9"), std::string::npos) << trouble;
}

TEST_F(HidHandleTest, AllocatesNothing) {
    say(0x5e, 0x01);
    const auto before = allocation_count();
    run(milliseconds{100});
    EXPECT_EQ(allocation_count(), before);
}

TEST(HidSettings, AreReadAndRefused) {
    const auto file = ConfigFile::parse(
        "[handle.hid]\ndevice_id = \"256F:c635\"\nserial = \"A1\"\naxis = \"z\"\n"
        "control = \"position\"\ninverted = true\n",
        "test.toml");
    const auto settings = read_hid_hand_settings(file.table("handle").table("hid"));
    EXPECT_EQ(settings.axis, 2U);
    EXPECT_TRUE(settings.inverted);
    EXPECT_EQ(settings.control, HidControl::kPosition);
    EXPECT_TRUE(settings.device.matches(compact_cap()));
    EXPECT_FALSE(settings.device.matches(compact_cap("/dev/hidraw0", "B2")));
    for (const char* bad : {"256f", "256f-c635", "256f:c6351", "256g:c635", "256f:"}) {
        const auto wrong =
            ConfigFile::parse(std::string("[hid]\ndevice_id = \"") + bad + "\"\n", "test.toml");
        EXPECT_THROW(read_hid_choice(wrong.table("hid")), Error) << bad;
    }
}

}  // namespace
}  // namespace thimble::test
