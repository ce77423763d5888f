// Draws of parameters: within their ranges, independent, the same for the same seed.
#include <cmath>

#include <gtest/gtest.h>

#include "study/sweeps/variation.hpp"

namespace thimble {
namespace {

TEST(JointDraws, AreAFunctionOfTheSeed) {
    const auto& ranges = documented_ranges();
    EXPECT_EQ(draw_jointly(ranges, 7).values, draw_jointly(ranges, 7).values);
    EXPECT_NE(draw_jointly(ranges, 7).values, draw_jointly(ranges, 8).values);
}

TEST(JointDraws, AFurtherParameterChangesNoOther) {
    std::vector<ParameterRange> ranges = documented_ranges();
    const std::vector<double> all = draw_jointly(ranges, 3).values;
    ranges.resize(5);
    const std::vector<double> five = draw_jointly(ranges, 3).values;
    ASSERT_EQ(five.size(), 5U);
    for (std::size_t i = 0; i < five.size(); ++i) EXPECT_EQ(five[i], all[i]);
}

TEST(JointDraws, FillTheirRangesEvenlyAndIndependently) {
    const std::vector<ParameterRange> ranges{parse_parameter_range("a.a=2:6"),
                                             parse_parameter_range("a.b=-1:1")};
    constexpr int kDraws = 4000;
    double mean[2] = {0, 0}, product = 0;
    for (int i = 0; i < kDraws; ++i) {
        const JointDraw draw = draw_jointly(ranges, static_cast<std::uint64_t>(i));
        for (std::size_t k = 0; k < 2; ++k) {
            ASSERT_GE(draw.values[k], ranges[k].low);
            ASSERT_LT(draw.values[k], ranges[k].high);
            mean[k] += draw.values[k] / kDraws;
        }
        product += (draw.values[0] - 4) * draw.values[1] / kDraws;
    }
    // Four standard errors: 4 / sqrt(12) / sqrt(4000) x 4, and so on.
    EXPECT_NEAR(mean[0], 4, 0.074);
    EXPECT_NEAR(mean[1], 0, 0.037);
    EXPECT_NEAR(product, 0, 0.043);
}

}  // namespace
}  // namespace thimble
