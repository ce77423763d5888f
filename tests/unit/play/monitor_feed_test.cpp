// The state for a view, from a whole session in virtual time.
#include "session/play/monitor_feed.hpp"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class MonitorFeedTest : public testing::Test {
  protected:
    explicit MonitorFeedTest(Duration delay = milliseconds{50}) : session(with(delay)) {}

    static SystemSettings with(Duration delay) {
        SystemSettings settings = load_system_settings({});
        settings.netem.force.delay = delay;
        return settings;
    }
    static TrialConditions trial() {
        TrialConditions trial;
        trial.subject = 3;
        trial.modality = Modality::kHF;
        trial.fixture_position_m = 0.12;
        return trial;
    }
    void run_for(Duration time) {
        const SessionTime end = session.loop().now() + time;
        while (session.loop().now() < end && session.step()) {
        }
    }
    Monitor monitor(const MonitorContext& context = {}) {
        return make_monitor(session.loop().now(), session.session(), context);
    }
    VirtualSession session;
};

TEST_F(MonitorFeedTest, BeforeAnyTrialNothingIsKnown) {
    const Monitor m = monitor({12, true});
    EXPECT_EQ(m.state, NodeState::kIdle);
    EXPECT_EQ(m.trials, 12U);
    EXPECT_TRUE(m.paused);
    EXPECT_FALSE(m.beeped);
    EXPECT_EQ(m.network_delay_s, 0.05);
    EXPECT_LT(m.one_way_s, 0);
    EXPECT_EQ(m.round_trip_s, 0);
}

TEST_F(MonitorFeedTest, ShowsTheNewestSampleAndWhatTheNodesSay) {
    session.start(trial());
    run_for(seconds{5});
    const Monitor m = monitor();
    const TrajectorySample& newest = session.session().record().samples.back();
    EXPECT_EQ(m.state, NodeState::kRunning);
    EXPECT_EQ(m.time_s, newest.time_s);
    EXPECT_EQ(m.position_needle_m, newest.position_needle_m);
    EXPECT_EQ(m.force_total_N, newest.force_total_N);
    EXPECT_EQ(m.position_fixture_m, 0.12);
    EXPECT_EQ(m.subject, 3U);
    EXPECT_GT(m.position_needle_m, 0);
    EXPECT_GT(m.accepted, 10'000U);
    EXPECT_EQ(m.refused, 0U);
    EXPECT_EQ(m.round_trip_s, 0.05);
    EXPECT_NEAR(m.one_way_s, 0.05, 1e-9);  // one clock, and no delay on the needle's way
    EXPECT_NEAR(m.one_way_bound_s, 0, 0.02);
}

TEST_F(MonitorFeedTest, HasTheHandlesForceAndEnergy) {
    session.start(trial());
    double greatest_N = 0, last_J = 0;
    while (session.step()) {
        const Monitor m = monitor();
        greatest_N = std::max(greatest_N, std::fabs(m.force_hand_N));
        last_J = m.energy_in_J;
    }
    EXPECT_GT(greatest_N, 0.5);
    EXPECT_NE(last_J, 0);
    EXPECT_EQ(monitor().reason, session.session().record().reason);
    EXPECT_EQ(monitor().state, NodeState::kIdle);
}

TEST_F(MonitorFeedTest, SendsNoMoreThan250PerSecondUnderTheTrialsNumber) {
    QueuePipe pipe;
    MonitorFeed feed(8, {&pipe.a}, session.session());
    session.start(trial());
    std::uint64_t heard = 0;
    InboundFlow view(Role::kSession);
    const SessionTime begin = session.loop().now();
    while (session.loop().now() < begin + seconds{4} && session.step()) {
        feed.tick(session.loop().now(), {});
        while (const Message* message = view.receive(session.loop().now(), pipe.b)) {
            ++heard;
            EXPECT_TRUE(std::holds_alternative<Monitor>(message->body));
            EXPECT_EQ(message->header.trial, session.session().number());
        }
    }
    EXPECT_LE(heard, 1001U);
    EXPECT_GT(heard, 900U);
    EXPECT_EQ(view.counters().refused_total(), 0U);
}

TEST_F(MonitorFeedTest, SaysAtOnceAndAgainThatADeviceHasEndedTheTrial) {
    QueuePipe pipe;
    MonitorFeed feed(8, {&pipe.a}, session.session());
    InboundFlow view(Role::kSession);
    const auto faults_at = [&](SessionTime now) {
        feed.tick(now, {});
        int faults = 0;
        while (const Message* message = view.receive(now, pipe.b))
            faults += std::holds_alternative<DeviceFault>(message->body) ? 1 : 0;
        return faults;
    };
    session.start(trial());
    run_for(seconds{1});
    const SessionTime now = session.loop().now();
    EXPECT_EQ(faults_at(now), 0);
    session.session().abort(EndReason::kDeviceFault, Role::kMaster);
    run_for(milliseconds{2});
    EXPECT_EQ(faults_at(now + milliseconds{2}), 1);
    EXPECT_EQ(faults_at(now + milliseconds{50}), 0);
    EXPECT_EQ(faults_at(now + milliseconds{102}), 1);
}

}  // namespace
}  // namespace thimble
