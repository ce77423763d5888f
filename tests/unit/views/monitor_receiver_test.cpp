#include "visual_node/views/monitor_receiver.hpp"

#include <gtest/gtest.h>

#include "tests/unit/views/played_session.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

int take(MonitorReceiver& receiver, SessionTime now) {
    int taken = 0;
    receiver.update(now, [&](SessionTime, std::uint32_t, const Monitor&) { ++taken; });
    return taken;
}

TEST(MonitorReceiver, HandsOverEveryMessageAndKeepsTheNewest) {
    PlayedViewSession session;
    MonitorReceiver receiver(*session.channels().monitor_in);
    EXPECT_FALSE(receiver.heard());
    EXPECT_TRUE(receiver.silent(at(milliseconds{1})));
    EXPECT_EQ(receiver.age(at(milliseconds{1})), Duration::max());
    for (int i = 1; i <= 3; ++i) {
        session.trial = static_cast<std::uint32_t>(i);
        session.monitor.time_s = i;
        session.say(at(milliseconds{i}));
    }
    EXPECT_EQ(take(receiver, at(milliseconds{3})), 3);
    EXPECT_EQ(receiver.newest().time_s, 3);
    EXPECT_EQ(receiver.trial(), 3U);
    EXPECT_EQ(receiver.age(at(milliseconds{10})), milliseconds{7});
    EXPECT_FALSE(receiver.silent(at(milliseconds{503})));
    EXPECT_TRUE(receiver.silent(at(milliseconds{504})));
}

// A cable that was out overnight: the view needs no new start, whichever session speaks first.
TEST(MonitorReceiver, HearsAgainAfterHoursOfSilence) {
    QueuePipe pipe;
    MonitorReceiver receiver(pipe.b);
    OutboundFlow session(Role::kSession, 2, {&pipe.a}), next(Role::kSession, 3, {&pipe.a});
    session.send(at(milliseconds{1}), 4, Monitor{});
    EXPECT_EQ(take(receiver, at(milliseconds{1})), 1);
    SessionTime now = at(std::chrono::hours{9});
    EXPECT_EQ(take(receiver, now), 0);
    EXPECT_EQ(receiver.age(now), std::chrono::hours{9} - milliseconds{1});
    session.send(now, 4, Monitor{});
    EXPECT_EQ(take(receiver, now), 1);
    now += std::chrono::hours{9};
    next.send(now, 1, Monitor{});
    EXPECT_EQ(take(receiver, now), 1);
    EXPECT_FALSE(receiver.silent(now));
}

TEST(MonitorReceiver, ADevicesWordsStayUntilAnotherTrialRuns) {
    QueuePipe pipe;
    MonitorReceiver receiver(pipe.b);
    OutboundFlow session(Role::kSession, 2, {&pipe.a});
    session.send(at(milliseconds{1}), 4, DeviceFault("drive 3: EMCY 0x2310"));
    session.send(at(milliseconds{1}), 4, Monitor{.reason = EndReason::kDeviceFault});
    take(receiver, at(milliseconds{1}));
    EXPECT_EQ(receiver.fault(), "drive 3: EMCY 0x2310");
    take(receiver, at(std::chrono::seconds{9}));
    EXPECT_EQ(receiver.fault(), "drive 3: EMCY 0x2310") << "also where the session has ended with it";
    session.send(at(std::chrono::seconds{9}), 5, Monitor{});
    take(receiver, at(std::chrono::seconds{9}));
    EXPECT_EQ(receiver.fault(), "");
}

TEST(MonitorReceiver, WhatIsNoMonitorOrNoSessionsIsCounted) {
    QueuePipe pipe;
    MonitorReceiver receiver(pipe.b);
    OutboundFlow master(Role::kMaster, 1, {&pipe.a}), session(Role::kSession, 2, {&pipe.a});
    master.send(at(milliseconds{1}), 1, Monitor{});
    session.send(at(milliseconds{2}), 1, Heartbeat{});
    EXPECT_EQ(take(receiver, at(milliseconds{3})), 0);
    EXPECT_FALSE(receiver.heard());
    EXPECT_EQ(receiver.counters().of(Refusal::kUnexpectedKind), 2U);
}

TEST(MonitorReceiver, AnotherSessionIsHeardOnceTheFirstHasGone) {
    QueuePipe pipe;
    MonitorReceiver receiver(pipe.b);
    OutboundFlow first(Role::kSession, 1, {&pipe.a}), second(Role::kSession, 2, {&pipe.a});
    first.send(at(milliseconds{1}), 1, Monitor{});
    EXPECT_EQ(take(receiver, at(milliseconds{1})), 1);
    second.send(at(milliseconds{500}), 1, Monitor{});
    EXPECT_EQ(take(receiver, at(milliseconds{500})), 0);  // the first may still live
    second.send(at(milliseconds{1100}), 1, Monitor{});
    EXPECT_EQ(take(receiver, at(milliseconds{1100})), 1);
}

}  // namespace
}  // namespace thimble
