// The quantile functions: against closed forms, and against their own mean and variance.
#include "netem/stages/delay_shape.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <boost/math/special_functions/gamma.hpp>
#include <gtest/gtest.h>

#include "netem/jitter_table.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

DelayShape shape_of(JitterShape shape, double delay_per_spread = 4) {
    JitterSettings settings{.shape = shape, .spread = milliseconds{1}};
    if (shape == JitterShape::kTable) settings.table = std::make_shared<JitterTable>(std::vector{-1.0, 1.0});
    return {settings, from_seconds(1e-3 * delay_per_spread)};
}

double share_below(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

struct Moments {
    double mean = 0, variance = 0;
};

// Integrals over z with the normal density: exact to many digits, tails included.
Moments moments(const DelayShape& shape) {
    constexpr double kStep = 0.0005;
    double sum = 0;
    double squares = 0;
    for (double z = -8.5; z < 8.5; z += kStep) {
        const double weight = kStep * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
        sum += weight * shape.at_normal(z);
        squares += weight * shape.at_normal(z) * shape.at_normal(z);
    }
    return {sum, squares - sum * sum};
}

TEST(DelayShape, MeanIsZeroAndVarianceOne) {
    for (const JitterShape shape : {JitterShape::kNormal, JitterShape::kGamma, JitterShape::kPareto,
                                    JitterShape::kParetoNormal, JitterShape::kTable}) {
        const Moments found = moments(shape_of(shape));
        EXPECT_NEAR(found.mean, 0, 1e-5) << static_cast<int>(shape);
        // Beyond the integral's end a Pareto tail holds 4 / 10^6 of its variance; the table's is that of two values.
        const double variance = shape == JitterShape::kTable ? JitterTable({-1, 1}).standard_deviation() : 1;
        EXPECT_NEAR(found.variance, variance * variance, 1e-4) << static_cast<int>(shape);
    }
    EXPECT_NEAR(moments(shape_of(JitterShape::kUniform)).variance, 1.0 / 3, 1e-6);  // half width 1
}

TEST(DelayShape, RisesWithItsArgument) {
    for (const JitterShape shape : {JitterShape::kUniform, JitterShape::kNormal, JitterShape::kGamma,
                                    JitterShape::kPareto, JitterShape::kParetoNormal, JitterShape::kTable}) {
        for (const double ratio : {0.35, 1.0, 3.0, 30.0, 3000.0}) {
            const DelayShape deviates = shape_of(shape, ratio);
            double last = -std::numeric_limits<double>::infinity();
            for (double z = -9; z <= 9; z += 0.001) {
                const double deviate = deviates.at_normal(z);
                ASSERT_GE(deviate, last - 1e-14) << static_cast<int>(shape) << ' ' << ratio << ' ' << z;
                last = deviate;
            }
        }
    }
}

// The table's error, in units of the spread, as delay_shape.hpp states it.
TEST(DelayShape, GammaTableAgreesWithTheQuantileFunction) {
    for (const double ratio : {0.1, 0.35, 0.5, 1.0, 2.0, 5.0, 50.0, 5000.0}) {
        const DelayShape gamma = shape_of(JitterShape::kGamma, ratio);
        const double k = ratio * ratio;
        for (double z = -8; z <= 8; z += 0.0173) {
            const double exact = z < 0 ? boost::math::gamma_p_inv(k, share_below(z))
                                       : boost::math::gamma_q_inv(k, share_below(-z));
            ASSERT_NEAR(gamma.at_normal(z), (exact - k) / ratio, ratio < 1 ? 1e-5 : 2e-8)
                << ratio << ' ' << z;
        }
    }
}

TEST(DelayShape, GammaWithoutDelayIsNoJitter) {
    const DelayShape none({.shape = JitterShape::kGamma, .spread = milliseconds{5}}, {});
    EXPECT_FALSE(none.takes_normal());
    EXPECT_EQ(none.at_uniform(0.99), 0);
    EXPECT_EQ(none.at_normal(3), 0);
}

// Where tables of ever larger shapes end, two terms of an expansion go on.
TEST(DelayShape, NarrowGammaIsNearlyNormal) {
    const DelayShape below = shape_of(JitterShape::kGamma, 0.9e4);
    const DelayShape beyond = shape_of(JitterShape::kGamma, 1.1e4);
    for (double z = -6; z <= 6; z += 0.37) {
        EXPECT_NEAR(below.at_normal(z), z + (z * z - 1) / (3 * 0.9e4), 1e-6);
        EXPECT_NEAR(beyond.at_normal(z), z + (z * z - 1) / (3 * 1.1e4), 1e-9);
    }
}

TEST(DelayShape, ParetoHasIndexThree) {
    const DelayShape pareto = shape_of(JitterShape::kPareto);
    const double spread = std::sqrt(0.75);
    EXPECT_DOUBLE_EQ(pareto.at_uniform(0), (1 - 1.5) / spread);
    EXPECT_NEAR(pareto.at_uniform(1 - 1e-3), (10 - 1.5) / spread, 1e-11);
    EXPECT_NEAR(pareto.at_uniform(1 - 1e-6), (100 - 1.5) / spread, 1e-7);
}

TEST(DelayShape, BothArgumentsMeanTheSame) {
    for (const JitterShape shape : {JitterShape::kUniform, JitterShape::kPareto, JitterShape::kTable}) {
        const DelayShape deviates = shape_of(shape);
        EXPECT_FALSE(deviates.takes_normal());
        for (double z = -3; z <= 3; z += 0.1) {
            EXPECT_NEAR(deviates.at_normal(z), deviates.at_uniform(share_below(z)), 1e-10);
        }
    }
}

TEST(JitterTable, StraightLinesBetweenItsDeviates) {
    const JitterTable table({-2, -1, 1, 2});
    EXPECT_EQ(table.quantile(0), -2);
    EXPECT_EQ(table.quantile(0.125), -2);
    EXPECT_EQ(table.quantile(0.375), -1);
    EXPECT_EQ(table.quantile(0.5), 0);
    EXPECT_EQ(table.quantile(0.75), 1.5);
    EXPECT_EQ(table.quantile(1), 2);
}

TEST(JitterTable, KnowsItsMeanAndSpread) {
    const JitterTable table({-1, 0, 0.5, 4});
    constexpr int kCells = 100'000;
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < kCells; ++i) {
        const double x = table.quantile((i + 0.5) / kCells);
        sum += x / kCells;
        squares += x * x / kCells;
    }
    EXPECT_NEAR(table.mean(), sum, 1e-8);
    EXPECT_NEAR(table.standard_deviation(), std::sqrt(squares - sum * sum), 1e-8);
}

}  // namespace
}  // namespace thimble::test
