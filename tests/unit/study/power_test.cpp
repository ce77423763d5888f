// Power is counted over studies that are drawn from a pool of virtual subjects.
#include "study/power/power.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/power/power_report.hpp"

namespace thimble {
namespace {

PowerOptions small_pool() {
    PowerOptions options;
    options.pool = 10;
    options.trials = 1;
    options.studies = 20;
    return options;
}

const PowerComparison& find(const PowerResult& result, const std::string& name) {
    for (const PowerComparison& comparison : result.comparisons)
        if (name_of(comparison) == name) return comparison;
    throw std::out_of_range(name);
}

TEST(Power, ALargeDifferenceNeedsTheFewestThatCanBeJudged) {
    const PowerOptions options = small_pool();
    const PowerResult result = plan_power({}, options);
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.comparisons.size(), 18U);
    const auto needed = find(result, "HF - VF, mean penetration, 50 ms").subjects.at(1);
    ASSERT_TRUE(needed.has_value());
    EXPECT_GE(*needed, 8U);  // with six pairs fewer subjects cannot differ significantly
    EXPECT_LE(*needed, 20U);
    const auto json = to_json(result, options);
    EXPECT_EQ(json.at("comparisons").size(), 18U);
    EXPECT_EQ(json.at("comparisons")[0].at("subjects_by_trials").size(), 1U);
}

TEST(Power, ACoarseIntervalIsNarrowWithTheFewest) {
    PowerOptions options = small_pool();
    options.precision_m = 1;
    const PowerResult result = plan_power({}, options);
    EXPECT_EQ(find(result, "HF - CF, maximum penetration, 50 ms").subjects.at(1), 8U);
    EXPECT_EQ(power_tables(result, options).size(), 1U);
}

}  // namespace
}  // namespace thimble
