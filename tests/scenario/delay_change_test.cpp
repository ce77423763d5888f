// The delay changes while a trial runs: nobody is lost, forces get older and younger, and the record says when.
#include <gtest/gtest.h>

#include "experiment/virtual_session.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kLong = milliseconds{500};

class LiveDelay : public testing::Test {
  protected:
    LiveDelay() : rig(settings()) {
        rig.start(trial_of(Modality::kVF));
        rig.run_until(SessionTime{seconds{2}});
    }
    static SystemSettings settings() {
        SystemSettings s = paper();
        s.slave.contact_hold = s.session.contact_hold = seconds{40};  // no end before the test's
        return s;
    }
    void run_for(Duration time) { rig.run_until(rig.now() + time); }
    double round_trip_s() { return rig.session().heartbeat_of(Role::kMaster).round_trip_median_s; }

    Rig rig;
};

TEST_F(LiveDelay, NobodyIsLostAndRoundTripsFollow) {
    EXPECT_EQ(round_trip_s(), 0);
    rig.session().change_delay(kLong);
    run_for(seconds{3});
    ASSERT_TRUE(rig.session().running());
    EXPECT_EQ(round_trip_s(), 0.5);
    rig.session().change_delay(Duration{0});
    run_for(seconds{3});
    ASSERT_TRUE(rig.session().running());
    EXPECT_EQ(round_trip_s(), 0);
}

TEST_F(LiveDelay, ToTheLongestThatTheSliderHasInOneStepAndBackManyTimes) {
    for (int i = 0; i < 6; ++i) {
        rig.session().change_delay(i % 2 == 0 ? kLong : Duration{0});
        run_for(milliseconds{700});
        ASSERT_TRUE(rig.session().running()) << i;
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
    ASSERT_EQ(record.delay_changes.size(), 2U);
    EXPECT_EQ(record.delay_changes[0].delay_s, 0.5);
    EXPECT_EQ(record.delay_changes[1].delay_s, 0.05);
    EXPECT_NEAR(record.delay_changes[1].time_s - record.delay_changes[0].time_s, 2, 0.01);
    EXPECT_EQ(record.conditions.delay_s, 0);
}

TEST(DelayChangeBetweenTrials, TheNextTrialHasItFromItsStart) {
    SystemSettings settings = paper();
    settings.slave.contact_hold = settings.session.contact_hold = milliseconds{200};
    VirtualSession session(settings);
    TrialConditions trial = trial_of(Modality::kVF);
    EXPECT_EQ(session.run(trial).round_trip_s, 0);
    session.session().change_delay(kLong);
    trial.trial = 2;
    const TrialRecord& record = session.run(trial);
    EXPECT_EQ(record.reason, EndReason::kCompleted);
    EXPECT_EQ(record.round_trip_s, 0.5);
    EXPECT_TRUE(record.delay_changes.empty());  // it did not change while it ran
}

TEST(DelayChangeWithFault, WhoFallsSilentForGoodIsMissedAfterTheExcuse) {
    class Cut final : public Tap {
      public:
        Cut(Channel& inner, const bool& cut) : Tap(inner), cut_(&cut) {}
        void send(Bytes datagram) override {
            if (!*cut_) Tap::send(datagram);
        }

      private:
        const bool* cut_;
    };
    bool cut = false;
    Rig rig(paper(), [&cut](Wire wire, Channel& inner) -> std::unique_ptr<Tap> {
        if (wire != Wire::kForceMaster) return nullptr;
        return std::make_unique<Cut>(inner, cut);
    });
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
