#include "cutaneous_node/simulated_actuator.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/allocation_count.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

CutaneousSettings lagging(Duration dead_time, Duration time_constant) {
    CutaneousSettings settings;
    settings.dead_time = dead_time;
    settings.time_constant = time_constant;
    return settings;
}

TEST(SimulatedActuator, DeadTimeIsExactToTheNanosecond) {
    SimulatedActuator actuator{CutaneousSettings{}};
    const SessionTime sent = at(milliseconds{7});
    actuator.command(sent, Finger::kIndex, 0.8);
    const FingertipForce before = actuator.output(sent + milliseconds{45} - Duration{1});
    EXPECT_EQ(before.finger, Finger::kNone);
    EXPECT_EQ(before.force_N, 0);
    const FingertipForce after = actuator.output(sent + milliseconds{45});
    EXPECT_EQ(after.finger, Finger::kIndex);
    EXPECT_EQ(after.force_N, 0.8);
    EXPECT_EQ(after.sample_time, sent);
}

TEST(SimulatedActuator, FollowsIrregularCommandsInOrder) {
    EXPECT_TRUE(rc::check("output is the command of one dead time ago", [] {
        SimulatedActuator actuator{CutaneousSettings{}};
        struct Command {
            SessionTime time;
            double force_N;
        };
        std::vector<Command> sent;
        SessionTime now{};
        for (int i = 0; i < 100; ++i) {
            now += microseconds{*rc::gen::inRange(500, 9000)};
            const double force_N = 0.01 * *rc::gen::inRange(1, 150);
            actuator.command(now, Finger::kIndex, force_N);
            sent.push_back({now, force_N});
            const SessionTime asked = now + microseconds{*rc::gen::inRange(0, 400)};
            Command expected{{}, 0};
            for (const Command& command : sent) {
                if (command.time + milliseconds{45} <= asked) expected = command;
            }
            const FingertipForce felt = actuator.output(asked);
            RC_ASSERT(felt.force_N == expected.force_N);
            RC_ASSERT(felt.sample_time == expected.time);
            now = asked;
        }
    }));
}

TEST(SimulatedActuator, LagFollowsTheExponential) {
    const double tau_s = 0.020;
    SimulatedActuator actuator(lagging(milliseconds{45}, milliseconds{20}));
    actuator.command(at({}), Finger::kIndex, 1.0);
    actuator.command(at(milliseconds{30}), Finger::kIndex, 0.4);
    const auto rise = [&](double t_s) { return 1.0 - std::exp(-t_s / tau_s); };
    for (const int ms : {1, 5, 10, 20, 29}) {
        const FingertipForce felt = actuator.output(at(milliseconds{45 + ms}));
        EXPECT_NEAR(felt.force_N, rise(ms * 1e-3), 1e-14) << ms;
        EXPECT_EQ(felt.sample_time, at({}));
    }
    for (const int ms : {1, 5, 10, 20, 100}) {
        const FingertipForce felt = actuator.output(at(milliseconds{75 + ms}));
        EXPECT_NEAR(felt.force_N, 0.4 + (rise(0.030) - 0.4) * std::exp(-ms * 1e-3 / tau_s), 1e-14) << ms;
        EXPECT_EQ(felt.sample_time, at(milliseconds{30}));
    }
}

TEST(SimulatedActuator, AskingMoreOftenDoesNotChangeTheAnswer) {
    SimulatedActuator often(lagging(milliseconds{10}, milliseconds{30}));
    SimulatedActuator once(lagging(milliseconds{10}, milliseconds{30}));
    for (int ms = 0; ms < 60; ++ms) {
        const double force_N = 0.02 * (ms % 17);
        const Finger finger = ms % 23 < 11 ? Finger::kIndex : Finger::kThumb;
        once.command(at(milliseconds{ms}), finger, force_N);
        often.command(at(milliseconds{ms}), finger, force_N);
        for (int i = 1; i < 10; ++i) often.output(at(milliseconds{ms} + microseconds{100 * i}));
    }
    const FingertipForce expected = once.output(at(milliseconds{63}));
    const FingertipForce felt = often.output(at(milliseconds{63}));
    EXPECT_EQ(felt.force_N, expected.force_N);
    EXPECT_EQ(felt.finger, expected.finger);
    EXPECT_GT(felt.force_N, 0);
}

TEST(SimulatedActuator, NeverPullsAndNeverExceedsTheLimit) {
    EXPECT_TRUE(rc::check("0 <= force <= limit", [] {
        SimulatedActuator actuator(lagging(milliseconds{3}, milliseconds{*rc::gen::inRange(0, 20)}));
        SessionTime now{};
        for (int i = 0; i < 200; ++i) {
            now += microseconds{*rc::gen::inRange(0, 3000)};
            const auto finger = static_cast<Finger>(*rc::gen::inRange(0, 3));
            actuator.command(now, finger, *rc::gen::inRange(-4000, 4000) * 1e-3);
            const FingertipForce felt = actuator.output(now);
            RC_ASSERT(felt.force_N >= 0 && felt.force_N <= 1.5);
            RC_ASSERT((felt.finger == Finger::kNone) == (felt.force_N == 0));
        }
    }));
}

TEST(SimulatedActuator, ClipsWhatIsTooMuchOrNoForce) {
    SimulatedActuator actuator(lagging({}, {}));
    actuator.command(at({}), Finger::kThumb, 9);
    EXPECT_EQ(actuator.output(at({})).finger, Finger::kThumb) << "at once, without dead time";
    EXPECT_EQ(actuator.output(at({})).force_N, 1.5);
    for (const double force_N : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
        actuator.command(at({}), Finger::kIndex, force_N);
        EXPECT_EQ(actuator.output(at({})).force_N, 0);
        EXPECT_EQ(actuator.output(at({})).finger, Finger::kNone);
    }
}

TEST(SimulatedActuator, SwitchingRelaxesOneFingerAndPressesTheOther) {
    SimulatedActuator actuator(lagging({}, milliseconds{20}));
    actuator.command(at({}), Finger::kIndex, 1.0);
    const double pressed_N = actuator.output(at(milliseconds{100})).force_N;
    actuator.command(at(milliseconds{100}), Finger::kThumb, 1.0);
    const FingertipForce early = actuator.output(at(milliseconds{105}));
    EXPECT_EQ(early.finger, Finger::kIndex);
    EXPECT_NEAR(early.force_N, pressed_N * std::exp(-0.25), 1e-12);
    const FingertipForce late = actuator.output(at(milliseconds{120}));
    EXPECT_EQ(late.finger, Finger::kThumb);
    EXPECT_NEAR(late.force_N, 1 - std::exp(-1.0), 1e-12);
    actuator.command(at(milliseconds{200}), Finger::kNone, 1.0);
    EXPECT_EQ(actuator.output(at(milliseconds{250})).finger, Finger::kThumb);
    EXPECT_EQ(actuator.output(at(milliseconds{700})).finger, Finger::kNone) << "slack in the end";
    EXPECT_EQ(actuator.output(at(milliseconds{700})).force_N, 0);
}

TEST(SimulatedActuator, ReleaseForgetsWhatIsPressedAndInFlight) {
    SimulatedActuator actuator(lagging(milliseconds{45}, milliseconds{5}));
    for (int ms = 0; ms < 100; ++ms) actuator.command(at(milliseconds{ms}), Finger::kIndex, 1.0);
    EXPECT_GT(actuator.output(at(milliseconds{100})).force_N, 0.9);
    actuator.release(at(milliseconds{100}));
    for (int ms = 100; ms < 200; ++ms) {
        EXPECT_EQ(actuator.output(at(milliseconds{ms})).force_N, 0) << ms;
        EXPECT_EQ(actuator.output(at(milliseconds{ms})).finger, Finger::kNone) << ms;
    }
}

TEST(SimulatedActuator, FollowsEachCommandOfTheShortestSamplePeriod) {
    SimulatedActuator actuator{CutaneousSettings{}};
    for (int i = 0; i < 1000; ++i) actuator.command(at(microseconds{100 * i}), Finger::kIndex, 1e-3 * i);
    EXPECT_EQ(actuator.output(at(microseconds{99'900})).force_N, 1e-3 * 549) << "of 45 ms before";
}

TEST(SimulatedActuator, CoalescesWhenCommandsComeTooFast) {
    SimulatedActuator actuator{CutaneousSettings{}};
    const std::uint64_t allocations_before = test::allocation_count();
    SessionTime now{};
    for (int i = 0; i < 45'000; ++i) {
        now += microseconds{1};
        actuator.command(now, Finger::kIndex, 1e-5 * i);
    }
    // The latest command still comes exactly when it must.
    EXPECT_LT(actuator.output(now + milliseconds{45} - Duration{1}).force_N, 1e-5 * 44'999);
    EXPECT_EQ(actuator.output(now + milliseconds{45}).force_N, 1e-5 * 44'999);
    EXPECT_EQ(actuator.output(now + milliseconds{45}).sample_time, now);
    EXPECT_EQ(test::allocation_count(), allocations_before);
}

}  // namespace
}  // namespace thimble
