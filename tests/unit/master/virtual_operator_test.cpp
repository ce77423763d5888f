// How far the hand strays from what was intended.
#include "master/operator/virtual_operator.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/master/operator_test_tools.hpp"

namespace thimble::test {
namespace {

// Root mean square of x_eq - x_cmd while the muscles hold the arm `effort_m` away from where it would be.
double stray_m(const NoiseParameters& noise, double effort_m) {
    OperatorParameters parameters = calm_parameters();
    parameters.noise = noise;
    VirtualOperator subject(parameters, task_of(Modality::kHF));
    double sum = 0;
    constexpr int kTicks = 1'000'000;
    for (int i = 0; i < kTicks; ++i) {
        const double arm_m = subject.behaviour().intention().position_m - effort_m;
        const double stray_m =
            subject.tick(0, {}, arm_m).equilibrium_m - subject.behaviour().intention().position_m;
        sum += stray_m * stray_m;
    }
    return std::sqrt(sum / kTicks);
}

NoiseParameters only(double sway_m, double tremor_m, double force_noise_fraction) {
    return {.sway_m = sway_m, .tremor_m = tremor_m, .force_noise_fraction = force_noise_fraction};
}

TEST(VirtualOperator, StraysByEachNoiseAsMuchAsItSays) {
    EXPECT_NEAR(stray_m(only(2.5e-4, 0, 0), 0.01), 2.5e-4, 2.5e-5);
    EXPECT_NEAR(stray_m(only(0, 5e-5, 0), 0.01), 5e-5, 2e-6);
    EXPECT_NEAR(stray_m(only(0, 0, 0.04), 0.01), 4e-4, 1.5e-5);
    EXPECT_NEAR(stray_m(only(0, 0, 0.04), 0.02), 8e-4, 3e-5);
    EXPECT_LT(stray_m(only(0, 0, 0), 0.01), 1e-15) << "without noise";
}

TEST(VirtualOperator, SilencingOneNoiseLeavesTheOthersTheirNumbers) {
    OperatorParameters with = calm_parameters(), without = calm_parameters();
    with.noise = only(0, 5e-5, 0.04);
    without.noise = only(0, 5e-5, 0);
    VirtualOperator noisy(with, task_of(Modality::kHF)), quiet(without, task_of(Modality::kHF));
    for (int i = 0; i < 100; ++i) {  // no effort: no force noise
        const double here_m = noisy.behaviour().intention().position_m;
        EXPECT_NEAR(noisy.tick(0, {}, here_m).equilibrium_m, quiet.tick(0, {}, here_m).equilibrium_m, 1e-5);
    }
}

}  // namespace
}  // namespace thimble::test
