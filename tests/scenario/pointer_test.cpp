// A person's pointer instead of the virtual operator: a scripted hand that advances, presses, holds, withdraws. Delay
// changes HF, and not CF and VF, with the model's own contact and the study's own measure.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SystemSettings pointed(Duration delay, Duration timeout = paper().session.trial_timeout) {
    SystemSettings settings = paper_with_delays({}, delay);
    settings.session.trial_timeout = timeout;
    settings.handle.kind = HandleKind::kPointer;
    settings.session.ends_by_withdrawal = true;  // a pointer does not know when it is over
    return settings;
}

// Moves a pointer as a person would who knows where the fixture is: no eyes, no skin, so that nothing but the handle can
// oscillate. 60 inputs a second, as a screen has frames.
class ScriptedHand {
  public:
    ScriptedHand(Rig& rig, double press_hand_m, double fixture_needle_m)
        : rig_(rig),
          flow_(Role::kVisual, 77, {&rig.hand()}),
          hold_at_m_(fixture_needle_m / 3 + press_hand_m) {}

    // False once the trial has ended.
    bool step() {
        if (rig_.now() >= next_ && rig_.session().running() && present_) {
            move();
            flow_.send(rig_.now(), rig_.session().number(), HandInput{wanted_m_, engaged_});
            next_ = rig_.now() + kFrame;
        }
        return rig_.step();
    }
    const TrialRecord& finish() {
        while (step()) {
        }
        return rig_.session().record();
    }
    bool until_held() {
        while (wanted_m_ < hold_at_m_ && step()) {
        }
        return wanted_m_ >= hold_at_m_;
    }
    void let_go() { engaged_ = false; }
    void vanish() { present_ = false; }

  private:
    static constexpr Duration kFrame = milliseconds{16};
    static constexpr double kSpeed_m_per_s = 0.02;

    void move() {
        const bool beeped = !std::isnan(rig_.session().record().beep_time_s);
        const double way_m = kSpeed_m_per_s * to_seconds(kFrame);
        wanted_m_ = beeped ? std::max(wanted_m_ - way_m, 0.0) : std::min(wanted_m_ + way_m, hold_at_m_);
    }

    Rig& rig_;
    OutboundFlow flow_;
    double hold_at_m_, wanted_m_ = 0;
    SessionTime next_{};
    bool engaged_ = true, present_ = true;
};

struct Outcome {
    TrialRecord record;
    TrialMetrics metrics;
    double energy_in_J = 0;
};

// 2 mm further than the fixture: 1 N through the default coupling.
constexpr double kPress_hand_m = 0.002;

Outcome press(Modality modality, Duration delay, const SystemSettings& settings,
              double press_hand_m = kPress_hand_m) {
    const TrialConditions trial = trial_of(modality, delay);
    Rig rig(settings);
    rig.start(trial);
    ScriptedHand hand(rig, press_hand_m, trial.fixture_position_m);
    Outcome outcome{hand.finish(), {}, 0};
    outcome.metrics = measure(outcome.record);
    outcome.energy_in_J = rig.master().energy().energy_in_J();
    return outcome;
}

Outcome press(Modality modality, Duration delay) { return press(modality, delay, pointed(delay)); }

TEST(Pointer, WithoutDelayTheHandleRestsAgainstTheFixture) {
    const Outcome felt = press(Modality::kHF, Duration{0});
    EXPECT_EQ(felt.record.reason, EndReason::kCompleted);
    EXPECT_TRUE(felt.metrics.beeped);
    EXPECT_FALSE(felt.metrics.oscillates);
    EXPECT_EQ(felt.metrics.contacts_lost, 0U);
    // Pressed with 1 N less friction, against 3 kN/m at the needle: a third of a millimetre, where CF goes 2 mm deep.
    EXPECT_LT(felt.metrics.penetration_max_m, 0.0005);
    EXPECT_GT(felt.metrics.penetration_max_m, 0.00005);
}

TEST(Pointer, FingertipsAndBarDoNotMoveTheHandleWhateverTheDelay) {
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        for (const Duration delay : {Duration{0}, kPaperDelay}) {
            const Outcome seen = press(modality, delay);
            EXPECT_EQ(seen.record.reason, EndReason::kCompleted);
            EXPECT_EQ(seen.metrics.contacts_lost, 0U);
            EXPECT_FALSE(seen.metrics.oscillates);
            EXPECT_LT(seen.metrics.oscillation_rms_m, 1e-4);
            EXPECT_GT(seen.metrics.penetration_max_m, 0.001);
            EXPECT_EQ(seen.energy_in_J, 0);
        }
    }
}

TEST(Pointer, AFirmerHandOscillatesToo) {
    for (const double stiffness_N_per_m : {500.0, 1000.0}) {
        for (const double damping_Ns_per_m : {5.0, 15.0, 30.0}) {
            for (const Duration delay : {Duration{0}, kPaperDelay}) {
                SystemSettings settings = pointed(delay, seconds{12});
                settings.handle.coupling = {stiffness_N_per_m, damping_Ns_per_m};
                EXPECT_EQ(press(Modality::kHF, delay, settings).metrics.oscillates, delay > Duration{0})
                    << stiffness_N_per_m << " N/m, " << damping_Ns_per_m << " Ns/m";
            }
        }
    }
}

// 24 mm beyond the fixture at the hand, 12 N by the spring: the hand pulls with less, so that the late force still moves it.
TEST(Pointer, ShovingCuresNothing) {
    for (const Modality modality : kModalities) {
        const Outcome shoved = press(modality, kPaperDelay, pointed(kPaperDelay, seconds{12}), 0.024);
        EXPECT_EQ(shoved.metrics.oscillates, modality == Modality::kHF) << to_string(modality);
    }
}

// The figures of docs/play.md.
TEST(Pointer, WhatDelayDoesToAHandThatPresses) {
    fmt::print("| delay, ms | contacts lost | rms, mm | peak to peak, mm | frequency, Hz | energy in, J |\n");
    double before_J = 1;
    for (const int ms : {0, 1, 2, 5, 10, 20, 50, 100}) {
        const milliseconds delay{ms};
        const Outcome felt = press(Modality::kHF, delay, pointed(delay, seconds{20}));
        const TrialMetrics& m = felt.metrics;
        fmt::print("| {} | {} | {:.2f} | {:.1f} | {:.1f} | {:.3f} |\n", ms, m.contacts_lost,
                   1000 * m.oscillation_rms_m, 1000 * m.oscillation_peak_to_peak_m,
                   m.oscillation_frequency_Hz, felt.energy_in_J);
        EXPECT_EQ(m.oscillates, ms >= 20) << ms;
        EXPECT_EQ(m.contacts_lost > 0, ms >= 10) << ms;
        if (ms <= 50) {
            EXPECT_LT(felt.energy_in_J, before_J) << ms;  // the later, the more comes out
        }
        before_J = felt.energy_in_J;
        if (ms != 50) continue;  // the handle is thrown back and forth: contact is never kept, no beep
        EXPECT_EQ(felt.record.reason, EndReason::kTimeout);
        EXPECT_FALSE(m.beeped);
        EXPECT_GT(m.contacts_lost, 20U);
        EXPECT_LT(felt.energy_in_J, -1);  // the handle gives out energy that the hand did not put in
    }
}

// A needle that has been let go while it oscillates comes to rest, and stays in the trial.
void expect_rest_after(void (ScriptedHand::*leave)()) {
    const TrialConditions trial = trial_of(Modality::kHF, kPaperDelay);
    Rig rig(pointed(kPaperDelay));
    rig.start(trial);
    ScriptedHand hand(rig, kPress_hand_m, trial.fixture_position_m);
    ASSERT_TRUE(hand.until_held());
    const SessionTime held = rig.now();
    while (rig.now() < held + seconds{2} && hand.step()) {
    }
    (hand.*leave)();
    const SessionTime left = rig.now();
    while (rig.now() < left + seconds{1} && hand.step()) {
    }
    const double rest_m = rig.pointer().position_hand_m();
    double moved_m = 0;
    while (rig.now() < left + seconds{4} && hand.step())
        moved_m = std::max(moved_m, std::fabs(rig.pointer().position_hand_m() - rest_m));
    EXPECT_TRUE(rig.session().running());  // no peer is lost: needle commands go on
    EXPECT_LT(moved_m, 1e-5);
    EXPECT_EQ(rig.session().recorder().newest()->force_fixture_N, 0);
}

TEST(Pointer, LetGoItComesToRest) { expect_rest_after(&ScriptedHand::let_go); }
TEST(Pointer, WithoutInputItComesToRest) { expect_rest_after(&ScriptedHand::vanish); }

TEST(Pointer, ForeignAndOldInputsAreCountedAndMoveNothing) {
    const TrialConditions trial = trial_of(Modality::kVF);
    Rig rig(pointed({}));
    rig.start(trial);
    rig.run_until(SessionTime{milliseconds{200}});
    const std::uint64_t before = rig.master().counters().refused_total();
    OutboundFlow wrong_role(Role::kMaster, 5, {&rig.hand()});
    OutboundFlow wrong_trial(Role::kVisual, 6, {&rig.hand()});
    wrong_role.send(rig.now(), rig.session().number(), HandInput{0.01, true});
    wrong_trial.send(rig.now(), rig.session().number() + 1, HandInput{0.01, true});
    rig.run_until(SessionTime{milliseconds{400}});
    EXPECT_EQ(rig.master().counters().refused_total(), before + 2);
    EXPECT_EQ(rig.master().counters().of(Refusal::kWrongTrial), 1U);
    EXPECT_EQ(rig.pointer().position_hand_m(), 0);
}

TEST(Pointer, TheSameBitsTwice) {
    const Outcome once = press(Modality::kHF, Duration{0}), again = press(Modality::kHF, Duration{0});
    ASSERT_FALSE(once.record.samples.empty());
    EXPECT_TRUE(same_samples(once.record, again.record));
    EXPECT_EQ(once.energy_in_J, again.energy_in_J);
}

}  // namespace
}  // namespace thimble::test
