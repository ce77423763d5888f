// Handle, needle, fixture and back: how old the force at the handle is, and what more age costs (the budget
// of the haptic loop, docs/model.md).
#include <algorithm>
#include <vector>

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
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", subject " << subject);
            const TrialRecord record = run_virtual_trial(paper(), trial);
            const TrialMetrics metrics = measure(record);
            EXPECT_EQ(record.reason, EndReason::kCompleted);
            EXPECT_EQ(metrics.contacts_lost, 0U);
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

// One sample of computation is affordable. At five milliseconds friction decides. Without friction there is nothing but the hand's
// damping: at d = 0 samples it suffices (a single slip at most), one sample later it is at its limit, from two on every hand is thrown
// off again and again, and from twenty milliseconds on it swings.
TEST(HapticLoopBudget, IsWhatFrictionAndTheHandsDampingAllow) {
    constexpr int kAll = static_cast<int>(kSubjects);
    const double friction_N = paper().handle.mechanics.friction_N;
    for (const int ms : {0, 1, 5}) EXPECT_EQ(hold_with(milliseconds{ms}, friction_N).lost_contact, 0) << ms;
    EXPECT_LE(hold_with({}, 0).losses, 1U);
    for (const int ms : {2, 5, 10}) {
        const Held held = hold_with(milliseconds{ms}, 0);
        EXPECT_EQ(held.lost_contact, kAll) << ms;
        EXPECT_GT(held.losses, 20 * kSubjects) << ms;
    }
    EXPECT_EQ(hold_with(milliseconds{20}, 0).oscillated, kAll);
}

// Only the sum counts for a hand and eyes that both wait for it: until the beep, whose way to the ear begins at the environment, the
// needle moves the same however the 50 ms are split.
TEST(DelaySplit, TheTrajectoryIsTheSameUntilTheBeep) {
    for (const Modality modality : {Modality::kHF, Modality::kCF, Modality::kVF}) {
        SystemSettings at_once = paper();
        at_once.visual.picture_delayed = true;
        const TrialRecord whole = run_virtual_trial(at_once, trial_of(modality, kPaperDelay));
        const auto until_beep = static_cast<std::size_t>(1000 * whole.beep_time_s);
        for (const Duration needle : {milliseconds{25}, milliseconds{50}}) {
            const Duration force = kPaperDelay - needle;
            SystemSettings in_parts = at_once;
            in_parts.netem.needle.delay = needle;
            const TrialRecord split = run_virtual_trial(in_parts, trial_of(modality, force));
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

TEST(DelaySplit, ContactTimeAndBeepFollowTheUndelayedNeedle) {
    for (const Duration needle : {milliseconds{0}, milliseconds{25}, milliseconds{50}}) {
        Beep beep;
        const Hear hear = [&beep](const Message& message) { beep.listen(message); };
        Rig rig(paper_with_delays(needle, kPaperDelay - needle),
                tap_on<Listener>({Wire::kRecord, Wire::kPerceptVisual}, hear));
        const TrialRecord& record = rig.run(trial_of(Modality::kCF, kPaperDelay - needle));
        ASSERT_NE(beep.heard, kNever);
        EXPECT_EQ(beep.contact_s, 5.0);                   // of the handle's samples, whatever the network did
        EXPECT_EQ(beep.answered - beep.sampled, needle);  // known as soon as the needle has arrived
        EXPECT_EQ(beep.heard, beep.answered);             // and no force delay on the way to the ear
        const double contact_s = measure(record).first_contact_time_s;
        EXPECT_NEAR(record.beep_time_s - contact_s, 5, 1e-9);
    }
}

TEST(Vision, TheInsertedPartIsNeverShownAndABarInVFOnly) {
    for (const Modality modality : kModalities) {
        ShownList all_shown;
        const Hear keep = keep_in(all_shown);
        Rig rig(paper(), tap_on<Listener>({Wire::kPerceptVisual}, keep));
        const TrialRecord& record = rig.run(trial_of(modality));
        ASSERT_EQ(record.reason, EndReason::kCompleted);
        double deepest_m = 0, deepest_shown_m = -1, longest_N = 0;
        for (const TrajectorySample& s : record.samples)
            deepest_m = std::max(deepest_m, s.position_needle_m - s.position_surface_m);
        ASSERT_GT(deepest_m, 0.05);  // there was something to hide
        int hidden = 0;
        for (const Shown& shown : all_shown) {
            const Percept& p = shown.percept;
            deepest_shown_m =
                std::max(deepest_shown_m, p.position_needle_shown_m - p.position_surface_shown_m);
            hidden += p.touching_shown && p.position_needle_shown_m == p.position_surface_shown_m;
            EXPECT_EQ(p.force_N, 0);
            longest_N = std::max(longest_N, p.bar_N);
        }
        EXPECT_LE(deepest_shown_m, 0);
        EXPECT_GT(hidden, 100);
        if (modality != Modality::kVF) {
            EXPECT_EQ(longest_N, 0);
        } else {
            EXPECT_GT(longest_N, 5);
            EXPECT_LE(longest_N, 12);
        }
        // 60 frames a second, and the beep.
        EXPECT_NEAR(static_cast<double>(all_shown.size()), 60 * record.samples.back().time_s, 10);
    }
}

// Two trials that differ in nothing but the fixture's place look the same until the needle is at the nearer
// one, even where the hand has been inside for seconds.
TEST(Vision, NothingShownTellsWhereTheFixtureIs) {
    ShownList near_shown, far_shown;
    const Hear keep_near = keep_in(near_shown), keep_far = keep_in(far_shown);
    TrialConditions near = trial_of(Modality::kVF), far = near;
    near.fixture_position_m = 0.110;
    far.fixture_position_m = 0.135;
    Rig near_rig(paper(), tap_on<Listener>({Wire::kPerceptVisual}, keep_near));
    Rig far_rig(paper(), tap_on<Listener>({Wire::kPerceptVisual}, keep_far));
    const TrialRecord& record = near_rig.run(near);
    far_rig.run(far);
    double touched_s = 0;
    for (const TrajectorySample& s : record.samples) {
        if (s.contact_time_s > 0 || s.force_fixture_N != 0) break;
        touched_s = s.time_s;
    }
    ASSERT_GT(touched_s, 3);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < near_shown.size() && i < far_shown.size(); ++i) {
        const Shown &a = near_shown[i], &b = far_shown[i];
        if (to_seconds(a.when.time_since_epoch()) > touched_s) break;
        ++compared;
        ASSERT_EQ(a.when, b.when);
        ASSERT_EQ(a.percept.bar_N, b.percept.bar_N);
        ASSERT_EQ(a.percept.position_needle_shown_m, b.percept.position_needle_shown_m);
        ASSERT_EQ(a.percept.position_surface_shown_m, b.percept.position_surface_shown_m);
        ASSERT_EQ(a.percept.touching_shown, b.percept.touching_shown);
    }
    EXPECT_GT(compared, 150U);
}

}  // namespace
}  // namespace thimble::test
