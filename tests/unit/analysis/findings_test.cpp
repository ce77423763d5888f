// Findings follow the numbers: one procedure per comparison, nothing said that few subjects cannot tell.
#include "analysis/findings.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/statistics/descriptive.hpp"
#include "tests/unit/analysis/modality_rows.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::array<double, 4> kAscending{0.001, 0.004, 0.0055, 0.008};

std::vector<TrialRow> rows(std::size_t subjects, std::uint32_t experiment = 3,
                           const std::array<double, 4>& means = kAscending) {
    return rows_of(normal_columns(subjects, means), experiment);
}

std::vector<TrialRow> only(std::vector<TrialRow> of, Modality modality) {
    std::erase_if(of, [&](const TrialRow& row) { return row.conditions.modality != modality; });
    return of;
}

std::vector<TrialRow> at(std::vector<TrialRow> of, double delay_s) {
    for (TrialRow& row : of) row.conditions.delay_s = delay_s;
    return of;
}

std::vector<TrialRow> with_oscillating_handle(std::vector<TrialRow> of) {
    for (TrialRow& row : of) row.metrics.oscillates = row.conditions.modality == Modality::kHF;
    return of;
}

std::vector<TrialRow> both(std::vector<TrialRow> a, const std::vector<TrialRow>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

const nlohmann::ordered_json& entry(const nlohmann::ordered_json& list, const std::string& comparison) {
    const auto found = std::find_if(list.begin(), list.end(),
                                    [&](const auto& one) { return one.at("comparison") == comparison; });
    if (found == list.end()) throw std::runtime_error("no " + comparison + " in " + list.dump(1));
    return *found;
}

TEST(Findings, EachPairHasEstimateIntervalAndPOfOneTest) {
    const auto trials = rows(10);
    const auto json = to_json(findings_of(trials));
    ASSERT_EQ(json.size(), 4U + 3 * 6);
    const auto& pair = entry(json, "HF - CF, maximum penetration, 50 ms");
    std::vector<std::string> keys;
    for (const auto& [key, value] : pair.items()) keys.push_back(key);
    EXPECT_THAT(keys, ElementsAre("comparison", "n", "difference", "interval", "P", "words"));
    const Columns columns = normal_columns(10, kAscending);
    NamedValues differences{"HF - CF", {}};
    for (std::size_t s = 0; s < 10; ++s) differences.values.push_back(columns[0][s] - columns[1][s]);
    const LocationShift shift = signed_rank(differences, 6);
    EXPECT_EQ(pair["n"], 10);
    EXPECT_EQ(pair["difference"], shift.estimate);
    EXPECT_EQ(pair["interval"], nlohmann::ordered_json({shift.interval->low, shift.interval->high}));
    EXPECT_EQ(pair["P"], shift.p);
    EXPECT_THAT(pair["words"].get<std::string>(),
                AllOf(StartsWith("HF was "),
                      HasSubstr(" mm shallower than CF in maximum penetration at 50 ms "
                                "(95 % interval "),
                      HasSubstr("P = 0.012; 10 subjects")));
    EXPECT_THAT(entry(json, "HF - VF, completion time, 50 ms")["words"].get<std::string>(),
                HasSubstr(" s faster than VF in completion time"));
}

TEST(Findings, WordsFollowTheDirectionWithTheIntervalTurned) {
    const auto down = findings_of(rows(10, 3, {0.008, 0.0055, 0.004, 0.001}));
    const auto up = findings_of(rows(10));
    const ConditionPair& deeper = down[0].comparisons[2];
    const ConditionPair& shallower = up[0].comparisons[2];
    EXPECT_THAT(difference_text(deeper), AllOf(StartsWith("HF was "), HasSubstr("deeper than VF")));
    EXPECT_THAT(difference_text(shallower), HasSubstr("shallower than VF"));
    for (const ConditionPair* c : {&deeper, &shallower}) EXPECT_THAT(interval_text(*c), Not(HasSubstr("-")));
}

// The words never say "No difference was found" beside an interval without zero, nor the other way round.
TEST(Findings, WordsAndIntervalsAgree) {
    std::size_t apart = 0, alike = 0;
    for (const double step : {0.0, 2e-5, 5e-5, 1e-4, 1e-3}) {
        for (const std::size_t subjects : {8U, 10U, 16U}) {
            const auto json =
                to_json(findings_of(rows(subjects, 3, {0.004, 0.004 + step, 0.004, 0.004 - step})));
            for (const auto& one : json) {
                if (one["P"].is_null()) continue;
                const bool excludes = one["interval"][0] > 0 || one["interval"][1] < 0;
                const std::string words = one["words"].get<std::string>();
                EXPECT_EQ(words.find("No difference was found") == std::string::npos, excludes) << one.dump();
                EXPECT_EQ(one["P"] < kFindingLevel, excludes) << one.dump();
                (excludes ? apart : alike) += 1;
            }
        }
    }
    EXPECT_GT(apart, 50U);
    EXPECT_GT(alike, 50U);
}

TEST(Findings, TooFewSubjectsAreSaidToBeTooFew) {
    for (const std::size_t subjects : {1U, 2U, 7U}) {
        const auto groups = findings_of(rows(subjects));
        const auto json = to_json(groups);
        const auto& pair = entry(json, "HF - CF, maximum penetration, 50 ms");
        EXPECT_TRUE(pair["P"].is_null() && pair["interval"].is_null());
        EXPECT_TRUE(pair["difference"].is_number());
        EXPECT_THAT(pair["words"].get<std::string>(),
                    AllOf(StartsWith("HF and CF cannot be compared"),
                          HasSubstr("at least 8 subjects are needed, with 6 pairs compared at once")));
        const auto sentences = answer(groups);
        ASSERT_EQ(sentences.size(), 3U);
        EXPECT_THAT(sentences[1], StartsWith("The largest differences seen: at 50 ms HF was "));
        EXPECT_THAT(sentences[2], AllOf(HasSubstr("too few"), HasSubstr("at least 8 subjects (at 50 ms)")));
        EXPECT_THAT(finding_tables(groups)[1].columns,
                    ElementsAre("delay", "measure", "pair", "n", "difference"));
    }
    EXPECT_THAT(answer(findings_of(rows(1)))[2], StartsWith("1 subject is too few"));
}

// Without three of four modalities there is one pair, for which six subjects are enough.
TEST(Findings, FewerPairsNeedFewerSubjects) {
    const auto trials = rows(6);
    const auto groups = findings_of(both(only(trials, Modality::kHF), only(trials, Modality::kCF)));
    ASSERT_EQ(groups[0].comparisons.size(), 3U);
    EXPECT_TRUE(groups[0].comparisons[0].apart());
    EXPECT_EQ(groups[0].comparisons[0].fewest(), 6U);
    EXPECT_THAT(answer(groups)[1], HasSubstr("the only pair compared"));
}

TEST(Findings, OneModalityHasNothingToCompare) {
    const auto groups = findings_of(with_oscillating_handle(only(rows(3), Modality::kHF)));
    EXPECT_EQ(to_json(groups).size(), 1U);
    EXPECT_THAT(answer(groups),
                ElementsAre("At 50 ms HF oscillates in 3 of 3 trials (95 % interval 44 to 100 %).",
                            StartsWith("No two modalities can be compared"),
                            "The results do not tell about other hands, tissues or delays."));
    EXPECT_EQ(finding_tables(groups).size(), 1U);
}

TEST(Findings, OscillationIsAShareOfTrialsWithWilsonsInterval) {
    const auto groups = findings_of(with_oscillating_handle(rows(10)));
    const auto json = to_json(groups);
    const auto& handle = entry(json, "HF oscillates, 50 ms");
    EXPECT_EQ(handle["difference"], 1.0);
    EXPECT_EQ(handle["interval"][0], wilson_interval(10, 10).low);
    EXPECT_EQ(handle["n"], 10);
    EXPECT_TRUE(handle["P"].is_null());
    EXPECT_EQ(handle["words"],
              "HF oscillates at 50 ms: 10 of 10 trials (95 % interval 72 to 100 %; 10 subjects).");
    EXPECT_THAT(entry(json, "VF oscillates, 50 ms")["words"].get<std::string>(),
                StartsWith("VF does not oscillate at 50 ms: 0 of 10 trials"));
    EXPECT_EQ(
        answer(groups)[0],
        "At 50 ms HF oscillates in 10 of 10 trials (95 % interval 72 to 100 %), and CF, CCF and VF do not (0 "
        "of 30 trials).");
}

// A softer fixture, say: that HF is stable is no failure.
TEST(Findings, NothingThatOscillatesIsSimplySaid) {
    EXPECT_EQ(answer(findings_of(both(rows(2), at(rows(2), 0.02))))[0],
              "At 20 ms and at 50 ms no condition oscillates (0 of 16 trials).");
}

TEST(Findings, EachDelayAndExperimentIsAGroup) {
    const auto groups = findings_of(both(both(rows(8, 1), rows(8, 3)), at(rows(8, 3), 0.02)));
    ASSERT_EQ(groups.size(), 3U);
    EXPECT_EQ(groups[0].name, "0 ms in experiment 1");
    EXPECT_EQ(groups[1].name, "20 ms in experiment 3");
    EXPECT_EQ(groups[2].name, "50 ms in experiment 3");
    for (const GroupFindings& group : groups) EXPECT_EQ(group.comparisons.size(), 18U);
}

TEST(Findings, RemovalsAreIndependentTrials) {
    const auto groups = findings_of(rows(8, 2));
    ASSERT_EQ(groups[0].comparisons.size(), 6U);
    const ConditionPair& pair = groups[0].comparisons[0];
    EXPECT_FALSE(pair.paired);
    EXPECT_EQ(pair.n, 16U);
    EXPECT_TRUE(pair.apart());
    const auto removed = StudyColumns(rows(8, 2), 2).groups(Metric::kPeakDisplacement);
    EXPECT_EQ(pair.shift->p, rank_sum(removed[0], removed[1], 6).p);
    EXPECT_THAT(
        answer(findings_of(rows(4, 2)))[2],
        StartsWith("8 trials of two modalities are too few for a test, which needs at least 5 trials of "
                   "each"));
}

TEST(Findings, ASubjectWithoutBothIsLeftOutOfThatPairOnly) {
    Columns columns = normal_columns(9, kAscending);
    columns[3][6] = std::nan("");
    const auto groups = findings_of(rows_of(columns, 3));
    for (const ConditionPair& c : groups[0].comparisons) EXPECT_EQ(c.n, c.second == "VF" ? 8U : 9U);
}

TEST(Findings, AMeasureThatAModalityNeverReachesIsNamed) {
    auto trials = rows(8);
    for (TrialRow& row : trials) {
        if (row.conditions.modality == Modality::kHF) row.metrics.completion_time_s = std::nan("");
    }
    EXPECT_THAT(answer(findings_of(trials))[2], HasSubstr("HF has no completion time at 50 ms"));
    // With one other modality there is no pair at all.
    const auto two = both(only(trials, Modality::kHF), only(trials, Modality::kCF));
    EXPECT_THAT(answer(findings_of(two))[2], HasSubstr("HF has no completion time at 50 ms"));
    EXPECT_THAT(answer(findings_of(only(trials, Modality::kHF)))[2], Not(HasSubstr("completion time")));
}

TEST(Findings, AnswersNamePairsThatAreNotToldApart) {
    const auto sentences = answer(findings_of(rows(10, 3, {0.001, 0.004, 0.004, 0.004})));
    EXPECT_THAT(sentences[1], AllOf(HasSubstr("in maximum penetration (95 % interval "),
                                    HasSubstr("the largest of 3 differences among 6 pairs")));
    EXPECT_THAT(
        sentences[2],
        AllOf(StartsWith("No difference was found in these pairs, which does not mean that they are equal"),
              HasSubstr("maximum penetration CF - CCF (-")));
}

// The answer leaves mean penetration out, but not where it says that every pair differs.
TEST(Findings, EveryPairDiffersOnlyIfItDoesInEachMeasure) {
    auto trials = rows(10);
    EXPECT_THAT(answer(findings_of(trials))[2], StartsWith("Every pair differs; the results "));
    const auto alike = rows(10, 3, {0.004, 0.004, 0.004, 0.004});
    for (std::size_t i = 0; i < trials.size(); ++i)
        trials[i].metrics.penetration_mean_m = alike[i].metrics.penetration_mean_m;
    EXPECT_THAT(answer(findings_of(trials))[2], StartsWith("The results do not tell"));
}

// Too many to name are counted.
TEST(Findings, ManyPairsThatAreNotToldApartAreCounted) {
    const auto sentences = answer(findings_of(rows(10, 3, {0.004, 0.004, 0.004, 0.004})));
    EXPECT_EQ(sentences[1], "No difference between two modalities was found in any measure.");
    EXPECT_EQ(
        sentences[2],
        "No difference was found in these pairs, which does not mean that they are equal: at 50 ms 6 of 6 "
        "pairs in maximum penetration and 6 of 6 pairs in completion time (the tables show the intervals).");
}

// The control without delay is in the table; the answer is about the delay.
TEST(Findings, TheAnswerComparesAtTheDelaysOfTheExperiment) {
    const auto sentences = answer(findings_of(both(rows(10), at(rows(10), 0))));
    EXPECT_EQ(sentences[0], "At 0 ms and at 50 ms no condition oscillates (0 of 80 trials).");
    EXPECT_THAT(sentences[1], AllOf(StartsWith("At 50 ms "), Not(HasSubstr("at 0 ms"))));
    EXPECT_THAT(answer(findings_of(at(rows(10), 0)))[1], StartsWith("At 0 ms "));
}

TEST(Findings, WithoutTrialsNothingIsFound) {
    EXPECT_TRUE(findings_of({}).empty());
    EXPECT_EQ(to_json(findings_of({})).dump(), "[]");
    auto interrupted = rows(3);
    for (TrialRow& row : interrupted) row.reason = EndReason::kInterrupted;
    EXPECT_THAT(answer(findings_of(interrupted))[0], StartsWith("No trial ran to its end"));
    EXPECT_EQ(answer({})[1], "No two modalities can be compared: no delay has measures of two modalities.");
    EXPECT_TRUE(finding_tables(findings_of(interrupted)).empty());
}

TEST(ShownText, HasNoNegativeZero) {
    EXPECT_EQ(shown_text(-1e-9, Metric::kPenetrationMean), "0.00");
    EXPECT_EQ(shown_text(-0.00401, Metric::kPenetrationMean), "-4.01");
}

TEST(PlainTable, PadsByCharacters) {
    const ReportTable table{"T", "a note", {"x", "long"}, {{"–", "1"}, {"abc", "2"}}};
    EXPECT_EQ(plain_table(table), "T\n  x    long\n  –    1\n  abc  2\n  a note\n");
}

TEST(ReportTable, LosesColumnsWithoutAValue) {
    ReportTable table{"T", "", {"x", "nothing", "some"}, {{"1", "–", "–"}, {"2", "–", "3"}}};
    drop_empty_columns(table);
    EXPECT_THAT(table.columns, ElementsAre("x", "some"));
    EXPECT_THAT(table.rows[1], ElementsAre("2", "3"));
    ReportTable empty{"T", "", {"x"}, {}};
    drop_empty_columns(empty);
    EXPECT_EQ(empty.columns.size(), 1U);
}

}  // namespace
}  // namespace thimble
