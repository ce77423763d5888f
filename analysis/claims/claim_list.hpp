// The claims by experiment; each function appends its own, judged or not.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/claims/claims.hpp"
#include "analysis/tables/study_columns.hpp"

namespace thimble {

// Where the paper says P < .0001, and where it says that nothing differs, P > .1.
inline constexpr double kHighlySignificant = 1e-4;
inline constexpr double kNoDifference = 0.1;

void claim_without_delay(const StudyColumns& one, std::vector<Claim>& claims);
void claim_sudden_removal(const StudyColumns& two, std::vector<Claim>& claims);
void claim_with_delay(const StudyColumns& one, const StudyColumns& three, std::vector<Claim>& claims);
void claim_in_the_discussion(const StudyColumns& one, const StudyColumns& no_lag, std::vector<Claim>& claims);
void claim_session_length(const StudyColumns& one, const StudyColumns& two, const StudyColumns& three,
                          std::vector<Claim>& claims);

struct Finding {
    std::string ours;
    bool reproduced = false;
    std::optional<bool> direction = {};
};
// Appends a claim (id, claim and paper given) with what `judge` finds. Without trials, or where a test refuses
// the data, it is not judged, and `ours` says why.
void add_claim(std::vector<Claim>& claims, const StudyColumns& columns, Claim claim,
               const std::function<Finding()>& judge);

// "P = 3.2e-05", "P < 1e-300".
std::string p_text(double p);
// "HF 0.59, CF 4.52, CCF 5.22, VF 6.06 mm": the columns' means, as shown.
std::string means_text(const SampleTable& table, Metric metric);

}  // namespace thimble
