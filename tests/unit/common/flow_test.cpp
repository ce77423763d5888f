// A flow accepts one sender, newest first, for the running trial.
#include "common/flow.hpp"

#include <array>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "common/stop_bus.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Sends any message under any role.
struct Speaker {
    Header header{7, at(seconds{1}), 100, 3, Role::kMaster};
    Encoder encoder;

    template <class Body>
    Bytes say(const Body& body) {
        return encoder.encode(header, body);
    }
    Bytes say() { return say(NeedleCommand{}); }
    Bytes numbered(std::uint32_t sequence) {
        header.sequence = sequence;
        return say();
    }
};

class InboundFlowTest : public testing::Test {
  protected:
    bool admits(Bytes datagram) { return flow.admit(now, datagram) != nullptr; }
    std::uint64_t refused(Refusal refusal) const { return flow.counters().of(refusal); }

    Speaker master;
    InboundFlow flow{Role::kMaster};
    SessionTime now = at(seconds{10});
};

TEST_F(InboundFlowTest, AdmitsTheExpectedSender) {
    const Message* message = flow.admit(now, master.say(NeedleCommand{0.5, 0, 0, 0, 0, 0}));
    ASSERT_NE(message, nullptr);
    EXPECT_EQ(std::get<NeedleCommand>(message->body).position_needle_m, 0.5);
    EXPECT_EQ(message->header.sequence, 100U);
    EXPECT_EQ(flow.last_accepted(), now);
    EXPECT_EQ(flow.counters().accepted, 1U);
    EXPECT_EQ(flow.counters().refused_total(), 0U);
}

// Sequences in the order of their arrival, and why they are refused.
TEST_F(InboundFlowTest, NewestWinsAndDuplicatesAreCounted) {
    struct Arrival {
        std::uint32_t sequence;
        std::optional<Refusal> refusal{};
    };
    constexpr auto kOld = Refusal::kOutdated, kTwice = Refusal::kDuplicate;
    const std::vector<std::vector<Arrival>> cases{
        {{100}, {105}, {104, kOld}, {1, kOld}, {106}},  // a gap is no reason to wait
        {{100}, {100, kTwice}, {100, kTwice}, {101}},
        {{0xfffffffe}, {0xffffffff}, {0}, {1}, {0xffffffff, kOld}, {0, kOld}},
        {{1},
         {1 + 0x80000000U, kOld},
         {1 + 0x7fffffffU}}};  // half the circle is ahead, the other half behind
    for (std::size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(i);
        InboundFlow fresh{Role::kMaster};
        std::uint64_t accepted = 0;
        for (const auto& [sequence, refusal] : cases[i]) {
            const std::uint64_t before = refusal ? fresh.counters().of(*refusal) : 0;
            EXPECT_EQ(fresh.admit(now, master.numbered(sequence)) != nullptr, !refusal) << sequence;
            EXPECT_EQ(refusal ? fresh.counters().of(*refusal) : 1, before + 1) << sequence;
            accepted += refusal ? 0 : 1;
        }
        EXPECT_EQ(fresh.counters().accepted, accepted);
    }
}

TEST(SequenceAhead, CountsAcrossTheWrap) {
    EXPECT_EQ(sequence_ahead(5, 3), 2);
    EXPECT_EQ(sequence_ahead(3, 5), -2);
    EXPECT_EQ(sequence_ahead(1, 0xffffffff), 2);
    EXPECT_EQ(sequence_ahead(0xffffffff, 1), -2);
}

TEST_F(InboundFlowTest, StampsMayRestButNotGoBack) {
    ASSERT_TRUE(admits(master.numbered(100)));
    EXPECT_TRUE(admits(master.numbered(101)));  // two sends in one instant
    master.header.send_time -= Duration{1};
    EXPECT_FALSE(admits(master.numbered(102)));
    EXPECT_EQ(refused(Refusal::kStampNotIncreasing), 1U);
    master.header.send_time += Duration{1};
    EXPECT_TRUE(admits(master.numbered(102)));  // the refused one left nothing behind
}

TEST_F(InboundFlowTest, ASecondSenderIsLockedOut) {
    Speaker other;
    other.header.instance = 8;
    ASSERT_TRUE(admits(master.numbered(100)));
    now += seconds{1};  // exactly the limit
    EXPECT_FALSE(admits(other.numbered(5000)));
    EXPECT_EQ(refused(Refusal::kSecondSender), 1U);
    EXPECT_TRUE(admits(master.numbered(101)));
}

TEST_F(InboundFlowTest, ARestartedSenderGetsInAfterASecondOfSilence) {
    Speaker restarted;
    restarted.header.instance = 8;
    restarted.header.send_time = at(milliseconds{1});  // its clock and numbers begin anew
    ASSERT_TRUE(admits(master.numbered(100)));
    now += seconds{1} + Duration{1};
    EXPECT_TRUE(admits(restarted.numbered(1)));
    EXPECT_TRUE(admits(restarted.numbered(2)));
    EXPECT_FALSE(admits(master.numbered(101)));  // now the old one is the second
    EXPECT_EQ(refused(Refusal::kSecondSender), 1U);
}

// A stranger who keeps knocking must not keep the seat warm for himself, nor for the one who left.
TEST_F(InboundFlowTest, RefusedMessagesAreNoSignOfLife) {
    Speaker other;
    other.header.instance = 8;
    ASSERT_TRUE(admits(master.numbered(100)));
    const SessionTime heard = now;
    for (int i = 0; i < 10; ++i) {
        now += milliseconds{100};
        EXPECT_FALSE(admits(other.say()));
        EXPECT_FALSE(admits(master.numbered(100)));
    }
    EXPECT_EQ(flow.last_accepted(), heard);
    EXPECT_TRUE(flow.silent_for(now, milliseconds{999}));
    now += milliseconds{1};
    EXPECT_TRUE(admits(other.say()));
}

// A program that was restarted between two trials need not wait, whatever its clock and numbers are now.
TEST_F(InboundFlowTest, ATrialBelongsToWhoSpeaksFirstInIt) {
    Speaker restarted;
    restarted.header.instance = 8;
    restarted.header.send_time = at(milliseconds{1});
    ASSERT_TRUE(admits(master.numbered(100)));
    now += milliseconds{10};
    flow.expect_from(now);
    EXPECT_FALSE(flow.silent_for(now, Duration{0}));
    EXPECT_TRUE(flow.silent_for(now + Duration{1}, Duration{0}));
    EXPECT_TRUE(admits(restarted.numbered(1)));
    EXPECT_FALSE(admits(master.numbered(101)));
    EXPECT_EQ(refused(Refusal::kSecondSender), 1U);
}

// The first answer may take a while: its silence counts from a time to come.
TEST_F(InboundFlowTest, ExpectedLaterIsNotSilentYet) {
    flow.expect_from(now + milliseconds{300});
    EXPECT_FALSE(flow.silent_for(now + milliseconds{400}, milliseconds{100}));
    EXPECT_TRUE(flow.silent_for(now + milliseconds{401}, milliseconds{100}));
}

TEST_F(InboundFlowTest, AWrongRoleIsRefusedAndLocksNobodyOut) {
    master.header.sender = Role::kSlaveSim;
    EXPECT_FALSE(admits(master.numbered(100)));
    EXPECT_EQ(refused(Refusal::kUnexpectedKind), 1U);
    master.header.sender = Role::kMaster;
    EXPECT_TRUE(admits(master.numbered(100)));
}

TEST_F(InboundFlowTest, CountsWhatTheCodecRefuses) {
    const std::vector<std::uint8_t> noise(20, 0x55);
    EXPECT_FALSE(admits(noise));
    EXPECT_FALSE(admits(Bytes(noise.data(), 3)));
    EXPECT_EQ(refused(Refusal::kForeignFormat), 1U);
    EXPECT_EQ(refused(Refusal::kTooShort), 1U);
    EXPECT_EQ(flow.counters().refused_total(), 2U);
}

TEST_F(InboundFlowTest, RefusingAnAdmittedMessageMovesItsCount) {
    ASSERT_TRUE(admits(master.numbered(100)));
    flow.refuse_admitted(Refusal::kWrongTrial);
    EXPECT_EQ(flow.counters().accepted, 0U);
    EXPECT_EQ(refused(Refusal::kWrongTrial), 1U);
}

// Drains `flow` through a channel that holds what was said to it.
class Drain : public InboundFlowTest {
  protected:
    Drain() { sender.connect(receiver); }
    std::vector<std::uint32_t> drain(bool running, std::uint32_t trial) {
        std::vector<std::uint32_t> used;
        flow.drain<NeedleCommand>(
            now, receiver, running, trial,
            [&](const Header& header, const NeedleCommand&) { used.push_back(header.sequence); });
        return used;
    }
    using Sequences = std::vector<std::uint32_t>;

    QueueChannel sender, receiver;
};

TEST_F(Drain, UsesAllThatIsNewInOrder) {
    for (const std::uint32_t sequence : {1U, 2U, 2U, 4U, 3U, 5U}) sender.send(master.numbered(sequence));
    EXPECT_EQ(drain(true, 3), (Sequences{1, 2, 4, 5}));
    EXPECT_EQ(refused(Refusal::kDuplicate), 1U);
    EXPECT_EQ(refused(Refusal::kOutdated), 1U);
    EXPECT_EQ(drain(true, 3), Sequences{});
}

TEST_F(Drain, EarlierAndLaterTrialsAreCountedNotUsed) {
    sender.send(master.numbered(1));
    master.header.trial = 5;
    sender.send(master.numbered(2));
    master.header.trial = 4;
    sender.send(master.numbered(3));
    EXPECT_EQ(drain(true, 4), Sequences{3});
    EXPECT_EQ(refused(Refusal::kWrongTrial), 2U);
    EXPECT_EQ(flow.counters().accepted, 1U);
}

// Rests of an earlier trial must neither lock the flow nor spoil the numbers of the running one.
TEST_F(Drain, AnEarlierTrialLocksNobodyOut) {
    Speaker left_over;
    left_over.header.trial = 2;
    left_over.header.instance = 6;
    sender.send(left_over.numbered(9000));
    sender.send(master.numbered(1));
    EXPECT_EQ(drain(true, 3), Sequences{1});
    EXPECT_EQ(refused(Refusal::kWrongTrial), 1U);
    EXPECT_EQ(refused(Refusal::kSecondSender), 0U);
}

TEST_F(Drain, BetweenTrialsTheChannelIsKeptEmpty) {
    sender.send(master.numbered(1));
    sender.send(master.numbered(2));
    EXPECT_EQ(drain(false, 3), Sequences{});
    EXPECT_EQ(refused(Refusal::kWrongTrial), 2U);
    EXPECT_TRUE(receiver.receive().empty());
}

TEST_F(Drain, OtherKindsAreCountedNotUsed) {
    sender.send(master.say(ForceFeedback{}));
    sender.send(master.numbered(101));
    EXPECT_EQ(drain(true, 3), Sequences{101});
    EXPECT_EQ(refused(Refusal::kUnexpectedKind), 1U);
}

TEST(OutboundFlow, NumbersStampsAndSendsToAll) {
    QueueChannel near_a, near_b, far_a, far_b;
    near_a.connect(far_a);
    near_b.connect(far_b);
    OutboundFlow out(Role::kSlaveSim, 99, {&near_a, &near_b});
    out.send(at(seconds{1}), 4, Percept{});
    out.send(at(seconds{2}), 5, Heartbeat{});
    EXPECT_EQ(out.sequence(), 2U);
    for (QueueChannel* far : {&far_a, &far_b}) {
        for (std::uint32_t n = 1; n <= 2; ++n) {
            const Decoded decoded = decode(far->receive());
            ASSERT_TRUE(decoded.message);
            const Header& header = decoded.message->header;
            EXPECT_EQ(header.instance, 99U);
            EXPECT_EQ(header.sender, Role::kSlaveSim);
            EXPECT_EQ(header.sequence, n);
            EXPECT_EQ(header.trial, 3 + n);
            EXPECT_EQ(header.send_time, at(seconds{n}));
        }
        EXPECT_TRUE(far->receive().empty());
    }
}

TEST_F(InboundFlowTest, SilenceIsExcusedUntilANamedTimeAndTheUsualPatienceThen) {
    ASSERT_TRUE(admits(master.say()));
    flow.excuse_silence_until(now + seconds{2});
    EXPECT_FALSE(flow.lost_for(now + milliseconds{2400}, milliseconds{500}));
    EXPECT_TRUE(flow.lost_for(now + milliseconds{2501}, milliseconds{500}));
    EXPECT_TRUE(flow.silent_for(now + milliseconds{501}, milliseconds{500}));  // still silent
    flow.did_not_listen(milliseconds{100});
    EXPECT_FALSE(flow.silent_for(now + milliseconds{600}, milliseconds{500}));
    EXPECT_FALSE(flow.lost_for(now + milliseconds{2600}, milliseconds{500}));
    EXPECT_TRUE(flow.lost_for(now + milliseconds{2601}, milliseconds{500}));
    flow.expect_from(now);
    EXPECT_TRUE(flow.lost_for(now + milliseconds{501}, milliseconds{500}));
}

// A socket that is filled faster than it can be read.
class EndlessChannel final : public Channel {
  public:
    void send(Bytes /*datagram*/) override {}
    int taken = 0;

  private:
    Bytes take() override {
        ++taken;
        return {rubbish_.data(), rubbish_.size()};
    }
    std::array<std::uint8_t, 112> rubbish_{};
};

TEST(Flood, HoldsNoTick) {
    EndlessChannel flood;
    InboundFlow flow{Role::kMaster};
    int used = 0;
    flow.drain<NeedleCommand>(at(seconds{1}), flood, true, 1, [&](const auto&, const auto&) { ++used; });
    EXPECT_EQ(used, 0);
    EXPECT_EQ(flood.taken, kMostRefusedAtOnce);
    EXPECT_EQ(flow.counters().refused_total(), static_cast<std::uint64_t>(kMostRefusedAtOnce));

    EndlessChannel stops;
    StopBus line(Role::kMaster, 1);
    line.connect(stops, StopOutlets{&stops, &stops, &stops, &stops, &stops, &stops});
    line.tick(at(seconds{1}));
    EXPECT_EQ(stops.taken, kMostRefusedAtOnce);
    EXPECT_FALSE(line.stopped());
}

}  // namespace
}  // namespace thimble
