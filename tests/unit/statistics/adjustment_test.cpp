#include <gtest/gtest.h>

#include "analysis/statistics/pairwise.hpp"
#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(Adjustment, AgreesWithR) {
    for (const auto& g : golden("adjustments")) {
        const std::vector<double> p = numbers(g.at("p"));
        SCOPED_TRACE(g.at("p").dump());
        const auto by_bonferroni = bonferroni(p);
        const auto by_holm = holm(p);
        for (std::size_t i = 0; i < p.size(); ++i) {
            EXPECT_TRUE(close(by_bonferroni[i], g.at("bonferroni")[i], 1e-15));
            EXPECT_TRUE(close(by_holm[i], g.at("holm")[i], 1e-15));
        }
    }
}

TEST(Adjustment, ByHand) {
    // 3 x .01, 2 x .03 and 1 x .04 that may not fall below the one before.
    EXPECT_EQ(holm({0.03, 0.01, 0.04}), (std::vector<double>{0.06, 0.03, 0.06}));
    EXPECT_EQ(bonferroni({0.25, 0.5}), (std::vector<double>{0.5, 1}));
    EXPECT_TRUE(holm({}).empty());
}

TEST(Adjustment, RefusesWhatIsNoProbability) {
    for (const double p : {-0.1, 1.1, kMissing}) {
        expect_refused([&] { bonferroni({0.5, p}); }, {"adjustment", "not in [0, 1]"});
        expect_refused([&] { holm({0.5, p}); }, {"adjustment", "not in [0, 1]"});
    }
}

}  // namespace
}  // namespace thimble
