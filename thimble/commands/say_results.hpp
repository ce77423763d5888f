// The results of a run or a study on stdout.
#pragma once

#include <filesystem>
#include <vector>

#include "session/records/trial_table.hpp"

namespace thimble {

// A line per condition, the headline if there was a delay, and where the report lies in `folder`; as JSON the
// folder's summary.json instead.
void say_results(bool json, const std::filesystem::path& folder, const std::vector<TrialRow>& rows);

}  // namespace thimble
