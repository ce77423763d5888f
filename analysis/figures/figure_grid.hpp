// Panels of equal size in rows and columns of one picture, in pixels; and the axes that figures share.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/statistics/named_values.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {

struct FigureGrid {
    std::size_t columns = 1, rows = 1;
    int panel_width_px = 260, panel_height_px = 240;
    int left_px = 92, right_px = 12;       // of the whole picture
    int head_px = 44, foot_px = 48;        // of the whole picture
    int between_px = 82, beneath_px = 48;  // from a panel to the next beside it, and below it

    int width_px() const;
    int height_px() const;
    // The gnuplot lines that put what is plotted next there; row 0 is on top.
    std::string margins(std::size_t row, std::size_t column) const;
    // A key as wide as all panels, in the head. Entries are those of gnuplot's plot ("NaN with lines title 'a'"). It is the
    // last plot of a multiplot, because gnuplot stacks the key of a panel to fit that panel.
    std::string key(const std::string& entries) const;
};

// A panel per measure, side by side; of a single one wider, so that key and axis fit.
FigureGrid measure_grid(std::size_t measures);

// HF, CF, CCF, VF at 0 to 3, with room beside them.
std::string modality_tics();
std::string modality_axis();

// A value as the measure is shown (mm, s), and a tab.
void write_shown(std::string& data, double value, Metric metric);

// The vertical axis of a measure. Logarithmic if the largest of the values is more than five times their median
// and none is zero or negative: else an oscillation presses all others into one line.
bool wants_logarithm(std::span<const double> values);
std::string measure_axis(Metric metric, std::span<const double> values);
std::vector<double> values_of(const std::vector<NamedValues>& columns);

}  // namespace thimble
