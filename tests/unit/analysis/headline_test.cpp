#include "analysis/claims/headline.hpp"

#include <gtest/gtest.h>

namespace thimble {
namespace {

// Ten trials per modality at 0 and 50 ms; HF oscillates in all of those at 50 ms.
std::vector<ConditionSummary> paper() {
    std::vector<ConditionSummary> conditions;
    for (const double delay_s : {0.0, 0.05}) {
        for (const Modality modality : kModalities) {
            ConditionSummary condition;
            condition.modality = modality;
            condition.delay_s = delay_s;
            condition.trials = condition.judged = 10;
            condition.oscillating = modality == Modality::kHF && delay_s > 0 ? 10 : 0;
            conditions.push_back(condition);
        }
    }
    return conditions;
}

ConditionSummary& at(std::vector<ConditionSummary>& conditions, Modality modality, double delay_s) {
    return *find_condition(conditions, modality, delay_s);
}

TEST(Headline, Supported) {
    const Headline headline = judge_headline(paper());
    EXPECT_EQ(headline.verdict, Verdict::kSupported);
    EXPECT_EQ(headline.sentence(), "At 50 ms only HF oscillates: supported.");
}

TEST(Headline, MostTrialsOfHFSuffice) {
    auto conditions = paper();
    at(conditions, Modality::kHF, 0.05).oscillating = 6;
    EXPECT_EQ(judge_headline(conditions).verdict, Verdict::kSupported);
    at(conditions, Modality::kHF, 0.05).oscillating = 5;
    const Headline half = judge_headline(conditions);
    EXPECT_EQ(half.verdict, Verdict::kNotSupported);
    EXPECT_EQ(half.sentence(),
              "At 50 ms only HF oscillates: not supported (HF oscillates in only 5 of 10 trials at 50 ms).");
}

TEST(Headline, OneOscillatingTrialOfAnotherModalityRefutes) {
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        for (const double delay_s : {0.0, 0.05}) {
            auto conditions = paper();
            at(conditions, modality, delay_s).oscillating = 1;
            EXPECT_EQ(judge_headline(conditions).verdict, Verdict::kNotSupported);
        }
    }
}

TEST(Headline, HFWithoutDelayMustNotOscillate) {
    auto conditions = paper();
    at(conditions, Modality::kHF, 0).oscillating = 1;
    const Headline headline = judge_headline(conditions);
    EXPECT_EQ(headline.verdict, Verdict::kNotSupported);
    ASSERT_EQ(headline.reasons.size(), 1U);
    EXPECT_EQ(headline.reasons[0], "HF oscillates in 1 of 10 trials at 0 ms");
}

TEST(Headline, WhatWasNotTriedIsNotJudged) {
    auto conditions = paper();
    at(conditions, Modality::kVF, 0.05).judged = 0;
    const Headline headline = judge_headline(conditions);
    EXPECT_EQ(headline.verdict, Verdict::kNotJudged);
    EXPECT_EQ(headline.reasons.at(0), "no trial of VF at 50 ms that can be judged");
    EXPECT_EQ(judge_headline({}).verdict, Verdict::kNotJudged);
    at(conditions, Modality::kCF, 0).oscillating = 1;  // a counterexample needs no complete study
    EXPECT_EQ(judge_headline(conditions).verdict, Verdict::kNotSupported);
}

TEST(Headline, AnotherDelay) {
    const Headline headline = judge_headline(paper(), 0.1);
    EXPECT_EQ(headline.claim(), "At 100 ms only HF oscillates");
    EXPECT_EQ(headline.verdict, Verdict::kNotJudged);
}

TrialRow row(std::uint32_t subject, double maximum_m) {
    TrialRow row;
    row.conditions.subject = subject;
    row.metrics.penetration_max_m = maximum_m;
    row.metrics.first_contact_time_s = 1;
    row.metrics.beeped = true;
    row.reason = EndReason::kCompleted;
    return row;
}

TEST(ConditionSummary, TrialsOfASubjectAreAveragedFirst) {
    // Subject means 2 and 6 mm; a mean over trials would give 3 mm.
    const auto conditions = summarize({row(1, 0.001), row(1, 0.002), row(1, 0.003), row(2, 0.006)});
    ASSERT_EQ(conditions.size(), 1U);
    const Statistic& statistic = conditions[0].of(Metric::kPenetrationMax);
    EXPECT_EQ(statistic.n, 2U);
    EXPECT_NEAR(statistic.mean, 0.004, 1e-15);
    EXPECT_NEAR(statistic.sd, 0.004 / std::sqrt(2), 1e-15);
    EXPECT_EQ(conditions[0].of(Metric::kCompletionTime).n, 0U);
    EXPECT_TRUE(std::isnan(conditions[0].of(Metric::kCompletionTime).mean));
}

TEST(ConditionSummary, BrokenOffAndContactlessTrialsAreNotJudged) {
    TrialRow lost = row(1, 0.5);
    lost.reason = EndReason::kPeerLost;
    lost.metrics.oscillates = true;
    TrialRow contactless = row(1, 0.5);
    contactless.metrics.first_contact_time_s = std::numeric_limits<double>::quiet_NaN();
    const auto conditions = summarize({row(1, 0.001), lost, contactless});
    EXPECT_EQ(conditions.at(0).trials, 3U);
    EXPECT_EQ(conditions.at(0).judged, 1U);
    EXPECT_EQ(conditions.at(0).oscillating, 0U);
    EXPECT_DOUBLE_EQ(conditions.at(0).of(Metric::kPenetrationMax).mean, 0.001);
    EXPECT_TRUE(std::isnan(conditions.at(0).of(Metric::kPenetrationMax).sd));
}

TEST(ConditionSummary, SortedByDelayThenModality) {
    TrialRow slow = row(1, 0.001);
    slow.conditions.delay_s = 0.05;
    TrialRow visual = row(1, 0.001);
    visual.conditions.modality = Modality::kVF;
    const auto conditions = summarize({slow, visual, row(1, 0.001)});
    ASSERT_EQ(conditions.size(), 3U);
    EXPECT_EQ(conditions[0].modality, Modality::kHF);
    EXPECT_EQ(conditions[1].modality, Modality::kVF);
    EXPECT_EQ(conditions[2].delay_s, 0.05);
}

}  // namespace
}  // namespace thimble
