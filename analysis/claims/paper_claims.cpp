#include <utility>

#include "analysis/claims/claim_findings.hpp"

namespace thimble {
namespace {

using E = Experiments;
using Columns = StudyColumns;
constexpr Metric kMean = Metric::kPenetrationMean, kMax = Metric::kPenetrationMax,
                 kTime = Metric::kCompletionTime;

PaperClaim of(Columns E::*experiment, const char* id, const char* claim, const char* paper,
              const std::function<Finding(const Columns&)>& judge) {
    return {id, claim, paper, {experiment}, [=](const E& e) { return judge(e.*experiment); }};
}

PaperClaim as(ClaimKind kind, PaperClaim claim) {
    claim.kind = kind;
    return claim;
}

PaperClaim dunn(const char* id, const char* claim, const char* paper, Metric metric, const char* larger,
                const char* smaller, double level) {
    return of(&E::three, id, claim, paper,
              [=](const Columns& c) { return dunn_finding(c, metric, larger, smaller, level); });
}

std::vector<PaperClaim> claims_on_insertion() {
    return {
        of(&E::one, "E1.mean.order", "mean penetration HF < CF < CCF < VF",
           "RM-ANOVA F(3, 45) = 106.5, P < .0001", [](const Columns& c) { return order_finding(c, kMean); }),
        of(&E::one, "E1.mean.pairs", "mean penetration: all six pairs differ", "Bonferroni, P < .001 each",
           [](const Columns& c) { return pairs_finding(c, kMean, 1e-3); }),
        of(&E::one, "E1.max.order", "maximum penetration HF < CF < CCF < VF",
           "RM-ANOVA F(3, 45) = 81.89, P < .0001", [](const Columns& c) { return order_finding(c, kMax); }),
        of(&E::one, "E1.max.pairs", "maximum penetration: all six pairs differ",
           "Bonferroni, CF - CCF P < .05, others P < .001",
           [](const Columns& c) { return pairs_finding(c, kMax, 0.05); }),
        as(ClaimKind::kSize,
           of(&E::one, "E1.mean.ratio", "mean penetration: CF costs at most .519 of what VF costs",
              "(CF - HF) / (VF - HF), from F and P of the pairs",
              [](const Columns& c) { return cost_ratio_finding(c, kMean, 0.519); })),
        as(ClaimKind::kSize,
           of(&E::one, "E1.max.ratio", "maximum penetration: CF costs at most .547 of what VF costs",
              "(CF - HF) / (VF - HF), from F and P of the pairs",
              [](const Columns& c) { return cost_ratio_finding(c, kMax, 0.547); })),
        as(ClaimKind::kSize,
           of(&E::one, "E1.mean.f", "mean penetration: the effect is as large as the paper's",
              "RM-ANOVA F(3, 45) = 106.5", [](const Columns& c) { return f_size_finding(c, kMean, 106.5); })),
        as(ClaimKind::kSize,
           of(&E::one, "E1.max.f", "maximum penetration: the effect is as large as the paper's",
              "RM-ANOVA F(3, 45) = 81.89", [](const Columns& c) { return f_size_finding(c, kMax, 81.89); })),
        of(&E::one, "E1.normal", "penetration columns pass the normality test, time columns do not",
           "D'Agostino-Pearson K2", normality_finding),
        of(&E::one, "E1.time.same", "completion time does not differ", "Friedman, P > .1", same_time_finding),
    };
}

std::vector<PaperClaim> claims_on_removal() {
    return {
        of(&E::two, "E2.peak.differs", "peak displacement differs",
           "one-way ANOVA F(3, 28) = 100.3, P < .0001", removal_finding),
        of(&E::two, "E2.peak.hf", "HF's peak displacement is larger than each of the others'",
           "Bonferroni, P < .001 each", [](const Columns& c) { return removal_pairs_finding(c, true); }),
        of(&E::two, "E2.peak.rest", "VF, CF and CCF do not differ from each other",
           "Bonferroni, not significant", [](const Columns& c) { return removal_pairs_finding(c, false); }),
        as(ClaimKind::kSize,
           of(&E::two, "E2.peak.spread",
              "HF's peak displacement: the SD is at most .282 of its distance to the others",
              "from F(3, 28) = 100.3", removal_spread_finding)),
        as(ClaimKind::kSize,
           of(&E::two, "E2.peak.f", "peak displacement: the effect is as large as the paper's",
              "one-way ANOVA F(3, 28) = 100.3",
              [](const Columns& c) { return removal_f_finding(c, 100.3); })),
    };
}

std::vector<PaperClaim> claims_on_delay() {
    return {
        PaperClaim{"E3.stable",
                   "at 50 ms only HF oscillates; VF, CF and CCF hold a stable contact",
                   "figure",
                   {&E::three},
                   [](const E& e) { return stability_finding(e.three); },
                   false},
        of(&E::three, "E3.max.differs", "maximum penetration differs", "Friedman, P < .0001",
           [](const Columns& c) { return friedman_finding(c, kMax); }),
        dunn("E3.max.hf_cf", "maximum penetration HF > CF", "Dunn, P < .001", kMax, "HF", "CF", 1e-3),
        dunn("E3.max.hf_ccf", "maximum penetration HF > CCF", "Dunn, P < .05", kMax, "HF", "CCF", 0.05),
        dunn("E3.max.vf_cf", "maximum penetration VF > CF", "Dunn, P < .001", kMax, "VF", "CF", 1e-3),
        of(&E::three, "E3.max.rest", "maximum penetration: HF and VF, VF and CCF, CF and CCF do not differ",
           "Dunn, not significant",
           [](const Columns& c) {
               return same_ranks_finding(c, kMax, {{"HF", "VF"}, {"CCF", "VF"}, {"CF", "CCF"}});
           }),
        of(&E::three, "E3.max.normal", "HF's maximum penetration does not pass the normality test",
           "D'Agostino-Pearson K2", skewed_handle_finding),
        of(&E::three, "E3.time.differs", "completion time differs", "Friedman, P < .0001",
           [](const Columns& c) { return friedman_finding(c, kTime); }),
        dunn("E3.time.hf_vf", "completion time HF > VF", "Dunn, P < .01", kTime, "HF", "VF", 0.01),
        dunn("E3.time.hf_cf", "completion time HF > CF", "Dunn, P < .05", kTime, "HF", "CF", 0.05),
        dunn("E3.time.hf_ccf", "completion time HF > CCF", "Dunn, P < .001", kTime, "HF", "CCF", 1e-3),
        of(&E::three, "E3.time.rest", "completion time: VF, CF and CCF do not differ from each other",
           "Dunn, not significant",
           [](const Columns& c) {
               return same_ranks_finding(c, kTime, {{"CF", "VF"}, {"CCF", "VF"}, {"CF", "CCF"}});
           }),
    };
}

// Of several experiments, and statements of abstract, discussion and text.
std::vector<PaperClaim> claims_of_the_text() {
    return {
        as(ClaimKind::kRecount, PaperClaim{"E3.time.only_delay",
                                           "without delay, HF takes no longer than the others",
                                           "E1.time.same with E3.time.differs",
                                           {&E::one, &E::three},
                                           [](const E& e) { return only_delay_finding(e.one, e.three); }}),
        of(&E::one, "D.indistinct", "inserting with CF is nearly indistinguishable from HF",
           "abstract; here two one-sided tests of CF against HF in experiment 1", indistinct_finding),
        as(ClaimKind::kByConstruction,
           PaperClaim{"D.delay45",
                      "part of CF's larger penetration comes from the actuators' 45 ms",
                      "discussion; here the same trials with actuators without lag, paired t test, P < .001",
                      {&E::one, &E::no_lag},
                      [](const E& e) { return lag_finding(e.one, e.no_lag); }}),
        PaperClaim{"S.length",
                   "a participant session takes as long as in the paper",
                   "text: 9.13 min with experiments 1 and 2 (26 trials), 8.39 min with experiment 3",
                   {&E::one, &E::two, &E::three},
                   [](const E& e) { return length_finding(e.one, e.two, e.three); },
                   false},
    };
}

}  // namespace

std::vector<PaperClaim> paper_claims() {
    std::vector<PaperClaim> all;
    for (const auto& part :
         {claims_on_insertion(), claims_on_removal(), claims_on_delay(), claims_of_the_text()})
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace thimble
