// Obey, report, and stop safely: what every node does, tried on a node that does nothing else.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/common/tiny_node.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST_F(NodeProcessTest, HeartbeatsTenTimesASecond) {
    std::vector<SessionTime> sent;
    for (int ms = 1; ms <= 1000; ++ms) {
        tick(milliseconds{ms});
        if (!heartbeats().empty()) sent.push_back(now);
        EXPECT_EQ(process.next_wakeup(), SessionTime{milliseconds{100 * (ms / 100 + 1)}});
    }
    ASSERT_EQ(sent.size(), 10U);
    for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(sent[i], SessionTime{milliseconds{100 * (i + 1)}});
}

TEST_F(NodeProcessTest, WakesForItsWorkToo) {
    process.wanted = SessionTime{milliseconds{3}};
    EXPECT_EQ(process.next_wakeup(), SessionTime{milliseconds{3}});
    const int before = process.works;
    tick(milliseconds{3});
    EXPECT_EQ(process.works, before + 1);
}

TEST_F(NodeProcessTest, StartsAndAcknowledgesAtOnce) {
    order(ControlKind::kTrialStart, 5);
    tick(milliseconds{7});
    EXPECT_EQ(process.said, Said{"begin 5 CF"});
    EXPECT_EQ(process.state(), NodeState::kRunning);
    expect_heartbeat(5, NodeState::kRunning);
}

struct GivenOrder {
    ControlKind kind;
    std::uint32_t trial;
    EndReason reason = EndReason::kNone;
};
// Orders to a node that runs trial 5.
struct OrdersCase {
    const char* name;
    std::vector<GivenOrder> orders;
    std::vector<std::string> said;
    NodeState state;
    EndReason reason = EndReason::kNone;
};

class OrderedNode : public NodeProcessTest, public testing::WithParamInterface<OrdersCase> {};

TEST_P(OrderedNode, ObeysOnceAndAcknowledgesEachTime) {
    start(5);
    for (const GivenOrder& given : GetParam().orders) {
        order(given.kind, given.trial, given.reason);
        tick(now.time_since_epoch() + milliseconds{10});
        EXPECT_EQ(heartbeats().size(), 1U);
    }
    order(ControlKind::kBeep, 99);  // another acknowledgement
    tick(now.time_since_epoch() + milliseconds{10});
    EXPECT_EQ(process.said, GetParam().said);
    EXPECT_EQ(process.stopped(), GetParam().orders[0].kind == ControlKind::kShutdown);
    expect_heartbeat(process.said.size() == 2 ? 6 : 5, GetParam().state, GetParam().reason);
}

using enum ControlKind;
const GivenOrder kTimedOut{kTrialEnd, 5, EndReason::kTimeout};
INSTANTIATE_TEST_SUITE_P(
    Each, OrderedNode,
    testing::Values(
        OrdersCase{"ARepeatedStart", {{kTrialStart, 5}}, {}, NodeState::kRunning},
        OrdersCase{"AnotherTrial", {{kTrialStart, 6}}, {"end 5", "begin 6 CF"}, NodeState::kRunning},
        OrdersCase{"TwoEnds", {kTimedOut, kTimedOut}, {"end 5"}, NodeState::kIdle, EndReason::kTimeout},
        OrdersCase{
            "ALateStart", {kTimedOut, {kTrialStart, 5}}, {"end 5"}, NodeState::kIdle, EndReason::kTimeout},
        OrdersCase{"TheEndOfAnotherTrial", {{kTrialEnd, 4}}, {}, NodeState::kRunning},
        OrdersCase{"ChangesOfTwoTrials",
                   {{kFixtureChange, 6}, {kFixtureChange, 5}},
                   {"fixture"},
                   NodeState::kRunning},
        OrdersCase{"Shutdown", {{kShutdown, 5}}, {"end 5"}, NodeState::kIdle, EndReason::kInterrupted}),
    [](const auto& test) { return test.param.name; });

TEST_F(NodeProcessTest, BetweenTrialsItObeysAShutdownAlone) {
    order(kFixtureChange, 1);
    order(kShutdown, 0);
    tick(milliseconds{20});
    EXPECT_EQ(process.said, Said{});
    EXPECT_TRUE(process.stopped());
}

TEST_F(NodeProcessTest, FinishingIsReportedAtOnceAndStillRunning) {
    process.end_at_once = true;
    start();
    tick(milliseconds{11});
    heartbeats();
    process.end_at_once = false;
    EXPECT_EQ(process.state(), NodeState::kFinished);
    order(ControlKind::kTrialEnd, 1, EndReason::kCompleted);
    tick(milliseconds{20});
    EXPECT_EQ(process.said, Said{"end 1"});
}

TEST_F(NodeProcessTest, ASilentSessionEndsTheTrial) {
    start();  // at 10 ms
    listen_until(milliseconds{10} + kPeerTimeout);
    EXPECT_EQ(process.state(), NodeState::kRunning);  // exactly the limit
    heartbeats();
    tick(milliseconds{10} + kPeerTimeout + Duration{1});
    EXPECT_EQ(process.said, Said{"end 1"});
    expect_heartbeat(1, NodeState::kFailed, EndReason::kPeerLost);
    EXPECT_EQ(process.reason(), EndReason::kPeerLost);
    tick(seconds{2});
    EXPECT_EQ(process.said, Said{"end 1"});
}

// Stopped, or kept from the processor of a busy machine, as the others may have been.
TEST_F(NodeProcessTest, WhoStoodStillListensBeforeItCallsOthersSilent) {
    start();
    process.needs_peer = true;
    tick(seconds{9});
    EXPECT_EQ(process.state(), NodeState::kRunning);
    listen_until(seconds{9} + kPeerTimeout);
    EXPECT_EQ(process.reason(), EndReason::kPeerLost);
}

// Without messages its own wake-ups must be enough to notice within the promised second.
TEST_F(NodeProcessTest, ItsOwnWakeUpsNoticeTheSilence) {
    start();
    while (process.state() == NodeState::kRunning) {
        ASSERT_LT(process.next_wakeup(), SessionTime{seconds{2}});
        tick(process.next_wakeup().time_since_epoch());
        heartbeats();
    }
    EXPECT_LT(now, SessionTime{seconds{1}});
}

TEST_F(NodeProcessTest, TheSessionsHeartbeatsKeepItAlive) {
    start();
    for (int ms = 100; ms <= 3000; ms += 100) {
        now = SessionTime{milliseconds{ms}};
        session.send(now, 1, Heartbeat{});
        tick(milliseconds{ms});
        heartbeats();
    }
    EXPECT_EQ(process.state(), NodeState::kRunning);
}

TEST_F(NodeProcessTest, ALostPeerEndsTheTrial) {
    process.needs_peer = true;
    start();
    for (int ms = 100; ms <= 500; ms += 100) {
        session.send(now, 1, Heartbeat{});
        tick(milliseconds{ms});
    }
    EXPECT_EQ(process.said, Said{});
    heartbeats();
    tick(milliseconds{501});
    EXPECT_EQ(process.said, Said{"end 1"});
    expect_heartbeat(1, NodeState::kFailed, EndReason::kPeerLost);
}

TEST_F(NodeProcessTest, AFailedDeviceEndsTheTrialAndSaysWhy) {
    start();
    process.fault = "the handle is unplugged; plug it in";
    tick(milliseconds{11});
    EXPECT_EQ(process.said, Said{"end 1"});
    const std::vector<Message> said = heartbeats();
    ASSERT_EQ(said.size(), 2U);
    EXPECT_EQ(std::get<Heartbeat>(said[0].body).reason, EndReason::kDeviceFault);
    EXPECT_EQ(std::get<Heartbeat>(said[0].body).state, NodeState::kFailed);
    EXPECT_EQ(std::get<DeviceFault>(said[1].body).words(), process.fault);
}

TEST_F(NodeProcessTest, NoTrialBeginsWithAFailedDevice) {
    process.fault = "gone";
    order(ControlKind::kTrialStart);
    tick(milliseconds{10});
    EXPECT_EQ(process.state(), NodeState::kFailed);
    EXPECT_EQ(process.said, (Said{"begin 1 CF", "end 1"}));
}

TEST_F(NodeProcessTest, BetweenTrialsSilenceIsNoFailure) {
    process.needs_peer = true;
    listen_until(seconds{5});
    EXPECT_EQ(process.state(), NodeState::kIdle);
    EXPECT_EQ(process.said, Said{});
}

TEST_F(NodeProcessTest, AFailedTrialIsAcknowledgedByItsEndAndTheNextStarts) {
    start();
    listen_until(seconds{1});
    ASSERT_EQ(process.state(), NodeState::kFailed);
    heartbeats();
    order(ControlKind::kTrialEnd, 1, EndReason::kPeerLost);
    tick(seconds{1} + milliseconds{1});
    expect_heartbeat(1, NodeState::kIdle, EndReason::kPeerLost);
    order(ControlKind::kTrialStart, 2);
    tick(seconds{1} + milliseconds{2});
    EXPECT_EQ(process.state(), NodeState::kRunning);
    EXPECT_EQ(process.said, (Said{"end 1", "begin 2 CF"}));
}

TEST_F(NodeProcessTest, AnswersAClockProbeInTheSameTick) {
    session.send(now, 0, ClockProbe{SessionTime{milliseconds{3}}});
    tick(milliseconds{40});
    const auto messages = heartbeats();
    ASSERT_EQ(messages.size(), 1U);
    const auto& reply = std::get<ClockReply>(messages[0].body);
    EXPECT_EQ(reply.probe_send_time, SessionTime{milliseconds{3}});
    EXPECT_EQ(reply.probe_arrival_time, now);  // the channel does not know better
    EXPECT_EQ(messages[0].header.send_time, now);
    EXPECT_EQ(process.state(), NodeState::kIdle);
}

TEST_F(NodeProcessTest, AClockReplyIsNoOrder) {
    session.send(now, 0, ClockReply{});
    tick(milliseconds{40});
    EXPECT_TRUE(heartbeats().empty());
    EXPECT_EQ(process.counters().of(Refusal::kUnexpectedKind), 1U);
}

TEST_F(NodeProcessTest, CountsWhatItHearsAndReportsIt) {
    session.send(now, 0, NeedleCommand{});  // the session does not steer needles
    session.send(now, 0, Heartbeat{});
    OutboundFlow stranger(Role::kSession, 2, {&far});
    stranger.send(now, 0, Heartbeat{});
    far.send(std::vector<std::uint8_t>(9, 0x55));
    tick(milliseconds{100});
    const FlowCounters counters = process.counters();
    EXPECT_EQ(counters.accepted, 1U);
    EXPECT_EQ(counters.of(Refusal::kUnexpectedKind), 1U);
    EXPECT_EQ(counters.of(Refusal::kSecondSender), 1U);
    EXPECT_EQ(counters.of(Refusal::kForeignFormat), 1U);
    const auto messages = heartbeats();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(std::get<Heartbeat>(messages[0].body).accepted, 1U);
    EXPECT_EQ(std::get<Heartbeat>(messages[0].body).refused, 3U);
}

TEST_F(NodeProcessTest, ANetworkIsChangedOnceHoweverOftenItIsSaidAndAlsoBetweenTrials) {
    const auto say = [&](const char* name, double delay_s, std::uint32_t trial) {
        SessionControl control;
        control.kind = ControlKind::kNetworkChange;
        control.network = *NetworkName::of(name);
        control.network_delay_s = delay_s;
        session.send(now, trial, control);
        process.tick(now);
    };
    say("lte", 0.25, 0);  // before the first trial
    order(ControlKind::kTrialStart);
    tick(milliseconds{10});
    EXPECT_EQ(process.said, (Said{"delay 0.250000lte", "begin 1 CF"}));
    process.said.clear();
    say("lte", 0.25, 1);
    for (int i = 0; i < 2; ++i) say("geo", 0.25, 1);
    for (int i = 0; i < 2; ++i) say("geo", 0.5, 1);
    say("geo", 0, 7);  // of another trial
    say("geo", 0, 1);
    EXPECT_EQ(process.said, (Said{"delay 0.250000geo", "delay 0.500000geo", "delay 0.000000geo"}));
}

}  // namespace
}  // namespace thimble
