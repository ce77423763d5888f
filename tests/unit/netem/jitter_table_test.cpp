#include "netem/jitter_table.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace thimble {
namespace {

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
}  // namespace thimble
