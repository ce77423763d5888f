// The session around a trial: time-outs, interruptions, a fixture that is taken away, nodes that do not
// answer.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/allocation_count.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

bool idle(const NodeProcess& node) { return node.state() == NodeState::kIdle; }

void expect_all_stopped(Rig& rig, EndReason reason) {
    for (const NodeProcess* node : rig.nodes()) {
        EXPECT_TRUE(idle(*node)) << to_string(node->role());
        EXPECT_EQ(node->reason(), reason) << to_string(node->role());
    }
    EXPECT_EQ(rig.handle().force_hand_N(), 0);
}

TEST(Session, ACompletedTrialLeavesEverybodyIdle) {
    Rig rig(paper());
    const TrialRecord& record = rig.run(trial_of(Modality::kHF));
    EXPECT_EQ(record.reason, EndReason::kCompleted);
    expect_all_stopped(rig, EndReason::kCompleted);
    // Recorded from the first answer on, one per millisecond, none twice and none left out.
    for (std::size_t i = 0; i < record.samples.size(); ++i)
        ASSERT_NEAR(record.samples[i].time_s, 1e-3 * static_cast<double>(i), 1e-9);
    EXPECT_EQ(rig.session().missing_peers(rig.now(), seconds{1}), "");
}

// The force is gone with the sample that could not be read; the session hears why and ends the trial for all.
TEST(Session, AFailedHandleEndsTheTrialInItsOwnWords) {
    Rig rig(paper());
    rig.start(trial_of(Modality::kHF));
    ASSERT_TRUE(
        rig.run_until_sample([](const TrajectorySample& sample) { return sample.force_fixture_N < -1; }));
    const double pressed_N = rig.handle().force_hand_N();
    EXPECT_GT(pressed_N, 1);
    const SessionTime broken = rig.now();
    rig.break_handle("the handle is unplugged; plug it in");
    rig.run_until(broken + milliseconds{2});
    EXPECT_EQ(rig.handle().force_hand_N(), 0);
    EXPECT_NE(rig.master().state(), NodeState::kRunning);
    const TrialRecord& record = rig.finish();
    EXPECT_LT(rig.now() - broken, milliseconds{200});
    EXPECT_EQ(record.reason, EndReason::kDeviceFault);
    EXPECT_EQ(record.lost_peer, Role::kMaster);
    EXPECT_EQ(record.fault, "the handle is unplugged; plug it in");
    EXPECT_FALSE(record.samples.empty());
    expect_all_stopped(rig, EndReason::kDeviceFault);
    // Another trial does not begin with it either.
    TrialConditions conditions = trial_of(Modality::kCF);
    conditions.trial = 2;
    const TrialRecord& next = rig.run(conditions);
    EXPECT_EQ(next.reason, EndReason::kDeviceFault)
        << to_string(next.lost_peer) << ' ' << to_seconds(rig.now() - broken);
    EXPECT_EQ(next.fault, "the handle is unplugged; plug it in");
    EXPECT_TRUE(next.samples.empty());
}

TEST(Session, AnInterruptEndsTheTrialAtOnce) {
    Rig rig(paper());
    rig.start(trial_of(Modality::kHF));
    ASSERT_TRUE(rig.run_until_contact(1));
    const SessionTime when = rig.now();
    rig.session().abort(EndReason::kInterrupted);
    const TrialRecord& record = rig.finish();
    EXPECT_EQ(record.reason, EndReason::kInterrupted);
    EXPECT_LT(rig.now() - when, milliseconds{200});
    expect_all_stopped(rig, EndReason::kInterrupted);
    rig.session().abort(EndReason::kInterrupted);  // harmless when none runs
    EXPECT_EQ(rig.run(trial_of(Modality::kVF, {}, 1, 2)).reason, EndReason::kCompleted);
}

TEST(Session, AShutdownReachesEveryNode) {
    Rig rig(paper());
    rig.run(trial_of(Modality::kHF));
    EXPECT_FALSE(rig.slave().stopped());
    rig.session().shut_down(rig.now());
    for (const NodeProcess* node : rig.nodes()) {
        const_cast<NodeProcess*>(node)->tick(rig.now());
        EXPECT_TRUE(node->stopped()) << to_string(node->role());
    }
}

TEST(Session, AMovedFixtureIsWhereItWasMoved) {
    Rig rig(paper());
    const TrialConditions trial = trial_of(Modality::kHF);
    rig.start(trial);
    ASSERT_TRUE(rig.run_until_contact(2));
    const double moved_m = trial.fixture_position_m - 0.002;
    rig.session().change_fixture(true, moved_m);
    ASSERT_TRUE(rig.run_until_sample([&](const TrajectorySample& s) {
        return s.force_fixture_N != 0 &&
               std::fabs(s.force_fixture_N + 3000 * (s.position_needle_m - moved_m)) < 1e-9;
    }));
}

// Experiment 2: the fixture vanishes with the beep. A hand that pushed against it falls through, a hand that stood still does not.
TrialRecord removal(Modality modality) {
    TrialConditions trial = trial_of(modality);
    trial.experiment = 2;
    trial.removes_fixture = true;
    return run_virtual_trial(paper(), trial);
}

TEST(FixtureRemoval, HappensWithTheBeepAndNotBefore) {
    const TrialRecord record = removal(Modality::kHF);
    EXPECT_EQ(record.reason, EndReason::kCompleted);
    ASSERT_TRUE(std::isfinite(record.beep_time_s));
    const auto gone = std::find_if(record.samples.begin(), record.samples.end(),
                                   [](const TrajectorySample& s) { return !s.fixture_present; });
    ASSERT_NE(gone, record.samples.end());
    EXPECT_GT(gone->time_s, record.beep_time_s);
    EXPECT_LT(gone->time_s, record.beep_time_s + 0.005);
    for (auto sample = gone; sample != record.samples.end(); ++sample) {
        EXPECT_FALSE(sample->fixture_present);
        EXPECT_EQ(sample->force_fixture_N, 0);
    }
}

TEST(FixtureRemoval, OnlyWhoPushedFallsThrough) {
    const double handle_m = measure(removal(Modality::kHF)).peak_displacement_m;
    EXPECT_GT(handle_m, 5e-3);
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        const double other_m = measure(removal(modality)).peak_displacement_m;
        EXPECT_LT(other_m, 1.5e-3) << to_string(modality);
        EXPECT_GT(handle_m, 5 * other_m) << to_string(modality);
    }
}

// Up to the beep the subject cannot know which trial it is.
TEST(FixtureRemoval, ChangesNothingBeforeTheBeep) {
    const TrialRecord with = removal(Modality::kCF);
    TrialConditions trial = with.conditions;
    trial.removes_fixture = false;
    const TrialRecord without = run_virtual_trial(paper(), trial);
    ASSERT_EQ(with.beep_time_s, without.beep_time_s);
    for (std::size_t i = 0; with.samples[i].time_s <= with.beep_time_s; ++i) {
        ASSERT_EQ(with.samples[i].position_needle_m, without.samples[i].position_needle_m);
        ASSERT_EQ(with.samples[i].force_total_N, without.samples[i].force_total_N);
    }
}

class SilentNode : public testing::TestWithParam<Role> {
  protected:
    // Cuts `which` control wires of the node from the start.
    MakeTap silence(bool orders, bool heartbeats) {
        return [orders, heartbeats, index = std::array<std::size_t, 2>{}](
                   Wire wire, Channel& end) mutable -> std::unique_ptr<Tap> {
            if (wire != Wire::kOrders && wire != Wire::kHeartbeats) return nullptr;
            const std::size_t i = index[wire == Wire::kOrders ? 0 : 1]++;
            const bool cut = kNodeRoles[i] == GetParam() && (wire == Wire::kOrders ? orders : heartbeats);
            return cut ? std::make_unique<Scissors>(end, kCut) : nullptr;
        };
    }

  private:
    static constexpr bool kCut = true;
};

TEST_P(SilentNode, ADeadNodeIsNamedWhenItDoesNotStart) {
    Rig rig(paper(), silence(true, true));
    const TrialRecord& record = rig.run(trial_of(Modality::kHF));
    EXPECT_EQ(record.reason, EndReason::kPeerLost);
    EXPECT_EQ(record.lost_peer, GetParam()) << to_string(record.lost_peer);
    EXPECT_EQ(rig.session().missing_peers(rig.now(), seconds{1}), to_string(GetParam()));
    EXPECT_LT(rig.now(), SessionTime{2 * paper().session.peer_wait + seconds{1}});
}

TEST_P(SilentNode, ANodeThatIsHeardButDoesNotObeyIsNamed) {
    Rig rig(paper(), silence(true, false));
    const TrialRecord& record = rig.run(trial_of(Modality::kHF));
    EXPECT_EQ(record.reason, EndReason::kPeerLost);
    EXPECT_EQ(record.lost_peer, GetParam()) << to_string(record.lost_peer);
}

INSTANTIATE_TEST_SUITE_P(Each, SilentNode, testing::ValuesIn(kNodeRoles),
                         [](const auto& test) { return std::string(to_string(test.param)); });

// Sessions whose fingers are pressed by twelve emulated drives on one bus.
// As the program does before it says that it is ready.
constexpr SessionTime kBroughtUp{std::chrono::seconds{3}};

SystemSettings with_drives() {
    SystemSettings settings = paper();
    settings.cutaneous.device = FingertipDevice::kDrives;
    settings.cutaneous.drives.bus = "can0";
    settings.session.contact_hold = settings.slave.contact_hold = std::chrono::milliseconds{500};
    return settings;
}

TEST(DrivenFingers, ATrialIsCompletedByWhatTheyFeel) {
    for (const Modality modality : {Modality::kCF, Modality::kCCF}) {
        Rig rig(with_drives());
        rig.run_until(kBroughtUp);
        const TrialRecord& record = rig.run(trial_of(modality));
        EXPECT_EQ(record.reason, EndReason::kCompleted) << record.fault;
        const std::size_t hand = modality == Modality::kCF ? 0 : 2;
        EXPECT_GT(rig.drives().strongest_N(), 0.3);
        for (std::size_t finger = 0; finger < 4; ++finger)
            EXPECT_LT(rig.drives().force_N(finger), 0.15) << "let go at the end: " << finger;
        EXPECT_EQ(rig.drives().drive(3 * hand).state(), DriveState::kOperationEnabled);
    }
}

void press_finger(Rig& rig) {
    rig.run_until(kBroughtUp);
    rig.start(trial_of(Modality::kCF));
    ASSERT_TRUE(rig.run_until_sample([&](const TrajectorySample&) { return rig.drives().force_N(0) > 0.3; }));
}

TEST(DrivenFingers, NothingIsAllocatedWhileTheyArePressed) {
    Rig rig(with_drives());
    press_finger(rig);
    const std::uint64_t before = allocation_count();
    EXPECT_EQ(rig.finish().reason, EndReason::kCompleted);
    EXPECT_EQ(allocation_count() - before, 0U);
}

TEST(DrivenFingers, AFaultInATrialEndsItWithItsWords) {
    Rig rig(with_drives());
    press_finger(rig);
    rig.order_drives("emcy 2 0x2310");
    const SessionTime since = rig.now();
    const TrialRecord& record = rig.finish();
    EXPECT_EQ(record.reason, EndReason::kDeviceFault);
    EXPECT_EQ(record.lost_peer, Role::kCutaneous);
    EXPECT_FALSE(record.samples.empty());
    EXPECT_THAT(record.fault,
                testing::HasSubstr("drive 2 (acting hand, index, cable 1): EMCY 0x2310 (over-current)"));
    // The trial was given up in the tick in which the bus said it, and the session heard of it in the same instant.
    EXPECT_LT(rig.now() - since, std::chrono::milliseconds{100});
    EXPECT_EQ(rig.drives().drive(0).state(), DriveState::kSwitchOnDisabled);
    EXPECT_EQ(rig.run(trial_of(Modality::kCCF, {}, 1, 2)).reason, EndReason::kDeviceFault)
        << "no trial that needs a device that has failed";
    EXPECT_EQ(rig.run(trial_of(Modality::kVF, {}, 1, 3)).reason, EndReason::kCompleted)
        << "the others do without";
}

}  // namespace
}  // namespace thimble::test
