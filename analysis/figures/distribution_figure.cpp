#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/measure_axes.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

constexpr double kBoxAt = -0.2, kPointsAt = 0.18;  // beside the modality's place on the axis
constexpr double kPointsWidth = 0.3;

// Spread evenly by the golden section: no random number, and neighbours in time stand apart.
double jitter(std::size_t i) {
    constexpr double kGolden = 0.6180339887498949;
    const double turns = kGolden * static_cast<double>(i);
    return (turns - std::floor(turns) - 0.5) * kPointsWidth;
}

// Tukey's box: quartiles and median, whiskers to the last value within 1.5 times the box's height.
void write_box(std::string& data, double x, const NamedValues& trials, Metric metric) {
    const double low = sample_quantile(trials, 0.25), high = sample_quantile(trials, 0.75);
    const double reach = 1.5 * (high - low);
    double lowest = low, highest = high;
    for (const double value : trials.values) {
        if (value >= low - reach) lowest = std::min(lowest, value);
        if (value <= high + reach) highest = std::max(highest, value);
    }
    write_cell(data, x + kBoxAt);
    for (const double value : {low, lowest, highest, high, sample_median(trials), sample_mean(trials)})
        write_shown(data, value, metric);
    data.back() = '\n';
}

using MeasureGroups = std::vector<std::vector<NamedValues>>;  // of each measure

void write_boxes(std::string& data, const std::vector<NamedValues>& groups, Metric metric) {
    data += fmt::format("# {}: x, quartile, whisker, whisker, quartile, median, mean\n", info(metric).label);
    for (std::size_t m = 0; m < groups.size(); ++m) {
        if (!groups[m].values.empty()) write_box(data, static_cast<double>(m), groups[m], metric);
    }
    data += "NaN NaN NaN NaN NaN NaN NaN\n\n\n";  // gnuplot does not count a block without numbers
}

void write_points(std::string& data, const std::vector<NamedValues>& groups, Metric metric) {
    data += fmt::format("# {}: x, trial\n", info(metric).label);
    for (std::size_t m = 0; m < groups.size(); ++m) {
        for (std::size_t i = 0; i < groups[m].values.size(); ++i) {
            write_cell(data, static_cast<double>(m) + kPointsAt + jitter(i));
            write_shown(data, groups[m].values[i], metric);
            data.back() = '\n';
        }
    }
    data += "NaN NaN\n\n\n";
}

// Two blocks per measure: boxes, points.
std::string distribution_data(const MeasureGroups& measures, const std::vector<Metric>& metrics) {
    std::string data;
    for (std::size_t i = 0; i < metrics.size(); ++i) {
        write_boxes(data, measures[i], metrics[i]);
        write_points(data, measures[i], metrics[i]);
    }
    return data;
}

std::string trial_point() {
    return fmt::format("with points pointtype 7 pointsize 0.3 linecolor '{}'", kBlue);
}
constexpr const char* kMeanCross = "with points pointtype 2 pointsize 0.7 linewidth 1.5 linecolor 'black'";

std::string distribution_script(const MeasureGroups& measures, const std::vector<Metric>& metrics,
                                const std::string& name) {
    FigureGrid grid = measure_grid(metrics.size(), places_of(measures[0]));
    grid.entries = {{trial_point(), "one trial"},
                    {"with boxes fillstyle solid 0.15 border linewidth 1 linecolor 'black'", "quartiles"},
                    {"with lines linewidth 2.5 linecolor 'black'", "median"},
                    {kMeanCross, "mean"}};
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += "unset key; set boxwidth 0.26 absolute\nset multiplot\n";
    for (std::size_t i = 0; i < metrics.size(); ++i) {
        script += grid.margins(0, i) + place_axis(places_of(measures[i])) +
                  measure_axis(metrics[i], values_of(measures[i]));
        fmt::format_to(std::back_inserter(script),
                       R"(plot '{name}.tsv' index {points} using 1:2 {trial}, \
     '{name}.tsv' index {boxes} using 1:2:3:4:5 with candlesticks whiskerbars 0.5 fillstyle solid 0.15 border linewidth 1 linecolor 'black', \
     '' index {boxes} using 1:6:6:6:6 with candlesticks linewidth 2.5 linecolor 'black', \
     '' index {boxes} using 1:7 {mean}
)",
                       fmt::arg("name", name), fmt::arg("boxes", 2 * i), fmt::arg("points", 2 * i + 1),
                       fmt::arg("trial", trial_point()), fmt::arg("mean", kMeanCross));
    }
    return script + grid.key() + "unset multiplot\n";
}

}  // namespace

FigureSource distribution_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                                 const std::string& name) {
    if (columns.empty() || metrics.empty()) return {};
    MeasureGroups measures;
    for (const Metric metric : metrics) measures.push_back(columns.groups(metric));
    measures = present_columns(std::move(measures));
    return {name, "Distributions",
            fmt::format("{} Each point is one trial; points are spread sideways so that all can be seen. n: "
                        "trials with this measure. Box: quartiles and median; cross: mean; whiskers: "
                        "farthest trials within 1.5 times the height of the box. Trials of one subject are "
                        "not independent, so the tests average them first.",
                        trials_text(columns)),
            distribution_data(measures, metrics), distribution_script(measures, metrics, name)};
}

}  // namespace thimble
