// How claims are counted and classed.
#include "study/sweeps/claim_tally.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace thimble {
namespace {

Claim claim(std::optional<bool> reproduced, std::optional<bool> direction, bool had_trials = true) {
    return {"E0.test", "a claim", "a test", "a number", reproduced, direction, had_trials};
}

ClaimTally tally_of(int studies, int reproduced, int direction) {
    ClaimTally tally;
    for (int i = 0; i < studies; ++i) tally.add({claim(i < reproduced, i < direction)});
    return tally;
}

TEST(ClaimTally, CountsSignificanceAndDirectionApart) {
    const ClaimTally tally = tally_of(100, 30, 95);
    EXPECT_EQ(tally.studies(), 100U);
    const ClaimCount& count = tally.counts().at(0);
    EXPECT_DOUBLE_EQ(count.fraction(), 0.30);
    EXPECT_DOUBLE_EQ(count.direction_fraction(), 0.95);
    EXPECT_TRUE(count.fragile());
    EXPECT_NEAR(count.interval().low, 0.2189, 1e-4);  // Wilson, as any textbook
    EXPECT_NEAR(count.interval().high, 0.3958, 1e-4);
}

TEST(ClaimTally, ClassesFollowTheFractions) {
    const auto class_of = [](int reproduced, int direction) {
        return tally_of(100, reproduced, direction).counts()[0].classified();
    };
    EXPECT_EQ(class_of(96, 100), ClaimClass::kReproduced);  // 90.2 % by the lower end of its interval
    EXPECT_EQ(class_of(95, 100), ClaimClass::kDirection);   // 88.8 %
    EXPECT_EQ(class_of(0, 96), ClaimClass::kDirection);
    EXPECT_EQ(class_of(0, 95), ClaimClass::kLess);
}

TEST(ClaimTally, FewStudiesProveNoClass) {
    EXPECT_EQ(tally_of(34, 34, 34).counts()[0].classified(), ClaimClass::kLess);
    EXPECT_EQ(tally_of(35, 35, 35).counts()[0].classified(), ClaimClass::kReproduced);
}

// A claim that two things do not differ has no direction to fall back on.
TEST(ClaimTally, WithoutADirectionThereIsOnlyTheFraction) {
    ClaimTally tally;
    for (int i = 0; i < 10; ++i) tally.add({claim(i < 8, {})});
    const ClaimCount& count = tally.counts()[0];
    EXPECT_EQ(count.directed, 0U);
    EXPECT_FALSE(count.fragile());
    EXPECT_EQ(count.classified(), ClaimClass::kLess);
    EXPECT_FALSE(to_json(count).contains("direction_fraction"));
}

TEST(ClaimTally, TooFewSubjectsSayNothing) {
    ClaimTally tally;
    Claim few = claim({}, {});
    few.too_few = true;
    tally.add({few});
    EXPECT_EQ(tally.counts()[0].classified(), ClaimClass::kNotJudged);
    EXPECT_FALSE(tally.counts()[0].fragile());
}

TEST(ClaimTally, AnExperimentThatWasNotRunSaysNothing) {
    ClaimTally tally;
    tally.add({claim({}, {}, false)});
    EXPECT_EQ(tally.counts()[0].classified(), ClaimClass::kNotJudged);
    EXPECT_EQ(tally.fragile(), 0U);
    EXPECT_TRUE(to_json(tally.counts()[0]).at("reproduced").is_null());
    EXPECT_FALSE(to_json(tally.counts()[0]).contains("fraction"));
}

// A study whose data a test refuses has not reproduced the claim, the first study included.
TEST(ClaimTally, RefusedDataAreNoReproduction) {
    ClaimTally tally;
    tally.add({claim({}, {})});
    EXPECT_EQ(tally.counts()[0].classified(), ClaimClass::kLess);
    EXPECT_EQ(tally.fragile(), 1U);
    EXPECT_EQ(to_json(tally.counts()[0]).at("fraction"), 0.0);
    tally.add({claim(true, true)});
    EXPECT_EQ(tally.counts()[0].judged, 1U);
    EXPECT_EQ(tally.counts()[0].fraction(), 0.5);
    EXPECT_EQ(tally.counts()[0].direction_fraction(), 0.5);
    const auto json = to_json(tally.counts()[0]);
    EXPECT_EQ(json.at("class"), "less often");
    EXPECT_EQ(json.at("reproduced"), false);
    EXPECT_EQ(json.at("direction"), false);
    EXPECT_EQ(json.at("studies_judged"), 1);
    EXPECT_EQ(json.at("studies"), 2);
    EXPECT_EQ(json.at("fraction"), 0.5);
}

TEST(ClaimTally, TheFragileTableHoldsTheFragile) {
    ClaimTally tally = tally_of(10, 7, 10);
    EXPECT_EQ(tally_table("t", tally, "seeds", true).rows.size(), 1U);
    EXPECT_EQ(tally_table("t", tally_of(10, 8, 10), "seeds", true).rows.size(), 0U);
    EXPECT_EQ(tally_table("t", tally_of(10, 8, 10), "seeds", false).rows.size(), 1U);
}

}  // namespace
}  // namespace thimble
