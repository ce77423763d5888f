// Tails and quantiles against closed forms and 40-digit values (mpmath). The tests of their users test their use.
#include "analysis/statistics/distributions.hpp"

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(Distributions, SmallTailsKeepTheirDigits) {
    EXPECT_TRUE(close(f_upper(106.5, 3, 45), 1.8511799347924729e-20, 1e-12));
    EXPECT_TRUE(close(f_upper(81.89, 3, 45), 2.9622036401556914e-18, 1e-12));
    EXPECT_TRUE(close(f_upper(1e6, 3, 45), 1.5760962092915585e-108, 1e-11));
    EXPECT_TRUE(close(t_upper(30, 40), 2.425453830295104e-29, 1e-12));
    EXPECT_TRUE(close(t_two_sided(-30, 40), 2 * 2.425453830295104e-29, 1e-12));
    EXPECT_TRUE(close(normal_two_sided(-37), 1.1451142445049154e-299, 1e-11));
    EXPECT_TRUE(close(chi_squared_upper(500, 3), 4.7716720319127585e-108, 1e-11));
}

TEST(Distributions, ClosedForms) {
    for (const double x : {0.0, 0.1, 1.0, 7.0, 300.0}) {
        EXPECT_TRUE(close(chi_squared_upper(x, 2), std::exp(-x / 2), 1e-13));
        EXPECT_TRUE(close(f_upper(x, 2, 12), std::pow(1 + x / 6, -6), 1e-12));
        EXPECT_TRUE(close(t_upper(x, 2) + t_upper(-x, 2), 1, 1e-15));
    }
    EXPECT_EQ(normal_two_sided(0), 1);
    EXPECT_EQ(t_two_sided(0, 7), 1);
    EXPECT_TRUE(close(normal_quantile(0.975), 1.9599639845400542, 1e-14));
    EXPECT_TRUE(close(t_half_width(0.95, 1), 12.706204736174704, 1e-13));
}

TEST(Distributions, WhatCannotBeComputedIsRefused) {
    expect_refused([] { t_upper(kMissing, 3); }, {"t tail"});
    expect_refused([] { f_upper(2, -1, 3); }, {"F tail"});
    expect_refused([] { chi_squared_upper(-1, 3); }, {"chi-squared tail"});
    expect_refused([] { normal_quantile(1); }, {"normal quantile"});
}

}  // namespace
}  // namespace thimble
