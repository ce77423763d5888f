// The example of docs/board-protocol.md, compiled as it stands there, with this computer's side of the protocol before it and
// a finger behind it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cutaneous_node/board/board_actuator.hpp"
#include "tests/unit/hid/fake_hid.hpp"
#include "tests/unit/session_time.hpp"

#include THIMBLE_FIRMWARE  // docs/examples/fingertip_board.c

namespace played {
uint32_t clock_ms;
uint16_t pressed_mN[2];
thimble::test::Report told;
}  // namespace played

uint32_t now_ms() { return played::clock_ms; }
void press(int finger, uint16_t force_mN) { played::pressed_mN[finger] = force_mN; }
uint16_t measured_mN(int finger) { return played::pressed_mN[finger]; }
void tud_task() {}
bool tud_hid_ready() { return true; }
bool tud_hid_report(uint8_t report_id, void const* report, uint16_t size) {
    const auto* const bytes = static_cast<const std::uint8_t*>(report);
    played::told = {report_id};
    played::told.insert(played::told.end(), bytes, bytes + size);
    return true;
}

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;

// The cable between both: reports take no time.
class FirmwareLink final : public HidLink {
  public:
    int read(std::span<std::uint8_t> report, Duration /*longest*/) override {
        const std::size_t size = played::told.size();
        std::copy(played::told.begin(), played::told.end(), report.begin());
        played::told.clear();
        return static_cast<int>(size);
    }
    bool write(std::span<const std::uint8_t> report) override {
        tud_hid_set_report_cb(0, 0, 0, report.data(), static_cast<std::uint16_t>(report.size()));
        return true;
    }
};

class Firmware : public testing::Test {
  protected:
    Firmware() {
        board_fault = 0;
        std::string trouble;
        actuator.attach({}, {}, trouble);
    }
    void run(int milliseconds_of_time, bool connected = true) {
        for (int i = 0; i < milliseconds_of_time; ++i) {
            now += milliseconds{1};
            played::clock_ms += 1;
            if (connected) actuator.turn(now, link);
            board_task();
        }
    }
    void press_index() {
        actuator.command(now, Finger::kIndex, 1);
        run(3);
        ASSERT_EQ(played::pressed_mN[0], 1000);
    }
    SessionTime now = at(std::chrono::seconds{1});
    FirmwareLink link;
    BoardActuator actuator{HidChoice{}, 5};
};

TEST_F(Firmware, PressesAndSaysSo) {
    actuator.command(now, Finger::kThumb, 0.8);
    run(3);
    EXPECT_EQ(played::pressed_mN[1], 800);
    EXPECT_EQ(actuator.output(now).finger, Finger::kThumb);
    EXPECT_DOUBLE_EQ(actuator.output(now).force_N, 0.8);
    EXPECT_THAT(actuator.fault(), IsEmpty());
    actuator.command(now, Finger::kIndex, 4);  // beyond what the board allows itself
    run(3);
    EXPECT_EQ(played::pressed_mN[0], 1500);
    EXPECT_EQ(played::pressed_mN[1], 0);
    actuator.release(now);
    run(3);
    EXPECT_EQ(played::pressed_mN[0], 0);
}

TEST_F(Firmware, SpeaksOftenEnoughWhenNothingChanges) {
    actuator.release(now);
    run(500);
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

TEST_F(Firmware, LetsGoFiftyMillisecondsAfterTheLastCommand) {
    press_index();
    run(46, false);
    EXPECT_EQ(played::pressed_mN[0], 1000);
    run(6, false);
    EXPECT_EQ(played::pressed_mN[0], 0);
    run(12, false);  // its next status
    const auto status = decode_board_status(played::told);
    ASSERT_TRUE(status);
    EXPECT_TRUE(status->watchdog);
    EXPECT_FALSE(status->pressing);
}

TEST_F(Firmware, AGarbledCommandIsNoSignOfLife) {
    press_index();
    BoardReport bad = encode(BoardCommand{9, true, 1400, 0});
    bad[4] ^= 1U;
    for (int i = 0; i < 60; ++i) {
        link.write(bad);
        run(1, false);
    }
    EXPECT_EQ(played::pressed_mN[0], 0);
}

TEST_F(Firmware, AFaultLetsGoAndIsTold) {
    press_index();
    board_fault = 1;
    run(20);
    EXPECT_EQ(played::pressed_mN[0], 0);
    EXPECT_THAT(actuator.fault(), HasSubstr("over-current"));
}

}  // namespace
}  // namespace thimble::test
