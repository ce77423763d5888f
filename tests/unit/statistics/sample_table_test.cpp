#include "analysis/statistics/sample_table.hpp"

#include <gtest/gtest.h>

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

TEST(SampleTable, RowsAreSubjects) {
    const SampleTable values = SampleTable::from_columns({{"HF", {1, 2, 3}}, {"CF", {4, 5, 6}}});
    EXPECT_EQ(values.subjects(), 3U);
    EXPECT_EQ(values.conditions(), 2U);
    EXPECT_EQ(values.name(1), "CF");
    EXPECT_EQ(values.at(2, 1), 6);
    EXPECT_EQ(std::vector<double>(values.row(1).begin(), values.row(1).end()), (std::vector<double>{2, 5}));
    EXPECT_EQ(values.column(0).name, "HF");
    EXPECT_EQ(values.column(0).values, (std::vector<double>{1, 2, 3}));
}

TEST(SampleTable, Refuses) {
    const auto make = [](const std::vector<NamedValues>& columns) {
        return SampleTable::from_columns(columns);
    };
    expect_refused([&] { make({}); }, {"no column"});
    expect_refused([&] { make({{"HF", {}}, {"CF", {}}}); }, {"HF", "0 values"});
    expect_refused([&] { make({{"HF", {1, 2}}, {"CF", {1}}}); }, {"'CF' has 1", "'HF' has 2"});
    expect_refused([&] { make({{"HF", {1, 2}}, {"CF", {1, kMissing}}}); }, {"CF", "row 2", "nan"});
    expect_refused([&] { make({{"HF", {1, kInfinite}}, {"CF", {1, 2}}}); }, {"HF", "row 2", "inf"});
    expect_refused([&] { make({{"HF", {1}}, {"HF", {2}}}); }, {"two columns", "HF"});
    expect_refused([&] { make({{"HF", {1}}, {"", {2}}}); }, {"column 2", "no name"});
}

TEST(CompleteRows, LeavesIncompleteSubjectsOutAndSaysWhich) {
    const CompleteRows rows = complete_rows(
        {{"HF", {1, kMissing, 3, 4}}, {"CF", {5, 6, 7, kMissing}}, {"VF", {8, kMissing, 9, 10}}});
    EXPECT_EQ(rows.dropped, (std::vector<std::size_t>{1, 3}));
    EXPECT_EQ(rows.table.subjects(), 2U);
    EXPECT_EQ(rows.table.column(0).values, (std::vector<double>{1, 3}));
    EXPECT_EQ(rows.table.column(2).values, (std::vector<double>{8, 9}));
    EXPECT_TRUE(complete_rows({{"HF", {1, 2}}}).dropped.empty());
}

TEST(CompleteRows, Refuses) {
    expect_refused([] { complete_rows({{"HF", {kMissing}}, {"CF", {1}}}); }, {"no row is complete"});
    expect_refused([] { complete_rows({{"HF", {1, 2}}, {"CF", {1}}}); }, {"'CF' has 1"});
    expect_refused([] { complete_rows({{"HF", {1, kInfinite}}}); }, {"HF", "inf"});
}

}  // namespace
}  // namespace thimble
