// The trials of one participant, as a run or a study left them, for a fit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "study/fit/operator_model.hpp"

namespace thimble {

struct RecordedTrials {
    std::vector<ObservedTrial> trials;
    std::size_t left_out = 0;  // without a beep, or without a feature
};

// From trials.csv and trajectories/ of `folder`, of all experiments or of one; trials whose fixture vanishes are not counted. Throws
// Error (data) where a file is missing, the participant has no trial, or a condition fewer than two. Likewise where experiments have
// other people under the same number.
RecordedTrials recorded_trials(const std::filesystem::path& folder, std::uint32_t subject,
                               std::optional<std::uint32_t> experiment = {});

}  // namespace thimble
