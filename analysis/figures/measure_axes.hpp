// The axes that figures of measures share. All ranges are given: gnuplot refuses to find one where no value is a number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/statistics/named_values.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {

// A place of the horizontal axis, with as many values as are shown there ("n = 9-10" where its bars differ).
struct AxisPlace {
    std::string name, n;  // a name may have several lines
};
// The places at 0, 1, ...; with room beside them.
std::string place_axis(const std::vector<AxisPlace>& places);
// A place per column, with the number of its values. Long names are broken, "HF+wave" behind its modality.
std::vector<AxisPlace> places_of(const std::vector<NamedValues>& columns);

// A panel per measure, side by side, of the width and with the foot that these places need; one alone is wide enough for a key.
FigureGrid measure_grid(std::size_t measures, const std::vector<AxisPlace>& places);

// A value as the measure is shown (mm, s), and a tab.
void write_shown(std::string& data, double value, Metric metric);

// The vertical axis of a measure. Logarithmic if the largest of the values is more than five times their median
// and none is zero or negative: else an oscillation presses all others into one line.
bool wants_logarithm(std::span<const double> values);
std::string measure_axis(Metric metric, std::span<const double> values);  // SI
// Its range and numbers, of values as shown. Linear, if none is a number above zero.
std::string vertical_axis(std::span<const double> values, bool logarithmic);
// The horizontal axis of what may have either sign, with zero in it and at most seven numbers.
std::string signed_axis(std::span<const double> values);
// 1, 2 or 5 times a power of ten, so that a range of `span` has at most `most` of them.
double nice_step(double span, double most);

std::vector<double> values_of(const std::vector<NamedValues>& columns);  // all of them
// Without those columns in which no measure has a number: conditions that the study does not have. All of them, if none has.
std::vector<std::vector<NamedValues>> present_columns(std::vector<std::vector<NamedValues>> measures);

}  // namespace thimble
