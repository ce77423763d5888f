#include "analysis/statistics/location_shift.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

LocationShift signed_rank_of(std::vector<double> differences, std::size_t family = 1) {
    return signed_rank({"d", std::move(differences)}, family);
}

LocationShift rank_sum_of(std::vector<double> first, std::vector<double> second, std::size_t family = 1) {
    return rank_sum({"a", std::move(first)}, {"b", std::move(second)}, family);
}

// R's intervals, where so few values cannot be significant, are the whole range.
void expect_shift(const LocationShift& one, const LocationShift& of_six, const nlohmann::json& expected) {
    const auto number = [&](const char* key, std::size_t i) { return expected.at(key)[i].get<double>(); };
    const double rounding = 1e-12 * (number("interval_of_six", 1) - number("interval_of_six", 0));
    EXPECT_TRUE(close(one.estimate, expected.at("estimate"), 1e-12, rounding));
    EXPECT_TRUE(close(one.p, expected.at("p"), 1e-11));
    EXPECT_TRUE(close(of_six.p, std::min(1.0, 6 * expected.at("p").get<double>()), 1e-11));
    for (const auto& [shift, key] : {std::pair{one, "interval"}, {of_six, "interval_of_six"}}) {
        if (!shift.interval) continue;
        EXPECT_TRUE(close(shift.interval->low, number(key, 0), 1e-12, rounding));
        EXPECT_TRUE(close(shift.interval->high, number(key, 1), 1e-12, rounding));
    }
}

TEST(LocationShift, SignedRankAgreesWithRAndScipy) {
    int intervals = 0;
    for (const auto& g : golden("signed_rank")) {
        SCOPED_TRACE(g.at("name"));
        const std::vector<double> x = numbers(g.at("values"));
        expect_shift(signed_rank_of(x), signed_rank_of(x, 6), g);
        intervals += signed_rank_of(x, 6).interval.has_value();
    }
    EXPECT_GE(intervals, 10);
}

TEST(LocationShift, RankSumAgreesWithRAndScipy) {
    int intervals = 0;
    for (const auto& g : golden("rank_sum")) {
        SCOPED_TRACE(g.at("name"));
        const std::vector<double> a = numbers(g.at("first")), b = numbers(g.at("second"));
        expect_shift(rank_sum_of(a, b), rank_sum_of(a, b, 6), g);
        intervals += rank_sum_of(a, b, 6).interval.has_value();
    }
    EXPECT_GE(intervals, 9);
}

// Every choice of signs one by one, of ranks in the order least favourable to a difference.
double p_by_enumeration(const std::vector<double>& d) {
    const auto sum_if = [&](int sign) {  // largest sum of the ranks that do not have the other sign
        std::vector<double> order = d;
        std::sort(order.begin(), order.end(), [&](double a, double b) {
            return std::abs(a) != std::abs(b) ? std::abs(a) < std::abs(b) : sign * a < sign * b;
        });
        std::size_t sum = 0;
        for (std::size_t i = 0; i < order.size(); ++i) sum += sign * order[i] >= 0 ? i + 1 : 0;
        return sum;
    };
    const std::size_t observed = std::min(sum_if(1), sum_if(-1));
    std::size_t as_small = 0;
    for (std::size_t signs = 0; signs < (1U << d.size()); ++signs) {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < d.size(); ++i) sum += (signs >> i & 1U) * (i + 1);
        as_small += sum <= observed;
    }
    return std::min(1.0, 2 * static_cast<double>(as_small) / static_cast<double>(1U << d.size()));
}

TEST(LocationShift, TiesAndZerosSpeakAgainstADifference) {
    EXPECT_EQ(signed_rank_of({1, 2, 3, 4, 5, 6}).p, 2.0 / 64);
    EXPECT_EQ(signed_rank_of({0, 2, 3, 4, 5, 6}).p, 4.0 / 64);  // as if the zero were below
    EXPECT_EQ(signed_rank_of({3, 3, 3, 3, 3, 3}).p, 2.0 / 64);  // ties of one sign cost nothing
    const LocationShift zeros = signed_rank_of({0, 0, 0, 0, 0, 0});
    EXPECT_EQ(zeros.p, 1);
    EXPECT_EQ(zeros.estimate, 0);
    EXPECT_EQ(zeros.rank_biserial, 0);
    std::mt19937 random(7);
    for (int i = 0; i < 300; ++i) {
        std::vector<double> d(1 + random() % 9);
        for (double& value : d) value = static_cast<double>(random() % 7) - 2;
        EXPECT_DOUBLE_EQ(signed_rank_of(d).p, p_by_enumeration(d));
    }
}

// With integers, which tie, as well as without ties.
TEST(LocationShift, TheIntervalExcludesZeroExactlyIfPIsBelowTheLevel) {
    std::mt19937 random(11);
    int apart = 0, not_apart = 0;
    for (int i = 0; i < 2000; ++i) {
        const std::size_t n = 4 + random() % 14, family = 1 + random() % 6;
        const double shift = 0.25 * static_cast<double>(random() % 12), step = i % 2 == 0 ? 1 : 0.017;
        std::vector<double> a(n), b(4 + random() % 10);
        for (std::vector<double>* values : {&a, &b}) {
            for (double& value : *values) value = step * static_cast<double>(random() % 6);
        }
        for (double& value : a) value += step * std::floor(4 * shift);
        for (const LocationShift& found : {signed_rank_of(a, family), rank_sum_of(a, b, family)}) {
            if (!found.interval) {
                EXPECT_GE(found.p, 0.05);
                continue;
            }
            const bool excludes = found.interval->low > 0 || found.interval->high < 0;
            EXPECT_EQ(excludes, found.p < 0.05)
                << found.interval->low << " " << found.interval->high << " " << found.p;
            EXPECT_LE(found.interval->low, found.estimate);
            EXPECT_GE(found.interval->high, found.estimate);
            (excludes ? apart : not_apart) += 1;
        }
    }
    EXPECT_GT(apart, 300);
    EXPECT_GT(not_apart, 300);
}

TEST(LocationShift, TooFewValuesHaveNoInterval) {
    EXPECT_EQ(fewest_for_signed_rank(), 6U);
    EXPECT_EQ(fewest_for_signed_rank(6), 8U);
    EXPECT_EQ(fewest_for_rank_sum(), 4U);
    EXPECT_EQ(fewest_for_rank_sum(6), 5U);
    const std::vector<double> seven{1, 2, 3, 4, 5, 6, 7};
    EXPECT_FALSE(signed_rank_of(seven, 6).interval);
    EXPECT_EQ(signed_rank_of(seven, 6).p, 6 * 2.0 / 128);
    EXPECT_EQ(signed_rank_of(seven, 6).estimate, 4);
    EXPECT_TRUE(signed_rank_of({1, 2, 3, 4, 5, 6, 7, 8}, 6).interval);
    EXPECT_FALSE(rank_sum_of({1, 2, 3}, {4, 5, 6}).interval);
    EXPECT_TRUE(rank_sum_of({1, 2, 3, 4}, {5, 6, 7, 8}).interval);
}

// Beyond the exact sizes nothing jumps.
TEST(LocationShift, TheNormalDistributionContinuesTheExactOne) {
    std::vector<double> d(kSignedRankExact);
    std::iota(d.begin(), d.end(), -90.5);
    const LocationShift exact = signed_rank_of(d);
    d.push_back(9.5);
    const LocationShift normal = signed_rank_of(d);
    EXPECT_NEAR(normal.p, exact.p, 0.02);
    EXPECT_NEAR(normal.interval->low, exact.interval->low, 0.5);
    EXPECT_NEAR(normal.interval->high, exact.interval->high, 0.5);
    std::vector<double> a(50), b(50);
    std::iota(a.begin(), a.end(), 8.25);
    std::iota(b.begin(), b.end(), 0);
    const double exact_p = rank_sum_of(a, b).p;
    a.push_back(33);
    EXPECT_NEAR(rank_sum_of(a, b).p, exact_p, 0.005);
}

TEST(LocationShift, EffectIsTheShareAboveLessTheShareBelow) {
    EXPECT_EQ(signed_rank_of({1, 2, 3}).rank_biserial, 1);
    EXPECT_EQ(signed_rank_of({-1, 2, 3}).rank_biserial, 4.0 / 6);
    EXPECT_EQ(rank_sum_of({1, 2}, {3, 4}).rank_biserial, -1);
}

TEST(LocationShift, Refuses) {
    expect_refused([] { signed_rank_of({}); }, {"signed-rank test", "at least 1"});
    expect_refused([] { signed_rank_of({1, kMissing}); }, {"signed-rank test", "row 2"});
    expect_refused([] { rank_sum_of({1}, {kInfinite}); }, {"rank-sum test", "'b'"});
    expect_refused([] { signed_rank_of({1}, 0); }, {"family"});
    expect_refused([] { signed_rank({"d", {1}}, 1, 1.5); }, {"(0, 1)"});
}

}  // namespace
}  // namespace thimble
