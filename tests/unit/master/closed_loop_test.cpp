// The subject on a bare fixture, without tissue, nodes or network: what a hand and a delay alone bring about.
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "master/devices/simulated_handle.hpp"
#include "tests/unit/master/operator_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

constexpr double kFixture_m = 0.123, kFixture_N_per_m = 3000, kScale = 3;
constexpr int kLongest_ms = 40000;

struct Outcome {
    double deepest_m = 0;     // penetration of the needle, before the beep
    double beep_s = 0;        // 0: never
    double frequency_Hz = 0;  // of the contact
    unsigned contacts = 0;    // times the fixture was entered
    bool finished = false;
};

// Force on the path to the handle or the fingertip, one value per ms, and as it was some ms ago.
class DelayLine {
  public:
    double delayed(int now_ms, int delay_ms) const {
        return now_ms < delay_ms ? 0 : forces_N_[static_cast<std::size_t>(now_ms - delay_ms)];
    }
    void put(int now_ms, double force_N) { forces_N_[static_cast<std::size_t>(now_ms)] = force_N; }

  private:
    std::array<double, kLongest_ms> forces_N_{};
};

OperatorParameters recovering_by(Recovery recovery) {
    OperatorParameters person;
    person.behaviour.recovery = recovery;
    return person;
}

Outcome run(Modality modality, int delay_ms, std::uint32_t subject,
            Recovery recovery = OperatorParameters{}.behaviour.recovery,
            const HandleSettings& settings = {}) {
    SimulatedHandle handle(settings, recovering_by(recovery));
    handle.start_trial(at(Duration{0}), task_of(modality, subject));
    DelayLine line;
    Outcome outcome;
    Percept percept;
    int contact_ms = 0, first_entry_ms = 0, last_entry_ms = 0;
    for (int ms = 0; ms < kLongest_ms && !handle.finished(); ++ms) {
        const SessionTime now = at(milliseconds{ms});
        const double needle_m = kScale * handle.read(now).position_hand_m;
        const double deep_m = needle_m - kFixture_m;
        line.put(ms, std::max(0.0, kFixture_N_per_m * deep_m));
        contact_ms = deep_m > 0 ? contact_ms + 1 : 0;
        if (!percept.beep) {
            outcome.deepest_m = std::max(outcome.deepest_m, deep_m);
            if (contact_ms == 1) {
                if (outcome.contacts++ == 0) first_entry_ms = ms;
                last_entry_ms = ms;
            }
            if (contact_ms >= 5000) percept.beep = true, outcome.beep_s = 1e-3 * ms;
        }
        percept.touching_shown |= needle_m > 0.020;
        percept.force_N = std::min(line.delayed(ms, delay_ms + 45), 1.5);
        handle.perceive(now, percept);
        handle.command_force(now, modality == Modality::kHF ? line.delayed(ms, delay_ms) : 0);
    }
    if (outcome.contacts > 1) {
        outcome.frequency_Hz = 1e3 * (outcome.contacts - 1) / (last_entry_ms - first_entry_ms);
    }
    outcome.finished = handle.finished();
    return outcome;
}

TEST(ClosedLoop, WithoutDelayEverySubjectHoldsTheFixture) {
    for (std::uint32_t subject = 1; subject <= 20; ++subject) {
        const Outcome outcome = run(Modality::kHF, 0, subject);
        EXPECT_EQ(outcome.contacts, 1U) << subject;
        EXPECT_TRUE(outcome.finished);
        EXPECT_LT(outcome.deepest_m, 0.003);
        EXPECT_NEAR(outcome.beep_s, 12, 3);
    }
}

// A hand that leans on goes deep: the handle swings between nothing and its 12 N. With little enough friction that no
// first touch sticks.
TEST(ClosedLoop, FiftyMillisecondsMakeTheHandOscillate) {
    HandleSettings smooth;
    smooth.mechanics.friction_N = 0.5;
    for (std::uint32_t subject = 1; subject <= 20; ++subject) {
        const Outcome outcome = run(Modality::kHF, 50, subject, Recovery::kPush, smooth);
        EXPECT_GE(outcome.contacts, 5U) << subject;
        EXPECT_GT(outcome.frequency_Hz, 3.0);
        EXPECT_LT(outcome.frequency_Hz, 5.5);
        EXPECT_GT(outcome.deepest_m, 0.020);
    }
}

TEST(ClosedLoop, WhoRelaxesAndApproachesAgainIsThrownOutAsWellButLessDeep) {
    int thrown_out = 0, finished = 0;
    for (std::uint32_t subject = 1; subject <= 20; ++subject) {
        const Outcome gentle = run(Modality::kHF, 50, subject, Recovery::kApproach);
        const Outcome pushing = run(Modality::kHF, 50, subject, Recovery::kPush);
        if (gentle.contacts == 1) continue;  // friction held the first touch
        ++thrown_out;
        finished += gentle.finished;
        EXPECT_LT(gentle.deepest_m, pushing.deepest_m / 2) << subject;
        EXPECT_GT(gentle.deepest_m, 0.001) << subject;
    }
    EXPECT_GE(thrown_out, 15);
    EXPECT_GE(finished, thrown_out * 2 / 3);  // within the 40 s of this file; a trial has 60
}

TEST(ClosedLoop, WithoutForceOnTheHandleDelayOnlyDeepensTheStop) {
    for (std::uint32_t subject = 1; subject <= 20; ++subject) {
        const Outcome prompt = run(Modality::kCF, 0, subject), delayed = run(Modality::kCF, 50, subject);
        EXPECT_EQ(delayed.contacts, 1U) << subject;
        EXPECT_TRUE(delayed.finished);
        EXPECT_GT(delayed.deepest_m, prompt.deepest_m);
        EXPECT_LT(delayed.deepest_m, prompt.deepest_m + 0.003);
    }
}

TEST(ClosedLoop, CutaneousFeedbackCostsDepth) {
    for (std::uint32_t subject = 1; subject <= 20; ++subject) {
        EXPECT_GT(run(Modality::kCF, 0, subject).deepest_m, 2 * run(Modality::kHF, 0, subject).deepest_m);
    }
}

}  // namespace
}  // namespace thimble::test
