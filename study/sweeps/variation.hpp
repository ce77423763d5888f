// One parameter after another from end to end of its range, the others as they are: which claims survive?
#pragma once

#include <filesystem>
#include <vector>

#include "analysis/figures/figures.hpp"
#include "study/sweeps/parameter_range.hpp"
#include "study/sweeps/seed_sweep.hpp"

namespace thimble {

struct VariedPoint {
    double value = 0;  // of the parameter, SI
    ClaimTally tally;  // over the seeds, the same ones at every point
};

struct Variation {
    ParameterRange range;
    std::vector<VariedPoint> points;
};

// Claims whose experiment was run, as indices into a tally's counts, in their order.
std::vector<std::size_t> shown_claims(const Variation& variation);

struct VariationResult {
    std::vector<Variation> variations;
    bool complete = true;
};

// A point that was interrupted is left out. `config`: the session file, "" for the defaults; every range has points.
// Writes claims_vary.csv (parameter, value, seed, id, reproduced, direction; as each study ends), vary.json and
// report.html with a figure for each parameter. All settings are read before the first trial: an unknown key or a
// value out of range costs nothing (Error, usage).
VariationResult run_variations(const std::filesystem::path& config, const std::vector<ParameterRange>& ranges,
                               const SweepOptions& options);

// Which claims come out where: claims down, the parameter across, the darker the more often.

// Into OUTPUT/figures; failure becomes `problem`, as in draw_figures.
DrawnFigures draw_survival(const Variation& variation, const std::filesystem::path& output);

// All uncertain parameters drawn at once, a study for each draw: how much of a claim depends on the point that
// was chosen for them?
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
