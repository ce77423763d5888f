// The delay that a fitted person's hand bears is the theory's, for the hand of the fit.

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "study/fit/fit.hpp"
#include "study/loop_limits.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

class PersonBound : public testing::Test {
  protected:
    std::vector<DelayBound> bounds(const std::string& arm) const {
        const auto fit = directory_.path() / "fit.json";
        std::ofstream(fit) << R"({"parameters": {"operator.arm_stiffness_N_per_m": )" << arm << "}}";
        return delay_bounds(load_system_settings("", twin_of(fit)), fit);
    }

    TemporaryDirectory directory_;
};

TEST_F(PersonBound, TheFirstRowIsTheSessionsOwnLoop) {
    const auto rows = bounds(R"({"median": 500, "low": 300, "high": 700})");
    ASSERT_EQ(rows.size(), 7U);
    SystemSettings person = load_system_settings("");
    EXPECT_NEAR(rows[0].stiffness_N_per_m, 9000, 1e-6);
    person.person.hand.arm_stiffness_N_per_m = 500;
    EXPECT_EQ(rows[0].median_s, loop_limits(person).critical_delay_s);
    double least_s = rows[0].median_s;
    for (const double end : {300, 700}) {
        person.person.hand.arm_stiffness_N_per_m = end;
        least_s = std::min(least_s, loop_limits(person).critical_delay_s);
    }
    EXPECT_EQ(rows[0].least_s, least_s);
    EXPECT_LT(least_s, rows[0].median_s);
}

TEST_F(PersonBound, ASofterFixtureBearsMoreDelay) {
    const auto rows = bounds(R"({"median": 500, "low": 300, "high": 700})");
    for (std::size_t i = 1; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].stiffness_N_per_m, rows[i - 1].stiffness_N_per_m / 2);
        EXPECT_GT(rows[i].median_s, rows[i - 1].median_s);
        EXPECT_LE(rows[i].least_s, rows[i].median_s);
    }
    EXPECT_EQ(bounds_table(rows).rows.size(), rows.size());
}

TEST_F(PersonBound, AFitWithoutAnIntervalHasItsMedianOnly) {
    for (const char* arm : {R"({"median": 500})", R"({"median": 500, "low": "much", "high": null})"})
        for (const DelayBound& row : bounds(arm)) EXPECT_EQ(row.least_s, row.median_s);
}

}  // namespace
}  // namespace thimble
