// hidapi itself, and what is built on it, with devices that umockdev makes: no hardware, no rights, every fault.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/hid/hid_thread.hpp"
#include "cutaneous_node/board/board_actuator.hpp"
#include "master/devices/hid/hid_hand.hpp"
#include "tests/devices/mock_bed.hpp"
#include "tests/devices/mock_devices.hpp"
#include "tests/loopback/workbench.hpp"
#include "tests/unit/hid/fake_hid.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

Report bytes_of(const BoardReport& report) { return {report.begin(), report.end()}; }

class HidDevices : public OnABed<MockHid> {
  protected:
    void SetUp() override {
        OnABed::SetUp();
        bus = make_hidapi_bus();
    }
    // Steps until the condition holds, as the thread would but without its pauses.
    template <class Condition>
    bool step_until(HidConnection& connection, Condition holds, int steps = 200) {
        for (int i = 0; i < steps && !holds(); ++i) {
            now += milliseconds{1};
            connection.step(now);
        }
        return holds();
    }

    std::optional<MockHid>& mock = bed_;
    std::unique_ptr<HidBus> bus;
    std::vector<std::string> said;
    std::function<void(const std::string&)> say = [this](const std::string& words) { said.push_back(words); };
    SessionTime now = at(seconds{1});
};

TEST_F(HidDevices, AreListedWithWhatTheySayTheyAre) {
    mock->plug(mock_cap());
    mock->plug(mock_board());
    const auto devices = bus->list();
    ASSERT_EQ(devices.size(), 2U);
    for (const HidDevice& device : devices) {
        const bool is_cap = device.vendor == 0x256f;
        EXPECT_EQ(device.usage_page, is_cap ? 0x01 : kBoardUsagePage);
        EXPECT_EQ(device.usage, is_cap ? 0x08 : kBoardUsage);
        EXPECT_EQ(device.serial, is_cap ? "A1" : "B7");
        EXPECT_EQ(bus->descriptor(device), is_cap ? kCapDescriptor : kBoardDescriptor);
    }
}

TEST_F(HidDevices, ASpaceMouseIsReadLostAndFoundAgain) {
    mock->plug(mock_cap());
    HidHand hand{HidHandSettings{}};
    HidConnection connection(*bus, hand, say);
    connection.step(now);
    ASSERT_TRUE(connection.attached()) << testing::PrintToString(said);
    mock->say(0, Report{1, 0, 0, 0x5e, 0x01, 0, 0});
    EXPECT_TRUE(step_until(connection, [&] { return hand.deflection() == 1.0; }));
    mock->unplug(0);
    EXPECT_TRUE(step_until(connection, [&] { return !hand.deflection(); }));
    EXPECT_THAT(said.back(), HasSubstr("is gone: plug it in again"));
    mock->plug(mock_cap(3));
    EXPECT_TRUE(step_until(connection, [&] { return hand.deflection() == 0.0; }));
    EXPECT_THAT(said.back(), HasSubstr("/dev/hidraw3 is in use"));
}

// One plug, several devices: hidapi lists each, and the one that a hand can hold is read.
TEST_F(HidDevices, OfAReceiverTheCapIsRead) {
    mock->plug({5, 0x1209, 0x0002, "Receiver", "R1", kReceiverDescriptor});
    EXPECT_GT(bus->list().size(), 1U);
    HidHand hand{HidHandSettings{}};
    HidConnection connection(*bus, hand, say);
    connection.step(now);
    ASSERT_TRUE(connection.attached()) << testing::PrintToString(said);
    mock->say(5, Report{2, 1, 100, 156, 1});  // the mouse
    connection.step(now);
    EXPECT_EQ(hand.deflection(), 0.0);
    mock->say(5, Report{3, 0, 0, 0xa2, 0xfe, 0, 0, 0, 0, 0, 0, 0, 0});
    EXPECT_TRUE(step_until(connection, [&] { return hand.deflection() == -1.0; }));
    EXPECT_EQ(hand.bad_reports(), 0U);
}

TEST_F(HidDevices, ABoardIsToldAndHeard) {
    mock->plug(mock_board());
    BoardActuator actuator(HidChoice{}, 1.5);
    HidConnection connection(*bus, actuator, say);
    EXPECT_THAT(actuator.fault(), HasSubstr("not plugged in"));
    actuator.command(now, Finger::kIndex, 1.2);
    connection.step(now);
    ASSERT_TRUE(connection.attached()) << testing::PrintToString(said);
    const Report told = mock->hear(1, kBoardReportBytes, seconds{5});
    const auto command = decode_board_command(told);
    ASSERT_TRUE(command) << testing::PrintToString(told);
    EXPECT_EQ(command->index_mN, 1200);
    mock->say(1, bytes_of(encode(BoardStatus{command->sequence, true, false, BoardFault::kNone, 1100, 0})));
    EXPECT_TRUE(step_until(connection, [&] { return actuator.output(now).force_N > 0; }));
    EXPECT_DOUBLE_EQ(actuator.output(now).force_N, 1.1);
    mock->unplug(1);
    EXPECT_TRUE(step_until(connection, [&] { return !actuator.fault().empty(); }));
    EXPECT_EQ(actuator.output(now).force_N, 0);
}

// The thread ends at once, with a device and while it looks for one.
TEST_F(HidDevices, TheThreadFindsADeviceAndEnds) {
    HidHand hand{HidHandSettings{}};
    { const HidThread looking(hand, RuntimeSettings{}); }
    mock->plug(mock_cap());
    {
        const HidThread reading(hand, RuntimeSettings{});
        EXPECT_TRUE(wait_until([&] { return hand.deflection().has_value(); }));
    }
    EXPECT_FALSE(hand.deflection());
}

}  // namespace
}  // namespace thimble::test
