#include "analysis/figures/measure_panels.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/statistics/descriptive.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {

FigureGrid measure_grid(std::size_t measures) {
    FigureGrid grid;
    grid.columns = measures;
    if (measures == 1) grid.panel_width_px = 480;
    return grid;
}

std::string modality_axis() {
    std::string tics;
    for (std::size_t i = 0; i < kModalities.size(); ++i) {
        tics += fmt::format("{}'{}' {}", i > 0 ? ", " : "", to_string(kModalities[i]), i);
    }
    return fmt::format("set xrange [-0.6:{}.6]; set xtics scale 0 ({})\n", kModalities.size() - 1, tics);
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

}  // namespace thimble
