// From a force to three cables and back; the pad; slack.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cutaneous_node/fingertip/cable_command.hpp"
#include "cutaneous_node/fingertip/pad_model.hpp"

namespace thimble {
namespace {

constexpr double kAngle_rad = 0.35;
constexpr double kRated_Nm = 150e-6;

TEST(FingerGeometry, ANormalForceIsSharedEvenlyAndNeverPushed) {
    const FingerGeometry geometry(kAngle_rad);
    const double tension_N = geometry.tension_N(1.5);
    EXPECT_NEAR(tension_N, 1.5 / (3 * std::cos(kAngle_rad)), 1e-12);
    EXPECT_NEAR(geometry.normal_N({tension_N, tension_N, tension_N}), 1.5, 1e-12);
    EXPECT_NEAR(geometry.normal_N({3, 0, 0}), 3 * std::cos(kAngle_rad), 1e-12);
    EXPECT_EQ(geometry.tension_N(-1), 0);
}

TEST(PadModel, ElasticForceAndIndentationAreInverse) {
    const PadModel pad;
    for (const double force_N : {0.0, 0.05, 0.5, 1.5}) {
        EXPECT_NEAR(pad.elastic_N(pad.indentation_m(force_N)), force_N, 1e-12);
    }
    EXPECT_EQ(pad.elastic_N(-0.001), 0);
    // Between 0.3 and 1 N/mm where fingers are pressed, as the literature has it.
    for (const double force_N : {0.5, 1.0}) {
        const double x_m = pad.indentation_m(force_N);
        const double stiffness_N_per_m = (pad.elastic_N(x_m + 1e-6) - pad.elastic_N(x_m)) / 1e-6;
        EXPECT_GT(stiffness_N_per_m, 300);
        EXPECT_LT(stiffness_N_per_m, 1000);
    }
}

TEST(PadModel, AStepRelaxesWithItsThreeTimes) {
    PadModel pad;
    const double indentation_m = 0.003, elastic_N = pad.elastic_N(indentation_m), step_s = 1e-5;
    double time_s = 0;
    for (const double until_s : {0.001, 0.01, 0.1, 1.0}) {
        for (; time_s < until_s - step_s / 2; time_s += step_s) pad.advance(indentation_m, step_s);
        double share = 0.4;
        for (const double relaxation_s : {0.004, 0.070, 1.4})
            share += 0.2 * std::exp(-until_s / relaxation_s);
        EXPECT_NEAR(pad.force_N() / elastic_N, share, 2e-3) << until_s;
    }
}

TEST(PadModel, ARampIsExactWhateverTheStep) {
    PadModel coarse, fine;
    // An elastic force that rises evenly: x = ln(1 + F/b) / m.
    const auto at = [&](double time_s) { return coarse.indentation_m(2 * time_s); };
    for (int i = 1; i <= 5; ++i) coarse.advance(at(0.1 * i), 0.1);
    for (int i = 1; i <= 5000; ++i) fine.advance(at(1e-4 * i), 1e-4);
    EXPECT_NEAR(coarse.force_N(), fine.force_N(), 1e-9);
}

TEST(PadModel, StepsMayDiffer) {
    PadModel mixed, even;
    for (const double step_s : {0.001, 0.003, 0.001}) mixed.advance(0.003, step_s);
    for (int i = 0; i < 5; ++i) even.advance(0.003, 0.001);
    EXPECT_NEAR(mixed.force_N(), even.force_N(), 1e-12);
}

TEST(PadModel, DoesNotStickWhenTheForceIsTakenAway) {
    PadModel pad;
    for (int i = 0; i < 1000; ++i) pad.advance(0.003, 0.001);
    for (int i = 0; i < 100; ++i) EXPECT_GE(pad.advance(-0.001, 0.001), 0);
}

TEST(CableCommand, ADeadbandALimitAndNoForceForWhatIsNone) {
    const ForceShape shape{0.02, 1.5};
    EXPECT_EQ(shape.shaped_N(0.019), 0);
    EXPECT_EQ(shape.shaped_N(0.02), 0.02);
    EXPECT_EQ(shape.shaped_N(7), 1.5);
    EXPECT_EQ(shape.shaped_N(-1), 0);
    EXPECT_EQ(shape.shaped_N(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(CableCommand, TensionBecomesPerMilleAndComesBack) {
    CableDrive cable;
    // 0.5 N at 2.5 mm through 16:1 at 80 %: 97.7 uNm at the motor, of 150.
    EXPECT_EQ(cable.torque_per_mille(0.5, kRated_Nm), 651);
    EXPECT_NEAR(cable.tension_N(651, kRated_Nm), 0.5, 0.0005);
    EXPECT_EQ(cable.torque_per_mille(100, kRated_Nm), 1000);
    EXPECT_EQ(cable.torque_per_mille(-1, kRated_Nm), 0);
    EXPECT_EQ(cable.tension_N(-20, kRated_Nm), 0);
    cable.reversed = true;
    EXPECT_EQ(cable.torque_per_mille(0.5, kRated_Nm), -651);
    EXPECT_NEAR(cable.tension_N(-651, kRated_Nm), 0.5, 0.0005);
}

TEST(CableCommand, CountsBecomeCableAndComeBack) {
    for (const bool reversed : {false, true}) {
        CableDrive cable;
        cable.reversed = reversed;
        const std::int32_t origin = -5000;
        for (const double wound_m : {0.0, 0.001, 0.01, -0.002}) {
            EXPECT_NEAR(cable.wound_m(cable.counts(wound_m, origin), origin), wound_m, 1e-5);
        }
    }
    EXPECT_GT(CableDrive{}.counts(0.01, 0), 0);
}

TEST(SlackDetector, WantsMoreThanTheMarginForAWhile) {
    SlackDetector slack(0.003, 0.05);
    for (int i = 0; i < 49; ++i) EXPECT_FALSE(slack.slack(0.0101, 0.007, 0.001));
    EXPECT_FALSE(slack.slack(0.0099, 0.007, 0.001)) << "back within the margin: it starts anew";
    for (int i = 0; i < 49; ++i) EXPECT_FALSE(slack.slack(0.0101, 0.007, 0.001));
    EXPECT_TRUE(slack.slack(0.0101, 0.007, 0.002));
    SlackDetector exact(0.001, 0.5);
    EXPECT_FALSE(exact.slack(0.003, 0.001, 0.25));
    EXPECT_TRUE(exact.slack(0.003, 0.001, 0.25)) << "once the time is full";
    EXPECT_FALSE(exact.slack(0.002, 0.001, 0.25)) << "the pad explains it again";
}

}  // namespace
}  // namespace thimble
