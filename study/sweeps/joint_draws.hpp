// All uncertain parameters drawn at once, a study for each draw: how much of a claim depends on the point that
// was chosen for them?
#pragma once

#include "study/sweeps/parameter_range.hpp"
#include "study/sweeps/seed_sweep.hpp"

namespace thimble {

struct JointDraw {
    std::uint64_t seed = 0;      // of the study, and of the draw
    std::vector<double> values;  // of the parameters, in their order, SI
};

// Independent and uniform within the ranges. A pure function of its arguments; a further parameter changes no
// other.
JointDraw draw_jointly(const std::vector<ParameterRange>& ranges, std::uint64_t seed);

// options.seeds draws. Writes draws.csv (seed, then a column per parameter), claims_draws.csv (seed, id,
// reproduced, direction), both as each study ends, claims.json and report.html.
TallyResult run_draws(const std::filesystem::path& config, const std::vector<ParameterRange>& ranges,
                      const SweepOptions& options);

}  // namespace thimble
