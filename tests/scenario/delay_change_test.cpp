// The delay changes while a trial runs: no peer is lost, forces get older and younger, and the record says when.
#include <memory>

#include <gtest/gtest.h>

#include "session/virtual/virtual_session.hpp"
#include "study/with_compensator.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kLong = milliseconds{500};

SystemSettings held_for(Duration hold, Duration force_delay = {}) {
    SystemSettings settings = paper_with_delays({}, force_delay);
    settings.slave.contact_hold = settings.session.contact_hold = hold;
    return settings;
}

class LiveDelay : public testing::Test {
  protected:
    LiveDelay() : rig(held_for(seconds{40})) {  // no end before the test's
        rig.start(trial_of(Modality::kVF));
        rig.run_until(SessionTime{seconds{2}});
    }
    void run_for(Duration time) { rig.run_until(rig.now() + time); }
    double round_trip_s() { return rig.session().peer(Role::kMaster).newest().round_trip_median_s; }

    Rig rig;
};

TEST_F(LiveDelay, ToTheLongestThatTheSliderHasInOneStepAndBackManyTimes) {
    for (int i = 0; i < 6; ++i) {
        rig.session().change_delay(i % 2 == 0 ? kLong : Duration{0});
        run_for(milliseconds{700});
        ASSERT_TRUE(rig.session().running()) << i;
    }
    for (const Duration delay : {kLong, Duration{0}}) {
        rig.session().change_delay(delay);
        run_for(seconds{3});
        EXPECT_EQ(round_trip_s(), to_seconds(delay));
    }
    for (int i = 0; i < 100; ++i) {  // a slider that is dragged
        rig.session().change_delay(milliseconds{5 * i});
        run_for(milliseconds{10});
    }
    run_for(seconds{2});
    ASSERT_TRUE(rig.session().running());
    EXPECT_EQ(round_trip_s(), 0.495);
}

TEST_F(LiveDelay, WhatIsInFlightKeepsItsFateAndItsOrder) {
    rig.session().change_delay(milliseconds{100});
    run_for(seconds{1});
    const std::uint64_t pushed = rig.netem().relays()[1].model.counters().pushed;
    EXPECT_EQ(rig.netem().relays()[1].model.in_flight(), 100U);
    rig.session().change_delay(Duration{0});
    run_for(seconds{1});
    for (const Relay& relay : rig.netem().relays()) EXPECT_EQ(relay.model.counters().reordered, 0U);
    EXPECT_GT(rig.netem().relays()[1].model.counters().delivered, pushed);
    EXPECT_EQ(rig.netem().relays()[0].model.delays().max, Duration{0});  // the needle's way is as it was
}

TEST_F(LiveDelay, ASilenceIsExcusedForAsLongAsTheNewDelay) {
    rig.session().change_delay(seconds{30});
    run_for(seconds{31});
    EXPECT_TRUE(rig.session().running());
    run_for(seconds{3});
    EXPECT_TRUE(rig.session().running());  // what left 30 s ago arrives
    EXPECT_EQ(round_trip_s(), 30);
    EXPECT_EQ(rig.netem().relays()[1].model.counters().overflowed, 0U);  // 30,000 were on their way
}

TEST_F(LiveDelay, TheRecordSaysWhen) {
    rig.session().change_delay(kLong);
    run_for(seconds{1});
    rig.session().change_delay(kLong);  // no change
    run_for(seconds{1});
    rig.session().change_delay(milliseconds{50});
    run_for(seconds{1});
    rig.session().abort(EndReason::kInterrupted);
    const TrialRecord& record = rig.finish();
    ASSERT_EQ(record.network_events.size(), 2U);
    EXPECT_EQ(record.network_events[0].delay_s, 0.5);
    EXPECT_EQ(record.network_events[1].delay_s, 0.05);
    EXPECT_NEAR(record.network_events[1].time_s - record.network_events[0].time_s, 2, 0.01);
    EXPECT_EQ(record.conditions.delay_s, 0);
}

// Every sample that was recorded and every packet's fate, while the network becomes wifi, lte, geo and none in one trial.
struct Visited {
    TrialRecord record;
    std::vector<std::uint64_t> fates;
    std::vector<double> delays_s;
    std::uint64_t lost = 0, reordered = 0;
};

Visited visit_networks() {
    Rig rig(held_for(seconds{40}));
    rig.start(trial_of(Modality::kVF));
    Visited visited;
    for (const char* name : {"", "wifi", "lte", "geo", "ideal"}) {
        const bool changes = *name != 0;
        EXPECT_EQ(rig.session().change_network(*NetworkName::of(name)), changes) << name;
        rig.run_until(rig.now() + seconds{2});
        EXPECT_TRUE(rig.session().running()) << name;
        visited.delays_s.push_back(rig.session().delay_s());
    }
    for (const Relay& relay : rig.netem().relays()) {
        const LinkCounters& counters = relay.model.counters();
        visited.fates.insert(visited.fates.end(), {counters.pushed, counters.delivered, counters.lost});
        visited.lost += counters.lost;
        visited.reordered += counters.reordered;
    }
    rig.session().abort(EndReason::kInterrupted);
    visited.record = rig.finish();
    return visited;
}

TEST(NetworkChange, LosesNobodyIsRecordedAndHasTheSameBitsTwice) {
    const Visited visited = visit_networks(), again = visit_networks();
    EXPECT_EQ(visited.fates, again.fates);
    EXPECT_TRUE(same_samples(visited.record, again.record));
    EXPECT_EQ(visited.delays_s.back(), 0);
    EXPECT_GT(visited.lost, 10U);  // geo loses 0.5 %, in bursts of ten
    EXPECT_EQ(visited.reordered, 0U);
    const std::vector<NetworkEvent>& events = visited.record.network_events;
    ASSERT_EQ(events.size(), 4U);
    EXPECT_EQ(events[0].profile, "wifi");
    EXPECT_EQ(events[2].profile, "geo");
    EXPECT_EQ(events[2].delay_s, 0.3);
    EXPECT_EQ(events[2].force.jitter_spread_s, 0.005);
    EXPECT_NEAR(events[2].needle.loss, 0.005, 1e-12);
    // The recorder hears of needle commands, which geo's way up makes 0.3 s late: the clock of a record stands still so long.
    EXPECT_NEAR(events[2].time_s - events[1].time_s, 2, 0.1);
}

TEST_F(LiveDelay, ANetworkKeepsItsJitterAndLossUnderAnotherDelay) {
    ASSERT_TRUE(rig.session().change_network(*NetworkName::of("lte")));
    run_for(seconds{1});
    rig.session().change_delay(milliseconds{100});
    run_for(seconds{1});
    ASSERT_TRUE(rig.session().running());
    const LinkSettings& force = rig.netem().relays()[1].model.settings();
    EXPECT_EQ(force.delay, milliseconds{100});
    EXPECT_EQ(force.jitter.shape, JitterShape::kParetoNormal);
    EXPECT_EQ(rig.netem().relays()[0].model.settings().delay, milliseconds{35});  // the needle's way is lte's
    EXPECT_TRUE(rig.session().change_network(*NetworkName::of("lte")));           // back to its own delay
    run_for(seconds{1});
    EXPECT_EQ(force.delay, milliseconds{35});
}

TEST_F(LiveDelay, AnUnknownNetworkIsRefusedAndNothingChanges) {
    for (const char* name : {"lte-9", "", "out"})
        EXPECT_FALSE(rig.session().change_network(*NetworkName::of(name)));
    run_for(seconds{1});
    EXPECT_EQ(round_trip_s(), 0);
    EXPECT_TRUE(rig.session().network().empty());
    rig.session().abort(EndReason::kInterrupted);
    EXPECT_TRUE(rig.finish().network_events.empty());
}

// A person leans on the fixture by waves while the network changes; the force at the handle, once all have settled.
class WavesInATrial : public testing::Test {
  protected:
    static SystemSettings with_waves(Duration force_delay) {
        const SystemSettings s = held_for(seconds{100}, force_delay);
        return with_control(s, control_for(s, Compensator::kWave));
    }
    void begin(Duration force_delay) {
        rig = std::make_unique<Rig>(with_waves(force_delay));
        rig->start(trial_of(Modality::kHF));
        ASSERT_TRUE(rig->run_until_contact(2));
    }
    // The mean over a second, after three.
    double settled_N() {
        rig->run_until(rig->now() + seconds{3});
        const SessionTime end = rig->now() + seconds{1};
        double sum_N = 0;
        int samples = 0;
        for (; rig->now() < end && rig->step(); ++samples) sum_N += rig->force_at_handle_N();
        EXPECT_TRUE(rig->session().running()) << to_string(rig->session().record().reason);
        return sum_N / samples;
    }
    std::unique_ptr<Rig> rig;
};

TEST_F(WavesInATrial, KeepTheWallUnderANetworkWithTwoSlowWaysAndJitter) {
    for (const char* name : {"lte", "geo"}) {
        begin({});
        const double before_N = settled_N();
        EXPECT_GT(before_N, 0.5);
        ASSERT_TRUE(rig->session().change_network(*NetworkName::of(name)));
        EXPECT_GT(settled_N(), 0.3) << name;
        ASSERT_TRUE(rig->session().change_network(*NetworkName::of("ideal")));
        EXPECT_GT(settled_N(), 0.5) << "after " << name;
    }
}

TEST_F(WavesInATrial, AChangeThereAndBackLeavesTheForceAsItWas) {
    begin(milliseconds{50});
    const double before_N = settled_N();
    rig->session().change_delay(milliseconds{60});
    rig->run_until(rig->now() + seconds{1});
    rig->session().change_delay(milliseconds{50});
    EXPECT_NEAR(settled_N(), before_N, 0.1 * before_N);
}

TEST(DelayChangeBetweenTrials, TheNextTrialHasItFromItsStartAndANetworkIsRecorded) {
    for (const bool by_name : {false, true}) {
        VirtualSession session(held_for(milliseconds{200}));
        TrialConditions trial = trial_of(Modality::kVF);
        EXPECT_EQ(session.run(trial).round_trip_s, 0);
        if (!by_name) session.session().change_delay(kLong);
        if (by_name) {
            EXPECT_TRUE(session.session().change_network(*NetworkName::of("lte")));
        }
        trial.trial = 2;
        const TrialRecord& record = session.run(trial);
        EXPECT_EQ(record.reason, EndReason::kCompleted);
        EXPECT_TRUE(by_name ? record.round_trip_s > 0.05 : record.round_trip_s == 0.5);
        ASSERT_EQ(record.network_events.size(), by_name ? 1U : 0U);  // a delay did not change while it ran
        if (!by_name) continue;
        EXPECT_EQ(record.network_events[0].time_s, 0);
        EXPECT_EQ(record.network_events[0].profile, "lte");
    }
}

TEST(DelayChangeWithFault, WhoFallsSilentForGoodIsMissedAfterTheExcuse) {
    bool cut = false;
    Rig rig(paper(), tap_on<Scissors>({Wire::kForceMaster}, cut));
    rig.start(trial_of(Modality::kVF));
    rig.run_until(SessionTime{seconds{2}});
    rig.session().change_delay(kLong);
    cut = true;
    rig.run_until(SessionTime{milliseconds{2900}});
    EXPECT_TRUE(rig.session().running());  // 0.9 s of silence are within 0.5 s of delay and 0.5 s of patience
    const TrialRecord& record = rig.finish();
    EXPECT_EQ(record.reason, EndReason::kPeerLost);
    EXPECT_LT(rig.now(), SessionTime{seconds{4}});
}

}  // namespace
}  // namespace thimble::test
