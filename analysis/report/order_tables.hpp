// Mixed models on single trials: what their order does, beside tests that average a subject's trials first.
#pragma once

#include <vector>

#include "analysis/text/html.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

// A table per experiment and delay: of each measure the change with every ten trials, the differences of the modalities from the first
// one, and how much subjects differ. Empty where no group of trials can be judged.
std::vector<ReportTable> order_tables(const std::vector<TrialRow>& rows);

}  // namespace thimble
