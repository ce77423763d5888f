// How much delay the handle's loop bears in one fitted person's hand.
#pragma once

#include <filesystem>
#include <vector>

#include "analysis/text/html.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// Delays of the whole way round, up to which the loop is stable; infinite: any delay.
struct DelayBound {
    double stiffness_N_per_m = 0;  // of the fixture, at the handle
    double median_s = 0;           // arm and grip at the medians of the fit
    double least_s = 0;            // at the worst corner of their 90 % intervals
};

// The session's own fixture, then half of its stiffness, a quarter and so on to 1/64. Co-contraction and dry friction are left out, as in
// critical_delay.hpp. Empty for a session without a fixture. `settings` are the twin's, and `fit` was read before (twin_of).
std::vector<DelayBound> delay_bounds(const SystemSettings& settings, const std::filesystem::path& fit);

ReportTable bounds_table(const std::vector<DelayBound>& bounds);

}  // namespace thimble
