// Which test the paper's rule chooses, and that the words follow the numbers.
#include "analysis/analysis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/analysis/modality_rows.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::size_t kSubjects = 16;
constexpr std::array<double, 4> kAscending{0.001, 0.004, 0.0055, 0.008};

MeasureAnalysis analyse(const std::vector<TrialRow>& rows, AnalysisKind kind = AnalysisKind::kFull,
                        std::uint32_t experiment = 1, Metric metric = Metric::kPenetrationMean) {
    return analyse_measure(StudyColumns(rows, experiment), metric, kind);
}

// Skewed: one subject far off in CF.
Columns with_outlier() {
    Columns columns = normal_columns(kSubjects, kAscending);
    columns[1][4] = 0.05;
    return columns;
}

TEST(Analysis, NormalColumnsAreComparedByTheirMeans) {
    const auto rows = rows_of(normal_columns(kSubjects, kAscending));
    const MeasureAnalysis m = analyse(rows, AnalysisKind::kPaper);
    ASSERT_EQ(m.chosen, ChosenTest::kRepeatedAnova);
    const SampleTable table = StudyColumns(rows, 1).table(Metric::kPenetrationMean).table;
    EXPECT_EQ(m.p(), repeated_anova(table).p);
    const auto pairs = pairs_after_repeated_anova(table);
    ASSERT_EQ(m.pairs.size(), 6U);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        EXPECT_EQ(m.pairs[i].first, pairs[i].first);
        EXPECT_EQ(m.pairs[i].second, pairs[i].second);
        EXPECT_EQ(m.p_of(m.pairs[i]), pairs[i].p_bonferroni);
    }
}

TEST(Analysis, OneColumnThatIsNotNormalAndRanksDecide) {
    const auto rows = rows_of(with_outlier());
    const MeasureAnalysis m = analyse(rows, AnalysisKind::kPaper);
    ASSERT_EQ(m.chosen, ChosenTest::kFriedman);
    EXPECT_FALSE(m.columns[0].fails_normality());
    EXPECT_TRUE(m.columns[1].fails_normality());
    const SampleTable table = StudyColumns(rows, 1).table(Metric::kPenetrationMean).table;
    EXPECT_EQ(m.p(), friedman(table).p_exact);
    const auto pairs = dunn_after_friedman(table);
    for (std::size_t i = 0; i < pairs.size(); ++i) EXPECT_EQ(m.p_of(m.pairs[i]), pairs[i].p_adjusted);
    EXPECT_THAT(finding_text(m), HasSubstr("K2 rejects normality of CF"));
}

TEST(Analysis, ThePapersHoldsNothingElse) {
    for (const auto& columns : {normal_columns(kSubjects, kAscending), with_outlier()}) {
        const MeasureAnalysis m = analyse(rows_of(columns), AnalysisKind::kPaper);
        EXPECT_NE(m.repeated_anova.has_value(), m.friedman.has_value());
        EXPECT_FALSE(m.eta_squared_interval);
        ASSERT_EQ(m.pairs.size(), 6U);
        for (const PairAnalysis& pair : m.pairs) {
            EXPECT_NE(pair.pooled.has_value(), pair.dunn.has_value());
            EXPECT_FALSE(pair.paired || pair.d_z);
        }
        const std::string json = to_json({m}, AnalysisKind::kPaper).dump();
        for (const char* later : {"greenhouse", "eta_squared", "holm", "kendall", "d_z", "paired_t"}) {
            EXPECT_EQ(json.find(later), std::string::npos) << later;
        }
        EXPECT_THAT(finding_text(m), AllOf(Not(HasSubstr("Greenhouse")), Not(HasSubstr("CI"))));
    }
}

TEST(Analysis, TheFullOneHasAllBesideTheSameChoice) {
    for (const auto& columns : {normal_columns(kSubjects, kAscending), with_outlier()}) {
        const auto rows = rows_of(columns);
        const MeasureAnalysis full = analyse(rows), paper = analyse(rows, AnalysisKind::kPaper);
        EXPECT_EQ(full.chosen, paper.chosen);
        EXPECT_EQ(full.p(), paper.p());
        EXPECT_TRUE(full.repeated_anova && full.friedman && full.eta_squared_interval);
        ASSERT_EQ(full.pairs.size(), 6U);
        for (const PairAnalysis& pair : full.pairs) {
            EXPECT_TRUE(pair.pooled && pair.dunn && pair.paired && pair.d_z);
        }
        EXPECT_THAT(full.problems, testing::IsEmpty());
    }
}

TEST(Analysis, WordsFollowTheDirection) {
    const MeasureAnalysis up = analyse(rows_of(normal_columns(kSubjects, kAscending)));
    EXPECT_THAT(
        finding_text(up),
        AllOf(StartsWith("Mean penetration differed between modalities (repeated-measures ANOVA, F(3, 45)"),
              HasSubstr("HF 1.00, CF 4.00, CCF 5.50, VF 8.00 mm"),
              HasSubstr("HF was 3.00 mm shallower than CF (95 % CI 2."), Not(HasSubstr("deeper"))));
    const MeasureAnalysis down = analyse(rows_of(normal_columns(kSubjects, {0.008, 0.0055, 0.004, 0.001})));
    EXPECT_THAT(finding_text(down),
                AllOf(HasSubstr("HF was 2.50 mm deeper than CF"),
                      HasSubstr("VF 1.00, CCF 4.00, CF 5.50, HF 8.00 mm"), Not(HasSubstr("shallower"))));
    const MeasureAnalysis time = analyse(rows_of(normal_columns(kSubjects, kAscending)), AnalysisKind::kFull,
                                         1, Metric::kCompletionTime);
    EXPECT_THAT(finding_text(time), HasSubstr("HF was 3.00 s faster than CF"));
}

TEST(Analysis, WhatDoesNotDifferIsNotSaidToBeTheSame) {
    const MeasureAnalysis m = analyse(rows_of(normal_columns(kSubjects, {0.004, 0.004, 0.004, 0.004})));
    EXPECT_FALSE(m.differs());
    const std::string text = finding_text(m);
    EXPECT_THAT(text,
                AllOf(HasSubstr("was not shown to differ"), HasSubstr("leave room for differences up to"),
                      Not(HasSubstr("shallower")), Not(HasSubstr("Pair by pair"))));
    EXPECT_THAT(finding_in_brief(m), Not(HasSubstr("Pairs that differ")));
}

TEST(Analysis, DisagreementOfTestsIsSaid) {
    // CF and CCF differ in every subject by the same small amount: paired tests see it, Dunn does not.
    Columns columns = with_outlier();
    for (std::size_t s = 0; s < kSubjects; ++s)
        columns[2][s] = columns[1][s] + 1e-5 * (1 + 0.1 * static_cast<double>(s % 5));
    EXPECT_THAT(finding_text(analyse(rows_of(columns))),
                HasSubstr("Paired t tests with Holm's correction disagree on"));
    EXPECT_THAT(finding_text(analyse(rows_of(normal_columns(kSubjects, kAscending)))),
                AllOf(HasSubstr("agree on all six pairs"), HasSubstr("Friedman's test agrees")));
}

// The ranks decide, but one subject turns the means round.
TEST(Analysis, RanksAgainstMeansAreNamed) {
    Columns columns = normal_columns(kSubjects, {0.009, 0.001, 0.004, 0.005});
    columns[1][0] = 0.5;
    const MeasureAnalysis m = analyse(rows_of(columns));
    ASSERT_EQ(m.chosen, ChosenTest::kFriedman);
    EXPECT_THAT(finding_text(m), HasSubstr("HF ranked above CF, although its mean is lower"));
}

TEST(Analysis, WithFewSubjectsItSaysWhatCannotBeComputed) {
    const MeasureAnalysis seven = analyse(rows_of(normal_columns(7, kAscending)));
    EXPECT_EQ(seven.chosen, ChosenTest::kFriedman);  // normality is not shown
    EXPECT_TRUE(seven.differs());
    EXPECT_THAT(finding_text(seven), AllOf(HasSubstr("K2 cannot judge"),
                                           HasSubstr("Not computed: D'Agostino"), HasSubstr("at least 8")));
    const MeasureAnalysis two = analyse(rows_of(normal_columns(2, kAscending)));
    EXPECT_FALSE(two.repeated_anova);
    EXPECT_TRUE(two.p());
    for (const std::size_t subjects : {0U, 1U}) {
        const MeasureAnalysis none = analyse(rows_of(normal_columns(subjects, kAscending)));
        EXPECT_FALSE(none.p());
        EXPECT_FALSE(none.differs());
        EXPECT_FALSE(none.problems.empty());
        EXPECT_THAT(finding_text(none), StartsWith("Mean penetration could not be tested: "));
        EXPECT_TRUE(to_json({none}, AnalysisKind::kFull)["measures"][0]["p"].is_null());
    }
}

TEST(Analysis, APairWithEqualDifferencesDoesNotCostTheOthersTheirTests) {
    Columns columns = normal_columns(kSubjects, kAscending);
    columns[2] = columns[1];
    const MeasureAnalysis m = analyse(rows_of(columns));
    std::size_t tested = 0;
    for (const PairAnalysis& pair : m.pairs) {
        const bool equal = pair.first == 1 && pair.second == 2;
        EXPECT_EQ(pair.paired.has_value(), !equal) << pair.first << pair.second;
        if (!pair.paired) continue;
        EXPECT_EQ(pair.paired->first, pair.first);
        EXPECT_EQ(pair.paired->second, pair.second);
        ++tested;
    }
    EXPECT_EQ(tested, 5U);
    // Its place is empty: the error of the ANOVA would be another test.
    EXPECT_FALSE(m.by_means(m.pairs[3]).has_value());
    EXPECT_THAT(m.problems,
                testing::Contains(AllOf(HasSubstr("CF"), HasSubstr("CCF"), HasSubstr("same amount"))));
}

TEST(Analysis, AMissingModalityIsNamed) {
    Columns columns = normal_columns(kSubjects, kAscending);
    columns[2].assign(kSubjects, std::nan(""));
    for (const std::uint32_t experiment : {1U, 2U}) {
        const MeasureAnalysis m = analyse(rows_of(columns, experiment), AnalysisKind::kFull, experiment);
        EXPECT_THAT(m.problems, ElementsAre(HasSubstr("no trial of CCF")));
        EXPECT_THAT(finding_text(m), HasSubstr("could not be tested: no trial of CCF"));
        EXPECT_TRUE(analysis_tables({m}).empty());
    }
}

TEST(Analysis, ASubjectThatMissesAModalityIsLeftOutAndNamed) {
    Columns columns = normal_columns(kSubjects, kAscending);
    columns[3][6] = std::nan("");
    const MeasureAnalysis m = analyse(rows_of(columns));
    EXPECT_EQ(m.subjects, kSubjects - 1);
    EXPECT_THAT(m.left_out, ElementsAre(7));
    EXPECT_THAT(finding_text(m), HasSubstr("subject 7."));
}

TEST(Analysis, RemovalsAreIndependentTrialsWhateverTheirDistribution) {
    const auto rows = rows_of(with_outlier(), 2);
    const MeasureAnalysis m = analyse(rows, AnalysisKind::kFull, 2, Metric::kPeakDisplacement);
    ASSERT_EQ(m.chosen, ChosenTest::kOneWayAnova);
    const auto groups = StudyColumns(rows, 2).groups(Metric::kPeakDisplacement);
    EXPECT_EQ(m.p(), one_way_anova(groups).p);
    EXPECT_EQ(m.p_of(m.pairs[5]), pairs_after_one_way_anova(groups)[5].p_bonferroni);
    EXPECT_FALSE(m.pairs[0].d_z);  // no subject meets two modalities
    EXPECT_THAT(finding_text(m), AllOf(HasSubstr("one-way ANOVA, F(3, 60)"), HasSubstr("64 trials"),
                                       HasSubstr("knows ANOVA only")));
}

TEST(Analysis, OfAllExperimentsThereAreSevenMeasures) {
    std::vector<TrialRow> rows;
    for (const std::uint32_t experiment : {3U, 1U, 2U}) {
        const auto more = rows_of(normal_columns(10, kAscending), experiment);
        rows.insert(rows.end(), more.begin(), more.end());
    }
    const auto json = to_json(analyse_trials(rows, AnalysisKind::kFull), AnalysisKind::kFull);
    EXPECT_EQ(json["analysis"], "full");
    ASSERT_EQ(json["measures"].size(), 7U);
    EXPECT_EQ(json["measures"][3]["measure"], "peak_displacement_m");
    EXPECT_EQ(json["measures"][6]["experiment"], 3);
    EXPECT_EQ(json["measures"][0]["pairs"].size(), 6U);
    EXPECT_NEAR(json["measures"][0]["pairs"][0]["difference"].get<double>(), -0.003, 1e-6);
    EXPECT_TRUE(analyse_trials({}, AnalysisKind::kFull).empty());
}

TEST(Analysis, KindsAreKnownByName) {
    EXPECT_EQ(parse_analysis("paper"), AnalysisKind::kPaper);
    EXPECT_EQ(parse_analysis("full"), AnalysisKind::kFull);
    EXPECT_EQ(parse_analysis("Full"), std::nullopt);
}

TEST(Analysis, OscillationIsCountedInTrialsAndSubjects) {
    auto rows = rows_of(normal_columns(3, kAscending));
    rows[0].metrics.oscillates = rows[2].metrics.oscillates = true;
    EXPECT_THAT(stability_text(StudyColumns(rows, 1)),
                StartsWith("Oscillation: HF 2 of 3 trials (2 of 3 subjects), CF 0 of 3"));
}

TEST(ShownText, HasNoNegativeZero) {
    EXPECT_EQ(shown_text(-1e-9, Metric::kPenetrationMean), "0.00");
    EXPECT_EQ(shown_text(-0.00401, Metric::kPenetrationMean), "-4.01");
}

TEST(PlainTable, PadsByCharacters) {
    const ReportTable table{"T", "a note", {"x", "long"}, {{"–", "1"}, {"abc", "2"}}};
    EXPECT_EQ(plain_table(table), "T\n  x    long\n  –    1\n  abc  2\n  a note\n");
}

}  // namespace
}  // namespace thimble
