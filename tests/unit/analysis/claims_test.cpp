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
#include "tests/unit/analysis/paper_rows.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

Claim claim_of(const std::vector<Claim>& claims, const std::string& id) {
    const auto found = std::find_if(claims.begin(), claims.end(), [&](const Claim& c) { return c.id == id; });
    EXPECT_NE(found, claims.end()) << id;
    return found == claims.end() ? Claim{} : *found;
}

void expect_reproduced(const std::vector<Claim>& claims, bool reproduced,
                       const std::vector<const char*>& ids) {
    for (const char* id : ids) {
        const Claim claim = claim_of(claims, id);
        EXPECT_EQ(claim.reproduced, reproduced) << id << ": " << claim.ours;
    }
}

PaperRows the_papers() {
    PaperRows table;
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
          "E3.max.rest",    "E3.time.rest",    "E1.mean.f",      "E1.max.f",           "E2.peak.f",
          "E3.max.normal"}) {
        EXPECT_EQ(ids.count(id), 1U) << id;
    }
}

TEST(Claims, APaperRowsMadeForThemReproducesThem) {
    const std::vector<Claim> claims = judge_claims(the_papers().rows);
    expect_reproduced(claims, true,
                      {"E1.mean.order", "E1.mean.pairs", "E1.max.order", "E1.max.pairs", "E1.time.same",
                       "E2.peak.differs", "E2.peak.hf", "E2.peak.rest", "E3.stable", "E3.max.differs",
                       "E3.max.hf_cf", "E3.max.hf_ccf", "E3.time.differs", "E3.time.only_delay",
                       "E1.mean.ratio", "E1.max.ratio", "E2.peak.spread", "E3.max.rest"});
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

    PaperRows dear;  // CF costs 4 of 7 mm, and HF's jumps differ as much as they are large
    dear.add(1, 16, {0.001, 0.005, 0.0055, 0.008}, {11, 11, 11, 11});
    dear.add_removals({0.0002, 0.0001, 0.0001, 0.0001});
    expect_reproduced(judge_claims(dear.rows), false, {"E1.mean.ratio", "E1.max.ratio", "E2.peak.spread"});
}

// An F near the paper's is of its size, and one that is much larger is not. The size of an effect is not that of the study: each
// subject twice gives twice the F, and about the same interval.
TEST(Claims, TheEffectIsAsLargeAsThePapersWhereItsFIsAmongThoseOfSuchStudies) {
    EXPECT_EQ(claim_of(judge_claims(the_papers().rows), "E1.mean.f").reproduced, false);
    PaperRows small;
    small.add(1, 16, {0.001, 0.001057, 0.001107, 0.001136}, {11, 11, 11, 11});
    small.add_removals({0.0005, 0.0001, 0.0001, 0.0001});
    std::vector<TrialRow> twice = small.rows;
    for (TrialRow row : small.rows) {
        row.conditions.subject += 16;
        twice.push_back(row);
    }
    const std::string once_words = "95 % of studies", twice_words = "95 % of studies of the paper's size";
    for (const auto& [rows, words] : {std::pair{small.rows, once_words}, {twice, twice_words}}) {
        SCOPED_TRACE(words);
        const std::vector<Claim> claims = judge_claims(rows);
        expect_reproduced(claims, true, {"E1.mean.f", "E2.peak.f"});
        for (const char* id : {"E1.mean.f", "E2.peak.f"})
            EXPECT_THAT(claim_of(claims, id).ours, HasSubstr(words)) << id;
    }
}

TEST(Claims, AHandleThatThrowsAFewIsNotNormal) {
    PaperRows table = the_papers();
    const auto reproduced = [&] { return claim_of(judge_claims(table.rows), "E3.max.normal").reproduced; };
    EXPECT_EQ(reproduced(), false);
    for (TrialRow& row : table.rows) {
        const bool thrown = row.conditions.experiment == 3 && row.conditions.modality == Modality::kHF &&
                            row.conditions.subject == 1;
        if (thrown) row.metrics.penetration_max_m = 0.3;
    }
    EXPECT_EQ(reproduced(), true);
}

// Where HF is the worst, a cost has the wrong sign, and a ratio of two such costs says nothing.
TEST(Claims, ARatioOfNegativeCostsIsNoReproduction) {
    PaperRows worst;
    worst.add(1, 16, {0.008, 0.007, 0.005, 0.001}, {11, 11, 11, 11});
    EXPECT_EQ(claim_of(judge_claims(worst.rows), "E1.mean.ratio").reproduced, false);
}

TEST(Claims, ADifferenceWhereThePaperHasNoneIsNoReproduction) {
    PaperRows table = the_papers();
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
        "1 of 2 judged results is reproduced; not reproduced: b; 0 of 1 judged sizes are reproduced; not "
        "reproduced: c");
}

// Significance in the wrong direction is no reproduction.
TEST(Claims, TheDirectionCounts) {
    PaperRows table;
    table.add(1, 16, {0.008, 0.0055, 0.004, 0.001}, {11, 12, 13, 14});
    table.add_removals({0.001, 0.02, 0.02, 0.02});
    table.add(3, 10, {0.001, 0.004, 0.0055, 0.008}, {10, 11, 12, 13}, 0.05);
    const std::vector<Claim> claims = judge_claims(table.rows);
    expect_reproduced(claims, false,
                      {"E1.mean.order", "E1.mean.pairs", "E1.max.order", "E1.time.same", "E2.peak.hf",
                       "E3.max.hf_cf", "E3.time.hf_vf", "E3.time.only_delay"});
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
    PaperRows wrong;
    wrong.add(3, 10, {0.003, 0.004, 0.0055, 0.008}, {15, 11, 11, 11}, 0.05);
    EXPECT_EQ(claim_of(judge_claims(wrong.rows), "E3.max.hf_cf").direction, false);
}

TEST(Claims, WhatTheLagCostsIsAPairedDifference) {
    const PaperRows with = the_papers();
    PaperRows without;
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
    PaperRows table = the_papers();
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
    PaperRows table = the_papers();
    table.rows.back().metrics.oscillates = true;  // VF at 50 ms
    EXPECT_EQ(claim_of(judge_claims(table.rows), "E3.stable").reproduced, false);
}

TEST(Claims, StabilityNeedsMoreThanHalfOfTheHandlesTrialsToOscillate) {
    PaperRows table = the_papers();
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
    const auto pair_of = [](const PaperRows& table, Metric metric, std::size_t pair) {
        return pairs_after_repeated_anova(StudyColumns(table.rows, 1).table(metric).table).at(pair);
    };
    PaperRows near_cf, near_ccf;
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
    expect_reproduced(cf, true, {"E1.max.pairs"});
    expect_reproduced(cf, false, {"E1.mean.pairs"});
    expect_reproduced(ccf, false, {"E1.max.pairs", "E1.mean.pairs"});
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
    PaperRows table;
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
    expect_reproduced(claims, true, {"E3.time.hf_cf", "E3.max.hf_ccf"});
    expect_reproduced(
        claims, false,
        {"E3.time.hf_vf", "E3.time.hf_ccf", "E3.max.hf_cf", "E3.max.differs", "E3.time.differs"});
    for (const char* id : {"E3.time.hf_vf", "E3.time.hf_ccf", "E3.max.hf_cf"})
        EXPECT_EQ(claim_of(claims, id).direction, true) << id;
}

TEST(Claims, DataThatATestRefusesAreNotJudgedAndSayWhy) {
    PaperRows few;
    few.add(1, 2, {0.001, 0.004, 0.0055, 0.008}, {11, 11, 11, 11});
    const Claim order = claim_of(judge_claims(few.rows), "E1.mean.order");
    EXPECT_FALSE(order.reproduced);
    EXPECT_THAT(order.ours, HasSubstr("not judged: 2 subjects, at least 6 are needed"));
    PaperRows steady = the_papers();  // what only counts needs no number of subjects
    std::erase_if(steady.rows, [](const TrialRow& row) { return row.conditions.subject > 2; });
    const std::vector<Claim> two = judge_claims(steady.rows);
    EXPECT_EQ(claim_of(two, "E3.stable").reproduced, true);
    EXPECT_FALSE(claim_of(two, "E3.max.differs").reproduced);
    ASSERT_EQ(claims_table(two).rows.size(), 1U);  // those that are not judged have no row
    EXPECT_EQ(claims_table(two).rows[0][0], "E3.stable");
    EXPECT_THAT(
        claims_sentence(two),
        testing::MatchesRegex("1 of [12] judged results is reproduced.*; [0-9]+ more cannot be judged"))
        << "names no file, which not every caller writes";
    EXPECT_THAT(claims_sentence({}), HasSubstr("at least 6 subjects"));
    PaperRows interrupted = the_papers();
    for (TrialRow& row : interrupted.rows) row.reason = EndReason::kInterrupted;
    for (const Claim& c : judge_claims(interrupted.rows)) EXPECT_FALSE(c.reproduced) << c.id;
}

TEST(Claims, OnlyThePapersDesignIsThePapers) {
    PaperRows papers = the_papers();
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

TEST(Claims, JsonIsAListOfObjects) {
    const TemporaryDirectory directory;
    write_claims(judge_claims(the_papers().rows), directory / "claims.json");
    const auto json = nlohmann::json::parse(read_text(directory / "claims.json"));
    ASSERT_TRUE(json.is_array());
    ASSERT_GE(json.size(), 20U);
    for (const auto& entry : json) {
        for (const char* key : {"id", "kind", "claim", "paper", "ours"})
            EXPECT_TRUE(entry.at(key).is_string());
        // This table decides neither the lag nor the length of the participant sessions.
        const bool open = entry.at("id") == "D.delay45" || entry.at("id") == "S.length";
        EXPECT_EQ(entry.at("reproduced").is_null(), open) << entry.at("id");
        EXPECT_TRUE(entry.contains("direction"));
    }
}

}  // namespace
}  // namespace thimble
