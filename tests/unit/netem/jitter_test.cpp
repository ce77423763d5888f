// What a stream of packets gets: the shape as its marginal, whatever the correlation; and the correlation.
#include "netem/stages/jitter.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include <boost/math/special_functions/gamma.hpp>
#include <gtest/gtest.h>

#include "netem/jitter_table.hpp"
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

INSTANTIATE_TEST_SUITE_P(Jitter, EachShape,
                         testing::Values(JitterShape::kUniform, JitterShape::kNormal, JitterShape::kGamma,
                                         JitterShape::kPareto, JitterShape::kParetoNormal,
                                         JitterShape::kTable));

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
        const double fresh = Sampler(JitterShape::kNormal, 0.6).jitter.deviate(packet);
        z = 0.6 * z + 0.8 * fresh;
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

}  // namespace
}  // namespace thimble::test
