// The state for a view, from a whole session in virtual time.
#include "session/play/monitor_feed.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "session/play/recorded_trial.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/unit/session/records.hpp"

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
        return {.subject = 3, .modality = Modality::kHF, .fixture_position_m = 0.12};
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

// Finding a trial in a folder, and what was seen when.
TrialRecord short_record() {
    TrialRecord record;
    record.conditions = {.trial = 2, .modality = Modality::kVF, .delay_s = 0.05, .fixture_position_m = 0.02};
    record.reason = EndReason::kCompleted;
    for (int i = 0; i < 1000; ++i) {
        record.samples.push_back({.time_s = 0.001 * i,
                                  .position_needle_m = 0.00005 * i,
                                  .contact_time_s = i > 500 ? 0.001 * (i - 500) : 0});
    }
    record.beep_time_s = 0.7;
    return record;
}

void keep(const TrialRecord& record, const std::filesystem::path& folder, const std::string& name) {
    TrialTable table(folder / "trials.csv", IfExists::kReplace);
    table.append(make_row(record));
    std::filesystem::create_directories(folder / "trajectories");
    TrajectoryWriter writer(folder / "trajectories" / name);
    writer.append(record.samples);
    writer.end(record.reason);
}

TEST(RecordedTrial, IsFoundByTheNamesOfRunsAndOfStudies) {
    for (const char* name : {"trial02_VF_50ms.csv", "experiment3_subject01_trial02_VF_50ms.csv"}) {
        const TemporaryDirectory directory;
        keep(short_record(), directory.path(), name);
        const RecordedTrial trial = find_recorded_trial(directory.path(), 1, 0.2);
        EXPECT_EQ(trial.record.samples.size(), 1000U);
        EXPECT_EQ(trial.record.conditions.modality, Modality::kVF);
        EXPECT_EQ(trial.record.conditions.fixture_position_m, 0.02);
        EXPECT_NEAR(trial.record.beep_time_s, 0.7, 1e-9);
        EXPECT_EQ(trial.duration_s(), 0.999);
    }
}

TEST(RecordedTrial, KnowsWhatWasThereWhenAndHowLate) {
    const TemporaryDirectory directory;
    keep(short_record(), directory.path(), "trial02_VF_50ms.csv");
    write_events(directory / "trajectories/trial02_VF_50ms.events.csv", {{0.3, 0.5}, {0.6, 0}});
    const RecordedTrial trial = find_recorded_trial(directory.path(), 1, 0.2);
    EXPECT_EQ(trial.delay_s(0.1), 0.05);
    EXPECT_EQ(trial.delay_s(0.3), 0.5);
    EXPECT_EQ(trial.delay_s(0.9), 0);
    EXPECT_EQ(trial.at(0.4005).time_s, 0.4);
    EXPECT_EQ(trial.at(-1).time_s, 0);
    EXPECT_EQ(trial.at(5).time_s, 0.999);
}

TEST(RecordedTrial, SaysWhatIsMissing) {
    const TemporaryDirectory directory;
    EXPECT_THROW(find_recorded_trial(directory.path(), 1, 5), Error);
    keep(short_record(), directory.path(), "trial02_VF_50ms.csv");
    EXPECT_THROW(find_recorded_trial(directory.path(), 0, 5), Error);
    EXPECT_THROW(find_recorded_trial(directory.path(), 2, 5), Error);
    std::filesystem::remove(directory / "trajectories/trial02_VF_50ms.csv");
    EXPECT_THAT(refusal([&] { find_recorded_trial(directory.path(), 1, 5); }, ExitCode::kUsage),
                testing::HasSubstr("--trajectories"));
}

}  // namespace
}  // namespace thimble
