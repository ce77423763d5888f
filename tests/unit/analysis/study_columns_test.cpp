// The columns that tests of an experiment are about.
#include "analysis/tables/study_columns.hpp"

#include <gtest/gtest.h>

#include "tests/unit/analysis/paper_rows.hpp"

namespace thimble {
namespace {

TEST(StudyColumns, TakeAnExperimentsOwnTrials) {
    PaperRows table;
    table.add(3, 10, {0.03, 0.004, 0.005, 0.008}, {15, 11, 11, 11}, 0.05);
    table.add(3, 10, {0.001, 0.004, 0.005, 0.008}, {11, 11, 11, 11}, 0);
    EXPECT_TRUE(StudyColumns(table.rows, 1).empty());
    const StudyColumns three(table.rows, 3);
    EXPECT_EQ(three.rows().size(), 40U);
    const SampleTable max = three.table(Metric::kPenetrationMax).table;
    EXPECT_EQ(max.subjects(), 10U);
    EXPECT_EQ(max.name(0), "HF");
    EXPECT_GT(max.at(0, 0), 0.03);
}

// HF with several compensators are several conditions; with one it is HF.
TEST(StudyColumns, EachCompensatorIsAColumnOfItsOwn) {
    PaperRows table;
    table.add(3, 4, {0.03, 0.004, 0.005, 0.008}, {15, 11, 11, 11}, 0.05);
    std::vector<TrialRow> rows = table.rows;
    for (TrialRow& row : rows) {
        if (row.conditions.modality == Modality::kHF) row.conditions.compensator = Compensator::kTwoLayer;
    }
    EXPECT_EQ(StudyColumns(rows, 3).table(Metric::kPenetrationMean).table.name(0), "HF");
    for (TrialRow row : table.rows) {
        if (row.conditions.modality != Modality::kHF) continue;
        row.metrics.penetration_mean_m = 0.001 * row.conditions.subject;
        rows.push_back(row);
    }
    const SampleTable means = StudyColumns(rows, 3).table(Metric::kPenetrationMean).table;
    ASSERT_EQ(means.conditions(), 5U);
    EXPECT_EQ(means.name(0), "HF");
    EXPECT_EQ(means.name(1), "HF+two-layer");
    EXPECT_EQ(means.name(2), "CF");
    EXPECT_EQ(means.at(1, 0), 0.002);
    EXPECT_GT(means.at(1, 1), 0.02);
}

TEST(StudyColumns, AverageASubjectsTrialsAndLeaveOutWhoHasNone) {
    PaperRows table;
    table.add(1, 3, {0.001, 0.002, 0.003, 0.004}, {11, 11, 11, 11});
    table.add(1, 3, {0.003, 0.004, 0.005, 0.006}, {11, 11, 11, 11});
    for (TrialRow& row : table.rows) {
        if (row.conditions.subject == 2 && row.conditions.modality == Modality::kVF) {
            row.metrics.penetration_mean_m = TrialMetrics::kNone;
        }
    }
    const CompleteRows complete = StudyColumns(table.rows, 1).table(Metric::kPenetrationMean);
    EXPECT_EQ(complete.table.subjects(), 2U);
    EXPECT_EQ(complete.dropped, std::vector<std::size_t>{1});
    EXPECT_NEAR(complete.table.at(0, 0), 0.002 + 1e-4 * ripple(1, 0), 1e-12);
}

}  // namespace
}  // namespace thimble
