// A fingertip board as bytes, and as the node's actuator: who lets go, when, and what is said of it.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cutaneous_node/board/board_actuator.hpp"
#include "tests/allocation_count.hpp"
#include "tests/unit/hid/fake_hid.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::IsEmpty;

Report bytes_of(const BoardReport& report) { return {report.begin(), report.end()}; }

TEST(BoardReports, AreThoseOfTheManual) {
    // docs/board-protocol.md prints these two.
    EXPECT_EQ(bytes_of(encode(BoardCommand{7, true, 1500, 0})),
              (Report{0x01, 0x01, 0x07, 0x01, 0xdc, 0x05, 0x00, 0x00, 0x00, 0xe5}));
    EXPECT_EQ(bytes_of(encode(BoardStatus{7, true, false, BoardFault::kNone, 1480, 0})),
              (Report{0x02, 0x01, 0x07, 0x01, 0xc8, 0x05, 0x00, 0x00, 0x00, 0xd3}));
    const std::string check = "123456789";  // of the CRC's catalogue
    EXPECT_EQ(crc8(Report(check.begin(), check.end())), 0xf4);
}

TEST(BoardReports, ComeBackAsTheyWere) {
    const auto status =
        decode_board_status(encode(BoardStatus{200, true, true, BoardFault::kOther, 0xabcd, 0x1234}));
    ASSERT_TRUE(status);
    EXPECT_EQ(status->sequence, 200);
    EXPECT_TRUE(status->pressing);
    EXPECT_TRUE(status->watchdog);
    EXPECT_EQ(status->fault, BoardFault::kOther);
    EXPECT_EQ(status->index_mN, 0xabcd);
    EXPECT_EQ(status->thumb_mN, 0x1234);
    const auto command = decode_board_command(encode(BoardCommand{9, true, 3, 65535}));
    ASSERT_TRUE(command);
    EXPECT_EQ(command->thumb_mN, 65535);
}

TEST(BoardReports, AnyWrongBitRefusesThem) {
    const BoardReport good = encode(BoardStatus{7, true, false, BoardFault::kNone, 1480, 0});
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        BoardReport bad = good;
        bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << (bit % 8)));
        EXPECT_FALSE(decode_board_status(bad)) << bit;
    }
    EXPECT_FALSE(decode_board_status({}));
    EXPECT_FALSE(decode_board_status(std::span(good).first(9)));
    Report longer = bytes_of(good);
    longer.push_back(0);
    EXPECT_FALSE(decode_board_status(longer));
    EXPECT_FALSE(decode_board_status(encode(BoardCommand{})));
}

class BoardActuatorTest : public testing::Test {
  protected:
    BoardActuatorTest() { actuator.attach(device, {}, words); }
    // The device's thread, once each millisecond.
    void turn(Duration time = milliseconds{1}) {
        for (const SessionTime end = now + time; now < end; now += milliseconds{1}) {
            attached = attached && actuator.turn(now, link);
        }
    }
    void board_says(const BoardStatus& status) { cable.said.push_back(bytes_of(encode(status))); }
    void board_presses(Duration time = milliseconds{1}) {
        board_says({0, true, false, BoardFault::kNone, 900, 0});
        turn(time);
    }
    BoardCommand last_told() const { return decode_board_command(cable.told.back()).value(); }

    const HidDevice device{"/dev/hidraw2", "Board", "S1", 0x1209, 0x0001, kBoardUsagePage, kBoardUsage};
    std::string words;
    SessionTime now = at(seconds{3});
    FakeCable cable;
    FakeLink link{cable};
    BoardActuator actuator{HidChoice{}, 1.5};
    bool attached = true;
};

TEST_F(BoardActuatorTest, PressesWhatIsCommandedWithinItsLimit) {
    actuator.command(now, Finger::kIndex, 1.2);
    turn();
    EXPECT_TRUE(last_told().press);
    EXPECT_EQ(last_told().index_mN, 1200);
    EXPECT_EQ(last_told().thumb_mN, 0);
    actuator.command(now, Finger::kThumb, 99);
    turn();
    EXPECT_EQ(last_told().index_mN, 0);
    EXPECT_EQ(last_told().thumb_mN, 1500);
    actuator.command(now, Finger::kThumb, std::numeric_limits<double>::quiet_NaN());
    turn();
    EXPECT_EQ(last_told().thumb_mN, 0);
    actuator.command(now, Finger::kIndex, -3);
    turn();
    EXPECT_EQ(last_told().index_mN, 0);
    actuator.release(now);
    turn();
    EXPECT_FALSE(last_told().press);
}

TEST_F(BoardActuatorTest, SaysWhatTheBoardMeasuresAndWhenItWasCommanded) {
    const SessionTime commanded = now;
    actuator.command(now, Finger::kIndex, 1.0);
    turn();
    board_says({last_told().sequence, true, false, BoardFault::kNone, 940, 10});
    turn();
    const FingertipForce felt = actuator.output(now);
    EXPECT_EQ(felt.finger, Finger::kIndex);
    EXPECT_DOUBLE_EQ(felt.force_N, 0.94);
    EXPECT_EQ(felt.sample_time, commanded);
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

TEST_F(BoardActuatorTest, IsWrittenToOnlyWhenThereIsNewsOrFiveMillisecondsHavePassed) {
    actuator.command(now, Finger::kIndex, 1.0);
    turn(milliseconds{20});
    EXPECT_EQ(cable.told.size(), 4U);
}

TEST_F(BoardActuatorTest, LetsGoWhenTheNodesLoopStands) {
    actuator.command(now, Finger::kIndex, 1.0);
    turn(milliseconds{30});
    EXPECT_TRUE(last_told().press);
    turn(milliseconds{30});
    EXPECT_FALSE(last_told().press);
    EXPECT_EQ(last_told().index_mN, 0);
    actuator.output(now);  // alive again
    turn(milliseconds{10});
    EXPECT_TRUE(last_told().press);
}

TEST_F(BoardActuatorTest, ASilentBoardIsTroubleAndOneThatSpeaksAgainIsNot) {
    board_presses(milliseconds{90});
    EXPECT_THAT(actuator.fault(), IsEmpty());
    turn(milliseconds{20});
    EXPECT_THAT(actuator.fault(), HasSubstr("no valid report for 100 ms"));
    EXPECT_EQ(actuator.output(now).finger, Finger::kNone);
    board_presses();
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

TEST_F(BoardActuatorTest, OneThatRepeatsItselfIsSilent) {
    const BoardStatus old{3, true, false, BoardFault::kNone, 900, 0};
    const auto repeats_for = [&](int times) {
        for (int i = 0; i < times; ++i) {
            actuator.command(now, Finger::kIndex, 1.0);
            board_says(old);
            turn();
        }
    };
    repeats_for(90);
    EXPECT_THAT(actuator.fault(), IsEmpty());
    repeats_for(20);
    EXPECT_THAT(actuator.fault(), HasSubstr("or always the same"));
    EXPECT_EQ(actuator.output(now).force_N, 0);
    board_says({last_told().sequence, true, false, BoardFault::kNone, 900, 0});
    turn();
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

TEST_F(BoardActuatorTest, AStallOfThisComputerIsNoSilenceOfTheBoard) {
    board_presses();
    now += milliseconds{500};
    turn();
    EXPECT_THAT(actuator.fault(), IsEmpty());
    turn(milliseconds{110});
    EXPECT_THAT(actuator.fault(), HasSubstr("no valid report"));
}

TEST_F(BoardActuatorTest, AWriteThatTheBoardDoesNotTakeIsSilence) {
    board_presses();
    actuator.output(now);
    actuator.output(now += milliseconds{500});  // the loop's own stall
    const auto loop_goes_on = [&](int times) {  // while the thread waits for the board
        for (int i = 0; i < times; ++i) actuator.output(now += milliseconds{1});
    };
    loop_goes_on(99);
    EXPECT_THAT(actuator.fault(), IsEmpty());
    EXPECT_GT(actuator.output(now).force_N, 0);
    loop_goes_on(1);
    EXPECT_THAT(actuator.fault(), HasSubstr("no valid report for 100 ms"));
    EXPECT_EQ(actuator.output(now).force_N, 0);
    board_presses();
    EXPECT_THAT(actuator.fault(), IsEmpty());
    EXPECT_GT(actuator.output(now).force_N, 0);
}

TEST_F(BoardActuatorTest, GarbledReportsAreNoSignOfLife) {
    for (int i = 0; i < 120; ++i) cable.said.push_back({2, 1, 0, 1, 0xff, 0xff, 0, 0, 0, 0});
    turn(milliseconds{120});
    EXPECT_THAT(actuator.fault(), HasSubstr("no valid report"));
    EXPECT_EQ(actuator.bad_reports(), 120U);
    EXPECT_EQ(actuator.output(now).force_N, 0);
}

TEST_F(BoardActuatorTest, ABoardThatIsSlackOrFaultyPressesNothing) {
    board_says({0, false, true, BoardFault::kNone, 900, 0});  // by its watchdog
    turn();
    EXPECT_EQ(actuator.output(now).finger, Finger::kNone);
    EXPECT_THAT(actuator.fault(), IsEmpty());
    board_says({0, true, false, BoardFault::kOverTemperature, 900, 0});
    turn();
    EXPECT_THAT(actuator.fault(), HasSubstr("over-temperature"));
    EXPECT_EQ(actuator.output(now).force_N, 0);
    for (int fault = 1; fault <= static_cast<int>(BoardFault::kOther); ++fault) {
        board_says({0, true, false, static_cast<BoardFault>(fault), 900, 0});
        turn();
        EXPECT_THAT(actuator.fault(), HasSubstr(";")) << fault;  // what is wrong; what to do
    }
}

TEST_F(BoardActuatorTest, AnotherVersionIsTold) {
    BoardReport newer = encode(BoardStatus{});
    newer[1] = 2;
    newer[9] = crc8(std::span(newer).first(9));
    cable.said.push_back(bytes_of(newer));
    turn();
    EXPECT_THAT(actuator.fault(), HasSubstr("another version"));
}

TEST_F(BoardActuatorTest, UnpluggedItIsTroubleAtOnce) {
    board_presses();
    ASSERT_GT(actuator.output(now).force_N, 0);
    cable.plugged = false;
    turn();
    EXPECT_FALSE(attached);
    actuator.detach();
    EXPECT_THAT(actuator.fault(), HasSubstr("not plugged in"));
    EXPECT_EQ(actuator.output(now).force_N, 0);
}

TEST_F(BoardActuatorTest, TheLoopsHalfAllocatesNothing) {
    const auto before = allocation_count();
    for (int i = 0; i < 300; ++i) {
        actuator.command(now, Finger::kThumb, 1);
        actuator.output(now);
        EXPECT_FALSE(actuator.fault().empty());  // nothing has been heard yet
    }
    actuator.release(now);
    EXPECT_EQ(allocation_count(), before);
}

TEST(BoardChoice, TwoBoardsAreNotGuessedAt) {
    const HidDevice one{"/dev/hidraw1", "Board", "S1", 0x1209, 1, kBoardUsagePage, kBoardUsage};
    HidDevice two = one;
    two.path = "/dev/hidraw2";
    two.serial = "S2";
    std::string trouble;
    BoardActuator any(HidChoice{}, 1.5);
    EXPECT_FALSE(any.choose({one, two}, trouble));
    EXPECT_THAT(trouble, HasSubstr("[cutaneous.board]"));
    BoardActuator second(HidChoice{0, 0, "S2"}, 1.5);
    EXPECT_EQ(second.choose({one, two}, trouble), 1U);
    EXPECT_FALSE(any.choose({compact_cap()}, trouble));
    EXPECT_THAT(trouble, HasSubstr("no fingertip board"));
    EXPECT_THAT(any.fault(), HasSubstr("not plugged in"));
}

}  // namespace
}  // namespace thimble::test
