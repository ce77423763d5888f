// The report's parts about the loops themselves: the handle's, by theory and measured, and the person's.
#pragma once

#include <filesystem>

#include "analysis/report/report.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// Stability map of a firm grip, and for five hands the critical delay by theory and as measured. `jobs` threads (0: one per core)
// for the map. Figures into OUT/figures.
ReportSection handle_loop_section(const std::filesystem::path& out, unsigned jobs);

// At which gain and reaction time a person led by skin or eyes would oscillate: theory, the running loop of the same five hands, and
// the virtual operator's own arm with the lags of these settings.
ReportSection perceptual_loop_section(const SystemSettings& settings, const std::filesystem::path& out);

// Growth per second of the virtual operator's arm, nominal and without dry friction, whose intention follows -L x(t - lag).
double operator_growth_per_s(const SystemSettings& settings, double lag_s, double gain_per_s);

}  // namespace thimble
