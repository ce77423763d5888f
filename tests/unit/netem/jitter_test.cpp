// The delays of a stream of packets: the shape is their marginal distribution for any correlation; and the
// correlation.
#include "netem/stages/jitter.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <boost/math/special_functions/gamma.hpp>
#include <gtest/gtest.h>

#include "netem/jitter_table.hpp"
#include "netem/stages/delay_shape.hpp"
#include "netem/stages/packet_numbers.hpp"
#include "tests/unit/netem/link_test_tools.hpp"
#include "tests/unit/netem/statistics_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

constexpr double kRatio = 2;  // mean delay over spread

double normal_below(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double pareto_below(double x) {
    const double value = 1.5 + x * std::sqrt(0.75);
    return value <= 1 ? 0 : 1 - std::pow(value, -3);
}

// Distribution functions, each written another way than the quantiles.
double below(JitterShape shape, double x, const DelayShape& deviates) {
    switch (shape) {
        case JitterShape::kUniform:
            return std::clamp((1 + x) / 2, 0.0, 1.0);
        case JitterShape::kNormal:
            return normal_below(x);
        case JitterShape::kGamma:
            return x <= -kRatio ? 0 : boost::math::gamma_p(kRatio * kRatio, kRatio * (kRatio + x));
        case JitterShape::kPareto:
            return pareto_below(x);
        default:
            break;
    }
    double low = -9;  // no closed form: bisection
    double high = 9;
    for (int i = 0; i < 50; ++i) {
        const double middle = (low + high) / 2;
        (deviates.at_normal(middle) < x ? low : high) = middle;
    }
    return normal_below(low);
}

struct Sampler {
    explicit Sampler(JitterShape shape, double correlation = 0, const StreamKey& key = kKey)
        : jitter(link_key(key, 1, Purpose::kLinkDelay)) {
        JitterSettings settings{.shape = shape, .spread = milliseconds{1}};
        std::vector<double> measured;
        for (int i = 0; i < 100; ++i) measured.push_back(std::exp(0.02 * i) - 3);
        if (shape == JitterShape::kTable) settings.table = std::make_shared<JitterTable>(measured);
        deviates = std::make_shared<const DelayShape>(settings, from_seconds(1e-3 * kRatio));
        jitter.configure(deviates, correlation);
    }
    std::vector<double> draw(std::size_t count, std::size_t each = 1) {
        std::vector<double> values;
        for (std::size_t packet = 0; packet < count * each; ++packet) {
            const double value = jitter.deviate(packet);
            if (packet % each == 0) values.push_back(value);
        }
        return values;
    }
    std::shared_ptr<const DelayShape> deviates;
    Jitter jitter;
};

constexpr std::array kEveryShape{JitterShape::kUniform, JitterShape::kNormal,       JitterShape::kGamma,
                                 JitterShape::kPareto,  JitterShape::kParetoNormal, JitterShape::kTable};

class EachShape : public testing::TestWithParam<JitterShape> {};

// With correlation each 20th packet: so far apart these are independent, as the limit supposes (0.6^20 = 4e-5).
TEST_P(EachShape, MarginalIsWhatWasAskedWhateverTheCorrelation) {
    for (const auto& [correlation, each] : {std::pair{0.0, 1U}, std::pair{0.6, 20U}}) {
        Sampler sampler(GetParam(), correlation);
        const auto cdf = [&](double x) { return below(GetParam(), x, *sampler.deviates); };
        EXPECT_LT(ks_distance(sampler.draw(20'000 / each, each), cdf), ks_limit(20'000 / each)) << each;
    }
}

TEST_P(EachShape, PacketsAreIndependentUnlessAsked) {
    // Ranks, since products of a Pareto shape have no variance.
    std::vector<double> ranks;
    Sampler sampler(GetParam());
    for (const double x : sampler.draw(20'000)) ranks.push_back(below(GetParam(), x, *sampler.deviates));
    EXPECT_NEAR(correlation_of(ranks), 0, 4 / std::sqrt(20'000.0));
}

TEST_P(EachShape, DeviateDependsOnThePacketOnly) {
    Sampler forwards(GetParam());
    Sampler backwards(GetParam());
    const std::vector<double> expected = forwards.draw(100);
    for (std::size_t packet = 100; packet-- > 0;) {
        ASSERT_EQ(backwards.jitter.deviate(packet), expected[packet]);
    }
}

INSTANTIATE_TEST_SUITE_P(Jitter, EachShape, testing::ValuesIn(kEveryShape));

TEST(Jitter, AchievesTheCorrelationAsked) {
    for (const double r : {0.3, 0.6, 0.9}) {
        const double tolerance = 6 / std::sqrt(100'000.0);
        EXPECT_NEAR(correlation_of(Sampler(JitterShape::kNormal, r).draw(100'000)), r, tolerance);
        EXPECT_NEAR(correlation_of(Sampler(JitterShape::kUniform, r).draw(100'000)),
                    6 / std::numbers::pi * std::asin(r / 2), tolerance);
        const double gamma = correlation_of(Sampler(JitterShape::kGamma, r).draw(100'000));
        EXPECT_LT(gamma, r + tolerance);
        EXPECT_GT(gamma, 0.9 * r);
    }
}

// z(n) = r z(n-1) + sqrt(1 - r^2) e(n), with e(n) what a chain that begins at n draws.
TEST(Jitter, ChainFollowsThePacketBefore) {
    Sampler chain(JitterShape::kNormal, 0.6);
    double z = chain.jitter.deviate(0);
    for (std::uint64_t packet = 1; packet < 50; ++packet) {
        z = 0.6 * z + 0.8 * Sampler(JitterShape::kNormal, 0.6).jitter.deviate(packet);
        ASSERT_NEAR(chain.jitter.deviate(packet), z, 1e-9) << packet;
    }
}

// A chain that was left, for lack of correlation or of a packet, is stale: it begins anew where it is taken up again.
TEST(Jitter, AStaleChainBeginsAnew) {
    const auto begins_at = [](std::uint64_t packet) {
        return Sampler(JitterShape::kNormal, 0.9).jitter.deviate(packet);
    };
    Sampler chain(JitterShape::kNormal, 0.9);
    for (std::uint64_t packet = 0; packet < 10; ++packet) chain.jitter.deviate(packet);
    chain.jitter.configure(chain.deviates, 0);
    for (std::uint64_t packet = 10; packet < 20; ++packet) chain.jitter.deviate(packet);
    chain.jitter.configure(chain.deviates, 0.9);
    EXPECT_EQ(chain.jitter.deviate(20), begins_at(20));
    EXPECT_NE(chain.jitter.deviate(21), begins_at(21));
    EXPECT_EQ(chain.jitter.deviate(23), begins_at(23));
    EXPECT_EQ(chain.jitter.deviate(23), begins_at(23));
    EXPECT_EQ(chain.jitter.deviate(0), begins_at(0));
    EXPECT_NE(chain.jitter.deviate(1), begins_at(1));
}

TEST(Jitter, ChainStartsStationary) {
    std::vector<double> firsts;
    for (std::uint32_t trial = 0; trial < 4000; ++trial) {
        StreamKey key = kKey;
        key.trial = trial;
        firsts.push_back(Sampler(JitterShape::kNormal, 0.99, key).jitter.deviate(0));
    }
    EXPECT_LT(ks_distance(firsts, normal_below), ks_limit(4000));
}

// The quantile functions: against closed forms, and against their own mean and variance.
DelayShape shape_of(JitterShape shape, double delay_per_spread = 4) {
    JitterSettings settings{.shape = shape, .spread = milliseconds{1}};
    if (shape == JitterShape::kTable) settings.table = std::make_shared<JitterTable>(std::vector{-1.0, 1.0});
    return {settings, from_seconds(1e-3 * delay_per_spread)};
}

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
        // Beyond the integral's end a Pareto tail holds 4 / 10^6 of its variance. The table is -1 and 1: half of it is one of
        // the two, the rest a straight line between them.
        const double variance = shape == JitterShape::kTable ? (1 + 1.0 / 3) / 2 : 1;
        EXPECT_NEAR(found.variance, variance, 1e-4) << static_cast<int>(shape);
    }
    EXPECT_NEAR(moments(shape_of(JitterShape::kUniform)).variance, 1.0 / 3, 1e-6);  // half width 1
}

TEST(DelayShape, RisesWithItsArgument) {
    for (const JitterShape shape : kEveryShape) {
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
            const double exact = z < 0 ? boost::math::gamma_p_inv(k, normal_below(z))
                                       : boost::math::gamma_q_inv(k, normal_below(-z));
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
            EXPECT_NEAR(deviates.at_normal(z), deviates.at_uniform(normal_below(z)), 1e-10);
        }
    }
}

TEST(JitterTable, StraightLinesBetweenItsDeviates) {
    const JitterTable table({-2, -1, 1, 2});
    for (const auto& [share, deviate] :
         {std::pair{0.0, -2.0}, {0.125, -2}, {0.375, -1}, {0.5, 0}, {0.75, 1.5}, {1, 2}})
        EXPECT_EQ(table.quantile(share), deviate) << share;
}

}  // namespace
}  // namespace thimble::test
