// The exact null distribution against every arrangement there is, one by one.
#include <algorithm>

#include <gtest/gtest.h>

#include "analysis/statistics/friedman.hpp"
#include "tests/allocation_count.hpp"
#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

using Rows = std::vector<std::vector<std::int64_t>>;

std::int64_t spread_of(const std::vector<std::int64_t>& sums) {
    std::int64_t total = 0;
    for (const std::int64_t sum : sums) total += sum;
    const auto k = static_cast<std::int64_t>(sums.size());
    std::int64_t spread = 0;
    for (const std::int64_t sum : sums) spread += (sum - total / k) * (sum - total / k);
    return spread;
}

// Visits the spread of every combination of arrangements, repeated ones too: all k! of each row.
template <class Visit>
void enumerate(const Rows& rows, std::size_t row, std::vector<std::int64_t>& sums, const Visit& visit) {
    if (row == rows.size()) return visit(spread_of(sums));
    std::vector<std::size_t> order(sums.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    do {
        for (std::size_t i = 0; i < order.size(); ++i) sums[i] += rows[row][order[i]];
        enumerate(rows, row + 1, sums, visit);
        for (std::size_t i = 0; i < order.size(); ++i) sums[i] -= rows[row][order[i]];
    } while (std::next_permutation(order.begin(), order.end()));
}

// The whole distribution: at every spread that occurs.
void expect_enumerated(const std::vector<std::vector<double>>& data) {
    Rows rows;
    for (const auto& row : data) rows.push_back(doubled_ranks(row));
    std::vector<std::int64_t> spreads;
    std::vector<std::int64_t> sums(rows.front().size(), 0);
    enumerate(rows, 0, sums, [&](std::int64_t spread) { spreads.push_back(spread); });
    std::sort(spreads.begin(), spreads.end());
    const auto all = static_cast<double>(spreads.size());
    for (auto it = spreads.begin(); it != spreads.end(); it = std::upper_bound(it, spreads.end(), *it)) {
        const double expected = static_cast<double>(spreads.end() - it) / all;
        const auto p = friedman_exact_p(rows, *it, kFriedmanExactSteps);
        ASSERT_TRUE(p.has_value());
        EXPECT_TRUE(close(*p, expected, 1e-13)) << "spread " << *it;
    }
    EXPECT_EQ(friedman_exact_p(rows, spreads.back() + 1, kFriedmanExactSteps), 0.0);
}

std::vector<std::vector<double>> same_rows(std::size_t n, const std::vector<double>& row) {
    return std::vector<std::vector<double>>(n, row);
}

TEST(FriedmanExact, EveryArrangementWithoutTies) {
    for (const std::size_t n : {2U, 3U, 8U, 12U}) expect_enumerated(same_rows(n, {1, 2}));
    for (const std::size_t n : {2U, 3U, 5U, 7U}) expect_enumerated(same_rows(n, {1, 2, 3}));
    for (const std::size_t n : {2U, 3U, 4U}) expect_enumerated(same_rows(n, {1, 2, 3, 4}));
    for (const std::size_t n : {2U, 3U}) expect_enumerated(same_rows(n, {1, 2, 3, 4, 5}));
    expect_enumerated(same_rows(2, {1, 2, 3, 4, 5, 6}));
}

TEST(FriedmanExact, EveryArrangementWithTies) {
    expect_enumerated({{1, 1, 2}, {1, 2, 2}, {1, 2, 3}, {5, 5, 5}, {3, 1, 1}});
    expect_enumerated({{1, 1, 2, 2}, {1, 2, 2, 2}, {4, 3, 2, 1}, {1, 1, 2, 3}});
    expect_enumerated({{1, 1, 1, 2}, {2, 1, 1, 1}, {1, 1, 2, 1}});
    expect_enumerated({{1, 1, 2, 2, 3}, {1, 2, 3, 4, 5}, {1, 1, 1, 1, 2}});
}

TEST(FriedmanExact, TheClaimsFigure) {
    // Ten subjects, one condition always last, the other three with equal rank sums.
    std::vector<std::vector<double>> columns(4);
    for (int i = 0; i < 10; ++i) {
        const bool up = i % 2 == 0;
        columns[0].push_back(up ? 1 : 3);
        columns[1].push_back(2);
        columns[2].push_back(up ? 3 : 1);
        columns[3].push_back(4);
    }
    const Friedman result = friedman(table(columns));
    EXPECT_EQ(result.chi_squared, 18);
    ASSERT_TRUE(result.p_exact.has_value());
    EXPECT_NEAR(*result.p_exact, 7e-5, 0.5e-5);
    EXPECT_NEAR(result.p_asymptotic, 4e-4, 0.5e-4);
    EXPECT_EQ(result.p(), *result.p_exact);
}

TEST(FriedmanExact, PublishedTable) {
    // Friedman 1937 and every table since: k = 3, n = 5, chi-squared 6.4 is P = .039; k = 4, n = 4, 7.8 is .036.
    EXPECT_NEAR(*friedman_exact_p(Rows(5, {2, 4, 6}), 4 * 32, 1000000), 0.039, 0.0005);
    EXPECT_NEAR(*friedman_exact_p(Rows(4, {2, 4, 6, 8}), 4 * 52, 1000000), 0.036, 0.0005);
}

TEST(FriedmanExact, SaysWhenItGivesUp) {
    EXPECT_FALSE(friedman_exact_p(Rows(10, {2, 4, 6, 8}), 100, 1000).has_value());
    EXPECT_TRUE(friedman_exact_p(Rows(30, {2, 4, 6, 8}), 100, kFriedmanExactSteps).has_value());
    EXPECT_FALSE(friedman_exact_p(Rows(60, {2, 4, 6, 8}), 100, kFriedmanExactSteps).has_value());
    EXPECT_TRUE(friedman_exact_p(Rows(10, {2, 4, 6, 8}), 100, 1'000'000).has_value());
    // 24 conditions: neither do 24! arrangements fit, nor their sums into 64 bits.
    std::vector<std::int64_t> wide;
    for (int i = 1; i <= 24; ++i) wide.push_back(2 * i);
    EXPECT_FALSE(friedman_exact_p(Rows(3, wide), 100, kFriedmanExactSteps).has_value());
}

// 10! arrangements of one row are fewer than the steps, and take 0.4 GB.
TEST(FriedmanExact, GivesUpBeforeTheArrangementsTakeMemory) {
    std::vector<std::int64_t> ten;
    for (int i = 1; i <= 10; ++i) ten.push_back(2 * i);
    const auto before = test::allocation_count();
    EXPECT_FALSE(friedman_exact_p(Rows(2, ten), 100, kFriedmanExactSteps).has_value());
    EXPECT_LT(test::allocation_count() - before, 100U);
    EXPECT_TRUE(friedman_exact_p(Rows(1, {2, 5, 5, 8, 10}), 0, 60).has_value());  // 5! / 2!
    EXPECT_FALSE(friedman_exact_p(Rows(1, {2, 5, 5, 8, 10}), 0, 59).has_value());
}

}  // namespace
}  // namespace thimble
