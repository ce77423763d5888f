#include "cutaneous_node/cutaneous_node.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "cutaneous_node/guarded_actuator.hpp"
#include "cutaneous_node/simulated_actuator.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

SessionControl trial(Modality modality) {
    SessionControl control;
    control.modality = modality;
    return control;
}

ForceFeedback force(double total_N) {
    ForceFeedback feedback;
    feedback.force_total_N = total_N;
    return feedback;
}

// A device that records its commands and obeys at once.
class NotingActuator final : public FingertipActuator {
  public:
    void command(SessionTime now, Finger finger, double force_N) override {
        current = {finger, force_N, now};
        ++commands;
    }
    FingertipForce output(SessionTime) override { return current; }
    void release(SessionTime now) override {
        current = {Finger::kNone, 0, now};
        ++releases;
    }

    void use_hand(SessionTime, Hand which) override { hand = which; }
    void tick(SessionTime) override {}
    SessionTime next_wakeup() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    Hand hand = Hand::kActing;
    FingertipForce current;
    int commands = 0;
    int releases = 0;
};

struct Bench {
    NotingActuator actuator;
    CutaneousNode node{CutaneousSettings{}, actuator};
};

TEST(CutaneousNode, PushingInPressesTheIndexFingerPullingOutTheThumb) {
    Bench bench;
    bench.node.start_trial(at({}), trial(Modality::kCF));
    bench.node.on_feedback(at(milliseconds{1}), force(-0.7));
    EXPECT_EQ(bench.actuator.current.finger, Finger::kIndex);
    EXPECT_EQ(bench.actuator.current.force_N, 0.7);
    bench.node.on_feedback(at(milliseconds{2}), force(0.3));
    EXPECT_EQ(bench.actuator.current.finger, Finger::kThumb);
    EXPECT_EQ(bench.actuator.current.force_N, 0.3);
    bench.node.on_feedback(at(milliseconds{3}), force(0));
    EXPECT_EQ(bench.actuator.current.finger, Finger::kNone);
    EXPECT_EQ(bench.actuator.current.force_N, 0);
}

TEST(CutaneousNode, OnlyCutaneousModalitiesPress) {
    for (const Modality modality : kModalities) {
        Bench bench;
        bench.node.start_trial(at({}), trial(modality));
        bench.node.on_feedback(at({}), force(-1));
        const bool pressed = modality == Modality::kCF || modality == Modality::kCCF;
        EXPECT_EQ(bench.node.active(), pressed);
        EXPECT_EQ(bench.actuator.commands, pressed ? 1 : 0);
        EXPECT_EQ(bench.node.percept(at({})).has_value(), pressed);
        EXPECT_EQ(bench.node.next_percept(), pressed ? at(milliseconds{1}) : kNever);
        EXPECT_EQ(bench.node.acting_hand(), modality == Modality::kCF);
        EXPECT_EQ(bench.node.contralateral(), modality == Modality::kCCF);
        EXPECT_EQ(bench.actuator.hand, modality == Modality::kCCF ? Hand::kOther : Hand::kActing);
    }
}

// [control] compensator = "scaled"
TEST(CutaneousNode, PressesWhatTheHandleDoesNotGive) {
    NotingActuator actuator;
    CutaneousSettings settings;
    settings.hand_share = 0.25;
    CutaneousNode node(settings, actuator);
    node.start_trial(at({}), trial(Modality::kHF));
    EXPECT_TRUE(node.acting_hand());
    node.on_feedback(at({}), force(-2));
    EXPECT_EQ(actuator.current.force_N, 1.5);
    node.start_trial(at(milliseconds{1}), trial(Modality::kCF));
    node.on_feedback(at(milliseconds{1}), force(-2));
    EXPECT_EQ(actuator.current.force_N, 2);
}

TEST(CutaneousNode, IsSlackOutsideTrials) {
    Bench bench;
    EXPECT_FALSE(bench.node.active());
    bench.node.on_feedback(at({}), force(-1));
    EXPECT_EQ(bench.actuator.commands, 0);
    bench.node.start_trial(at({}), trial(Modality::kCF));
    bench.node.on_feedback(at({}), force(-1));
    bench.node.end_trial(at(milliseconds{1}));
    EXPECT_EQ(bench.actuator.current.finger, Finger::kNone);
    EXPECT_FALSE(bench.node.active());
    EXPECT_FALSE(bench.node.contralateral());
    EXPECT_FALSE(bench.node.percept(at(milliseconds{2})).has_value());
    bench.node.on_feedback(at(milliseconds{2}), force(-1));
    EXPECT_EQ(bench.actuator.commands, 1);
}

TEST(CutaneousNode, ChangeOfModalityReleasesTheFingers) {
    Bench bench;
    bench.node.start_trial(at({}), trial(Modality::kCCF));
    bench.node.on_feedback(at({}), force(-1));
    bench.node.start_trial(at(milliseconds{1}), trial(Modality::kHF));
    EXPECT_EQ(bench.actuator.current.finger, Finger::kNone);
}

TEST(CutaneousNode, LetsGoWhenFeedbackStops) {
    Bench bench;
    bench.node.start_trial(at({}), trial(Modality::kCF));
    bench.node.on_feedback(at(milliseconds{10}), force(-1));
    const int before = bench.actuator.releases;
    EXPECT_EQ(bench.node.percept(at(milliseconds{110} - Duration{1}))->force_N, 1);
    EXPECT_EQ(bench.node.percept(at(milliseconds{110}))->force_N, 0);
    bench.node.percept(at(milliseconds{150}));
    EXPECT_EQ(bench.actuator.releases, before + 1) << "once is enough";
    bench.node.on_feedback(at(milliseconds{160}), force(-0.5));
    EXPECT_EQ(bench.node.percept(at(milliseconds{160}))->force_N, 0.5);
}

TEST(CutaneousNode, HoldsOrFadesWhereItIsToldTo) {
    for (const StaleMode mode : {StaleMode::kHold, StaleMode::kRamp}) {
        NotingActuator actuator;
        CutaneousSettings settings;
        settings.stale.mode = mode;
        CutaneousNode node(settings, actuator);
        node.start_trial(at({}), trial(Modality::kCF));
        node.on_feedback(at(milliseconds{0}), force(-0.8));
        for (int ms = 0; ms <= 110; ++ms) static_cast<void>(node.percept(at(milliseconds{ms})));
        EXPECT_EQ(actuator.current.finger, Finger::kIndex);
        EXPECT_DOUBLE_EQ(actuator.current.force_N, mode == StaleMode::kHold ? 0.8 : 0.4);
        for (int ms = 111; ms <= 121; ++ms) static_cast<void>(node.percept(at(milliseconds{ms})));
        EXPECT_EQ(actuator.current.force_N, mode == StaleMode::kHold ? 0.8 : 0);
    }
}

TEST(GuardedActuator, NoFingerIsPressedHarderThanItsLimit) {
    NotingActuator device;
    GuardedActuator guard(2, device);
    for (const double wanted_N : {-1.0, 0.0, 1.5, 2.0, 2.5, 1e300}) {
        guard.command({}, Finger::kIndex, wanted_N);
        EXPECT_EQ(device.current.force_N, std::clamp(wanted_N, 0.0, 2.0));
    }
    for (const double no_number : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        guard.clear();
        guard.command({}, Finger::kThumb, 1);
        EXPECT_FALSE(guard.tripped());
        guard.command({}, Finger::kThumb, no_number);
        EXPECT_TRUE(guard.tripped());
        EXPECT_EQ(device.current.force_N, 0);
        guard.command({}, Finger::kThumb, 1);
        EXPECT_EQ(device.current.force_N, 0) << "until it is cleared";
    }
}

TEST(CutaneousNode, LetsGoWhenTheNeedleIsHeld) {
    Bench bench;
    bench.node.start_trial(at({}), trial(Modality::kCCF));
    bench.node.on_feedback(at({}), force(-1));
    ForceFeedback held = force(-1);
    held.needle_held = true;
    bench.node.on_feedback(at(milliseconds{1}), held);
    EXPECT_EQ(bench.actuator.current.finger, Finger::kNone);
    const int before = bench.actuator.releases;
    bench.node.on_feedback(at(milliseconds{2}), held);
    EXPECT_EQ(bench.actuator.releases, before);
    EXPECT_EQ(bench.actuator.commands, 1);
}

TEST(CutaneousNode, PerceptsKeepTheirGrid) {
    Bench bench;
    const SessionTime start = at(microseconds{250});
    bench.node.start_trial(start, trial(Modality::kCF));
    int percepts = 0;
    for (int i = 0; i < 1000; ++i) {
        percepts += bench.node.percept(start + microseconds{100 * i}).has_value() ? 1 : 0;
    }
    EXPECT_EQ(percepts, 100);
    // A late call counts once and the grid stays.
    EXPECT_TRUE(bench.node.percept(start + microseconds{110'300}).has_value());
    EXPECT_EQ(bench.node.next_percept(), start + microseconds{111'000});
}

TEST(CutaneousNode, PerceptCarriesForceFingerAndAge) {
    SimulatedActuator actuator{CutaneousSettings{}};
    CutaneousNode node(CutaneousSettings{}, actuator);
    node.start_trial(at({}), trial(Modality::kCF));
    for (int ms = 0; ms <= 100; ++ms) {
        node.on_feedback(at(milliseconds{ms}), force(ms < 20 ? -9 : 0.25));
        const auto percept = node.percept(at(milliseconds{ms}));
        ASSERT_TRUE(percept.has_value());
        const Finger expected = ms < 45 ? Finger::kNone : ms < 65 ? Finger::kIndex : Finger::kThumb;
        EXPECT_EQ(percept->finger, expected) << ms;
        EXPECT_EQ(percept->force_N, ms < 45 ? 0 : ms < 65 ? 1.5 : 0.25) << ms;
        EXPECT_DOUBLE_EQ(percept->sample_age_s, ms < 45 ? ms * 1e-3 : 0.045) << ms;
        EXPECT_EQ(percept->bar_N, 0);
        EXPECT_FALSE(percept->beep);
    }
}

TEST(CutaneousNode, NothingOfAnEarlierTrialIsFelt) {
    SimulatedActuator actuator{CutaneousSettings{}};
    CutaneousNode node(CutaneousSettings{}, actuator);
    node.start_trial(at({}), trial(Modality::kCF));
    for (int ms = 0; ms < 60; ++ms) node.on_feedback(at(milliseconds{ms}), force(-1));
    node.end_trial(at(milliseconds{60}));
    node.start_trial(at(milliseconds{61}), trial(Modality::kCF));
    for (int ms = 61; ms < 150; ++ms) EXPECT_EQ(node.percept(at(milliseconds{ms}))->force_N, 0) << ms;
}

}  // namespace
}  // namespace thimble
