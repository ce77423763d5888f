#include "analysis/statistics/mann_whitney.hpp"

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(MannWhitney, AgreesWithRAndScipy) {
    int with_exact = 0;
    for (const auto& g : golden("two")) {
        SCOPED_TRACE(g.at("name"));
        const MannWhitney result = mann_whitney(column("a", g.at("first")), column("b", g.at("second")));
        EXPECT_EQ(result.u, g.at("u").get<double>());
        EXPECT_TRUE(close(result.p_asymptotic, g.at("p"), 1e-10));
        ASSERT_EQ(result.p_exact.has_value(), g.at("p_exact").is_number());
        if (result.p_exact) {
            EXPECT_TRUE(close(*result.p_exact, g.at("p_exact"), 1e-11));
            ++with_exact;
        }
        EXPECT_EQ(result.p(), result.p_exact ? *result.p_exact : result.p_asymptotic);
    }
    EXPECT_GE(with_exact, 8);
}

TEST(MannWhitney, ByHand) {
    // One of the 20 ways to choose three of six places, at either end.
    const MannWhitney apart = mann_whitney({"a", {1, 2, 3}}, {"b", {4, 5, 6}});
    EXPECT_EQ(apart.u, 0);
    EXPECT_EQ(apart.superiority, 0);
    EXPECT_TRUE(close(*apart.p_exact, 0.1, 1e-15));
    const MannWhitney even = mann_whitney({"a", {1, 4}}, {"b", {2, 3}});
    EXPECT_EQ(even.superiority, 0.5);
    EXPECT_EQ(*even.p_exact, 1);
    EXPECT_EQ(even.p_asymptotic, 1);  // the continuity correction does not reach beyond the middle
    const MannWhitney tied = mann_whitney({"a", {1, 2}}, {"b", {2, 3}});
    EXPECT_EQ(tied.u, 0.5);
    EXPECT_FALSE(tied.p_exact.has_value());
}

TEST(MannWhitney, Refuses) {
    expect_refused([] { mann_whitney({"HF", {}}, {"CF", {1}}); }, {"HF", "0 values"});
    expect_refused([] { mann_whitney({"HF", {1, 1}}, {"CF", {1}}); }, {"HF", "CF", "equal"});
    expect_refused([] { mann_whitney({"HF", {1, 1}}, {"CF", {kMissing}}); }, {"CF", "row 1"});
}

}  // namespace
}  // namespace thimble
