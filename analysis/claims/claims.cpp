#include "analysis/claims/claims.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/claims/claim_findings.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

struct Experiments {
    StudyColumns one, two, three, no_lag;
};
using E = Experiments;

struct PaperClaim {
    const char *id, *claim, *paper;
    std::vector<StudyColumns E::*> needs;  // without trials of each of them the claim is not judged
    std::function<Finding(const E&)> judge;
    bool has_test = true;  // false: it only counts, so that any number of subjects will do
    ClaimKind kind = ClaimKind::kResult;
};

using Columns = StudyColumns;

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

std::vector<PaperClaim> paper_claims() {
    constexpr Metric kMean = Metric::kPenetrationMean, kMax = Metric::kPenetrationMax,
                     kTime = Metric::kCompletionTime;
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
        of(&E::one, "E1.normal", "penetration columns pass the normality test, time columns do not",
           "D'Agostino-Pearson K2", normality_finding),
        of(&E::one, "E1.time.same", "completion time does not differ", "Friedman, P > .1", same_time_finding),
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
        as(ClaimKind::kRecount, PaperClaim{"E3.time.only_delay",
                                           "HF's penalty in time is absent without delay",
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
                   "a sitting takes as long as the paper's",
                   "text: 9.13 min with experiments 1 and 2 (26 trials), 8.39 min with experiment 3",
                   {&E::one, &E::two, &E::three},
                   [](const E& e) { return length_finding(e.one, e.two, e.three); },
                   false},
    };
}

std::size_t fewest_subjects(const PaperClaim& of, const Experiments& experiments) {
    std::size_t fewest = kFewestJudged;
    for (const auto need : of.needs) fewest = std::min(fewest, (experiments.*need).subjects().size());
    return fewest;
}

constexpr double kPapersDelay_s = 0.05;

bool is_of_the_paper(const TrialConditions& c) {
    const bool delay =
        same_delay(c.delay_s, 0) || (c.experiment == 3 && same_delay(c.delay_s, kPapersDelay_s));
    return c.experiment >= 1 && c.experiment <= 3 && delay && c.removes_fixture == (c.experiment == 2) &&
           c.compensator == Compensator::kNone;
}

// Of an experiment that has trials at all.
bool has_all_modalities(const std::vector<TrialRow>& rows, std::uint32_t experiment) {
    if (of_experiment(rows, experiment).empty()) return true;
    const StudyColumns columns(rows, experiment);
    const auto& conditions = columns.conditions();
    return std::none_of(conditions.begin(), conditions.end(),
                        [&](const auto& condition) { return columns.rows_of(condition).empty(); });
}

Claim judged(const PaperClaim& of, const Experiments& experiments) {
    Claim claim{of.id, of.claim, of.paper};
    claim.kind = of.kind;
    claim.had_trials = std::none_of(of.needs.begin(), of.needs.end(),
                                    [&](const auto need) { return (experiments.*need).empty(); });
    if (!claim.had_trials) {
        claim.ours = "no trials to judge it by";
        return claim;
    }
    const std::size_t fewest = fewest_subjects(of, experiments);
    if (of.has_test && fewest < kFewestJudged) {
        claim.ours = fmt::format("not judged: {} subjects, at least {} are needed", fewest, kFewestJudged);
        return claim;
    }
    try {
        Finding finding = of.judge(experiments);
        claim.ours = std::move(finding.ours);
        claim.reproduced = finding.reproduced;
        claim.direction = finding.direction;
    } catch (const Error& refused) {
        claim.ours = fmt::format("not judged: {}", refused.what());
    }
    return claim;
}

}  // namespace

bool are_paper_trials(const std::vector<TrialRow>& rows) {
    return !rows.empty() &&
           std::all_of(rows.begin(), rows.end(),
                       [](const TrialRow& row) { return is_of_the_paper(row.conditions); }) &&
           has_all_modalities(rows, 1) && has_all_modalities(rows, 2) && has_all_modalities(rows, 3);
}

std::vector<Claim> judge_claims(const std::vector<TrialRow>& rows, const std::vector<TrialRow>& no_lag) {
    const Experiments experiments{{rows, 1}, {rows, 2}, {rows, 3}, {no_lag, 1}};
    std::vector<Claim> claims;
    for (const PaperClaim& claim : paper_claims()) claims.push_back(judged(claim, experiments));
    return claims;
}

nlohmann::ordered_json to_json(const Claim& claim) {
    const auto verdict = [](const std::optional<bool>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    nlohmann::ordered_json json{{"id", claim.id},
                                {"kind", kClaimKindNames[static_cast<std::size_t>(claim.kind)]},
                                {"claim", claim.claim},
                                {"paper", claim.paper},
                                {"ours", claim.ours}};
    json["reproduced"] = verdict(claim.reproduced);
    json["direction"] = verdict(claim.direction);
    return json;
}

void write_claims(const std::vector<Claim>& claims, const std::filesystem::path& json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Claim& claim : claims) list.push_back(to_json(claim));
    write_text_file(json, json_text(list, 2) + "\n");
}

ReportTable claims_table(const std::vector<Claim>& claims) {
    ReportTable table{"The paper's claims",
                      "Reproduced: direction and the paper's significance both come out; of a size: it is "
                      "within the paper's limit. "
                      "What is there by construction, and what recounts other claims, is not counted.",
                      {"id", "kind", "claim", "the paper", "here", "reproduced"}};
    for (const Claim& c : claims) {
        if (!c.reproduced) continue;
        table.rows.push_back({c.id, std::string(kClaimKindNames[static_cast<std::size_t>(c.kind)]), c.claim,
                              c.paper, c.ours,
                              *c.reproduced         ? "yes"
                              : c.direction == true ? "no, but the direction"
                                                    : "no"});
    }
    return table;
}

namespace {

// Of one kind: "17 of 19 judged results are reproduced; not: E1.normal". Nothing if none was judged.
std::string count_text(const std::vector<Claim>& claims, ClaimKind kind, const char* name) {
    unsigned judged = 0, reproduced = 0;
    std::string missing;
    for (const Claim& c : claims) {
        if (c.kind != kind || !c.reproduced) continue;
        ++judged;
        reproduced += *c.reproduced;
        if (!*c.reproduced) missing += (missing.empty() ? "; not: " : ", ") + c.id;
    }
    if (judged == 0) return "";
    return fmt::format("{} of {} judged {} {} reproduced{}", reproduced, judged, name,
                       reproduced == 1 ? "is" : "are", missing);
}

}  // namespace

std::string claims_sentence(const std::vector<Claim>& claims) {
    const std::string sizes = count_text(claims, ClaimKind::kSize, "sizes");
    std::string text = count_text(claims, ClaimKind::kResult, "results");
    if (text.empty())
        return fmt::format("No claim of the paper can be judged: it takes at least {} subjects",
                           kFewestJudged);
    if (!sizes.empty()) text += "; " + sizes;
    const auto refused = std::count_if(claims.begin(), claims.end(), [](const Claim& c) {
        return c.counts() && c.had_trials && !c.reproduced;
    });
    if (refused > 0) text += fmt::format("; {} more cannot be judged (see claims.json)", refused);
    return text;
}

}  // namespace thimble
