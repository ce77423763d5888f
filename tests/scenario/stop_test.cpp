// Emergency stop and guard in a whole session: from every program, within two samples, and nothing begins before the release.
#include <algorithm>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "session/virtual/energy_demand.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

void press_until_contact(Rig& rig, Modality modality) {
    rig.start(trial_of(modality));
    ASSERT_TRUE(rig.run_until_contact(0.5));
}

TEST(EmergencyStop, CablesGoSlack) {
    Rig rig(paper());
    press_until_contact(rig, Modality::kCF);
    ASSERT_GT(rig.force_at_finger_N(), 0.3);
    rig.session().emergency_stop(rig.now(), "a test");
    rig.run_until(rig.now() + milliseconds{2});
    EXPECT_EQ(rig.force_at_finger_N(), 0);
    EXPECT_EQ(rig.finish().reason, EndReason::kEmergencyStop);
}

// The session that tools run, not only the rig: a stop in mid-trial, pressed at each program, open and under a lab key.
class VirtualStop : public testing::TestWithParam<Role> {
  protected:
    static void press_in_contact(VirtualSession& session, Role at) {
        session.start(trial_of(Modality::kHF));
        while (session.handle().force_hand_N() <= 0.5) ASSERT_TRUE(session.step());
        session.emergency_stop(at, "a test");
        const std::size_t samples = session.session().record().samples.size();
        run_until(session, session.loop().now() + milliseconds{3});
        EXPECT_EQ(session.handle().force_hand_N(), 0);
        EXPECT_LE(session.session().record().samples.size(), samples + 1) << "the needle is held";
        for (const Role role : kNodeRoles) {
            EXPECT_NE(session.node(role).state(), NodeState::kRunning) << to_string(role);
            EXPECT_TRUE(session.node(role).stop_bus().stopped()) << to_string(role);
        }
        while (session.step()) {
        }
        EXPECT_EQ(session.session().record().reason, EndReason::kEmergencyStop);
        EXPECT_EQ(session.session().record().fault, "a test");
        EXPECT_EQ(session.session().record().lost_peer, at);
    }
};

TEST_P(VirtualStop, HoldsUntilItIsReleased) {
    for (const auto& key : {std::shared_ptr<const LabKey>{}, lab_key_of(7)}) {
        SCOPED_TRACE(key ? "under a lab key" : "open");
        VirtualSession session(paper(), key);
        press_in_contact(session, GetParam());
        session.idle(kHeldAtLeast);
        TrialConditions conditions = trial_of(Modality::kHF);
        conditions.trial = 2;
        EXPECT_EQ(session.run(conditions).reason, EndReason::kEmergencyStop);
        EXPECT_TRUE(session.session().record().samples.empty());
        session.release_stop();
        session.idle(milliseconds{10});
        for (const Role role : kNodeRoles)
            EXPECT_FALSE(session.node(role).stop_bus().stopped()) << to_string(role);
        conditions.trial = 3;
        EXPECT_EQ(session.run(conditions).reason, EndReason::kCompleted);
    }
}

INSTANTIATE_TEST_SUITE_P(Emergency, VirtualStop,
                         testing::Values(Role::kSession, Role::kMaster, Role::kSlaveSim, Role::kCutaneous,
                                         Role::kVisual, Role::kNetem),
                         [](const auto& test) { return std::string(to_string(test.param)); });

// A handle that gives out energy: HF with 50 ms oscillates, which the guard ends where it is asked to.
TEST(Guard, ATripEndsTheTrialInItsOwnWordsAndHolds) {
    SystemSettings settings = paper_with_delays({}, kPaperDelay);
    settings.master.guard.energy_limit_J = 0.02;
    Rig rig(settings);
    TrialConditions conditions = trial_of(Modality::kHF, kPaperDelay);
    const TrialRecord& record = rig.run(conditions);
    EXPECT_EQ(record.reason, EndReason::kSafetyStop);
    EXPECT_EQ(record.lost_peer, Role::kMaster);
    EXPECT_NE(record.fault.find("energy_limit_J"), std::string::npos) << record.fault;
    EXPECT_EQ(rig.handle().force_hand_N(), 0);
    conditions.trial = 2;
    EXPECT_EQ(rig.run(conditions).reason, EndReason::kSafetyStop) << "latched";
    // Without delay the same limit is never reached.
    settings = paper();
    settings.master.guard.energy_limit_J = 0.02;
    Rig calm(settings);
    EXPECT_EQ(calm.run(trial_of(Modality::kHF)).reason, EndReason::kCompleted);
    EXPECT_LT(calm.master().guard().most_given_out_J(), 0.02);
}

// A hand in the experiment reaches neither limit before the handle oscillates.
TEST(Guard, TheLimitsOfARealHandleStopAnOscillationAndCutNothingElse) {
    for (const int delay_ms : {0, 10, 50}) {
        SystemSettings settings = paper_with_delays({}, milliseconds{delay_ms});
        settings.master.guard = guard_of_real_handle();
        Rig rig(settings);
        const TrialRecord& record = rig.run(trial_of(Modality::kHF, milliseconds{delay_ms}));
        const bool oscillates = delay_ms == 50;
        EXPECT_EQ(record.reason, oscillates ? EndReason::kSafetyStop : EndReason::kCompleted) << delay_ms;
        EXPECT_EQ(rig.master().guard().cut(), 0U) << delay_ms;
        EXPECT_TRUE(oscillates || rig.master().guard().most_given_out_J() < 0.001) << delay_ms;
    }
}

// The warning before a run: of a real handle, HF and an oscillation only. The value that it names is enough.
TEST(Guard, AWarningNamesTheEnergyLimitThatAnOscillationNeeds) {
    SystemSettings settings = paper();
    EXPECT_EQ(energy_warning(settings, {milliseconds{50}}), "") << "a simulated handle";
    settings.handle.kind = HandleKind::kFalcon;
    settings.master.guard = guard_of_real_handle();
    EXPECT_EQ(energy_warning(settings, {milliseconds{0}, milliseconds{10}}), "");
    settings.plan.delays = {milliseconds{0}, milliseconds{50}};
    const std::string warning = energy_warning(settings);
    EXPECT_NE(warning.find("a delay of 50 ms"), std::string::npos) << warning;
    EXPECT_NE(warning.find("energy_limit_J is 0.5: the guard will end"), std::string::npos) << warning;
    const std::string_view wanted = "write energy_limit_J = ";
    ASSERT_NE(warning.find(wanted), std::string::npos) << warning;
    settings.master.guard.energy_limit_J = std::stod(warning.substr(warning.find(wanted) + wanted.size()));
    EXPECT_GT(settings.master.guard.energy_limit_J, 1);
    EXPECT_LT(settings.master.guard.energy_limit_J, 4);
    EXPECT_EQ(energy_warning(settings), "");
    settings.master.guard = guard_of_real_handle();
    settings.plan.modalities = {Modality::kCF, Modality::kVF};
    EXPECT_EQ(energy_warning(settings), "") << "without HF";
    settings.plan.modalities = {Modality::kHF};
    settings.master.guard.energy_limit_J = 0;
    EXPECT_EQ(energy_warning(settings), "") << "switched off on purpose";
}

// 90 ms of forces are lost while the needle goes into the fixture.
TEST(Guard, NoSilenceSavesUpAJumpOfTheForce) {
    SystemSettings settings = paper();
    settings.master.guard.force_rate_limit_N_per_s = 10;  // 0.01 N in a sample
    bool cut = false;
    Rig rig(settings, tap_on<Scissors>({Wire::kForceMaster}, cut));
    rig.start(trial_of(Modality::kHF));
    ASSERT_TRUE(rig.run_until_sample([](const TrajectorySample& s) { return s.force_fixture_N < 0; }));
    const SessionTime begun = rig.now();
    double before_N = rig.force_at_handle_N();
    while (rig.now() < begun + milliseconds{300}) {
        cut = rig.now() < begun + milliseconds{90};
        ASSERT_TRUE(rig.step());
        const double force_N = rig.force_at_handle_N();
        ASSERT_LE(std::abs(force_N), std::abs(before_N) + 0.01 + 1e-12);
        before_N = force_N;
    }
    EXPECT_GT(rig.master().guard().cut(), 0U);
}

TEST(StaleInput, TheHandleFollowsThePolicy) {
    for (const StaleMode mode : {StaleMode::kHold, StaleMode::kRamp, StaleMode::kZero}) {
        SCOPED_TRACE(to_string(mode));
        SystemSettings settings = paper();
        settings.master.stale.mode = mode;
        Rig rig(settings);
        press_until_contact(rig, Modality::kHF);
        rig.freeze(Role::kNetem);
        const SessionTime cut = rig.now();
        rig.run_until(cut + milliseconds{99});
        const double held_N = rig.force_at_handle_N();
        EXPECT_GT(held_N, 0.5);
        rig.run_until(cut + milliseconds{111});
        const double fallen_N = rig.force_at_handle_N();
        if (mode == StaleMode::kHold) {
            EXPECT_EQ(fallen_N, held_N);
        } else if (mode == StaleMode::kRamp) {
            EXPECT_NEAR(fallen_N / held_N, 0.5, 0.15);
        } else {
            EXPECT_EQ(fallen_N, 0);
        }
        rig.run_until(cut + milliseconds{125});
        EXPECT_EQ(rig.force_at_handle_N(), mode == StaleMode::kHold ? held_N : 0);
        rig.finish();
        EXPECT_EQ(rig.force_at_handle_N(), 0) << "the trial is over";
        // Each output without input reports for how long: to the trial's end, 500 ms after the last heartbeat or input.
        ASSERT_EQ(rig.master().stale_record().trials(), 1U);
        const StaleRecord::Trial acted = rig.master().stale_record().known().front();
        EXPECT_EQ(acted.trial, 1U);
        EXPECT_EQ(acted.times, 1U);
        EXPECT_GT(acted.acted, milliseconds{250});
        EXPECT_LE(acted.acted, milliseconds{401});
        EXPECT_EQ(acted.longest, acted.acted);
        EXPECT_EQ(rig.visual().stale_record().trials(), 1U);
        EXPECT_EQ(rig.slave().stale_record().trials(), 1U);
        EXPECT_EQ(rig.cutaneous().stale_record().trials(), 0U) << "presses nobody in HF";
    }
}

// SIGSTOP and SIGCONT: what waited meanwhile looks new and is not.
TEST(StaleInput, AMasterThatStoodStillTakesNoOldForce) {
    Rig rig(paper_with_delays({}, milliseconds{5}));  // so that no new force comes in the same instant
    rig.start(trial_of(Modality::kHF));
    ASSERT_TRUE(rig.run_until_sample([](const TrajectorySample& s) { return s.force_fixture_N < -1; }));
    rig.run_until(rig.now() + milliseconds{10});
    ASSERT_GT(rig.force_at_handle_N(), 0.5);
    rig.freeze(Role::kMaster);
    rig.run_until(rig.now() + milliseconds{300});
    rig.thaw(Role::kMaster);
    rig.take_largest_at_handle_N();
    rig.step();
    EXPECT_EQ(rig.force_at_handle_N(), 0);
    EXPECT_EQ(rig.take_largest_at_handle_N(), 0) << "not for an instant either: a device obeys each command";
    EXPECT_NE(rig.finish().reason, EndReason::kNone);
}

// From `since` on each datagram takes as long as that is ago: half of them come, each older than the one before. Never silent.
class StretchingTap final : public Tap {
  public:
    StretchingTap(Channel& end, const SessionTime& since) : Tap(end), since_(&since) {}
    void send(Bytes datagram) override {
        const SessionTime now = decode(datagram).message->header.send_time;
        waiting_.push_back(
            {now + std::max(Duration::zero(), now - *since_), {datagram.begin(), datagram.end()}});
        for (; !waiting_.empty() && waiting_.front().due <= now; waiting_.pop_front())
            Tap::send(waiting_.front().bytes);
    }

  private:
    struct Waiting {
        SessionTime due;
        std::vector<std::uint8_t> bytes;
    };
    const SessionTime* since_;
    std::deque<Waiting> waiting_;
};

// Forces of 100 ms and older count as none, however regularly they come.
TEST(StaleInput, ADelayThatGrowsTakesTheForceOffTheHandleAndTheFinger) {
    for (const Modality modality : {Modality::kHF, Modality::kCF}) {
        SCOPED_TRACE(to_string(modality));
        SessionTime since = kNever;
        Rig rig(paper(), tap_on<StretchingTap>({Wire::kForceMaster, Wire::kForceCutaneous}, since));
        press_until_contact(rig, modality);
        const auto felt_N = [&] {
            return modality == Modality::kHF ? rig.force_at_handle_N() : rig.force_at_finger_N();
        };
        since = rig.now();
        rig.run_until(since + milliseconds{180});
        EXPECT_GT(felt_N(), 0.3) << "90 ms old: still as good as news";
        rig.run_until(since + milliseconds{300});
        EXPECT_EQ(felt_N(), 0);
        rig.take_largest_at_handle_N();
        rig.run_until(since + milliseconds{1000});
        EXPECT_EQ(felt_N(), 0);
        EXPECT_EQ(rig.take_largest_at_handle_N(), 0);
        const auto& record =
            modality == Modality::kHF ? rig.master().stale_record() : rig.cutaneous().stale_record();
        EXPECT_EQ(record.trials(), 1U) << "and the report says so";
    }
}

// The same delay where the session was told of it is no reason to let go.
TEST(StaleInput, ADelayThatTheSessionKnowsOfMakesNoForceStale) {
    Rig rig(paper_with_delays({}, milliseconds{300}));
    rig.run(trial_of(Modality::kHF, milliseconds{300}));
    EXPECT_GT(rig.take_largest_at_handle_N(), 0.5);
    EXPECT_EQ(rig.master().stale_record().trials(), 0U);
}

}  // namespace
}  // namespace thimble::test
