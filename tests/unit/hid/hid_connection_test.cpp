// Finding a device, losing it, finding it again: what is said, and how often the machine is asked.
#include "common/hid/hid_connection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/devices/hid/hid_hand.hpp"
#include "tests/unit/hid/fake_hid.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble::test {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;

class HidAttendantTest : public testing::Test {
  protected:
    Duration step() { return connection.step(at(seconds{1})); }
    FakeCable& cable() { return bus.cables["/dev/hidraw0"]; }

    FakeBus bus;
    HidHand hand{HidHandSettings{}};
    std::vector<std::string> said;
    HidConnection connection{bus, hand, [this](const std::string& sentence) { said.push_back(sentence); }};
};

TEST_F(HidAttendantTest, LooksEachSecondAndSaysSoOnce) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(step(), HidConnection::kLookAgain);
    EXPECT_EQ(bus.listed, 3);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_THAT(said[0], HasSubstr("plug one in"));
    EXPECT_FALSE(hand.deflection());
}

TEST_F(HidAttendantTest, ASilentDeviceIsNotADeadOne) {
    bus.present = {compact_cap()};
    EXPECT_EQ(step(), Duration::zero());
    EXPECT_EQ(hand.deflection(), 0.0);
    cable().said = {{1, 0, 0, 0x5e, 0x01, 0, 0}};  // y = 350
    for (int i = 0; i < 1000; ++i) EXPECT_EQ(step(), Duration::zero());
    EXPECT_EQ(hand.deflection(), 1.0);
    EXPECT_EQ(bus.listed, 1);
    EXPECT_THAT(said, ElementsAre("SpaceMouse Compact (256f:c635) at /dev/hidraw0 is in use"));
}

TEST_F(HidAttendantTest, UnpluggedItLetsGoAtOnceAndComesBack) {
    bus.present = {compact_cap()};
    cable().said = {{1, 0, 0, 0x5e, 0x01, 0, 0}};
    step();
    ASSERT_EQ(hand.deflection(), 1.0);
    cable().plugged = false;
    bus.present.clear();
    EXPECT_EQ(step(), HidConnection::kLookAgain);
    EXPECT_FALSE(hand.deflection());
    step();
    bus.present = {compact_cap("/dev/hidraw7")};  // under another name
    EXPECT_EQ(step(), Duration::zero());
    EXPECT_EQ(hand.deflection(), 0.0);  // not where it was let go
    EXPECT_EQ(hand.attachments(), 2U);
    ASSERT_EQ(said.size(), 4U);
    EXPECT_THAT(said[1],
                HasSubstr("SpaceMouse Compact (256f:c635) at /dev/hidraw0 is gone: plug it in again"));
    EXPECT_THAT(said[3], HasSubstr("/dev/hidraw7 is in use"));
}

TEST_F(HidAttendantTest, AForbiddenDeviceIsNamedWithTheRuleThatOpensIt) {
    bus.present = {compact_cap()};
    bus.forbidden = true;
    EXPECT_EQ(step(), HidConnection::kLookAgain);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_THAT(said[0], HasSubstr("this user may not open SpaceMouse Compact (256f:c635) at /dev/hidraw0"));
    EXPECT_THAT(said[0], HasSubstr("Permission denied"));
    EXPECT_THAT(said[0], HasSubstr("70-thimble-hid.rules"));
    bus.forbidden = false;
    EXPECT_EQ(step(), Duration::zero());
}

TEST_F(HidAttendantTest, GarbledReportsAreCountedAndMoveNothing) {
    bus.present = {compact_cap()};
    cable().said = {{1, 0, 0, 0x5e, 0x01, 0, 0}, {1, 2}, {1, 0, 0, 0, 0x77, 0, 0}, {3, 1, 0}};
    for (int i = 0; i < 5; ++i) step();
    EXPECT_EQ(hand.deflection(), 1.0);
    EXPECT_EQ(hand.bad_reports(), 2U);
}

// Nothing is guessed: what cannot be the hand is named.
TEST_F(HidAttendantTest, WhatIsNotTakenIsNamed) {
    HidDevice mouse = compact_cap();
    mouse.name = "CadMouse";
    mouse.product = 0xc650;
    mouse.usage = kMouseUsage;
    const HidDevice pad{"/dev/hidraw0", "Pad", "", 0x054c, 0x0ce6, 1, kGamepadUsage};
    struct Case {
        std::vector<HidDevice> present;
        const char* words;
    };
    for (const Case& c :
         {Case{{compact_cap("/dev/hidraw0", "A1"), compact_cap("/dev/hidraw1", "B2")},
               "/dev/hidraw1: name one in [handle.hid] device_id or serial"},
          Case{{mouse}, "CadMouse (256f:c650) at /dev/hidraw0 is not a SpaceMouse"},
          Case{{{"/dev/hidraw0", "Pro", "", 0x057e, 0x2009, 1, kGamepadUsage}},
               "Pro (057e:2009) at /dev/hidraw0 is not a SpaceMouse, joystick or gamepad that"},
          Case{{pad}, "has no axis y: choose another in [handle.hid] axis"}}) {
        bus.present = c.present;
        EXPECT_EQ(step(), HidConnection::kLookAgain);
        EXPECT_THAT(said.back(), HasSubstr(c.words));
    }
    EXPECT_EQ(said.size(), 4U);
}

TEST_F(HidAttendantTest, SeveralEntriesOfOneDeviceAreOne) {
    bus.present = {compact_cap(), compact_cap()};
    EXPECT_EQ(step(), Duration::zero());
}

TEST_F(HidAttendantTest, AGamepadIsReadAsItDescribesItself) {
    bus.present = {{"/dev/hidraw0", "Pad", "", 0x054c, 0x0ce6, 1, kGamepadUsage}};
    bus.descriptors["/dev/hidraw0"] = kGamepadDescriptor;
    cable().said = {{1, 128, 255, 128, 128, 0}};
    EXPECT_EQ(step(), Duration::zero());
    EXPECT_EQ(hand.deflection(), 1.0);
}

TEST_F(HidAttendantTest, AGamepadWhoseReportsAreItsMakersIsNamedOnce) {
    bus.present = {{"/dev/hidraw0", "Pad", "", 0x054c, 0x0ce6, 1, kGamepadUsage}};
    bus.descriptors["/dev/hidraw0"] = kGamepadDescriptor;
    cable().said.assign(120, Report{0x31, 128, 255, 128, 128, 0});  // as by Bluetooth
    for (int i = 0; i < 99; ++i) step();
    EXPECT_EQ(said.size(), 1U);
    for (int i = 0; i < 40; ++i) step();
    EXPECT_THAT(said, ElementsAre(HasSubstr("is in use"), HasSubstr("0ce6) at /dev/hidraw0 sends reports")));
    EXPECT_THAT(said.back(), HasSubstr("connect it by cable"));
}

TEST_F(HidAttendantTest, ButtonsOfAGamepadThatIsReadAreNoComplaint) {
    bus.present = {{"/dev/hidraw0", "Pad", "", 0x054c, 0x0ce6, 1, kGamepadUsage}};
    bus.descriptors["/dev/hidraw0"] = kGamepadDescriptor;
    cable().said.assign(120, Report{0x31, 0});
    cable().said.push_front({1, 128, 255, 128, 128, 0});
    for (int i = 0; i < 130; ++i) step();
    EXPECT_EQ(said.size(), 1U);
}

}  // namespace
}  // namespace thimble::test
