// The whole study again with one seed after another: in which fraction of seeds does each claim come out?
#pragma once

#include "study/sweeps/claim_tally.hpp"
#include "study/sweeps/judged_study.hpp"

namespace thimble {

// Writes claims_seeds.csv (seed, id, reproduced, direction; as each seed ends), claims.json (write_tally) and
// report.html, fragile claims first. Trials are not kept.
TallyResult run_sweep(const SystemSettings& settings, const SweepOptions& options);

}  // namespace thimble
