// The paper's claims on tables that are made so that they hold, or do not.
#include "analysis/claims/claims.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/statistics/friedman.hpp"
#include "analysis/statistics/pairwise.hpp"
#include "analysis/tables/study_columns.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

using PerModality = std::array<double, 4>;  // HF, CF, CCF, VF

// A spread over subjects and trials that is none of the modality's.
double ripple(std::uint32_t subject, std::uint32_t modality) {
    return std::sin(1.7 * subject) + 0.3 * std::sin(2.3 * subject + 1.1 * modality);
}

struct Table {
    std::vector<TrialRow> rows;

    void add(std::uint32_t experiment, std::uint32_t subjects, const PerModality& penetration_m,
             const PerModality& time_s, double delay_s = 0) {
        for (std::uint32_t subject = 1; subject <= subjects; ++subject) {
            for (std::uint32_t m = 0; m < 4; ++m) {
                TrialRow row;
                row.conditions.experiment = experiment;
                row.conditions.subject = subject;
                row.conditions.modality = kModalities[m];
                row.conditions.delay_s = delay_s;
                row.reason = EndReason::kCompleted;
                row.metrics.penetration_mean_m = penetration_m[m] + 1e-4 * ripple(subject, m);
                row.metrics.penetration_max_m = penetration_m[m] * 1.1 + 1e-4 * ripple(subject, m);
                row.metrics.completion_time_s = time_s[m] + 0.1 * ripple(subject, m);
                row.metrics.oscillates = delay_s > 0 && m == 0;
                rows.push_back(row);
            }
        }
    }
    void add_removals(const PerModality& displacement_m) {
        for (std::uint32_t i = 0; i < 32; ++i) {
            TrialRow row;
            row.conditions.experiment = 2;
            row.conditions.subject = i / 2 + 1;
            row.conditions.modality = kModalities[i % 4];
            row.conditions.removes_fixture = true;
            row.reason = EndReason::kCompleted;
            row.metrics.peak_displacement_m = displacement_m[i % 4] + 1e-4 * ripple(i, 0);
            rows.push_back(row);
        }
    }
};

Claim claim_of(const std::vector<Claim>& claims, const std::string& id) {
    const auto found = std::find_if(claims.begin(), claims.end(), [&](const Claim& c) { return c.id == id; });
    EXPECT_NE(found, claims.end()) << id;
    return found == claims.end() ? Claim{} : *found;
}

Table the_papers() {
    Table table;
    table.add(1, 16, {0.001, 0.004, 0.0055, 0.008}, {11, 11, 11, 11});
    table.add_removals({0.02, 0.001, 0.001, 0.001});
    table.add(3, 10, {0.030, 0.004, 0.0055, 0.008}, {15, 11, 11, 11}, 0.05);
    return table;
}

TEST(Claims, WithoutTrialsNothingIsJudged) {
    const std::vector<Claim> claims = judge_claims({});
    std::set<std::string> ids;
    for (const Claim& c : claims) {
        EXPECT_FALSE(c.reproduced) << c.id;
        EXPECT_FALSE(c.ours.empty() || c.claim.empty() || c.paper.empty()) << c.id;
        EXPECT_TRUE(ids.insert(c.id).second) << c.id;
    }
    for (const char* id :
         {"E1.mean.order",  "E1.mean.pairs",   "E1.max.order",   "E1.max.pairs",       "E1.normal",
          "E1.time.same",   "E2.peak.differs", "E2.peak.hf",     "E2.peak.rest",       "E3.stable",
          "E3.max.differs", "E3.max.hf_cf",    "E3.max.hf_ccf",  "E3.max.vf_cf",       "E3.time.differs",
          "E3.time.hf_vf",  "E3.time.hf_cf",   "E3.time.hf_ccf", "E3.time.only_delay", "D.indistinct",
          "D.delay45",      "S.length",        "E1.mean.ratio",  "E1.max.ratio",       "E2.peak.spread",
          "E3.max.rest",    "E3.time.rest"}) {
        EXPECT_EQ(ids.count(id), 1U) << id;
    }
}

TEST(Claims, ATableMadeForThemReproducesThem) {
    const std::vector<Claim> claims = judge_claims(the_papers().rows);
    for (const char* id : {"E1.mean.order", "E1.mean.pairs", "E1.max.order", "E1.max.pairs", "E1.time.same",
                           "E2.peak.differs", "E2.peak.hf", "E2.peak.rest", "E3.stable", "E3.max.differs",
                           "E3.max.hf_cf", "E3.max.hf_ccf", "E3.time.differs", "E3.time.only_delay",
                           "E1.mean.ratio", "E1.max.ratio", "E2.peak.spread", "E3.max.rest"}) {
        const Claim c = claim_of(claims, id);
        EXPECT_EQ(c.reproduced, true) << id << ": " << c.ours;
    }
    EXPECT_THAT(claim_of(claims, "E1.mean.order").ours, HasSubstr("F(3, 45)"));
    EXPECT_THAT(claim_of(claims, "E2.peak.differs").ours, HasSubstr("F(3, 28)"));
    // Whom HF always outranks cannot outrank the others by the 2.17 that P < .001 takes.
    EXPECT_EQ(claim_of(claims, "E3.max.vf_cf").reproduced, false);
}

// Both intervals by an independent program: Fieller's as the roots of his equation, the other from tables of chi squared.
TEST(Claims, SizesHaveTheirIntervals) {
    const std::vector<Claim> claims = judge_claims(the_papers().rows);
    EXPECT_EQ(claim_of(claims, "E1.mean.ratio").ours, "3.00 of 7.00 mm: 0.428, 95 % interval 0.427 to 0.430");
    EXPECT_EQ(claim_of(claims, "E2.peak.spread").ours,
              "SD 0.05 of 19.05 mm: 0.003, 95 % interval 0.002 to 0.006");

    Table dear;  // CF costs 4 of 7 mm, and HF's jumps differ as much as they are large
    dear.add(1, 16, {0.001, 0.005, 0.0055, 0.008}, {11, 11, 11, 11});
    dear.add_removals({0.0002, 0.0001, 0.0001, 0.0001});
    for (const char* id : {"E1.mean.ratio", "E1.max.ratio", "E2.peak.spread"})
        EXPECT_EQ(claim_of(judge_claims(dear.rows), id).reproduced, false) << id;
}

TEST(Claims, ADifferenceWhereThePaperHasNoneIsNoReproduction) {
    Table table = the_papers();
    std::erase_if(table.rows, [](const TrialRow& row) { return row.conditions.experiment == 3; });
    table.add(3, 10, {0.030, 0.004, 0.0055, 0.008}, {15, 9, 11, 13}, 0.05);
    EXPECT_EQ(claim_of(judge_claims(table.rows), "E3.time.rest").reproduced, false);
    EXPECT_EQ(claim_of(judge_claims(table.rows), "E3.max.rest").reproduced, true);
}

// Claims by construction and recounts are not counted.
TEST(Claims, TheSentenceCountsResultsAndSizesApart) {
    const auto claim = [](const char* id, ClaimKind kind, bool reproduced) {
        Claim one{id, "", ""};
        one.kind = kind;
        one.had_trials = true;
        one.reproduced = reproduced;
        return one;
    };
    EXPECT_EQ(
        claims_sentence({claim("a", ClaimKind::kResult, true), claim("b", ClaimKind::kResult, false),
                         claim("c", ClaimKind::kSize, false), claim("d", ClaimKind::kByConstruction, true),
                         claim("e", ClaimKind::kRecount, true)}),
        "1 of 2 judged results is reproduced; not: b; 0 of 1 judged sizes are reproduced; not: c");
}

// Significance in the wrong direction is no reproduction.
TEST(Claims, TheDirectionCounts) {
    Table table;
    table.add(1, 16, {0.008, 0.0055, 0.004, 0.001}, {11, 12, 13, 14});
    table.add_removals({0.001, 0.02, 0.02, 0.02});
    table.add(3, 10, {0.001, 0.004, 0.0055, 0.008}, {10, 11, 12, 13}, 0.05);
    const std::vector<Claim> claims = judge_claims(table.rows);
    for (const char* id : {"E1.mean.order", "E1.mean.pairs", "E1.max.order", "E1.time.same", "E2.peak.hf",
                           "E3.max.hf_cf", "E3.time.hf_vf", "E3.time.only_delay"}) {
        EXPECT_EQ(claim_of(claims, id).reproduced, false) << id;
    }
    EXPECT_EQ(claim_of(claims, "E2.peak.differs").reproduced, true);
}

// Weak data in the right direction: the direction is kept apart from the significance.
TEST(Claims, TheDirectionIsJudgedByItself) {
    const std::vector<Claim> papers = judge_claims(the_papers().rows);
    EXPECT_EQ(claim_of(papers, "E3.max.vf_cf").direction, true);
    EXPECT_EQ(claim_of(papers, "E1.mean.order").direction, true);
    EXPECT_EQ(claim_of(papers, "E2.peak.hf").direction, true);
    for (const char* id : {"E1.normal", "E1.time.same", "E2.peak.rest", "E3.stable", "E3.max.differs"}) {
        EXPECT_FALSE(claim_of(papers, id).direction) << id;
    }
    Table wrong;
    wrong.add(3, 10, {0.003, 0.004, 0.0055, 0.008}, {15, 11, 11, 11}, 0.05);
    EXPECT_EQ(claim_of(judge_claims(wrong.rows), "E3.max.hf_cf").direction, false);
}

TEST(Claims, WhatTheLagCostsIsAPairedDifference) {
    const Table with = the_papers();
    Table without;
    without.add(1, 16, {0.001, 0.0033, 0.0055, 0.008}, {11, 11, 11, 11});
    std::erase_if(without.rows, [](const TrialRow& row) { return row.conditions.modality != Modality::kCF; });
    // A ripple of its own, or all differences would be the same.
    for (TrialRow& row : without.rows)
        row.metrics.penetration_mean_m += 2e-5 * ripple(row.conditions.subject, 7);
    const Claim lag = claim_of(judge_claims(with.rows, without.rows), "D.delay45");
    EXPECT_EQ(lag.reproduced, true) << lag.ours;
    EXPECT_THAT(lag.ours, HasSubstr("23 %"));  // 0.7 of 3 mm
    EXPECT_FALSE(claim_of(judge_claims(with.rows), "D.delay45").reproduced);
    for (TrialRow& row : without.rows) row.metrics.penetration_mean_m += 0.002;
    const Claim worse = claim_of(judge_claims(with.rows, without.rows), "D.delay45");
    EXPECT_EQ(worse.reproduced, false);
    EXPECT_EQ(worse.direction, false);
    without.rows.pop_back();
    EXPECT_THAT(claim_of(judge_claims(with.rows, without.rows), "D.delay45").ours,
                HasSubstr("not the same trials"));
}

// 4 + 2 trials of 12 s leave (517.8 - 72) / 6 s between trials; the participant session of experiment 3 has four.
TEST(Claims, TheSecondSessionFollowsFromTheFirst) {
    Table table = the_papers();
    for (TrialRow& row : table.rows) row.metrics.duration_s = 12;
    const Claim length = claim_of(judge_claims(table.rows), "S.length");
    EXPECT_EQ(length.reproduced, false) << length.ours;
    EXPECT_THAT(length.ours, HasSubstr("74.30 s between trials"));
    EXPECT_THAT(length.ours, HasSubstr("5.75 min"));
    for (TrialRow& row : table.rows) {
        if (row.conditions.experiment == 3) row.metrics.duration_s = 51.5;
    }
    EXPECT_EQ(claim_of(judge_claims(table.rows), "S.length").reproduced, true);
}

TEST(Claims, StabilityNeedsAllOthersToHold) {
    Table table = the_papers();
    table.rows.back().metrics.oscillates = true;  // VF at 50 ms
    EXPECT_EQ(claim_of(judge_claims(table.rows), "E3.stable").reproduced, false);
}

TEST(Claims, StabilityNeedsMoreThanHalfOfTheHandlesTrialsToOscillate) {
    Table table = the_papers();
    const auto oscillating = [&](std::uint32_t subjects) {
        for (TrialRow& row : table.rows) {
            if (row.conditions.experiment != 3 || row.conditions.modality != Modality::kHF) continue;
            row.metrics.oscillates = row.conditions.subject <= subjects;
        }
        return claim_of(judge_claims(table.rows), "E3.stable");
    };
    EXPECT_THAT(oscillating(5).ours, HasSubstr("HF 5 of 10"));
    EXPECT_EQ(oscillating(5).reproduced, false);
    EXPECT_EQ(oscillating(6).reproduced, true);
}

// A pair with .001 < P < .05 after Bonferroni, and P < .001 before: enough for CF - CCF of the maximum only.
TEST(Claims, EachPairHasItsOwnLimit) {
    const auto pair_of = [](const Table& table, Metric metric, std::size_t pair) {
        return pairs_after_repeated_anova(StudyColumns(table.rows, 1).table(metric).table).at(pair);
    };
    Table near_cf, near_ccf;
    near_cf.add(1, 16, {0.001, 0.004, 0.004029, 0.008}, {11, 11, 11, 11});
    near_ccf.add(1, 16, {0.001, 0.004, 0.007971, 0.008}, {11, 11, 11, 11});
    for (const Metric metric : {Metric::kPenetrationMean, Metric::kPenetrationMax}) {
        for (const MeanPair& pair : {pair_of(near_cf, metric, 3), pair_of(near_ccf, metric, 5)}) {
            ASSERT_LT(pair.p, 1e-3);
            ASSERT_GT(pair.p_bonferroni, 1e-3);
            ASSERT_LT(pair.p_bonferroni, 0.05);
        }
    }
    const std::vector<Claim> cf = judge_claims(near_cf.rows), ccf = judge_claims(near_ccf.rows);
    EXPECT_EQ(claim_of(cf, "E1.max.pairs").reproduced, true) << claim_of(cf, "E1.max.pairs").ours;
    EXPECT_EQ(claim_of(cf, "E1.mean.pairs").reproduced, false);
    EXPECT_EQ(claim_of(ccf, "E1.max.pairs").reproduced, false);
    EXPECT_EQ(claim_of(ccf, "E1.mean.pairs").reproduced, false);
    for (const auto& claims : {cf, ccf}) EXPECT_EQ(claim_of(claims, "E1.mean.pairs").direction, true);
}

// HF outranks each of the others with .001 < P < .05: the verdict is that of the claim's own level.
TEST(Claims, EachComparisonOfRanksHasItsOwnLevel) {
    constexpr std::array<PerModality, 10> kRanks{{{4, 1, 2, 3},
                                                  {4, 2, 3, 1},
                                                  {4, 3, 1, 2},
                                                  {4, 1, 2, 3},
                                                  {4, 2, 3, 1},
                                                  {4, 3, 1, 2},
                                                  {4, 1, 2, 3},
                                                  {4, 3, 2, 1},
                                                  {3, 1, 2, 4},
                                                  {3, 4, 2, 1}}};
    Table table;
    table.add(3, 10, {}, {}, 0.05);
    for (TrialRow& row : table.rows) {
        const double rank = kRanks.at(row.conditions.subject - 1)
                                .at(static_cast<std::size_t>(std::find(kModalities.begin(), kModalities.end(),
                                                                       row.conditions.modality) -
                                                             kModalities.begin()));
        row.metrics.penetration_max_m = 0.001 * rank;
        row.metrics.completion_time_s = 10 + rank;
    }
    for (const DunnPair& pair :
         dunn_after_friedman(StudyColumns(table.rows, 3).table(Metric::kCompletionTime).table)) {
        if (pair.first != 0) continue;
        ASSERT_GT(pair.p_adjusted, 0.01);
        ASSERT_LT(pair.p_adjusted, 0.05);
    }
    const std::vector<Claim> claims = judge_claims(table.rows);
    for (const char* id : {"E3.time.hf_cf", "E3.max.hf_ccf"}) {
        EXPECT_EQ(claim_of(claims, id).reproduced, true) << id << ": " << claim_of(claims, id).ours;
    }
    for (const char* id : {"E3.time.hf_vf", "E3.time.hf_ccf", "E3.max.hf_cf"}) {
        EXPECT_EQ(claim_of(claims, id).reproduced, false) << id << ": " << claim_of(claims, id).ours;
        EXPECT_EQ(claim_of(claims, id).direction, true) << id;
    }
    for (const char* id : {"E3.max.differs", "E3.time.differs"}) {
        EXPECT_EQ(claim_of(claims, id).reproduced, false) << id << ": " << claim_of(claims, id).ours;
    }
}

TEST(Claims, DataThatATestRefusesAreNotJudgedAndSayWhy) {
    Table few;
    few.add(1, 2, {0.001, 0.004, 0.0055, 0.008}, {11, 11, 11, 11});
    const Claim order = claim_of(judge_claims(few.rows), "E1.mean.order");
    EXPECT_FALSE(order.reproduced);
    EXPECT_THAT(order.ours, HasSubstr("not judged: 2 subjects, at least 6 are needed"));
    Table steady = the_papers();  // what only counts needs no number of subjects
    std::erase_if(steady.rows, [](const TrialRow& row) { return row.conditions.subject > 2; });
    const std::vector<Claim> two = judge_claims(steady.rows);
    EXPECT_EQ(claim_of(two, "E3.stable").reproduced, true);
    EXPECT_FALSE(claim_of(two, "E3.max.differs").reproduced);
    ASSERT_EQ(claims_table(two).rows.size(), 1U);  // those that are not judged have no row
    EXPECT_EQ(claims_table(two).rows[0][0], "E3.stable");
    EXPECT_THAT(claims_sentence(two),
                testing::MatchesRegex("1 of [12] judged results is reproduced.*; [0-9]+ more "
                                      "cannot be judged \\(see claims.json\\)"));
    EXPECT_THAT(claims_sentence({}), HasSubstr("at least 6 subjects"));
    Table interrupted = the_papers();
    for (TrialRow& row : interrupted.rows) row.reason = EndReason::kInterrupted;
    for (const Claim& c : judge_claims(interrupted.rows)) EXPECT_FALSE(c.reproduced) << c.id;
}

TEST(Claims, OnlyThePapersDesignIsThePapers) {
    Table papers = the_papers();
    papers.add(3, 10, {0.001, 0.004, 0.005, 0.008}, {11, 11, 11, 11}, 0);  // its control
    EXPECT_TRUE(are_paper_trials(papers.rows));
    EXPECT_FALSE(are_paper_trials({}));
    const auto changed = [&](const auto& change) {
        std::vector<TrialRow> rows = papers.rows;
        change(rows);
        return are_paper_trials(rows);
    };
    EXPECT_FALSE(changed([](auto& rows) { rows[0].conditions.experiment = 4; }));
    EXPECT_FALSE(changed([](auto& rows) { rows[0].conditions.delay_s = 0.05; }));       // experiment 1
    EXPECT_FALSE(changed([](auto& rows) { rows.back().conditions.delay_s = 0.009; }));  // experiment 3
    EXPECT_FALSE(changed([](auto& rows) { rows.back().conditions.removes_fixture = true; }));
    EXPECT_FALSE(changed([](auto& rows) { rows.back().conditions.compensator = Compensator::kWave; }));
    EXPECT_FALSE(changed([](auto& rows) {
        std::erase_if(rows, [](const TrialRow& row) {
            return row.conditions.experiment == 3 && row.conditions.modality == Modality::kHF;
        });
    }));
}

// Experiment 3's control trials have no delay and are not experiment 1's.
TEST(StudyColumns, TakeAnExperimentsOwnTrials) {
    Table table;
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
    Table table;
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
    Table table;
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

TEST(Claims, JsonIsAListOfObjects) {
    const TemporaryDirectory directory;
    write_claims(judge_claims(the_papers().rows), directory / "claims.json");
    const auto json = nlohmann::json::parse(read_text(directory / "claims.json"));
    ASSERT_TRUE(json.is_array());
    ASSERT_GE(json.size(), 20U);
    for (const auto& entry : json) {
        for (const char* key : {"id", "kind", "claim", "paper", "ours"})
            EXPECT_TRUE(entry.at(key).is_string());
        // Neither the lag nor the participant sessions' length can be judged by this table.
        const bool open = entry.at("id") == "D.delay45" || entry.at("id") == "S.length";
        EXPECT_EQ(entry.at("reproduced").is_null(), open) << entry.at("id");
        EXPECT_TRUE(entry.contains("direction"));
    }
}

}  // namespace
}  // namespace thimble
