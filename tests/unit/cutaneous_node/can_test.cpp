// Bytes on the bus: cannelloni's datagrams, CANopen's services, the states of a drive.
#include <array>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/can/canopen.hpp"
#include "cutaneous_node/can/cia402.hpp"

namespace thimble {
namespace {

using Datagram = std::vector<std::uint8_t>;

CanFrame plain(std::uint32_t id, std::uint8_t length) {
    CanFrame frame;
    frame.id = id;
    frame.length = length;
    for (std::uint8_t i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(0x10 + i);
    return frame;
}

TEST(Cannelloni, WritesWhatItsFormatSays) {
    QueuePipe pipe;
    CannelloniBus bus(pipe.a);
    bus.send(plain(0x201, 2));
    bus.send(plain(0x12345678U | kCanExtended, 0));
    bus.flush();
    bus.flush();  // nothing more to say
    const Bytes sent = pipe.b.receive();
    EXPECT_EQ(Datagram(sent.begin(), sent.end()),
              (Datagram{2, 0, 0, 0, 2, 0, 0, 2, 1, 2, 0x10, 0x11, 0x92, 0x34, 0x56, 0x78, 0}));
    EXPECT_TRUE(pipe.b.receive().empty());
}

TEST(Cannelloni, FramesComeBackAlsoMoreThanADatagramHolds) {
    QueuePipe pipe;
    CannelloniBus near(pipe.a), far(pipe.b);
    std::vector<CanFrame> sent;
    for (std::uint32_t i = 0; i < 100; ++i) sent.push_back(plain(i, static_cast<std::uint8_t>(i % 9)));
    sent.push_back({.id = 7 | kCanRemote, .length = 8});
    for (const CanFrame& frame : sent) near.send(frame);
    near.flush();
    CanFrame frame;
    for (const CanFrame& expected : sent) {
        ASSERT_TRUE(far.receive({}, frame));
        EXPECT_EQ(frame, expected);
    }
    EXPECT_FALSE(far.receive({}, frame));
    EXPECT_EQ(far.counters().received, sent.size());
    EXPECT_EQ(far.counters().malformed, 0U);
}

TEST(Cannelloni, RefusesWhatIsNotExactlyThat) {
    const Datagram good{2, 0, 0, 0, 1, 0, 0, 2, 1, 2, 0x10, 0x11};
    ASSERT_EQ(count_frames(good), 1U);
    const auto with = [&](std::size_t at, std::uint8_t value) {
        Datagram datagram = good;
        datagram[at] = value;
        return count_frames(datagram);
    };
    EXPECT_FALSE(with(0, 1)) << "version";
    EXPECT_FALSE(with(1, 1)) << "acknowledgement";
    EXPECT_FALSE(with(3, 1)) << "257 frames";
    EXPECT_FALSE(with(4, 0)) << "bytes behind the last frame";
    EXPECT_FALSE(with(9, 9)) << "longer than a frame";
    EXPECT_FALSE(with(9, 0x82)) << "CAN FD";
    for (std::size_t size = 0; size < good.size(); ++size) {
        EXPECT_FALSE(count_frames({good.data(), size})) << size;
    }
    QueuePipe pipe;
    CannelloniBus bus(pipe.b);
    pipe.a.send({good.data(), 7});
    pipe.a.send(good);
    CanFrame frame;
    EXPECT_TRUE(bus.receive({}, frame)) << "a good one behind a bad one";
    EXPECT_EQ(bus.counters().malformed, 1U);
}

TEST(CanOpen, SdoBytes) {
    const CanFrame mode = sdo_request(5, {SdoKind::kWrite, {0x6060, 0}, 10, 1});
    EXPECT_EQ(mode.id, 0x605U);
    EXPECT_EQ(mode.data, (std::array<std::uint8_t, 8>{0x2f, 0x60, 0x60, 0, 10, 0, 0, 0}));
    EXPECT_EQ(sdo_request(5, {SdoKind::kWrite, {0x1017, 0}, 30, 2}).data[0], 0x2b);
    EXPECT_EQ(sdo_request(5, {SdoKind::kWrite, {0x1400, 1}, 0x205, 4}).data[0], 0x23);
    EXPECT_EQ(sdo_request(5, {SdoKind::kRead, {0x1000, 0}}).data[0], 0x40);
    EXPECT_EQ(sdo_reply(5, {SdoKind::kRead, {0x6061, 0}, 10, 1}).data[0], 0x4f);
    EXPECT_EQ(sdo_reply(5, {SdoKind::kWrite, {0x6060, 0}}).data[0], 0x60);
    EXPECT_EQ(sdo_reply(5, {SdoKind::kAbort, {0x6060, 0}, 0x06020000}).data,
              (std::array<std::uint8_t, 8>{0x80, 0x60, 0x60, 0, 0, 0, 2, 6}));
}

TEST(CanOpen, SdoComesBack) {
    for (std::uint8_t bytes = 1; bytes <= 4; ++bytes) {
        const Sdo sent{SdoKind::kWrite, {0x1a00, 3}, 0x7f, bytes};
        const auto read = read_sdo_request(sdo_request(9, sent));
        ASSERT_TRUE(read);
        EXPECT_EQ(read->key, sent.key);
        EXPECT_EQ(read->value, sent.value);
        EXPECT_EQ(read->bytes, bytes);
    }
    CanFrame segmented = sdo_reply(9, {SdoKind::kRead, {0x1008, 0}, 20, 4});
    segmented.data[0] = 0x41;  // 20 bytes to follow
    EXPECT_FALSE(read_sdo_reply(segmented));
    segmented.length = 7;
    EXPECT_FALSE(read_sdo_reply(segmented));
}

TEST(Cia402, StatuswordsAreReadByTheirMasks) {
    EXPECT_EQ(state_of(0x0000), DriveState::kNotReady);
    EXPECT_EQ(state_of(0x0250), DriveState::kSwitchOnDisabled);
    EXPECT_EQ(state_of(0x0231), DriveState::kReadyToSwitchOn);
    EXPECT_EQ(state_of(0x0233), DriveState::kSwitchedOn);
    EXPECT_EQ(state_of(0x1637), DriveState::kOperationEnabled);
    EXPECT_EQ(state_of(0x0217), DriveState::kQuickStop);
    EXPECT_EQ(state_of(0x021f), DriveState::kFaultReaction);
    EXPECT_EQ(state_of(0x0218), DriveState::kFault);
}

TEST(Cia402, WordTowardsOperationLeadsThereFromAFault) {
    DriveAutomaton automaton;
    automaton.obey(kControlFaultReset);  // the bit is set before there is anything to reset
    automaton.fail();
    automaton.obey(kControlFaultReset);
    EXPECT_EQ(automaton.state(), DriveState::kFault) << "no edge";
    automaton.obey(0);
    int words = 0;
    for (; automaton.state() != DriveState::kOperationEnabled && words < 10; ++words) {
        automaton.obey(control_towards_operation(state_of(automaton.statusword())));
    }
    EXPECT_EQ(words, 4);
    automaton.obey(kControlDisableVoltage);
    EXPECT_EQ(automaton.state(), DriveState::kSwitchOnDisabled);
}

// Enabling is a step of its own: a drive that is ready gets its power first.
TEST(Cia402, EachStateHasItsNextWord) {
    EXPECT_EQ(control_towards_operation(DriveState::kSwitchOnDisabled), kControlShutdown);
    EXPECT_EQ(control_towards_operation(DriveState::kReadyToSwitchOn), kControlSwitchOn);
    EXPECT_EQ(control_towards_operation(DriveState::kSwitchedOn), kControlEnable);
    EXPECT_EQ(control_towards_operation(DriveState::kNotReady), kControlDisableVoltage);
}

TEST(Cia402, QuickStopOnlyFromOperation) {
    DriveAutomaton automaton;
    automaton.obey(kControlShutdown);
    automaton.obey(kControlQuickStop);
    EXPECT_EQ(automaton.state(), DriveState::kSwitchOnDisabled);
    for (const auto word : {kControlShutdown, kControlSwitchOn, kControlEnable, kControlQuickStop})
        automaton.obey(word);
    EXPECT_EQ(automaton.state(), DriveState::kQuickStop);
    EXPECT_EQ(state_of(automaton.statusword()), DriveState::kQuickStop);
}

TEST(CanBus, ErrorFramesSayWhatIsWrong) {
    CanFrame frame;
    frame.id = kCanError | 0x40;
    EXPECT_EQ(trouble_of(frame), BusTrouble::kOff);
    frame.id = kCanError | 0x04;
    EXPECT_EQ(trouble_of(frame), BusTrouble::kNone) << "a warning level";
    frame.data[1] = 0x20;
    EXPECT_EQ(trouble_of(frame), BusTrouble::kPassive);
    frame.id = 0x40;
    EXPECT_EQ(trouble_of(frame), BusTrouble::kNone) << "no error frame";
}

TEST(DriveCycle, ATimeIsSaidInTheLargestUnitThatFits) {
    const auto said = [](Duration cycle) {
        const auto time = interpolation_time(cycle);
        return time ? std::pair<int, int>{time->count, time->exponent} : std::pair<int, int>{};
    };
    EXPECT_EQ(said(std::chrono::milliseconds{1}), (std::pair{1, -3}));
    EXPECT_EQ(said(std::chrono::milliseconds{100}), (std::pair{100, -3}));
    EXPECT_EQ(said(std::chrono::microseconds{500}), (std::pair{5, -4}));
    EXPECT_EQ(said(std::chrono::microseconds{1250}), (std::pair{125, -5}));
    EXPECT_EQ(said(std::chrono::microseconds{2560}), (std::pair<int, int>{})) << "256 hundredths";
    EXPECT_EQ(said(Duration{0}), (std::pair<int, int>{}));
}

}  // namespace
}  // namespace thimble
