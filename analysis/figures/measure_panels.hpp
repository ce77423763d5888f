// Parts that the figures of one experiment share: panels by measure, modalities on the horizontal axis.
#pragma once

#include <span>
#include <string>

#include "analysis/figures/figure_grid.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {

// A panel per measure, side by side; of a single one wider, so that key and axis fit.
FigureGrid measure_grid(std::size_t measures);

// HF, CF, CCF, VF at 0 to 3, with room beside them.
std::string modality_axis();

// A value as the measure is shown (mm, s), and a tab.
void write_shown(std::string& data, double value, Metric metric);

// The vertical axis of a measure. Logarithmic if the largest of the values is more than five times their median
// and none is zero or negative: else an oscillation presses all others into one line.
bool wants_logarithm(std::span<const double> values);
std::string measure_axis(Metric metric, std::span<const double> values);

}  // namespace thimble
