// A replay and the real visual node, in virtual time.
#include "session/play/replay_process.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/queue_channel.hpp"
#include "session/virtual/virtual_loop.hpp"
#include "tests/unit/session_time.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A needle that moves at 10 mm/s for 10 s under a surface far away; the beep at 6 s.
RecordedTrial steady_trial(double delay_s) {
    RecordedTrial trial;
    trial.record.conditions.modality = Modality::kVF;
    trial.record.conditions.delay_s = delay_s;
    for (int i = 0; i <= 10'000; ++i) {
        const double time_s = 0.001 * i;
        trial.record.samples.push_back({.time_s = time_s,
                                        .position_needle_m = 0.01 * time_s,
                                        .position_surface_m = 1,
                                        .force_total_N = -time_s});
    }
    trial.record.beep_time_s = 6;
    trial.record.reason = EndReason::kCompleted;
    return trial;
}

class ReplayProcessTest : public testing::Test {
  protected:
    explicit ReplayProcessTest(double delay_s = 0)
        : trial(steady_trial(delay_s)),
          display(VisualSettings{}.pipeline),
          replay(
              1, trial, 1,
              {&control.a, &force.a, &beep.a, {&monitor.a, &orders.b, &second_monitor.a, &second_orders.b}}),
          visual(2, VisualSettings{}, {&control.b, &force.b, &beep.b, &percept.a}, display),
          view(Role::kExperimenter, 3, {&orders.a}) {
        const std::uint32_t replay_bit = loop.add(replay), visual_bit = loop.add(visual);
        control.a.wake(loop.wake_mask(), replay_bit);
        orders.b.wake(loop.wake_mask(), replay_bit);
        for (QueuePipe* pipe : {&control, &force, &beep}) pipe->b.wake(loop.wake_mask(), visual_bit);
        run_for(milliseconds{200});  // both have found each other
    }
    void run_for(Duration time) {
        const SessionTime end = loop.now() + time;
        while (loop.now() < end && loop.step()) hear();
    }
    void hear() {
        while (const Message* message = heard.receive(loop.now(), monitor.b))
            if (const auto* said = std::get_if<Monitor>(&message->body)) {
                newest = *said;
            } else {
                state = std::get<ReplayState>(message->body);
            }
        while (const Message* message = eyes.receive(loop.now(), percept.b))
            beeps_heard += std::get<Percept>(message->body).beep && !std::exchange(beeping, true);
    }
    void say(OrderKind kind, double value = 0) {
        view.send(loop.now(), 1, Order{.value = value, .kind = kind});
    }
    double shown_m() const { return display.recent(0).scene.position_needle_m; }

    RecordedTrial trial;
    QueuePipe control, force, beep, monitor, orders, second_monitor, second_orders, percept;
    RecordingDisplay display;
    ReplayProcess replay;
    VisualProcess visual;
    OutboundFlow view;
    VirtualLoop loop;
    InboundFlow heard{Role::kSession}, eyes{Role::kVisual};
    Monitor newest;
    ReplayState state;
    int beeps_heard = 0;
    bool beeping = false;
};

TEST_F(ReplayProcessTest, TheScreenShowsTheTrialAndTheViewTheTruth) {
    run_for(seconds{3});
    EXPECT_TRUE(replay.shows());
    EXPECT_EQ(newest.state, NodeState::kRunning);
    EXPECT_NEAR(newest.time_s, 3.2, 0.1);
    EXPECT_NEAR(newest.position_needle_m, 0.01 * newest.time_s, 1.1e-5);
    EXPECT_NEAR(shown_m(), newest.position_needle_m, 0.01 * 0.06);  // a frame and its pipeline ago
    EXPECT_GT(display.recent(0).scene.bar_N, 2.5);
    EXPECT_EQ(visual.counters().refused_total(), 0U);
}

TEST_F(ReplayProcessTest, PausesForMinutesAndGoesOn) {
    say(OrderKind::kPause);
    run_for(seconds{120});
    EXPECT_TRUE(newest.paused);
    EXPECT_EQ(visual.state(), NodeState::kRunning);  // no peer counts as lost
    const double time_s = newest.time_s;
    say(OrderKind::kResume);
    run_for(seconds{1});
    EXPECT_NEAR(newest.time_s, time_s + 1, 0.02);
    EXPECT_FALSE(newest.paused);
}

TEST_F(ReplayProcessTest, ASeekShowsAtOnceWhileItStandsStill) {
    say(OrderKind::kPause);
    run_for(seconds{1});
    for (const double time_s :
         {3.0, 8.0, 1.0, 1.05}) {  // past the beep and back: another trial number, no other picture
        say(OrderKind::kSeek, time_s);
        run_for(milliseconds{300});
        EXPECT_TRUE(newest.paused);
        EXPECT_EQ(newest.time_s, time_s);
        EXPECT_NEAR(shown_m(), 0.01 * time_s, 1.1e-5);
    }
}

TEST_F(ReplayProcessTest, ADimpleIsDrawnAgainstTheTrialsFirstSampleWhereverItBegins) {
    trial.record.samples.front().position_surface_m = 0.5;
    run_for(seconds{7});
    say(OrderKind::kSeek, 3);  // before the beep: begins anew, and not with the first sample
    run_for(milliseconds{300});
    EXPECT_EQ(display.recent(0).scene.position_surface_m, 1);
    EXPECT_EQ(display.recent(0).scene.position_surface_rest_m, 0.5);
}

TEST_F(ReplayProcessTest, AJumpBackOverTheBeepLosesNoScreen) {
    run_for(seconds{7});
    ASSERT_TRUE(replay.shows());
    EXPECT_FALSE(replay.obey(loop.now(), Order{.value = 3, .kind = OrderKind::kSeek}));
    EXPECT_TRUE(replay.shows());
}

TEST_F(ReplayProcessTest, BothViewsHearTheSameAndMaySeek) {
    OutboundFlow player(Role::kExperimenter, 4, {&second_orders.a});
    InboundFlow ears{Role::kSession};
    player.send(loop.now(), 1, Order{.value = 4, .kind = OrderKind::kSeek});
    say(OrderKind::kSpeed, 0.1);
    run_for(seconds{1});
    EXPECT_NEAR(newest.time_s, 4.1, 0.02);
    EXPECT_EQ(state.speed, 0.1);
    EXPECT_EQ(state.duration_s, 10);
    EXPECT_EQ(state.beep_s, 6);
    EXPECT_EQ(state.contact_s, -1);  // this needle touches nothing
    int monitors = 0, states = 0;
    while (const Message* message = ears.receive(loop.now(), second_monitor.b)) {
        monitors += std::holds_alternative<Monitor>(message->body);
        states += std::holds_alternative<ReplayState>(message->body);
    }
    EXPECT_GT(monitors, 30);  // as many as wait in a queue
    EXPECT_GT(states, 1);
}

TEST(ReplayState, MarksChangesAHundredthApartAndNoMoreThanThereIsRoomFor) {
    RecordedTrial trial = steady_trial(0);
    trial.record.samples[2500].phase = TissuePhase::kContact;
    trial.record.network_events = {{0, 0.05, "paper50", {}, {}}, {2, 0.1}, {2.04, 0.2}, {2.09, 0.3}, {5, 0}};
    const ReplayState state = replay_state_of(trial);
    EXPECT_EQ(state.contact_s, 2.5);
    ASSERT_EQ(state.changes, 2U);  // not what it began with, and a slider that was dragged once
    EXPECT_EQ(state.change_s[0], 2);
    EXPECT_EQ(state.change_s[1], 5);
    trial.record.network_events.clear();
    for (int i = 0; i < 60; ++i) trial.record.network_events.push_back({0.15 * i, 0.1});
    EXPECT_EQ(replay_state_of(trial).changes, ReplayState::kMostChanges);
    trial.record.beep_time_s = std::nan("");
    EXPECT_EQ(replay_state_of(trial).beep_s, -1);
    EXPECT_EQ(trial.network(5).empty(), true);
}

TEST_F(ReplayProcessTest, SeeksAndChangesItsSpeed) {
    say(OrderKind::kSeek, 4);
    say(OrderKind::kSpeed, 0.1);
    run_for(seconds{2});
    EXPECT_NEAR(newest.time_s, 4.2, 0.02);
    say(OrderKind::kSpeed, 1000);  // refused
    say(OrderKind::kDelay, 0.1);   // of no replay
    run_for(seconds{1});
    EXPECT_NEAR(newest.time_s, 4.3, 0.02);
    say(OrderKind::kSeek, 1000);
    run_for(seconds{1});
    EXPECT_EQ(newest.time_s, 10);
    EXPECT_EQ(newest.reason, EndReason::kCompleted);
}

TEST_F(ReplayProcessTest, BeepsOnceAndAgainAfterGoingBack) {
    say(OrderKind::kSeek, 5.5);
    run_for(seconds{2});
    EXPECT_EQ(beeps_heard, 1);
    EXPECT_TRUE(newest.beeped);
    beeping = false;
    say(OrderKind::kSeek, 5);
    run_for(milliseconds{500});
    EXPECT_FALSE(newest.beeped);
    EXPECT_EQ(beeps_heard, 1);
    run_for(seconds{1});
    EXPECT_EQ(beeps_heard, 2);
}

TEST_F(ReplayProcessTest, QuitsWhenAsked) {
    say(OrderKind::kQuit);
    run_for(milliseconds{100});
    EXPECT_TRUE(replay.stopped());
}

class LateReplayTest : public ReplayProcessTest {
  protected:
    LateReplayTest() : ReplayProcessTest(0.5) {}
};

TEST_F(LateReplayTest, TheBarIsAsLateAsItWasThenAndThePictureIsNot) {
    run_for(seconds{3});
    EXPECT_NEAR(shown_m(), newest.position_needle_m, 0.01 * 0.06);
    EXPECT_NEAR(newest.time_s - display.recent(0).scene.bar_N, 0.5, 0.07);
    EXPECT_EQ(newest.network_delay_s, 0.5);
}

constexpr SessionTime kBegin = at(seconds{100});

TEST(ReplayClock, RunsAtItsSpeedWithoutAJumpWhenThatChanges) {
    ReplayClock clock(10, 0.5);
    clock.resume(kBegin);
    EXPECT_EQ(clock.time_s(kBegin + seconds{4}), 2);
    clock.set_speed(kBegin + seconds{4}, 4);
    EXPECT_EQ(clock.time_s(kBegin + seconds{4}), 2);
    EXPECT_EQ(clock.time_s(kBegin + seconds{5}), 6);
}

TEST(ReplayClock, EndsAtTheEnds) {
    ReplayClock clock(10);
    clock.resume(kBegin);
    EXPECT_TRUE(clock.at_end(kBegin + seconds{11}));
    EXPECT_EQ(clock.time_s(kBegin + seconds{99}), 10);
    clock.seek(kBegin + seconds{99}, -4);
    EXPECT_EQ(clock.time_s(kBegin + seconds{99}), 0);
    clock.seek(kBegin + seconds{99}, 400);
    EXPECT_EQ(clock.time_s(kBegin + seconds{99}), 10);
    ReplayClock still(0);
    still.resume(kBegin);
    EXPECT_TRUE(still.at_end(kBegin));
    EXPECT_EQ(ReplayClock(1, 1e9).speed(), ReplayClock::kFastest);
}

TEST(ReplayClock, NeverLeavesTheRecordingNorGoesBackByItself) {
    EXPECT_TRUE(rc::check([] {
        ReplayClock clock(*rc::gen::inRange(0, 100));
        SessionTime now = kBegin;
        double before_s = 0;
        for (int i = 0; i < 50; ++i) {
            now += milliseconds{*rc::gen::inRange(0, 3000)};
            RC_ASSERT(clock.time_s(now) >= before_s);
            switch (*rc::gen::inRange(0, 4)) {
                case 0:
                    clock.pause(now);
                    break;
                case 1:
                    clock.resume(now);
                    break;
                case 2:
                    clock.set_speed(now, *rc::gen::inRange(1, 2000) * 0.1);
                    break;
                default:
                    clock.seek(now, *rc::gen::inRange(-10, 120));
            }
            before_s = clock.time_s(now);
            RC_ASSERT(before_s >= 0 && before_s <= 100);
        }
    }));
}

}  // namespace
}  // namespace thimble
