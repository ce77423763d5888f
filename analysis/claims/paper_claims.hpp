// The catalogue of the paper's claims: the trials that each needs, and how it is judged. claims.hpp says what they are.
#pragma once

#include <functional>
#include <vector>

#include "analysis/claims/claim_findings.hpp"
#include "analysis/claims/claims.hpp"
#include "analysis/tables/study_columns.hpp"

namespace thimble {

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
