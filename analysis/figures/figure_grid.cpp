#include "analysis/figures/figure_grid.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/statistics/descriptive.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {

int FigureGrid::width_px() const {
    const int n = static_cast<int>(columns);
    return left_px + n * panel_width_px + (n - 1) * between_px + right_px;
}

int FigureGrid::height_px() const {
    const int n = static_cast<int>(rows);
    return head_px + n * panel_height_px + (n - 1) * beneath_px + foot_px;
}

std::string FigureGrid::margins(std::size_t row, std::size_t column) const {
    const int left = left_px + static_cast<int>(column) * (panel_width_px + between_px);
    const int top = head_px + static_cast<int>(row) * (panel_height_px + beneath_px);
    const double width = width_px(), height = height_px();
    return fmt::format(
        "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}; set tmargin at screen {:.4f}; set "
        "bmargin at screen {:.4f}\n",
        left / width, (left + panel_width_px) / width, 1 - top / height,
        1 - (top + panel_height_px) / height);
}

std::string FigureGrid::key(const std::string& entries) const {
    constexpr int kHeight_px = 36;
    return fmt::format(
        "unset border; unset tics; unset xlabel; unset ylabel; unset title; unset arrow; unset logscale\n"
        "set xrange [0:1]; set yrange [0:1]; set offsets 0, 0, 0, 0\n"
        "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}; set tmargin at screen 1; set bmargin at "
        "screen {:.4f}\n"
        "set key center center horizontal samplen 2.5 textcolor '#222222'\nplot {}\n",
        1.0 * left_px / width_px(), 1 - 1.0 * right_px / width_px(), 1 - 1.0 * kHeight_px / height_px(),
        entries);
}

FigureGrid measure_grid(std::size_t measures) {
    FigureGrid grid;
    grid.columns = measures;
    if (measures == 1) grid.panel_width_px = 480;
    return grid;
}

std::string modality_tics() {
    return numbered_tics(kModalities.size(), [](std::size_t i) { return to_string(kModalities[i]); });
}

std::string modality_axis() {
    return fmt::format("set xrange [-0.6:3.6]; set xtics scale 0 ({})\n", modality_tics());
}

void write_shown(std::string& data, double value, Metric metric) {
    write_cell(data, value * info(metric).shown_per_si);
}

bool wants_logarithm(std::span<const double> values) {
    constexpr double kFarOut = 5;
    NamedValues numbers{"values", {}};
    for (const double value : values) {
        if (std::isnan(value)) continue;
        if (value <= 0) return false;
        numbers.values.push_back(value);
    }
    if (numbers.values.empty()) return false;
    const double largest = *std::max_element(numbers.values.begin(), numbers.values.end());
    return largest > kFarOut * sample_median(numbers);
}

std::string measure_axis(Metric metric, std::span<const double> values) {
    const bool logarithm = wants_logarithm(values);
    // Linear axes start at zero, so that sizes compare, unless there are values below it.
    const bool below_zero = std::any_of(values.begin(), values.end(), [](double value) { return value < 0; });
    // Decades alone would leave some panels with one tic.
    constexpr std::string_view kTics =
        "(0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500)";
    return fmt::format("set ylabel '{}{}'\n{}set yrange [{}:*]; set offsets 0, 0, {}, 0\n",
                       info(metric).label, logarithm ? ", log scale" : "",
                       logarithm ? fmt::format("set logscale y; set ytics {}; ", kTics)
                                 : "unset logscale y; set ytics autofreq; ",
                       logarithm || below_zero ? "*" : "0", logarithm ? "0" : "graph 0.04");
}

std::vector<double> values_of(const std::vector<NamedValues>& columns) {
    std::vector<double> values;
    for (const NamedValues& column : columns)
        values.insert(values.end(), column.values.begin(), column.values.end());
    return values;
}

}  // namespace thimble
