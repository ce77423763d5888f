// Power is counted over studies that are drawn from a pool of virtual subjects.
#include "study/power/power.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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
    const std::vector<ReportTable> tables = power_tables(result, options);
    ASSERT_EQ(tables.size(), 1U);
    EXPECT_THAT(tables[0].title, HasSubstr("intervals of +-1000 mm at most"));
    // Time has no interval that was asked for.
    EXPECT_EQ(result.comparisons.size(), 12U);
    for (const PowerComparison& comparison : result.comparisons) {
        EXPECT_NE(comparison.metric, Metric::kCompletionTime);
        EXPECT_EQ(comparison.with_a_value, options.pool);
    }
    EXPECT_EQ(to_json(result, options).at("comparisons")[0].at("subjects_with_a_value"), options.pool);
}

// Those who have a value all differ, but three of four drawn subjects have none.
TEST(Power, ADrawnSubjectWithoutAValueIsMissingInItsStudy) {
    const PowerOptions options = small_pool();
    PowerPair pair{{"HF - CF", {1, 2, 3, 4, 5}}, 6};
    EXPECT_EQ(share_of_studies(pair, 8, options), 1.0);
    pair.differences.values.resize(20, std::nan(""));
    EXPECT_EQ(share_of_studies(pair, 8, options), 0.0);
    EXPECT_EQ(share_of_studies(pair, 16, options), 0.0);
    EXPECT_EQ(share_of_studies(pair, 80, options), 1.0);
    pair.precision = 10;
    EXPECT_EQ(share_of_studies(pair, 8, options), 0.0);
    EXPECT_EQ(share_of_studies(pair, 80, options), 1.0);
}

// As HF's completion time where no trial with HF comes to its end. 0 would read as "no difference".
TEST(Power, ADifferenceThatNobodyHasIsNoNumber) {
    const PowerOptions options = small_pool();
    PowerResult result;
    result.comparisons.push_back({Metric::kCompletionTime, "HF", "CF", 0.05, {}, 0, {{1, {}}}, {}});
    EXPECT_TRUE(to_json(result, options).at("comparisons")[0].at("difference").is_null());
    EXPECT_EQ(power_tables(result, options).at(0).rows.at(0).at(1), kDash);
}

TEST(Power, AReportOfAnotherCommandStays) {
    const TemporaryDirectory folder;
    EXPECT_NO_THROW(refuse_other_report(folder.path()));
    write_text(folder / "report.html", "a study's");
    EXPECT_THAT(refusal([&] { refuse_other_report(folder.path()); }, ExitCode::kUsage),
                AllOf(HasSubstr("report.html"), HasSubstr("--overwrite")));
}

TEST(Power, TheReportSaysThatItsSubjectsAreVirtual) {
    const TemporaryDirectory folder;
    PowerOptions options = small_pool();
    options.studies = 1;
    PowerResult result;
    result.comparisons.push_back({Metric::kPenetrationMax, "HF", "CF", 0.05, 0.01, 7, {{1, 8}}, {}});
    write_power_report(result, options, "thimble power", {{"commit", "1234abcd"}}, folder.path());
    EXPECT_THAT(read_text(folder / "report.html"),
                AllOf(HasSubstr("The subjects are virtual"), HasSubstr("1234abcd"),
                      HasSubstr("99.2 % for each"), HasSubstr(">7<")));
}

}  // namespace
}  // namespace thimble
