// Handle, needle, fixture and back: how old the force at the handle is, and what more age costs (the budget
// of the haptic loop, docs/model.md).
#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

TEST(HapticLoop, WithoutDelayTheForceBelongsToTheSampleItAnswers) {
    Rig rig(paper());
    const TrialRecord& record = rig.run(trial_of(Modality::kHF));
    ASSERT_EQ(record.reason, EndReason::kCompleted);
    EXPECT_EQ(rig.master().round_trip().age().worst(), Duration{0});
    // The last sample is answered after the end.
    EXPECT_EQ(rig.master().round_trip().age().count(), rig.master().samples() - 1);
    EXPECT_EQ(record.round_trip_s, 0);
    EXPECT_EQ(rig.master().samples_skipped(), 0U);
    EXPECT_EQ(record.samples.size(), rig.master().samples());
}

TEST(HapticLoop, TheRoundTripIsTheDelayAndNothingElse) {
    for (const Duration needle : {milliseconds{0}, milliseconds{20}, milliseconds{50}}) {
        Rig rig(paper_with_delays(needle, kPaperDelay - needle));
        const TrialRecord& record = rig.run(trial_of(Modality::kCF));
        const Histogram& age = rig.master().round_trip().age();
        EXPECT_EQ(age.best(), kPaperDelay);
        EXPECT_EQ(age.worst(), kPaperDelay);
        EXPECT_EQ(record.round_trip_s, 0.05);
        EXPECT_EQ(record.achieved_delay_s, 0.05);
    }
}

TEST(HapticLoop, EverySubjectHoldsTheFixtureByHandWithoutDelay) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        for (std::uint32_t subject = 1; subject <= 10; ++subject) {
            TrialConditions trial = trial_of(Modality::kHF, {}, subject);
            trial.study_seed = seed;
            const TrialRecord record = run_virtual_trial(paper(), trial);
            const TrialMetrics metrics = measure(record);
            EXPECT_EQ(record.reason, EndReason::kCompleted) << seed << ' ' << subject;
            EXPECT_EQ(metrics.contacts_lost, 0U) << "seed " << seed << ", subject " << subject;
            EXPECT_FALSE(metrics.oscillates);
        }
    }
}

struct Held {
    int lost_contact = 0, oscillated = 0;
    std::uint32_t losses = 0;
};

constexpr std::uint32_t kSubjects = 5;

// HF with an extra age of `more`, put on the needle's way as a computation that takes a while would.
Held hold_with(Duration more, double friction_N) {
    SystemSettings settings = paper_with_delays(more, {});
    settings.handle.mechanics.friction_N = friction_N;
    Held held;
    for (std::uint32_t subject = 1; subject <= kSubjects; ++subject) {
        const TrialMetrics metrics =
            measure(run_virtual_trial(settings, trial_of(Modality::kHF, {}, subject)));
        held.lost_contact += metrics.contacts_lost > 0;
        held.oscillated += metrics.oscillates;
        held.losses += metrics.contacts_lost;
    }
    return held;
}

TEST(HapticLoopBudget, OneSampleOfComputationIsAffordable) {
    for (const Duration more : {milliseconds{0}, milliseconds{1}}) {
        const Held held = hold_with(more, paper().handle.mechanics.friction_N);
        EXPECT_EQ(held.lost_contact, 0) << to_seconds(more);
    }
}

// Without friction there is nothing but the hand's damping: at d = 0 samples it suffices (a single slip at
// most), one sample later it is at its limit, from two on every hand is thrown off again and again.
TEST(HapticLoopBudget, AFrictionlessHandleHoldsAtZeroAndChattersFromTwoMilliseconds) {
    const Held none = hold_with(milliseconds{0}, 0), two = hold_with(milliseconds{2}, 0);
    EXPECT_LE(none.losses, 1U);
    EXPECT_EQ(two.lost_contact, static_cast<int>(kSubjects));
    EXPECT_GT(two.losses, 20 * kSubjects);
}

TEST(HapticLoopBudget, AtFiveMillisecondsFrictionDecides) {
    const Held with = hold_with(milliseconds{5}, paper().handle.mechanics.friction_N);
    const Held without = hold_with(milliseconds{5}, 0);
    EXPECT_EQ(with.lost_contact, 0);
    EXPECT_EQ(without.lost_contact, static_cast<int>(kSubjects));
    EXPECT_GT(without.losses, 20 * kSubjects);
}

TEST(HapticLoopBudget, AFrictionlessHandleChattersAtTenMillisecondsAndSwingsFromTwenty) {
    const Held ten = hold_with(milliseconds{10}, 0), twenty = hold_with(milliseconds{20}, 0);
    EXPECT_EQ(ten.lost_contact, static_cast<int>(kSubjects));
    EXPECT_GT(ten.losses, 20 * kSubjects);
    EXPECT_EQ(twenty.oscillated, static_cast<int>(kSubjects));
}

// Only the sum counts for the hand: until the beep, whose way to the ear begins at the environment, the
// needle moves the same however the 50 ms are split.
TEST(DelaySplit, TheTrajectoryIsTheSameUntilTheBeep) {
    for (const Modality modality : {Modality::kHF, Modality::kCF, Modality::kVF}) {
        const TrialRecord whole = run_virtual_trial(paper(), trial_of(modality, kPaperDelay));
        const auto until_beep = static_cast<std::size_t>(1000 * whole.beep_time_s);
        for (const Duration needle : {milliseconds{25}, milliseconds{50}}) {
            const Duration force = kPaperDelay - needle;
            const TrialRecord split =
                run_virtual_trial(paper_with_delays(needle, {}), trial_of(modality, force));
            EXPECT_GE(common_samples(whole, split), until_beep)
                << to_string(modality) << ' ' << to_seconds(needle);
            EXPECT_EQ(split.beep_time_s, whole.beep_time_s);
            EXPECT_EQ(measure(split).oscillates, modality == Modality::kHF);
        }
    }
}

// Hears the slave's answers and what the operator is shown.
struct Beep {
    SessionTime sampled = kNever;   // when the handle was read that completed the five seconds
    SessionTime answered = kNever;  // when the environment knew
    SessionTime heard = kNever;     // when the operator did
    double contact_s = 0;

    void listen(const Message& message) {
        if (const auto* feedback = std::get_if<ForceFeedback>(&message.body)) {
            if (answered != kNever || feedback->contact_time_s < 5) return;
            sampled = feedback->echo_time;
            answered = message.header.send_time;
            contact_s = feedback->contact_time_s;
        } else if (const auto* percept = std::get_if<Percept>(&message.body)) {
            if (heard == kNever && percept->beep) heard = message.header.send_time;
        }
    }
};

struct BeepListener final : Tap {
    BeepListener(Channel& end, Beep& target) : Tap(end), beep(&target) {}
    void send(Bytes datagram) override {
        if (const Decoded decoded = decode(datagram); decoded.message) beep->listen(*decoded.message);
        Tap::send(datagram);
    }
    Beep* beep;
};

TEST(DelaySplit, ContactTimeAndBeepFollowTheUndelayedNeedle) {
    for (const Duration needle : {milliseconds{0}, milliseconds{25}, milliseconds{50}}) {
        Beep beep;
        Rig rig(paper_with_delays(needle, kPaperDelay - needle),
                tap_on<BeepListener>({Wire::kRecord, Wire::kPerceptVisual}, beep));
        const TrialRecord& record = rig.run(trial_of(Modality::kCF, kPaperDelay - needle));
        ASSERT_NE(beep.heard, kNever);
        EXPECT_EQ(beep.contact_s, 5.0);                   // of the handle's samples, whatever the network did
        EXPECT_EQ(beep.answered - beep.sampled, needle);  // known as soon as the needle has arrived
        EXPECT_EQ(beep.heard, beep.answered);             // and no force delay on the way to the ear
        const double contact_s = measure(record).first_contact_time_s;
        EXPECT_NEAR(record.beep_time_s - contact_s, 5, 1e-9);
    }
}

}  // namespace
}  // namespace thimble::test
