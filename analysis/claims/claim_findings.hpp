// A finding for each kind of claim of the paper. Each function throws Error (data) where a test refuses the data.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/claims/claims.hpp"
#include "analysis/tables/study_columns.hpp"

namespace thimble {

// Where the paper says P < .0001, and where it says that nothing differs, P > .1.
inline constexpr double kHighlySignificant = 1e-4;
inline constexpr double kNoDifference = 0.1;

struct Finding {
    std::string ours;
    bool reproduced = false;
    std::optional<bool> direction = {};
};

// The means of HF, CF, CCF and VF ascend, by ANOVA for repeated measures.
Finding order_finding(const StudyColumns& columns, Metric metric);
// All six pairs differ in the paper's direction, CF and CCF at a limit of their own.
Finding pairs_finding(const StudyColumns& columns, Metric metric, double limit_cf_ccf);
// Penetration is normal in every column, time is not: by this the paper chose its tests.
Finding normality_finding(const StudyColumns& columns);
// HF's maximum penetration is not normal: a few hands oscillate much more than the others.
Finding skewed_handle_finding(const StudyColumns& columns);
Finding same_time_finding(const StudyColumns& columns);

// Sizes that follow from the paper's F and P, with 95 % intervals. CF's cost beside HF is a part of VF's cost (Fieller, "Some problems
// in interval estimation", J. Royal Statistical Society B 16, 1954). HF's jumps have a spread, and a distance to the others' jumps.
Finding cost_ratio_finding(const StudyColumns& columns, Metric metric, double most);
Finding removal_spread_finding(const StudyColumns& columns);
// 95 % of studies of the paper's size with an effect as large as here have their F in an interval, and the paper's F
// lies in it. Noncentral F by Patnaik's approximation ("The non-central chi-square and F distributions", Biometrika
// 36, 1949). Of insertion, and of the removal.
Finding f_size_finding(const StudyColumns& columns, Metric metric, double papers_f);
Finding removal_f_finding(const StudyColumns& columns, double papers_f);

// After sudden removal: by one-way ANOVA, then the pairs with HF (HF larger), and those without (no difference).
Finding removal_finding(const StudyColumns& columns);
Finding removal_pairs_finding(const StudyColumns& columns, bool with_handle);

// With delay: only HF oscillates.
Finding stability_finding(const StudyColumns& columns);
// The metric differs between modalities (Friedman's test), and `larger` is larger than `smaller` (Dunn's test).
Finding friedman_finding(const StudyColumns& columns, Metric metric);
Finding dunn_finding(const StudyColumns& columns, Metric metric, std::string_view larger,
                     std::string_view smaller, double level);
// None of these pairs differs by Dunn's test.
using NamedPairs = std::vector<std::pair<std::string_view, std::string_view>>;
Finding same_ranks_finding(const StudyColumns& columns, Metric metric, const NamedPairs& pairs);
Finding only_delay_finding(const StudyColumns& without, const StudyColumns& with);

// Statements of abstract, discussion and text that have no test of their own.
Finding indistinct_finding(const StudyColumns& columns);
Finding lag_finding(const StudyColumns& one, const StudyColumns& no_lag);
Finding length_finding(const StudyColumns& one, const StudyColumns& two, const StudyColumns& three);

// "P = 3.2e-05", "P < 1e-300".
std::string p_text(double p);
// "HF 0.59, CF 4.52, CCF 5.22, VF 6.06 mm": the columns' means, as shown.
std::string means_text(const SampleTable& table, Metric metric);

// The catalogue of the paper's claims: the trials that each needs, and how it is judged. claims.hpp says what they are.
struct Experiments {
    StudyColumns one, two, three, no_lag;
};

struct PaperClaim {
    const char *id, *claim, *paper;
    std::vector<StudyColumns Experiments::*> needs;  // without trials of each of them the claim is not judged
    std::function<Finding(const Experiments&)> judge;
    bool has_test = true;  // false: it only counts, so that any number of subjects will do
    ClaimKind kind = ClaimKind::kResult;
};

// In the order of claims.json.
std::vector<PaperClaim> paper_claims();

}  // namespace thimble
