// portable::Real has the arithmetic of double, and templates of Boost compute with it.
#include "common/math/real.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

#include "common/random.hpp"

namespace thimble {
namespace {

using portable::InReal;
using portable::Real;

TEST(RealNumber, ItsArithmeticIsThatOfDouble) {
    RandomStream random({9, 0, 0, 3, Purpose::kParameter});
    for (int i = 0; i < 1000; ++i) {
        const double a = random.normal(), b = random.normal();
        const Real x = a, y = b;
        EXPECT_EQ(x + y, a + b);
        EXPECT_EQ(x - y, a - b);
        EXPECT_EQ(x * y, a * b);
        EXPECT_EQ(x / y, a / b);
        EXPECT_EQ(-x, -a);
        EXPECT_EQ(x < y, a < b);
        EXPECT_EQ(sqrt(x * x), std::sqrt(a * a));
        EXPECT_EQ(static_cast<int>(100 * x), static_cast<int>(100 * a));
    }
    EXPECT_EQ(std::numeric_limits<Real>::epsilon(), std::numeric_limits<double>::epsilon());
    EXPECT_EQ(std::numeric_limits<Real>::digits, 53);
}

TEST(RealNumber, ItsFunctionsAreThePortableOnes) {
    const Real x = 0.3;
    EXPECT_EQ(exp(x), portable::exp(0.3));
    EXPECT_EQ(log(x), portable::log(0.3));
    EXPECT_EQ(pow(x, x), portable::pow(0.3, 0.3));
    EXPECT_NEAR(static_cast<double>(asin(x)), std::asin(0.3), 1e-15);
    EXPECT_NEAR(static_cast<double>(asin(Real(-1))), -std::numbers::pi / 2, 1e-15);
}

// The quantiles of R 4.2: qnorm(0.975), qt(0.975, 9).
TEST(RealNumber, BoostsDistributionsComputeWithIt) {
    const boost::math::normal_distribution<Real, InReal> normal;
    const boost::math::students_t_distribution<Real, InReal> t(9);
    EXPECT_NEAR(static_cast<double>(quantile(normal, Real(0.975))), 1.9599639845400545, 1e-15);
    EXPECT_NEAR(static_cast<double>(quantile(t, Real(0.975))), 2.2621571627982053, 1e-14);
    EXPECT_NEAR(static_cast<double>(cdf(normal, Real(-8))), 6.220960574271786e-16, 1e-29);
}

}  // namespace
}  // namespace thimble
